# SPDX-License-Identifier: MIT
"""Every measure is compared with run folders written from exact solutions (small error) and from wrong ones (large)."""
import tomllib
import unittest

import paths
import numpy as np
from spume_tools.results import Results, read_csv
from spume_tools.places import CASES
from spume_tools.verify.cases import case_folder, load_measure
from case_test import CaseTest
from synthetic import lattice, series_of, write_snapshots, write_table


class EveryCase(unittest.TestCase):
    def test_has_file_readme_measure_and_bounds(self):
        folders = sorted(p.parent for p in CASES.glob("*/case.toml"))
        self.assertGreaterEqual(len(folders), 19)
        titles = set()
        for folder in folders:
            with self.subTest(case=folder.name):
                case = tomllib.loads((folder / "case.toml").read_text())
                titles.add(case["title"])
                self.assertTrue(case["verify"]["bounds"])
                self.assertTrue((folder / "README.md").is_file())
                self.assertTrue(callable(load_measure(folder).measure))
                extent = np.subtract(case["domain"]["upper"], case["domain"]["lower"])
                for axis, letter in enumerate("xyz"[: len(extent)]):
                    if "spacing" in case["resolution"] and case["domain"].get(letter) == "periodic":
                        cells = extent[axis] / case["resolution"]["spacing"]
                        self.assertAlmostEqual(cells, round(cells), places=6, msg="a whole number of particles must fit")
        self.assertEqual(len(titles), len(folders), "plots find a case by its title")

    def test_is_found_by_name_folder_and_file(self):
        expected = CASES / "beltrami"
        for name in ("beltrami", str(expected), str(expected / "case.toml")):
            self.assertEqual(case_folder(name), expected)


class TaylorGreen1600(CaseTest):
    def measured(self, name, factor=1.0, shift=0.0, until=10.0):
        folder, module = self.run_of("taylor_green_1600")
        reference = module.REFERENCE
        rows = reference["t"] <= until
        t = reference["t"][rows]
        write_table(folder / "series.csv", series_of(t, mean_energy=reference["E"][rows] * factor,
                                                     mean_dissipation=np.interp(t - shift, t, reference["eps"][rows]) * factor))
        return module.measure({name: Results(folder)})

    def test_reference_has_no_error_and_departures_are_seen(self):
        exact = self.measured("n128")
        self.assertLess(abs(exact["dissipation_error_n128"]), 1e-12)
        self.assertLess(abs(exact["peak_error_n128"]), 1e-12)
        self.assertAlmostEqual(self.measured("n128", 1.05)["peak_error_n128"], 0.05, places=9)
        self.assertAlmostEqual(self.measured("n128", shift=0.3)["peak_time_error_n128"], 0.3, places=2)
        self.assertLess(self.measured("n64", until=4)["energy_error_n64"], 1e-12)
        self.assertAlmostEqual(self.measured("n64", 1.001, until=4)["energy_error_n64"], 1.25e-4, places=7)
        # The reference's table holds E(0.1) with nine digits only.
        self.assertLess(self.measured("n32", until=0.1)["energy_error_n32"], 5e-10)
        self.assertGreater(self.measured("n32", 1 + 1e-7, until=0.1)["energy_error_n32"], 1e-8)


class BeltramiExact(CaseTest):
    def error(self, order, dt):
        folder, module = self.run_of("beltrami_exact")
        t = np.linspace(0, 0.5, 6)
        columns = {}
        for name, position in (("a", [0.13, 0.71, 0.37]), ("b", [0.55, 0.29, 0.83])):
            velocity = module.exact_velocity(position, t, 1 / 50, 1.0) + dt**order
            columns |= {f"{name}_velocity_{axis}": velocity[:, i] for i, axis in enumerate("xyz")}
        write_table(folder / "probes.csv", {"t": t} | columns)
        decay = np.exp(-2 * (2 * np.pi) ** 2 / 50 * t)
        write_table(folder / "series.csv", series_of(t, mean_energy=1.5 * decay + 0.625))
        return Results(folder)

    def test_decay_and_orders_are_found(self):
        module = load_measure(CASES / "beltrami_exact")
        measured = module.measure({"still": self.error(2, 0.0), "ab2-1": self.error(2, 0.2), "ab2-2": self.error(2, 0.1),
                                   "rk4-1": self.error(4, 0.2), "rk4-2": self.error(4, 0.1)})
        self.assertLess(measured["decay_error"], 1e-11)
        self.assertAlmostEqual(measured["order_ab2"], 2, places=6)
        self.assertAlmostEqual(measured["order_rk4"], 4, places=6)


