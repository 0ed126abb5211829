# SPDX-License-Identifier: MIT
import tempfile
import threading
import unittest
from functools import cached_property
from pathlib import Path

import paths  # noqa: F401  (import path)
import numpy as np
from spume_tools import results
from spume_tools.results import (DamagedResult, GridSnapshots, MissingResult, Results, Snapshots, observed_order, read_csv,
                                 relative_rms)
from spume_tools.results.units import field_label
from synthetic import lattice, new_folder, series_of, write_case, write_grid_snapshots, write_snapshots, write_table


class ReadingResults(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = new_folder(self.scratch.name, "run")

    def test_series_gives_columns_and_units(self):
        write_table(self.folder / "series.csv", series_of([0, 1, 2], kinetic_energy=[3, 2, 1]), {"kinetic_energy": "J"})
        series = Results(self.folder).series
        np.testing.assert_array_equal(series["kinetic_energy"], [3, 2, 1])
        self.assertEqual(series.label("kinetic_energy"), "kinetic energy [J]")

    def test_last_line_cut_short_is_left_out(self):
        # The last number may be whole or its first digits: only the end of the line tells.
        for part in ("2", "2,", "2,1.2", "2,1.25"):
            (self.folder / "series.csv").write_text("t,dt\n0,1\n1,1\n" + part)
            self.assertEqual(len(Results(self.folder).series["t"]), 2, part)
        (self.folder / "series.csv").write_text("t,dt\n0,1\n1,1\n2,1.25\n")
        self.assertEqual(Results(self.folder).series["dt"][2], 1.25)

    def test_a_run_that_is_writing_is_read_again_when_asked(self):
        (self.folder / "series.csv").write_text("t,dt\n0,1\n")
        run = Results(self.folder)
        self.assertEqual(len(run.series), 1)
        (self.folder / "series.csv").write_text("t,dt\n0,1\n1,1\n")
        self.assertEqual((len(run.series), len(run.refresh().series)), (1, 2))

    def test_a_snapshot_that_is_being_written_is_waited_for(self):
        write_snapshots(self.folder / "fluid.vtkhdf", [0, 0.5], lambda t: lattice([0, 0], [1, 1], 0.5), {"velocity": lambda p, t: p})
        path, journal = self.folder / "fluid.vtkhdf", self.folder / "fluid.vtkhdf.journal"
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
        journal.touch()

        def complete():
            path.write_bytes(whole)
            journal.unlink()

        timer = threading.Timer(0.2, complete)
        timer.start()
        self.addCleanup(timer.join)
        snapshots = Results(self.folder).snapshots()
        self.assertFalse(journal.exists())
        self.assertEqual([len(s) for s in snapshots], [4, 4])

    def test_damage_within_a_table_is_said_with_its_line(self):
        (self.folder / "series.csv").write_text("# units\nt,dt\n0,1\n1\n2,1\n")
        with self.assertRaisesRegex(DamagedResult, r"series.csv:4: the row holds 1 value, the header names 2 columns"):
            Results(self.folder).series
        (self.folder / "series.csv").write_text("t,dt\n0,1\n1,2,3\n")
        with self.assertRaisesRegex(DamagedResult, r"series.csv:3: the row holds 3 values"):
            Results(self.folder).series
        (self.folder / "series.csv").write_bytes(b"t,dt\n0,1\n1,\xff\n")
        with self.assertRaisesRegex(DamagedResult, r"series.csv:3: byte 0xff is not UTF-8 text"):
            Results(self.folder).series
        (self.folder / "series.csv").write_text("t,dt\n0,nan\n1,abc\n2,1\n")
        with self.assertRaisesRegex(DamagedResult, r"series.csv:3: column 'dt' holds 'abc'; a number was expected"):
            Results(self.folder).series
        (self.folder / "case.toml").write_bytes(b"title = \"\xff\"\n")
        with self.assertRaisesRegex(DamagedResult, "case.toml: cannot be read"):
            Results(self.folder).case

    def test_absent_column_names_what_there_is(self):
        write_table(self.folder / "series.csv", series_of([0, 1]))
        with self.assertRaisesRegex(MissingResult, "no column 'entropy'; it has step, t, dt"):
            Results(self.folder).series["entropy"]

    def test_absent_file_and_folder_are_said(self):
        with self.assertRaisesRegex(MissingResult, "series.csv: cannot be read"):
            Results(self.folder).series
        with self.assertRaisesRegex(MissingResult, "not a folder"):
            Results(self.folder / "nowhere")

    def test_snapshots_of_changing_size_keep_their_own_rows(self):
        grid = lattice([0, 0], [1, 1], 0.25)
        write_snapshots(self.folder / "fluid.vtkhdf", [0, 0.5, 1], lambda t: grid[: 16 - int(4 * t)],
                        {"velocity": lambda p, t: p * t, "pressure": lambda p, t: p[:, 0] + t})
        snapshots = Results(self.folder).snapshots()
        self.assertEqual([len(s) for s in snapshots], [16, 14, 12])
        last = snapshots[-1]
        self.assertEqual(last.time, 1.0)
        np.testing.assert_allclose(last.position[:, :2], grid[:12], atol=1e-6)
        np.testing.assert_allclose(last.field("pressure"), grid[:12, 0] + 1, atol=1e-6)
        np.testing.assert_allclose(last.field("speed"), np.linalg.norm(grid[:12], axis=1), atol=1e-6)
        with self.assertRaises(IndexError):
            snapshots[3]
        with self.assertRaisesRegex(MissingResult, "no field 'alpha'"):
            last.field("alpha")

    def test_damaged_snapshot_file_is_said(self):
        (self.folder / "fluid.vtkhdf").write_bytes(b"not HDF5 at all")
        with self.assertRaisesRegex(MissingResult, "not a VTKHDF file"):
            Results(self.folder).snapshots()

    def test_snapshots_of_a_grid_are_found_by_the_same_name(self):
        write_grid_snapshots(self.folder / "fluid.vtkhdf", [0, 0.5], (4, 5, 6), 0.1,
                             {"pressure": lambda x, y, z, t: x + 10 * y + 100 * z + t,
                              "velocity": lambda x, y, z, t: np.stack([x, y, z], axis=-1)})
        snapshots = Results(self.folder).snapshots()
        self.assertIsInstance(snapshots, GridSnapshots)
        last = snapshots[-1]
        self.assertEqual((last.time, last.field("pressure").shape), (0.5, (4, 5, 6)))
        self.assertAlmostEqual(float(last.field("pressure")[3, 1, 2]), 0.3 + 1 + 20 + 0.5, places=5)
        self.assertAlmostEqual(float(last.field("velocity")[3, 1, 2, 2]), 0.2, places=6)
        np.testing.assert_allclose(last.axis(1), 0.1 * np.arange(5))
        with self.assertRaisesRegex(MissingResult, "with steps of particles"):
            Snapshots(self.folder / "fluid.vtkhdf")

    def test_everything_says_what_it_is(self):
        write_case(self.folder, "A title", [0, 0], [1, 1], 0.5)
        write_table(self.folder / "series.csv", series_of([0, 1.5]))
        write_snapshots(self.folder / "fluid.vtkhdf", [0, 0.5], lambda t: lattice([0, 0], [1, 1], 0.5), {"velocity": lambda p, t: p})
        run = Results(self.folder)
        self.assertRegex(repr(run), r"^Results\('.*run': 'A title', les-sph, 2 rows to t = 1.5\)$")
        self.assertRegex(repr(run.series), r"^Table\('.*series.csv': 2 rows of step, t, dt\)$")
        self.assertRegex(repr(run.snapshots()), r"^Snapshots\('.*': 2 steps, t = 0 to 0.5, velocity\)$")
        self.assertEqual(repr(run.snapshots()[1]), "Snapshot(t = 0.5: 4 particles with velocity)")
        self.assertRegex(repr(Results(self.folder.parent)), r"^Results\('.*'\)$")

    def test_every_public_name_is_explained(self):
        for name in results.__all__:
            thing = getattr(results, name)
            self.assertTrue(thing.__doc__, name)
            if isinstance(thing, type):
                for member, value in vars(thing).items():
                    explained = callable(value) or isinstance(value, (property, cached_property))
                    if explained and not member.startswith("_"):
                        self.assertTrue(value.__doc__, f"{name}.{member}")

    def test_probes_may_have_names_with_blanks(self):
        write_table(self.folder / "probes.csv", {"t": [0.0], "west wall_pressure": [2.0]}, {"t": "time", "west wall_pressure": "Pa"})
        probes = Results(self.folder).probes
        self.assertEqual((probes["west wall_pressure"][0], probes.label("west wall_pressure")), (2, "west wall pressure [Pa]"))

    def test_components_of_sludge_keep_their_names(self):
        self.assertEqual(field_label("S_O", si=True), "S_O [g/m³]")
        self.assertEqual(field_label("S_ALK", si=True), "S_ALK [mol/m³]")
        self.assertEqual(field_label("velocity_x", si=True), "velocity x [m/s]")
        self.assertEqual(field_label("dye_of_paint", si=True), "dye of paint")

    def test_brackets_hold_units_and_nothing_else(self):
        notes = {"t": "time", "kinetic_energy": "rho u^2 / 2, integral", "retries": "steps refused so far", "mass": "mass, of the particles",
                 "momentum_x": "mass times speed", "max_divergence": "of the predicted velocity, 1 / time", "step": "1",
                 "kla": "1/time: k_L A of bubbles and surface over the volume", "oxygen_left": "g, with bubbles that burst, since the start",
                 "sotr": "g/time: standard transfer rate", "amount_of_dye": "g/m3 times length^2", "sweeps": "1, into which"}
        write_table(self.folder / "series.csv", {"t": [0.0], **{name: [0.0] for name in notes if name != "t"}}, notes)
        write_case(self.folder, "A title", [0, 0], [1, 1], 0.5)
        labels = {name: Results(self.folder).series.label(name) for name in notes}
        self.assertEqual(labels, {name: name.replace("_", " ") for name in notes})
        with (self.folder / "case.toml").open("a") as file:
            file.write("[fluid]\ndensity = 1000\nviscosity = 1e-3\ngravity = 9.81\n")
        series = Results(self.folder).series
        self.assertEqual([series.label(name) for name in notes],
                         ["t [s]", "kinetic energy [J/m]", "retries", "mass [kg/m]", "momentum x [kg/s]",
                          "max divergence [1/s]", "step", "kla [1/s]", "oxygen left [g]", "sotr [g/s]", "amount of dye [g/m]", "sweeps"])

    def test_line_of_a_time(self):
        write_table(self.folder / "lines.csv", {"t": [0, 0, 1, 1], "name": ["a", "a", "a", "b"], "s": [0, 1, 0, 9.0]})
        run = Results(self.folder)
        self.assertEqual(run.line_names(), ["a", "b"])
        np.testing.assert_array_equal(run.line("a", 0)["s"], [0, 1])
        np.testing.assert_array_equal(run.line("a")["s"], [0])

    def test_case_gives_spacing_and_dimensions(self):
        write_case(self.folder, "A title", [0, 0], [2, 1], 0.1, x="periodic")
        run = Results(self.folder)
        self.assertEqual((run.spacing, run.dimensions), (0.1, 2))

    def test_reference_with_comments_and_text(self):
        path = Path(self.scratch.name) / "reference.csv"
        path.write_text('# source, 1952\nname,value\n"a, b",1.5\nc,\n')
        table = read_csv(path)
        self.assertEqual(list(table["name"]), ["a, b", "c"])
        self.assertTrue(np.isnan(table["value"][1]))


class Norms(unittest.TestCase):
    def test_relative_rms_of_a_vector_field(self):
        self.assertAlmostEqual(relative_rms([[3, 4], [0, 0]], [[0, 0], [0, 0]], 5), np.sqrt(0.5))

    def test_observed_order_of_second_order_errors(self):
        spacings = np.array([0.04, 0.02, 0.01])
        self.assertAlmostEqual(observed_order(spacings, 3 * spacings**2), 2)


if __name__ == "__main__":
    unittest.main()
