# SPDX-License-Identifier: MIT
"""Size distributions and trends of bubbles against populations whose law is known."""
import unittest

import paths
import numpy as np
from spume_tools.results import density, slope
from spume_tools.places import CASES
from spume_tools.verify.cases import load_measure


def power_law(exponent, low, high, n, seed=1):
    """n numbers with a density proportional to a^exponent between low and high."""
    u = np.random.default_rng(seed).random(n)
    k = exponent + 1
    return (low**k + u * (high**k - low**k)) ** (1 / k)


class Sizes(unittest.TestCase):
    def test_density_integrates_to_one(self):
        centre, value, count = density(power_law(-2, 0.1, 10, 5000))
        self.assertEqual(count.sum(), 5000)
        width = centre * (10**0.05 - 10**-0.05)
        self.assertAlmostEqual(float(np.sum(value * width)), 1, delta=0.02)

    def test_slope_is_the_exponent(self):
        for exponent in (-10 / 3, -1.5, 0.5):
            values = power_law(exponent, 0.1, 10, 20000)
            self.assertAlmostEqual(slope(values, 0.2, 6), exponent, delta=0.1)

    def test_slope_needs_bubbles(self):
        self.assertTrue(np.isnan(slope(power_law(-2, 0.1, 10, 30), 3, 9)))


class Plume(unittest.TestCase):
    def test_centre_and_width_of_a_gaussian(self):
        module = load_measure(CASES / "plume")
        r = 0.02 * (np.arange(25) + 0.5)
        centre, width = module.centre_and_width(r, 0.7 * np.exp(-((r / 0.11) ** 2)))
        self.assertAlmostEqual(centre, 0.7, delta=0.01)
        self.assertAlmostEqual(width, 0.11, delta=0.002)

    def test_rank_correlation(self):
        module = load_measure(CASES / "plume_polydisperse")
        x = np.random.default_rng(2).random(500)
        self.assertAlmostEqual(module.rank_correlation(x, np.exp(x)), 1, places=12)
        self.assertAlmostEqual(module.rank_correlation(x, -(x**3)), -1, places=12)
        self.assertLess(abs(module.rank_correlation(x, np.random.default_rng(3).random(500))), 0.15)

    def test_breaking_wave_is_faster_than_its_phase(self):
        module = load_measure(CASES / "breaking_wave_steepness")

        class Run:
            case = {"constants": {"chi": 0.35}}
            series = {"max_speed": np.array([0.2, 0.3, 0.9]), "entrained_volume": np.array([0.0, 0.0, 1.0])}

        # sqrt(g / k) sqrt(1 + chi^2) = 0.4227; the speed of the spray after the first bubble does not count.
        self.assertAlmostEqual(module.speed_over_phase_speed(Run), 0.3 / 0.4227, delta=1e-4)


class SurfaceApproach(unittest.TestCase):
    def test_place_of_rest_counts_from_the_uppermost_particles(self):
        module = load_measure(CASES / "surface_approach")
        t = np.linspace(0, 8, 81)
        # Rises to 1.2 spacings of 0.02 below the surface of the liquid: 0.7 below the uppermost particles.
        trace = {"t": t, "z": np.where(t < 4, 0.3, 0.4 - 1.2 * 0.02)}
        self.assertAlmostEqual(module.place_of_rest(trace, 0.02, 8.0), 0.7, places=12)


if __name__ == "__main__":
    unittest.main()
