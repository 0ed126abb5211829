# SPDX-License-Identifier: MIT
"""spume compare: two runs side by side, on run folders whose differences are known."""
import json
import unittest

import paths  # noqa: F401
import numpy as np
from synthetic import lattice, new_folder, write_case, write_snapshots, write_table
from test_tools import Scratch, call

from spume_tools.compare.differences import compared, flattened
from spume_tools.results.tables import Table


def table(**columns):
    return Table("series.csv", {name: np.array(values, float) for name, values in columns.items()})


class Differences(unittest.TestCase):
    def test_the_second_run_is_interpolated_and_the_last_common_time_counts(self):
        first = table(t=[0, 1, 2, 3], speed=[0, 1, 2, 3], only=[1, 1, 1, 1])
        second = table(t=[0, 2.5], speed=[0, 5])
        (found,), end = compared((first, second), set())
        self.assertEqual((found.name, end), ("speed", 2.5))
        self.assertAlmostEqual(found.first, 2.5)
        self.assertAlmostEqual(found.second, 5)
        self.assertAlmostEqual(found.largest, 2.5)
        self.assertAlmostEqual(found.at, 2.5)
        self.assertAlmostEqual(found.scale, 2.5)

    def test_the_largest_difference_is_found_in_the_middle(self):
        first = table(t=[0, 1, 2], x=[0, 7, 0])
        second = table(t=[0, 1, 2], x=[0, 4, 0])
        (found,), _ = compared((first, second), set())
        self.assertEqual((found.largest, found.at, found.first, found.second), (3, 1, 0, 0))

    def test_times_without_a_value_do_not_count(self):
        first = table(t=[0, 1, 2], level=[np.nan, 2, np.nan])
        second = table(t=[0, 1, 2], level=[1, 3, np.nan])
        (found,), _ = compared((first, second), set())
        self.assertEqual((found.first, found.second, found.largest), (2, 3, 1))

    def test_runs_without_a_common_time_are_refused(self):
        with self.assertRaisesRegex(Exception, "no time in common"):
            compared((table(t=[0, 1], x=[0, 1]), table(t=[2, 3], x=[0, 1])), set())

    def test_keys_are_those_of_set(self):
        case = {"method": "gfd", "phase": [{"name": "a"}, {"name": "b", "density": 2}], "domain": {"lower": [0, 1]}}
        self.assertEqual(flattened(case), {"method": "gfd", "phase.0.name": "a", "phase.1.name": "b", "phase.1.density": 2,
                                           "domain.lower": [0, 1]})


class Command(Scratch):
    def run_folder(self, name, spacing, factor):
        folder = new_folder(self.path, name)
        write_case(folder, "A square", [0, 0], [1, 1], spacing, left="free-slip")
        times = np.linspace(0, 1, 11)
        write_table(folder / "series.csv", {"step": np.arange(11), "t": times, "dt": 0 * times + 0.1,
                                            "kinetic_energy": factor * (1 + times)}, {"t": "time"})
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: lattice([0, 0], [1, 1], 0.1),
                        {"velocity": lambda p, t: p, "pressure": lambda p, t: p[:, 0]})
        (folder / "summary.json").write_text(json.dumps({
            "method": "les-sph", "steps": 10, "threads": 2, "wall_seconds": 3.5, "particles": 100,
            "verdicts": [{"quantity": "mass_drift", "verdict": "pass" if factor == 1 else "fail"}]}))
        return folder

    def test_cost_options_verdicts_and_quantities_are_printed_and_pictures_drawn(self):
        first, second = self.run_folder("first", 0.1, 1.0), self.run_folder("second", 0.05, 1.1)
        done = call("compare", first, second)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        lines = [" ".join(line.split()) for line in done.stdout.splitlines()]
        self.assertIn("core-seconds 7 7", lines)
        self.assertIn("resolution.spacing 0.1 0.05", lines)
        self.assertIn("mass_drift pass fail", lines)
        # 10 % of 2 at the end, which is the largest.
        self.assertIn("kinetic_energy 2 2.2 10 % 10 % 1", lines)
        self.assertFalse(any(line.startswith(("dt ", "step ")) for line in lines))
        self.assertIn(str(first / "plots" / "beside_second" / "series.png"), lines)
        self.assertTrue((first / "plots" / "beside_second" / "series.png").is_file())

    def test_without_pictures_nothing_is_written(self):
        first, second = self.run_folder("first", 0.1, 1.0), self.run_folder("second", 0.1, 1.0)
        done = call("compare", first, second, "--no-pictures")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("no option differs", done.stdout)
        self.assertFalse((first / "plots").exists())

    def test_a_folder_that_is_no_run_is_an_error(self):
        first, other = self.run_folder("first", 0.1, 1.0), new_folder(self.path, "empty")
        for arguments in ((first, other), (first, self.path / "missing")):
            done = call("compare", *arguments)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("error: ", done.stderr)


if __name__ == "__main__":
    unittest.main()
