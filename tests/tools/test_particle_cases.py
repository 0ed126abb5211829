# SPDX-License-Identifier: MIT
"""Measures of the cases with particles, on run folders written from known answers."""
import shutil
import tempfile
import tomllib
import unittest

import paths
import numpy as np
from spume_tools.plots.point_particles import plot_particles
from spume_tools.results import Results
from spume_tools.places import CASES
from spume_tools.verify.cases import RunFailed, load_measure, settings_of
from synthetic import new_folder, series_of, write_table


class ParticleCase(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.count = 0

    def run_of(self, case, t, **columns):
        self.count += 1
        folder = new_folder(self.scratch.name, f"{case}-{self.count}")
        shutil.copy(CASES / case / "case.toml", folder / "case.toml")
        write_table(folder / "series.csv", series_of(t, **columns))
        return folder


class Clustering(ParticleCase):
    def test_dimension_from_rates_of_growth_after_a_transient(self):
        t = np.linspace(0, 20, 81)
        rates = [0.5, -0.25, -1.0, -2.0, -3.0, -4.0]
        transient = np.where(t < 5, 3.0 * t, 15.0)
        growth = {f"stretching_{k + 1}": rate * t + transient for k, rate in enumerate(rates)}
        folder = self.run_of("clustering", t, mean_dissipation=0.1, correlation_dimension=1.5, kaplan_yorke_dimension=1,
                             **growth)
        measured = load_measure(CASES / "clustering").measure({"light": Results(folder)})
        self.assertAlmostEqual(measured["light_dimension"], 2.25, places=9)

    def test_kaplan_yorke_dimension(self):
        dimension = load_measure(CASES / "clustering").kaplan_yorke
        self.assertAlmostEqual(dimension([1, 0, -2, -5, -6, -7]), 2.5)
        self.assertAlmostEqual(dimension([-1, -2, -3, -5, -6, -7]), 0)


class Exclusion(ParticleCase):
    def test_averages_the_end_of_the_run(self):
        t = np.linspace(0, 10, 41)
        columns = {"overlap_ratio_error": 1e-4, "clipped_force": np.where(t < 8, 1, 0.002), "reynolds_lambda": 35.0,
                   "kmax_eta": 3.2}
        excluded = Results(self.run_of("exclusion", t, overlap_ratio=np.where(t < 8, 0.5, 0.004), **columns))
        free = Results(self.run_of("exclusion", t, overlap_ratio=0.07 * t, **columns))
        measured = load_measure(CASES / "exclusion").measure({"free": free, "excluded": excluded})
        self.assertAlmostEqual(measured["overlap_ratio"], 0.004)
        self.assertAlmostEqual(measured["clipped_force"], 0.002)
        self.assertAlmostEqual(measured["free_overlap_ratio"], 0.7)

    def test_leaves_the_flow_before_the_bubbles_out_of_the_picture(self):
        t = np.linspace(0, 1, 5)
        runs = {"flow": Results(self.run_of("exclusion", t)),
                "excluded": Results(self.run_of("exclusion", t, overlap_ratio=0.01 * t))}
        figure = load_measure(CASES / "exclusion").curves(runs)[0]
        self.assertEqual([curve[0] for curve in figure["curves"]], ["excluded", "paper, free", "paper, excluded"])


class Starting(ParticleCase):
    def test_a_run_starts_from_the_last_state_of_one_before_it(self):
        flow = Results(self.run_of("exclusion", np.linspace(0, 1, 3)))
        run = {"name": "free", "start": "flow", "set": ["resolution.grid=32"]}
        settings = settings_of(run, {"flow": flow})
        self.assertEqual(settings[0], "resolution.grid=32")
        name, value = settings[1].split("=", 1)
        self.assertEqual(name, "initial")
        initial = tomllib.loads(f"initial = {value}")["initial"]
        self.assertEqual(initial, {"kind": "checkpoint", "file": str(flow.folder.resolve() / "checkpoint.h5")})
        self.assertEqual(run["set"], ["resolution.grid=32"])

    def test_one_that_was_not_made_is_refused(self):
        with self.assertRaises(RunFailed):
            settings_of({"name": "free", "start": "flow"}, {})


class Pictures(ParticleCase):
    def table(self, folder, variance):
        write_table(folder / "particle_boxes.csv", {"t": [0.0] * 3 + [1.0] * 3, "side": [0.1, 0.2, 0.4] * 2,
                                                    "mean_count": [1.0, 8.0, 64.0] * 2, "variance": variance})

    def test_box_counts_are_drawn_where_they_scatter(self):
        folder = self.run_of("exclusion", [0, 1])
        self.table(folder, [1.0, 1.0, 1.0, 2.0, 4.0, 3.0])
        self.assertEqual([file.name for file in plot_particles(Results(folder), folder)], ["particle_boxes.png"])
        self.assertGreater((folder / "particle_boxes.png").stat().st_size, 5000)
        self.table(folder, [0.0] * 6)  # a lattice: nothing on logarithmic axes
        self.assertEqual(plot_particles(Results(folder), folder), [])


class UniformBubbles(ParticleCase):
    def spectrum_of(self, energy, points=64):
        folder = self.run_of("uniform_bubbles", [0, 1])
        k = np.tile(np.arange(points / 2), 2)
        write_table(folder / "spectrum.csv",
                    {"t": np.repeat([0.0, 1.0], points // 2), "wavenumber": k, "energy": energy(k)})
        results = Results(folder)
        results.case["resolution"]["grid"] = points
        return results

    def test_error_up_to_half_of_the_largest_wavenumber(self):
        base = lambda k: np.exp(-0.1 * k)
        runs = {"enhanced": self.spectrum_of(base), "plain": self.spectrum_of(lambda k: 0.8 * base(k)),
                "coupled": self.spectrum_of(lambda k: base(k) * np.where(k > 16, 2, 1.01)),
                "coupled_half_step": self.spectrum_of(lambda k: base(k) * 1.0025),
                "coupled_coarse_grid": self.spectrum_of(lambda k: base(k) * 1.02, 32),
                "enhanced_coarse_grid": self.spectrum_of(base, 32),
                "coupled_fine_grid": self.spectrum_of(lambda k: base(k) * np.where(k > 8, 2, 0.99)),
                "enhanced_fine_grid": self.spectrum_of(base)}
        measured = load_measure(CASES / "uniform_bubbles").measure(runs)
        self.assertAlmostEqual(measured["spectrum_error"], 0.01, places=6)
        self.assertAlmostEqual(measured["ratio_half_step"], 0.25, places=6)
        self.assertAlmostEqual(measured["ratio_fine_grid"], 0.5, places=6)
        self.assertAlmostEqual(measured["effect_of_bubbles"], 1.01 / 0.8 - 1, places=6)


if __name__ == "__main__":
    unittest.main()