class ForcedTurbulence(CaseTest):
    def test_statistics_are_those_of_the_steady_part(self):
        folder, module = self.run_of("forced_turbulence")
        t = np.linspace(0, 25, 251)
        late = t >= 10
        write_table(folder / "series.csv", series_of(
            t, mean_injection=0.1 * (1 + 1e-9 * (t > 20)), balance_residual=np.where(t > 0, 2e-4, 0),
            gradient_skewness=np.where(late, -0.5, 0.3), gradient_flatness=4.0, kmax_eta=np.where(late, 1.6, 9),
            reynolds_lambda=50.0, mean_dissipation=np.where(late, 0.1, 0.5)))
        measured = module.measure({"run": Results(folder)})
        self.assertAlmostEqual(measured["balance_residual"], 2e-4, places=9)
        self.assertAlmostEqual(measured["skewness"], -0.5)
        self.assertAlmostEqual(measured["dissipation_over_injection"], 1)


class TaylorGreen(CaseTest):
    def errors(self, factor, spacing=0.05):
        folder, module = self.run_of("taylor_green_2d")
        grid = lattice([0, 0], [1, 1], spacing)
        t = np.linspace(0, 1, 101)
        write_table(folder / "series.csv", series_of(t, kinetic_energy=0.25 * np.exp(-16 * np.pi**2 * t / 100 * factor)))
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: grid,
                        {"velocity": lambda p, t: factor * module.exact_velocity(p, t, 100)})
        return module.measure({"run": Results(folder)})

    def test_exact_solution_has_no_error(self):
        measured = self.errors(1)
        self.assertLess(measured["velocity_error"], 1e-6)
        self.assertLess(measured["decay_rate_error"], 1e-9)

    def test_two_per_cent_too_much_is_seen(self):
        measured = self.errors(1.02)
        # rms of the exact velocity at t = 1: exp(-8 pi^2/100)/sqrt(2)
        self.assertAlmostEqual(measured["velocity_error"], 0.02 * np.exp(-0.08 * np.pi**2) / np.sqrt(2), places=6)
        self.assertAlmostEqual(measured["decay_rate_error"], 0.02, places=9)


class Tracer(CaseTest):
    def errors(self, factor, layers=1.0):
        folder, module = self.run_of("tracer")
        grid = lattice([0, 0], [1, 1], 0.05)
        t = np.linspace(0, 1, 11)
        write_table(folder / "series.csv", series_of(t, amount_of_dye=1 + 0 * t, amount_of_slow_dye=1 + 1e-9 * t,
                                                     amount_of_layers=0.5 + 0 * t))

        def exact(diffusivity):
            return lambda p, t: 1 + factor * np.exp(-8 * np.pi**2 * diffusivity * t) * module.shape(p)
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: grid,
                        {"dye": exact(0.01), "slow_dye": exact(0.001), "layers": lambda p, t: layers * (p[:, 1] > 0.5)})
        return module.measure({"run": Results(folder)})

    def test_exact_solution_has_no_error(self):
        measured = self.errors(1)
        self.assertLess(measured["dye_error"], 1e-6)
        self.assertLess(measured["slow_dye_error"], 1e-6)
        self.assertEqual(measured["new_extrema"], 0)

    def test_wrong_decay_amounts_and_extrema_are_seen(self):
        measured = self.errors(1.02, layers=1.01)
        # The rms of cos cos is 1/2.
        self.assertAlmostEqual(measured["dye_error"], 0.01 * np.exp(-0.08 * np.pi**2), places=6)
        self.assertAlmostEqual(measured["amount_change"], 1e-9, places=12)
        self.assertAlmostEqual(measured["new_extrema"], 0.01, places=6)


