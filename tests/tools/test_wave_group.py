# SPDX-License-Identifier: MIT
"""The measure of wave_group on exact waves and on wrong ones."""
import unittest

import paths
import numpy as np
from case_test import CaseTest
from spume_tools import waves
from spume_tools.results import MissingResult, Results
from synthetic import series_of, write_table


class WaveGroup(CaseTest):
    def measured(self, elevation, end=66.0):
        folder, module = self.run_of("wave_group")
        run = Results(folder)
        group, t = module.Group(run.case), np.arange(0, end, 0.2)
        write_table(folder / "probes.csv", {"t": t} | {
            one["name"]: 1 + np.clip((t - 5) / 10, 0, 1) * elevation(group, one["position"][0], t)  # from rest
            for one in run.case["probe"]})
        write_table(folder / "series.csv", series_of(t, mass=1))
        return module.measure({"standard": run})

    def test_theory_has_no_error(self):
        measured = self.measured(lambda group, x, t: group.linear(x, t) + sum(group.bound(x, t)))
        self.assertLess(measured["long_wave_error"], 0.01)
        self.assertLess(abs(measured["crest_error"]), 0.005)  # rows do not meet the crest
        self.assertEqual(measured["mass_drift"], 0)

    def test_missing_and_free_long_waves_are_seen(self):
        linear = self.measured(lambda group, x, t: group.linear(x, t))
        self.assertGreater(linear["long_wave_error"], 0.3)
        self.assertLess(linear["crest_error"], -0.05)
        # The opposite of the bound wave at the piston, which travels on with the speed of long waves.
        free = self.measured(lambda group, x, t: group.linear(x, t) + sum(group.bound(x, t)) - group.bound(0, t - x)[0])
        self.assertGreater(free["long_wave_error"], 0.2)

    def test_bound_waves_of_narrow_groups_and_of_stokes(self):
        folder, module = self.run_of("wave_group")
        group = module.Group(Results(folder).case)
        for kh in (0.5, 1.0, 1.5):
            w = np.sqrt(kh * np.tanh(kh))
            group.w = w * np.array([1.0005, 0.9995])
            group.k = np.array([waves.wavenumber(one, 1, 1) for one in group.w])
            low, high = group.interactions()
            n = (1 + 2 * kh / np.sinh(2 * kh)) / 2
            self.assertAlmostEqual(low[0, 1], -(2 * n - 0.5) / (1 - (n * w / kh)**2), places=4)
            self.assertAlmostEqual(low[1, 0], low[0, 1], places=12)
            # D a^2 / 2 of a wave with itself is the second harmonic of Stokes.
            s = np.tanh(kh)
            self.assertAlmostEqual(high[0, 1] / 2, kh * (3 - s * s) / (4 * s**3), places=4)

    def test_short_runs(self):
        with self.assertRaises(MissingResult):
            self.measured(lambda group, x, t: group.linear(x, t), end=50)


if __name__ == "__main__":
    unittest.main()
