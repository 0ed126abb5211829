# SPDX-License-Identifier: MIT
"""The measure of wave_absorption on exact waves and on wrong ones."""
import unittest

import paths
import numpy as np
from case_test import CaseTest
from spume_tools import waves
from spume_tools.results import MissingResult, Results
from synthetic import series_of, write_table

ABSORBER = '[[wavemaker]]\nside = "right"\nwaves = "none"\nabsorption = "{law}"\n[time]'


class WaveAbsorption(CaseTest):
    def measured(self, reflected, law=None, height=0.1, periods=15.0, own="tuned"):
        folder, module = self.run_of("wave_absorption")
        text = (folder / "case.toml").read_text().replace('absorption = "tuned"', f'absorption = "{own}"')
        if law:
            text = text.replace("[time]", ABSORBER.format(law=law))
        (folder / "case.toml").write_text(text)
        run = Results(folder)
        period = float(run.case["wavemaker"][0]["period"])
        w, t = 2 * np.pi / period, np.arange(0, periods * period, 0.15)
        k = waves.wavenumber(w, 1, 1)
        write_table(folder / "probes.csv", {"t": t} | {
            one["name"]: 1 + height / 2 * np.real(np.exp(1j * (w * t - k * one["position"][0])) +
                                                  reflected * np.exp(1j * (w * t + k * one["position"][0])))
            for one in run.case["probe"]})
        write_table(folder / "series.csv", series_of(t, mass=1))
        return module.measure({"standard": run}), module, w

    def test_incident_waves_beside_reflected_ones(self):
        self.assertLess(abs(self.measured(np.exp(1j))[0]["incident_error"]), 1e-6)
        self.assertAlmostEqual(self.measured(np.exp(1j), height=0.107)[0]["incident_error"], 0.07, places=6)
        measured = self.measured(0.9j, height=0.2, own="none")[0]
        self.assertAlmostEqual(measured["incident_of_fixed_motion_error"], 1, places=6)
        self.assertNotIn("incident_error", measured)

    def test_reflections(self):
        self.assertAlmostEqual(self.measured(0.04j, law="tuned")[0]["reflection_tuned"], 0.04, places=6)
        measured, module, w = self.measured(0.1, law="long-wave")
        expected = module.expected_reflection(w, 0.05)
        self.assertAlmostEqual(measured["reflection_long_wave_error"], 0.1 - expected, places=6)

    def test_the_law_takes_up_long_waves_and_not_short_ones(self):
        _, module, _ = self.measured(0)
        at = [module.expected_reflection(np.sqrt(kh * np.tanh(kh)), 1e-6) for kh in (0.5, 1.0, 1.5, 3.0)]
        self.assertLess(at[0], 0.03)
        self.assertTrue(np.all(np.diff(at) > 0))
        # Deep water: a piston of velocity -e sqrt(g/h) makes less than a wave of the height of what it meets.
        self.assertLess(at[-1], 1)

    def test_short_runs(self):
        with self.assertRaises(MissingResult):
            self.measured(0, periods=8)


if __name__ == "__main__":
    unittest.main()