class Beltrami(CaseTest):
    def test_field_agrees_with_the_published_points(self):
        module = load_measure(CASES / "beltrami")
        table = read_csv(CASES / "beltrami" / "reference" / "beltrami_antuono2020_points.csv")
        for label, k in (("k=2pi", 2 * np.pi), ("k=4pi", 4 * np.pi)):
            rows = table["case"] == label
            if rows.any():
                points = np.column_stack([table[c][rows] for c in "xyz"])
                velocity = np.column_stack([table[c][rows] for c in "uvw"])
                np.testing.assert_allclose(module.beltrami(points, k), velocity, atol=2e-12)

    def test_expressions_of_both_cases_are_the_field(self):
        module = load_measure(CASES / "beltrami")
        points = np.random.default_rng(1).random((50, 3))
        names = {"sin": np.sin, "cos": np.cos, "sqrt": np.sqrt, "pi": np.pi}
        for case, k, expressions in (
                ("beltrami", 2 * np.pi, lambda c: c["liquid"][0]["velocity"]),
                ("beltrami_turbulence", 4 * np.pi,
                 lambda c: [e.split("ramp*")[1].rsplit(": 0")[0] for e in c["forces"]["body"]])):
            table = tomllib.loads((CASES / case / "case.toml").read_text())
            scope = names | dict(zip("xyz", points.T)) | {"k": k, "amplitude": module.AMPLITUDE}
            field = np.column_stack([eval(e.replace("amplitude*", ""), scope) for e in expressions(table)])
            np.testing.assert_allclose(module.AMPLITUDE * field, module.beltrami(points, k), atol=1e-12)

    def test_exact_decay_and_wrong_decay(self):
        for factor, expected in ((1.0, 0.0), (1.01, None)):
            folder, module = self.run_of("beltrami")
            grid = lattice([0, 0, 0], [1, 1, 1], 0.125)
            rate = 3 * (2 * np.pi) ** 2 / 50 * factor
            t = np.linspace(0, 0.25, 51)
            write_table(folder / "series.csv", series_of(t, kinetic_energy=0.5 * np.exp(-2 * rate * t)))
            write_snapshots(folder / "fluid.vtkhdf", [0, 0.25], lambda t: grid,
                            {"velocity": lambda p, t: np.exp(-rate * t) * module.beltrami(p)})
            measured = module.measure({"run": Results(folder)})
            if expected is None:
                self.assertAlmostEqual(measured["energy_error"], 1 - np.exp(-2 * 0.25 * rate * 0.01 / 1.01), places=6)
            else:
                self.assertLess(measured["energy_error"], 1e-9)
                self.assertLess(measured["velocity_error"], 1e-6)


class Channel(CaseTest):
    def test_series_meet_start_wall_and_steady_state(self):
        module = load_measure(CASES / "couette_poiseuille")
        y = np.linspace(0, 1, 41)
        np.testing.assert_allclose(module.couette(y, 100, 0.1), y, atol=1e-12)
        np.testing.assert_allclose(module.poiseuille(y, 100, 0.1), 4 * y * (1 - y), atol=1e-12)
        np.testing.assert_allclose(module.poiseuille(y, 0, 0.1), 0, atol=1e-5)
        # Halfway in time the equation du/dt = nu d2u/dy2 + G holds.
        for solution, force in ((module.couette, 0), (module.poiseuille, 0.8)):
            h, t = 1e-3, 1.0
            rate = (solution(y, t + h, 0.1) - solution(y, t - h, 0.1)) / (2 * h)
            inner = y[1:-1]
            curvature = sum(w * solution(inner + s * h, t, 0.1) for w, s in ((1, 1), (-2, 0), (1, -1))) / h**2
            np.testing.assert_allclose(rate[1:-1], 0.1 * curvature + force, atol=1e-5)

    def test_error_of_a_shifted_profile(self):
        folder, module = self.run_of("couette_poiseuille")
        grid = lattice([0, 0], [0.5, 1], 0.025)
        write_snapshots(folder / "fluid.vtkhdf", [0, 0.5, 5], lambda t: grid, {
            "velocity": lambda p, t: np.column_stack([module.couette(p[:, 1], t, 0.1) + 0.02, 0 * p[:, 0]])})
        measured = module.measure({"couette": Results(folder)})
        self.assertAlmostEqual(measured["couette_error"], 0.02, places=6)


