# SPDX-License-Identifier: MIT
"""Analysis of waves from probes, and the measure of the wave flume, on exact waves and on wrong ones."""
import unittest

import paths
import numpy as np
from case_test import CaseTest
from spume_tools import waves
from spume_tools.results import MissingResult, Results
from synthetic import series_of, write_table


class Analysis(unittest.TestCase):
    def test_dispersion(self):
        for kh in (0.01, 0.5, 1.5, 20.0):
            w = np.sqrt(9.81 * kh / 0.7 * np.tanh(kh))
            self.assertAlmostEqual(waves.wavenumber(w, 0.7, 9.81) * 0.7 / kh, 1, places=12)

    def test_harmonics_and_height_of_a_sum(self):
        w, t = 1.3, np.linspace(0, 2 * 2 * np.pi / 1.3, 49)[:-1]
        elevation = 5 + 0.2 * np.cos(w * t + 0.3) + 0.05 * np.cos(2 * w * t - 1)
        found = waves.harmonics(t, elevation, w)
        np.testing.assert_allclose(found, [5, 0.2 * np.exp(0.3j), 0.05 * np.exp(-1j), 0, 0], atol=1e-12)
        fine = np.linspace(0, 2 * np.pi / w, 100001)
        exact = np.ptp(0.2 * np.cos(w * fine + 0.3) + 0.05 * np.cos(2 * w * fine - 1))
        self.assertAlmostEqual(waves.mean_height(t, elevation, w), exact, places=5)

    def test_incident_and_reflected_waves_are_told_apart(self):
        k, x = 1.5, np.array([3.0, 3.7, 4.1])
        a, b = 0.2 * np.exp(1j), 0.03 * np.exp(-2j)
        amplitudes = a * np.exp(-1j * k * x) + b * np.exp(1j * k * x)
        incident, reflected, left = waves.incident_and_reflected(x, amplitudes, k)
        self.assertAlmostEqual(abs(incident - a), 0)
        self.assertAlmostEqual(abs(reflected - b), 0)
        self.assertAlmostEqual(left, 0)
        self.assertGreater(waves.incident_and_reflected(x, amplitudes * [1, 1.1, 1], k)[2], 0.01)


class WaveFlume(CaseTest):
    def run_with(self, elevation, end, solitary=False):
        """A run whose probes record elevation(x, t)."""
        folder, module = self.run_of("wave_flume")
        if solitary:
            text = (folder / "case.toml").read_text()
            (folder / "case.toml").write_text(text.replace('waves = "regular"', 'waves = "solitary"')
                                              .replace("height = 0.22", "height = 0.2"))
        run = Results(folder)
        t = np.arange(0, end, 0.2 if solitary else float(run.case["output"]["series_every"]))
        write_table(folder / "probes.csv", {"t": t} | {
            probe["name"]: 1 + elevation(probe["position"][0], t) for probe in run.case["probe"]})
        write_table(folder / "series.csv", series_of(t, mass=1))
        return module.measure({"run": run})

    def regular(self, height=0.22, reflected=0.0, decay=0.0, periods=30.0, free=0.0):
        w, k = 2 * np.pi / 5.392304144, 1.5
        faster = waves.wavenumber(2 * w, 1, 1)

        def elevation(x, t):
            to = height / 2 * np.exp(-decay * x) * np.cos(w * t - k * x)
            return to + reflected * height / 2 * np.cos(w * t + k * x) + free * height / 2 * np.cos(2 * w * t - faster * x)

        return self.run_with(elevation, periods * 5.392304144 + 0.01)

    def test_exact_waves_have_no_error(self):
        measured = self.regular()
        for quantity in ("height_error", "loss", "reflection", "free_harmonic"):
            self.assertLess(abs(measured[quantity]), 1e-6, quantity)
        self.assertEqual(measured["mass_drift"], 0)

    def test_wrong_heights_losses_reflections_and_free_waves_are_seen(self):
        self.assertAlmostEqual(self.regular(height=0.22 * 1.04)["height_error"], 0.04, places=6)
        # Between the middles of the probes lie 9.75 wavelengths of 4.18879.
        self.assertAlmostEqual(self.regular(decay=0.001)["loss"], 1 - np.exp(-0.001 * 9.75 * 4.18879), places=5)
        measured = self.regular(reflected=0.07)
        self.assertAlmostEqual(measured["reflection"], 0.07, places=6)
        self.assertLess(abs(measured["loss"]), 0.005)
        self.assertAlmostEqual(self.regular(free=0.05)["free_harmonic"], 0.05, places=6)

    def test_short_runs(self):
        self.assertNotIn("loss", self.regular(periods=12))
        with self.assertRaises(MissingResult):
            self.regular(periods=4)

    def test_solitary_wave(self):
        def wave(x, t, speed=1.094345, decay=0.0):
            return 0.2 * (1 - decay * x) / np.cosh(0.35 * (x - speed * (t - 13)))**2

        exact = self.run_with(wave, 42, solitary=True)
        for quantity in ("solitary_height_error", "solitary_loss", "solitary_speed_error"):
            self.assertLess(abs(exact[quantity]), 5e-4, quantity)  # of the parabola through seven rows
        wrong = self.run_with(lambda x, t: wave(x, t, speed=1.05, decay=0.002), 45, solitary=True)
        self.assertAlmostEqual(wrong["solitary_loss"], 0.04, delta=0.003)
        self.assertLess(wrong["solitary_speed_error"], -0.03)
        with self.assertRaises(MissingResult):
            self.run_with(wave, 32, solitary=True)


if __name__ == "__main__":
    unittest.main()
