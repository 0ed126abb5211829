# SPDX-License-Identifier: MIT
"""tools/work-precision and tools/roofline: the front, the verdicts on defaults, and the picture of made-up results."""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import paths

from spume_tools.plots.labels import free_labels, overlap
from spume_tools.work_precision import command
from spume_tools.work_precision.sweeps import SWEEPS, terminal_speed


def row(error, seconds, option="default", value=""):
    return {"sweep": "s", "resolution": "r", "option": option, "value": value, "error": error, "seconds": seconds}


class Front(unittest.TestCase):
    def test_holds_what_nothing_beats_in_both(self):
        rows = [row(1, 1), row(0.5, 2), row(0.6, 3), row(0.1, 10), row(2, 1)]
        self.assertEqual([(r["error"], r["seconds"]) for r in command.front(rows)], [(1, 1), (0.5, 2), (0.1, 10)])

    def test_excess_is_the_time_over_that_of_the_best_as_accurate(self):
        rows = [row(1, 4), row(0.9, 2, "a", "b"), row(2, 1)]
        self.assertEqual(command.excess(rows[0], rows), 2)
        self.assertEqual(command.excess(rows[1], rows), 1)

    def test_verdict_names_the_better_setting(self):
        text = "\n".join(command.verdicts([row(1, 4), row(0.9, 2, "time.courant", "0.3"), row(0.5, 40)]))
        self.assertIn("2.00 times the time of r with time.courant = 0.3", text)
        self.assertIn("on the front", text)

    def test_plans_start_with_the_defaults_and_change_one_thing(self):
        for name, one in SWEEPS.items():
            runs = command.plan(one)
            self.assertEqual(runs[0][1], "default", name)
            self.assertEqual(len({run[:3] for run in runs}), len(runs), name)

    def test_terminal_speed_balances_drag_and_buoyancy(self):
        # By hand: w = 0.0683 is Re = 2.73, C_d = 24 / 2.73 (1 + 0.15 * 2.73^0.687) = 11.4, drag 0.375 * 11.4 w^2 / 0.02 = 1.
        self.assertAlmostEqual(terminal_speed(), 0.0683, 3)


class Labels(unittest.TestCase):
    def test_labels_of_crowded_points_cover_nothing(self):
        from spume_tools.plots.style import plt

        points = 10 ** np.random.default_rng(1).normal((0.8, 1.5), (0.15, 0.2), (39, 2))
        figure, axis = plt.subplots(figsize=(6, 6))
        axis.set(xscale="log", yscale="log", xlim=(0.1, 100), ylim=(1, 500))
        boxes = free_labels(axis, points, [str(k) for k in range(39)])
        marks = axis.transData.transform(points)
        for k, box in enumerate(boxes):
            self.assertFalse(any(overlap(box, other) for other in np.delete(boxes, k, axis=0)), k)
            self.assertFalse(any(overlap(box, np.concatenate([mark, mark])) for mark in marks), k)
        plt.close(figure)


class Roofline(unittest.TestCase):
    def test_table_and_picture(self):
        rate = {"memory_bytes_per_second": 1e10, "cache_bytes_per_second": 1e11, "flops_per_second": 5e10, "gathers_per_second": 1e9}
        entries = [{"run_name": "machine/threads:1/iterations:1", **rate},
                   {"run_name": "pressure_apply/particles:100000/arrangement:1/threads:1/real_time", "bytes_per_second": 5e9, "flops_per_second": 2e10,
                    "gathers_per_second": 8e8, "of_limit": 0.8},
                   {"run_name": "flow_step<double>/points:128/threads:1/real_time", "bytes_per_second": 5e9, "flops_per_second": 2e10,
                    "of_limit": 0.4}]
        with tempfile.TemporaryDirectory() as scratch:
            results = Path(scratch) / "results.json"
            results.write_text(json.dumps({"benchmarks": entries}))
            done = subprocess.run(paths.module("bench.roofline", results, "--out", Path(scratch) / "r.png"),
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"pressure_apply, 1 thread .* 80 %")
            self.assertRegex(done.stdout, r"flow_step<double>, 1 thread .* 40 %")
            self.assertTrue((Path(scratch) / "r.png").is_file())


if __name__ == "__main__":
    unittest.main()