class Cavity(CaseTest):
    def run_from(self, re, spacing, error, exact=False):
        """Lines through the published or the spectral values, u off by `error`."""
        folder, module = self.run_of("lid_driven_cavity")
        case = (folder / "case.toml").read_text(encoding="utf-8")
        case = case.replace("reynolds = 100\n", f"reynolds = {re}\n").replace("spacing = 0.01\n", f"spacing = {spacing}\n")
        (folder / "case.toml").write_text(case, encoding="utf-8")
        s = np.linspace(0, 1, 201)
        columns = {key: [] for key in ("t", "name", "s", "x", "y", "velocity_x", "velocity_y", "pressure")}
        for kind, name in (("u", "vertical"), ("v", "horizontal")):
            x, velocity = module.reference(kind, f"re{re}", module.EXACT if exact else module.REFERENCE)
            order = np.argsort(x)
            values = np.interp(s, x[order], velocity[order])
            columns["t"] += [20.0] * 201
            columns["name"] += [name] * 201
            for key in ("s", "x", "y"):
                columns[key] += list(s)
            columns["velocity_x"] += list(values + error)
            columns["velocity_y"] += list(values + error)
            columns["pressure"] += [0.0] * 201
        write_table(folder / "lines.csv", columns)
        return Results(folder), module

    def test_table_interpolated_onto_the_lines_has_a_small_error(self):
        run, module = self.run_from(100, 0.01, 0.01)
        measured = module.measure({"re100": run})
        # The lines sample the piecewise linear table at other places: its corners cost up to slope change x 0.0025.
        for kind in "uv":
            self.assertAlmostEqual(measured[f"{kind}_error_re100"], 0.01, delta=0.006)
        self.assertAlmostEqual(measured["u_difference_spectral_re100"], 0.01, delta=0.011)  # of the table itself 0.005

    def test_errors_of_second_order_have_order_two(self):
        coarse, module = self.run_from(3200, 0.0125, 0.225, exact=True)
        fine, _ = self.run_from(3200, 0.0125 / 1.5, 0.1, exact=True)
        measured = module.measure({"re3200_coarse": coarse, "re3200": fine})
        # Corners of the table, up to 0.007, are of the same size in both.
        self.assertAlmostEqual(measured["u_order_re3200"], 2, delta=0.1)
        self.assertAlmostEqual(measured["v_order_re3200"], 2, delta=0.1)
        self.assertNotIn("u_order_re3200", module.measure({"re3200": fine}))


class BeltramiTurbulence(CaseTest):
    def test_energy_at_the_end_of_the_ramp_and_time_of_transition(self):
        runs = {}
        for name, time in (("standard", 2.0), ("mixed-scale", 2.0), ("smagorinsky", 3.0)):
            folder, module = self.run_of("beltrami_turbulence")
            t = np.linspace(0, 5, 501)
            ramp = np.interp(t, module.REFERENCE["t"], module.REFERENCE["K"])
            energy = np.where(t <= 1, ramp, 0.142022455 - 0.05 * (np.tanh(4 * (t - time)) - np.tanh(4 * (1 - time))))
            write_table(folder / "series.csv", series_of(t, kinetic_energy=energy))
            runs[name] = Results(folder)
        measured = module.measure(runs)
        self.assertLess(measured["ramp_energy_error"], 1e-6)
        self.assertAlmostEqual(measured["transition_time_mixed-scale"], 2.0, delta=0.05)
        self.assertAlmostEqual(measured["transition_mixed_scale_after_smagorinsky"], -1.0, delta=0.05)

    def test_what_a_viscous_closure_takes_from_the_laminar_flow_is_no_transition(self):
        folder, module = self.run_of("beltrami_turbulence")
        t = np.linspace(0, 5, 501)
        energy = 0.02 + 0.14 * np.exp(-0.6 * (t - 1)) - 0.01 * np.tanh(4 * (t - 3))  # -dK/dt: 0.08 at once, 0.065 at 3
        write_table(folder / "series.csv", series_of(t, kinetic_energy=energy))
        self.assertAlmostEqual(module.transition_time(Results(folder)), 3.0, delta=0.05)

    def test_force_of_the_case_gives_the_reference_energy(self):
        module = load_measure(CASES / "beltrami_turbulence")
        strength = 3 * (4 * np.pi) ** 2 * 1.25e-3
        t = np.linspace(0, 1, 100001)
        ramp = np.where(t < 0.1, 10 * t, np.where(t < 0.9, 1, 10 * (1 - t)))
        # <|B|^2>/2 = 1/2 for the unit Beltrami field
        self.assertAlmostEqual(0.5 * (strength * np.trapz(ramp, t)) ** 2, module.REFERENCE["K"][-1], places=6)


if __name__ == "__main__":
    unittest.main()
