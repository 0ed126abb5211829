# SPDX-License-Identifier: MIT
"""Measures of the cases with several phases, on run folders written from exact and from wrong answers."""
import unittest

import numpy as np
from case_test import CaseTest
from spume_tools.places import CASES
from spume_tools.results import Results, read_reference
from spume_tools.verify.cases import load_measure
from synthetic import lattice, series_of, write_snapshots, write_table


class RisingBubbleAir(CaseTest):
    def bubble(self, shape, spacing=0.0625):
        """A run whose bubble is where shape(x, y, t) is positive."""
        folder, module = self.run_of("rising_bubble_air")
        at = lattice([-3, 0], [3, 10], spacing)
        write_snapshots(folder / "fluid.vtkhdf", (0, 1.6, 3.2, 4.8), lambda t: at,
                        {"phase": lambda p, t: shape(p[:, 0], p[:, 1], t) > 0})
        heights = [at[shape(at[:, 0], at[:, 1], t) > 0, 1].mean() for t in (0, 1.6, 3.2, 4.8)]
        write_table(folder / "series.csv", series_of(np.array([0, 1.6, 3.2, 4.8]), centre_air_y=np.array(heights)))
        return Results(folder), module

    def test_shapes_and_heights_against_those_of_the_reference(self):
        def ring(x, y, t, offset=0.0):
            """A disc, then the upper half of a ring, then three discs."""
            y = y - offset
            if t < 2:
                return 1 - x**2 - (y - 3) ** 2
            if t < 4:
                return np.where((y > 3) & (x**2 + (y - 3) ** 2 > 0.5), 1.5 - x**2 - (y - 3) ** 2, -1)
            return np.max([r**2 - (x - c) ** 2 - (y - 4) ** 2 for c, r in ((-1.8, 0.5), (0, 1), (1.8, 0.6))], axis=0)

        reference, module = self.bubble(ring)
        same, _ = self.bubble(ring)
        higher, _ = self.bubble(lambda x, y, t: ring(x, y, t, 0.125))
        measured = module.measure({"gfd": reference, "wcsph": same, "higher": higher})
        self.assertAlmostEqual(measured["wcsph_split_off"], 0.25 / 1.61, delta=0.01)
        self.assertEqual(measured["wcsph_shape_difference_1_6"], 0)
        self.assertAlmostEqual(measured["wcsph_height_error_3_2"], 0)
        # The inner radius is 0.71, the foot of the ring at 3.
        self.assertAlmostEqual(measured["gfd_horseshoe_depth"], 0.71, delta=0.0625)
        self.assertAlmostEqual(measured["higher_height_error_1_6"], 0.125 / 3, delta=0.002)
        # Two discs of radius 1 whose centres are d apart have 4 d / pi of their area for themselves alone, to first order.
        self.assertAlmostEqual(measured["higher_shape_difference_1_6"], 4 * 0.125 / np.pi, delta=0.02)

    def test_a_bubble_whole_has_one_piece_and_no_depth(self):
        run, module = self.bubble(lambda x, y, t: 1 - x**2 - (y - 3) ** 2)
        measured = module.measure({"gfd": run})
        self.assertEqual(measured["gfd_split_off"], 0)
        self.assertAlmostEqual(measured["gfd_horseshoe_depth"], 0, delta=0.01)


class BubbleReachesSurface(CaseTest):
    def test_joining_strays_and_volumes(self):
        folder, module = self.run_of("bubble_reaches_surface")
        at = lattice([-3, 0], [3, 7], 0.0625)

        bubble = at[:, 0] ** 2 + (at[:, 1] - 2) ** 2 < 1
        air = bubble | (at[:, 1] > 4.5)
        lone = np.argmin(np.hypot(at[:, 0], at[:, 1] - 6))

        def position(t):
            """The bubble rises by 1 in a time; a single particle of the air is in the water at the end."""
            moved = at + np.outer(bubble, [0, t])
            if t == 4:
                moved[lone] = [2.03, 1.03]
            return moved

        write_snapshots(folder / "fluid.vtkhdf", np.arange(5.0), position, {
            "phase": lambda p, t: air, "id": lambda p, t: np.arange(len(p)),
            "density": lambda p, t: np.where(air, 1.0, 1000 / (1 + 0.001 * t))})
        measured = module.measure({"bubble": Results(folder)})
        self.assertEqual(measured["bubble_joined_at"], 2)  # at 1 its top is at 4
        self.assertEqual(measured["bubble_joined_share_end"], 1)
        self.assertAlmostEqual(measured["bubble_strays"], 1 / len(at))
        self.assertAlmostEqual(measured["bubble_volume_water"], 0.004, delta=1e-6)
        self.assertEqual(measured["bubble_volume_air"], 0)
        self.assertEqual(measured["bubble_lost"], 0)


class PoiseuilleTwoPhase(CaseTest):
    def test_the_steady_profile_is_that_of_the_reference(self):
        module = load_measure(CASES / "poiseuille_two_phase")
        table = read_reference(CASES / "poiseuille_two_phase" / "reference" / "poiseuille_two_phase.csv",
                               ("chi", "y", "u"))
        for chi in (1, 5, 100):
            rows = np.asarray(table["chi"]) == chi
            y, u = np.asarray(table["y"])[rows], np.asarray(table["u"])[rows]
            self.assertGreater(len(y), 10)
            np.testing.assert_allclose(module.steady(y, chi), u, atol=1e-8)
            inner = y[(np.abs(y) < 0.99) & (y != 0)]  # the kink lies between two cells
            np.testing.assert_allclose(module.startup(inner, 50.0, chi), module.steady(inner, chi), atol=1e-5)

    def test_the_start_has_the_acceleration_of_the_force(self):
        module = load_measure(CASES / "poiseuille_two_phase")
        np.testing.assert_allclose(module.startup(np.array([-0.5, 0.5]), 1e-4, 5.0), 1e-4, rtol=1e-6)

    def test_measures_a_constant_error_and_its_order(self):
        peak, runs = None, {}
        for name, offset in (("ratio_5_coarse", 0.04), ("ratio_5", 0.01)):
            folder, module = self.run_of("poiseuille_two_phase")
            if name == "ratio_5_coarse":
                text = (folder / "case.toml").read_text(encoding="utf-8")
                (folder / "case.toml").write_text(text.replace("spacing = 0.05", "spacing = 0.1"), encoding="utf-8")
            peak = float(np.max(module.steady(np.linspace(-1, 1, 2001), 5.0)))
            write_snapshots(folder / "fluid.vtkhdf", [0, 0.4], lambda t: lattice([0, -1], [0.5, 1], 0.1), {
                "velocity": lambda p, t, offset=offset: np.column_stack(
                    [module.startup(p[:, 1], t, 5.0) + offset * peak, 0 * p[:, 0]])})
            runs[name] = Results(folder)
        measured = module.measure(runs)
        self.assertAlmostEqual(measured["ratio_5_error"], 0.01, places=6)
        self.assertAlmostEqual(measured["ratio_5_order"], 2, places=4)


class StaticDrop(CaseTest):
    def test_jump_and_speed(self):
        folder, module = self.run_of("static_drop")
        at = lattice([0, 0], [1, 1], 1 / 32)
        inside = np.hypot(at[:, 0] - 0.5, at[:, 1] - 0.5) < 0.25
        radius = np.sqrt(inside.mean() / np.pi)
        write_snapshots(folder / "fluid.vtkhdf", np.linspace(0, 1, 11), lambda t: at, {
            "pressure": lambda p, t: np.where(inside, 1.01 / radius, 0),
            "phase": lambda p, t: inside,
            "velocity": lambda p, t: np.column_stack([np.full(len(p), 0.3 if t < 0.3 else 0.004), 0 * p[:, 0]])})
        measured = module.measure({"ratio_1": Results(folder)})
        self.assertAlmostEqual(measured["ratio_1_jump"], 1.01, places=5)
        self.assertAlmostEqual(measured["ratio_1_capillary_number"], 0.1 * 0.004, places=8)

    def test_an_eighth_of_a_ball_has_the_jump_of_the_whole(self):
        folder, module = self.run_of("static_drop")
        text = (folder / "case.toml").read_text(encoding="utf-8")
        text = text.replace("lower = [0, 0]", "lower = [0, 0, 0]").replace("upper = [1, 1]", "upper = [0.5, 0.5, 0.5]")
        (folder / "case.toml").write_text(text, encoding="utf-8")
        at = lattice([0, 0, 0], [0.5, 0.5, 0.5], 1 / 32)
        inside = np.linalg.norm(at, axis=1) < 0.25
        radius = np.cbrt(6 * inside.sum() / 32**3 / np.pi)
        self.assertAlmostEqual(radius, 0.25, delta=0.002)
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: at, {
            "pressure": lambda p, t: np.where(inside, 2 * 1.01 / radius, 0), "phase": lambda p, t: inside,
            "velocity": lambda p, t: 0 * p})
        self.assertAlmostEqual(module.measure({"ball": Results(folder)})["ball_jump"], 1.01, places=5)


class HydrostaticLayers(CaseTest):
    def test_the_exact_pressure_has_no_error_and_a_linear_one_has(self):
        folder, module = self.run_of("hydrostatic_layers")
        at = lattice([0, 0], [1, 2], 1 / 32)
        for scale, largest in ((1, 0), (1.01, 0.01)):
            exact = {"pressure": lambda p, t, scale=scale: 7 + scale * module.exact_pressure(Results(folder), p[:, 1]),
                     "phase": lambda p, t: p[:, 1] > 1,
                     "velocity": lambda p, t: 0 * p[:, :2]}
            t = np.linspace(0, 20, 41)
            write_table(folder / "series.csv", series_of(t, max_speed=np.where(t < 10, 0.5, 0.004),
                                                         centre_water_y=0.5 + 1e-4 * t, centre_air_y=1.5 + 0 * t))
            write_snapshots(folder / "fluid.vtkhdf", [0, 20], lambda t: at, exact)
            measured = module.measure({"viscous": Results(folder)})
            self.assertLessEqual(measured["viscous_pressure_max"], largest + 1e-6)
            self.assertGreaterEqual(measured["viscous_pressure_max"], largest / 2)
            self.assertAlmostEqual(measured["viscous_speed"], 0.004)
            self.assertAlmostEqual(measured["viscous_centre_water"], 2e-3)
            self.assertEqual(measured["viscous_crossed"], 0)


class TaylorGreenWcsph(CaseTest):
    def test_the_decay_rate(self):
        folder, module = self.run_of("taylor_green_wcsph")
        t = np.linspace(0, 1, 101)
        write_table(folder / "series.csv", series_of(t, kinetic_energy=0.25 * np.exp(-1.03 * 16 * np.pi**2 * 0.01 * t)))
        measured = module.measure({"standard": Results(folder)})
        self.assertAlmostEqual(measured["decay_rate_error"], 0.03, places=6)
        self.assertAlmostEqual(measured["early_decay_rate_error"], 0.03, places=6)


class DamBreakAir(CaseTest):
    def test_the_front_and_single_particles(self):
        folder, module = self.run_of("dam_break_air")
        spacing = float(Results(folder).case["resolution"]["spacing"])
        at = lattice([0, 0], [2, 1], spacing)
        water = (at[:, 0] < 1) & (at[:, 1] < 0.5)
        water[np.argmin(np.hypot(at[:, 0] - 1.6, at[:, 1] - 0.8))] = True
        write_snapshots(folder / "fluid.vtkhdf", [1.5], lambda t: at, {"phase": lambda p, t: ~water})
        measured = module.measure({"coarse": Results(folder)})
        self.assertAlmostEqual(measured["coarse_strays"], 1 / len(at))
        self.assertAlmostEqual(measured["coarse_front"], 1, delta=spacing)


class RisingBubble(CaseTest):
    def test_the_reference_has_no_error_and_a_slower_bubble_has(self):
        folder, module = self.run_of("rising_bubble_2d")
        known = module.reference()
        at = lattice([0, 0], [1, 2], 1 / 64)
        inside = np.hypot(at[:, 0] - 0.5, at[:, 1] - 0.5) < 0.25
        write_snapshots(folder / "fluid.vtkhdf", [0], lambda t: at, {"phase": lambda p, t: inside})
        for factor in (1, 0.9):
            t = np.arange(0, 3.0005, 0.001)
            height = np.interp(t, known[:, 0], known[:, 2])
            end = height[-1]
            height = end + factor * (height - end)
            write_table(folder / "series.csv", series_of(
                t, centre_bubble_y=height, velocity_bubble_y=0.8 * np.interp(t, known[:, 0], known[:, 3]), volume_bubble=0.2))
            measured = module.measure({"bubble": Results(folder)})
            self.assertLess(measured["y_com_error"], 1e-6)
            self.assertAlmostEqual(measured["rise_velocity_error"], 1 - factor, delta=0.002)
            self.assertAlmostEqual(measured["mean_of_particles_error"], 0.2, delta=0.002)
            self.assertLess(measured["circularity_error"], 1e-3)
            self.assertEqual(measured["area_drift"], 0)

    def test_circularity_of_an_ellipse(self):
        module = load_measure(CASES / "rising_bubble_2d")
        at = lattice([0, 0], [1, 1], 1 / 64)
        inside = ((at[:, 0] - 0.5) / 0.3) ** 2 + ((at[:, 1] - 0.5) / 0.2) ** 2 < 1
        self.assertAlmostEqual(module.circularity(at, inside, 1 / 64), 0.97007, delta=0.004)


class Oscillations(CaseTest):
    def test_a_capillary_wave_of_the_normal_mode_has_no_error(self):
        folder, module = self.run_of("capillary_wave")
        omega, gamma = module.exact(Results(folder))
        self.assertAlmostEqual(omega / np.sqrt((2 * np.pi) ** 3 / 2), 0.96462295, places=6)
        at = lattice([0, -1], [1, 1], 1 / 128)
        for slower, damped in ((1, 1), (0.97, 1.1)):
            def phase(p, t):
                amplitude = 0.1 * np.exp(-damped * gamma * t) * np.cos(slower * omega * t + 0.3)
                return p[:, 1] > amplitude * np.cos(2 * np.pi * p[:, 0])
            write_snapshots(folder / "fluid.vtkhdf", np.linspace(0, 1.8, 91), lambda t: at, {"phase": phase})
            measured = module.measure({"wave": Results(folder)})
            self.assertAlmostEqual(measured["frequency_ratio"], slower, delta=0.002)
            self.assertAlmostEqual(measured["damping_ratio"], damped, delta=0.03)

    def test_an_oscillating_drop_of_the_exact_frequency_has_no_error(self):
        folder, module = self.run_of("oscillating_drop")
        at = lattice([0, 0], [2, 2], 1 / 48)
        for slower, growth in ((1, 0), (0.95, 0.02)):
            def phase(p, t):
                omega = np.sqrt(3)
                size = 1 + 0.1 * np.exp(growth * omega * t) * np.cos(slower * omega * t) * np.cos(
                    2 * np.arctan2(p[:, 1], p[:, 0]))
                return np.hypot(p[:, 0], p[:, 1]) < size
            write_snapshots(folder / "fluid.vtkhdf", np.linspace(0, 8, 81), lambda t: at, {"phase": phase})
            measured = module.measure({"equal": Results(folder)})
            self.assertAlmostEqual(measured["equal_frequency_inviscid_ratio"], slower, delta=0.003)
            omega = 1.717224 * 1.66622682 / np.sqrt(3)   # of this amplitude, box and viscosity
            self.assertAlmostEqual(measured["equal_frequency_ratio"], slower * np.sqrt(3) / omega, delta=0.003)
            self.assertAlmostEqual(measured["equal_decay_over_frequency"], -growth * np.sqrt(3) / omega, delta=0.003)

    def test_boundary_layers_slow_a_drop_by_what_they_damp_and_a_heavy_one_has_none(self):
        table = read_reference(CASES / "oscillating_drop" / "reference" / "viscous_frequencies.csv",
                               ("rho_c", "nu_d", "n", "omega", "decay"))
        rows = list(zip(*(map(float, table[name]) for name in ("rho_c", "nu_d", "n", "omega", "decay"))))
        self.assertEqual(len(rows), 6)
        for rho_c, nu_d, n, omega, decay in rows:
            inviscid = np.sqrt(n * (n * n - 1) / (1 + rho_c))
            if rho_c == 1:  # layers of sqrt(nu / omega): their next order is that small beside them
                layers = np.sqrt(nu_d / inviscid)
                self.assertAlmostEqual((1 - omega / inviscid) / (decay / inviscid), 1, delta=3 * layers)
            else:           # potential flow decays with 2 n (n - 1) nu; the air adds 2 to 6 % to that
                self.assertAlmostEqual(decay / (2 * n * (n - 1) * nu_d), 1, delta=0.06)


    def test_a_high_amplitude_slows_a_drop_with_its_square_and_walls_of_the_box_by_their_added_mass(self):
        table = read_reference(CASES / "oscillating_drop" / "reference" / "potential_frequencies.csv",
                               ("rho_c", "n", "amplitude", "half_width", "omega"))
        names = ("rho_c", "n", "amplitude", "half_width", "omega")
        omega = {row[:4]: row[4] for row in zip(*(map(float, table[name]) for name in names))}
        for rho_c in (1, 1e-3):
            for n, half_width in ((2, 4), (3, 3)):
                linear = np.sqrt(n * (n * n - 1) / (1 + rho_c))
                low, high = (1 - omega[rho_c, n, a, 0] / linear for a in (0.05, 0.1))
                self.assertAlmostEqual(high / low, 4, delta=0.1)    # the next order: (n a)^2 of it
                inertia = rho_c / (1 + rho_c)
                slower = 1 - omega[rho_c, n, 0.1, half_width] / omega[rho_c, n, 0.1, 0]
                self.assertGreaterEqual(slower, 0)
                # A round wall at L makes the inertia outside (1 + L^-2n) / (1 - L^-2n) of it; the corners are farther. The
                # file holds six decimals.
                self.assertLess(slower, inertia * half_width**(-2.0 * n) + 1e-6)


class Franke(CaseTest):
    def test_the_laplacian_is_that_of_differences(self):
        module = load_measure(CASES / "franke")
        x, y, d = np.array([0.1, 0.4, 0.7]), np.array([0.2, 0.8, 0.3]), 1e-4

        def f(x, y):
            return (0.75 * np.exp(-((9 * x - 2)**2 + (9 * y - 2)**2) / 4)
                    + 0.75 * np.exp(-(9 * x + 1)**2 / 49 - (9 * y + 1) / 10)
                    + 0.5 * np.exp(-((9 * x - 7)**2 + (9 * y - 3)**2) / 4)
                    - 0.2 * np.exp(-(9 * x - 4)**2 - (9 * y - 7)**2))
        found = (f(x + d, y) + f(x - d, y) + f(x, y + d) + f(x, y - d) - 4 * f(x, y)) / d**2
        np.testing.assert_allclose(module.laplacian(x, y), found, rtol=1e-4)

    def test_measures_errors_and_their_order(self):
        runs = {}
        for name, n, relative in (("gfd_81", 81, 0.04), ("gfd_161", 161, 0.01), ("sph_81", 81, 0.0083435313)):
            folder, module = self.run_of("franke")
            text = (folder / "case.toml").read_text(encoding="utf-8")
            (folder / "case.toml").write_text(text.replace("spacing = 0.025", f"spacing = {1 / (n - 1)}"), encoding="utf-8")
            at = lattice([-0.1 - 0.5 / (n - 1)] * 2, [1.1 + 0.5 / (n - 1)] * 2, 1 / (n - 1))
            write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t, at=at: at, {
                "diffusion": lambda p, t, relative=relative, module=module: np.column_stack(
                    [(1 + relative + t) * module.laplacian(p[:, 0], p[:, 1]), 0 * p[:, 0]])})
            runs[name] = Results(folder)
        measured = module.measure(runs)
        self.assertAlmostEqual(measured["gfd_81_error"], 0.04, delta=1e-4)
        self.assertAlmostEqual(measured["gfd_order"], 2, delta=0.01)
        self.assertLess(measured["sph_against_table"], 1e-3)
        self.assertGreater(measured["gfd_against_table"], 5)


class PoiseuilleOperators(CaseTest):
    def test_measures_how_far_forms_are_from_the_divergence(self):
        values, runs = {"gfd": 2.0, "sph": 2.2, "printed": 0.0}, {}
        at = lattice([0, -1], [3, 1], 0.05)
        for ratio in (5, 100):
            for name, value in values.items():
                folder, module = self.run_of("poiseuille_operators")
                write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: at, {
                    "id": lambda p, t: np.arange(len(p)),
                    "diffusion": lambda p, t, value=value, ratio=ratio: np.column_stack(
                        [ratio * value * (np.abs(p[:, 1]) < 0.14) + t, 0 * p[:, 0]])})
                runs[f"{name}_{ratio}"] = Results(folder)
        measured = module.measure(runs)
        # Six layers within 3 h, of which those at 0.125 are the last.
        self.assertAlmostEqual(measured["gfd_5"], 10, delta=1e-5)
        self.assertAlmostEqual(measured["gfd_5_scatter"], 0, delta=1e-5)
        self.assertAlmostEqual(measured["forms_apart"], 0.1, delta=1e-5)
        self.assertAlmostEqual(measured["growth"], 20, delta=1e-4)


class TaylorCouetteTwoPhase(CaseTest):
    def test_the_exact_flow_meets_the_walls_and_has_one_torque(self):
        module = load_measure(CASES / "taylor_couette_two_phase")
        for inner, outer in ((5.0, 1.0), (0.2, 1.0), (100.0, 1.0)):
            a, b, c, d = module.coefficients(inner, outer)
            self.assertAlmostEqual(a + b, 1)
            self.assertAlmostEqual(2 * c + d / 2, 0)
            self.assertAlmostEqual(1.5 * a + b / 1.5, 1.5 * c + d / 1.5)
            self.assertAlmostEqual(inner * b, outer * d)
        one = module.coefficients(1.0, 1.0)
        np.testing.assert_allclose(one, [-1 / 3, 4 / 3, -1 / 3, 4 / 3])

    def test_measures_a_constant_error_its_order_and_the_torques(self):
        runs, torque = {}, None
        at = lattice([-2, -2], [2, 2], 0.05)
        radius = np.hypot(at[:, 0], at[:, 1])
        at = at[(radius > 1) & (radius < 2)]
        for name, offset in (("ratio_5_coarse", 0.04), ("ratio_5", 0.02)):
            folder, module = self.run_of("taylor_couette_two_phase")
            torque = 4 * np.pi * 5 * module.coefficients(5.0, 1.0)[1]
            write_table(folder / "bodies.csv", {"t": np.array([0.1, 0.1, 0.4, 0.4]), "body": np.array([0, 1, 0, 1]),
                                                "viscous_torque_z": torque * np.array([0, 0, 1.01, -0.98])})

            def velocity(p, t, offset=offset):
                r = np.hypot(p[:, 0], p[:, 1])
                u = module.exact(r, 5.0, 1.0) + offset
                return np.column_stack([-u * p[:, 1] / r, u * p[:, 0] / r])
            write_snapshots(folder / "fluid.vtkhdf", [0, 0.4], lambda t: at, {"velocity": velocity})
            runs[name] = Results(folder)
        measured = module.measure(runs)
        self.assertAlmostEqual(measured["ratio_5_error"], 0.02, places=5)
        self.assertAlmostEqual(measured["ratio_5_order"], 1, places=4)
        self.assertAlmostEqual(measured["ratio_5_outer_torque_error"], 0.01, places=5)
        self.assertAlmostEqual(measured["ratio_5_inner_torque_error"], 0.02, places=5)


class DropInShear(CaseTest):
    def test_the_deformation_of_an_ellipsoid(self):
        folder, module = self.run_of("drop_in_shear")
        at = lattice([-1.5, 0, -1.5], [1.5, 1.5, 1.5], 0.0625)
        a, b, turn = 1.1, 0.95, np.radians(40)
        along = at[:, 0] * np.cos(turn) + at[:, 2] * np.sin(turn)
        across = at[:, 2] * np.cos(turn) - at[:, 0] * np.sin(turn)
        inside = (along / a) ** 2 + (across / b) ** 2 + at[:, 1] ** 2 * a * b < 1
        write_snapshots(folder / "fluid.vtkhdf", [0, 0.6], lambda t: at, {"phase": lambda p, t: inside})
        deformation, angle = module.shape(Results(folder).snapshots()[-1])
        self.assertAlmostEqual(deformation, (a - b) / (a + b), delta=0.004)
        self.assertAlmostEqual(angle, 40, delta=2)
        taylor = 0.05 * 35 / 32 * (1 + 5.6996 * 1.75 / 8**3)
        measured = module.measure({"ratio_1": Results(folder)})
        self.assertAlmostEqual(measured["ratio_1_deformation_error"], abs(deformation / taylor - 1), places=5)


class ViscousDrop(CaseTest):
    def written(self, ratio, faster, stretch):
        """The measures of a drop of radius 1 in a tube of radius 2.5 that has `faster` times the exact velocity at its end."""
        folder, module = self.run_of("viscous_drop")
        text = (folder / "case.toml").read_text(encoding="utf-8")
        drop = text.rindex("viscosity = 1\n")
        (folder / "case.toml").write_text(text[:drop] + f"viscosity = {ratio}\n" + text[drop + 14:], encoding="utf-8")
        at = lattice([0, 0, -3.5], [2.5, 2.5, 3.5], 1 / 12)
        at = at[at[:, 0] ** 2 + at[:, 1] ** 2 < 2.5**2]
        inside = at[:, 0] ** 2 + at[:, 1] ** 2 + ((at[:, 2] - 0.5) / stretch) ** 2 < 1
        known = {0.01: 0.657370, 1: 0.434048, 100: 0.281041}[ratio]
        t = np.linspace(0, 1, 101)
        speed = -faster * known * np.minimum(t / 0.8, 1)
        tube = np.pi / 4 * 2.5**2 * 7
        write_table(folder / "series.csv", series_of(t, velocity_drop_z=speed, centre_drop_z=0.5 - 0.9 * faster * known * t,
                                                     volume_drop=1.01 * np.pi / 3,
                                                     volume_outside=1.01 * (tube - np.pi / 3)))
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: at, {"phase": lambda p, t: inside})
        return module.measure({"drop": Results(folder)})

    def test_the_velocity_of_the_table_has_no_error_and_a_faster_one_has(self):
        for ratio in (0.01, 1, 100):
            measured = self.written(ratio, 1, 1)
            self.assertLess(measured["drop_error"], 1e-6)
            self.assertLess(measured["drop_out_of_round"], 0.01)
            self.assertAlmostEqual(measured["drop_way_excess"], -0.1, places=5)
            self.assertAlmostEqual(self.written(ratio, 1.04, 1)["drop_excess"], 0.04, places=6)

    def test_a_spheroid_is_out_of_round(self):
        self.assertAlmostEqual(self.written(1, 1, 1.1)["drop_out_of_round"], 0.1, delta=0.01)

    def test_the_radius_between_two_of_the_table(self):
        folder, module = self.run_of("viscous_drop")
        text = (folder / "case.toml").read_text(encoding="utf-8")
        (folder / "case.toml").write_text(text.replace("radius = 2.5", "radius = 4"), encoding="utf-8")
        tube = np.pi / 4 * 4**2 * 7
        write_table(folder / "series.csv", series_of([0, 1], volume_drop=np.pi / 3, volume_outside=tube - np.pi / 3))
        self.assertAlmostEqual(module.exact(Results(folder)), 0.693053, places=6)

    def test_the_other_stress_is_the_same_for_one_viscosity_and_for_a_rigid_drop(self):
        module = load_measure(CASES / "viscous_drop")
        self.assertAlmostEqual(module.other_stress(0), 1 / 3)
        self.assertAlmostEqual(module.other_stress(1), 0)
        self.assertAlmostEqual(module.other_stress(1e9), 0)
        # The drag 4 pi mu A of the flow that meets the four conditions at the sphere, solved for.
        for ratio in (0.01, 0.3, 100):
            drags = []
            for true_stress in (1, 0):
                # Unknowns A, B, c, d of u_r / cos and -u_theta / sin: A / (2 r) - B / (2 r^3), c + 2 d r^2.
                outside = np.array([-0.5, 1.5]) + true_stress * (np.array([1, 1]) - np.array([0.5, -0.5]))
                within = np.array([0, 4]) + true_stress * (np.array([1, 1]) - np.array([1, 2]))
                matrix = [[1, 1, 0, 0], [0, 0, 1, 1], [0.5, -0.5, -1, -2], [*outside, *(-ratio * within)]]
                drags.append(np.linalg.solve(matrix, [1, 1, 0, 0])[0])
            self.assertAlmostEqual(module.other_stress(ratio), drags[0] / drags[1] - 1)


class RisingBubbleInATube(CaseTest):
    def test_velocity_range_of_pressure_and_size(self):
        runs = {}
        at = lattice([0, 0, -2], [1, 1, 4], 1 / 16)
        inside = np.hypot(at[:, 0], at[:, 1]) ** 2 / 0.6**2 + (at[:, 2] - 1) ** 2 / 0.4**2 < 1
        centre = at[inside][:, 2].mean()
        near = at[:, 0] ** 2 + at[:, 1] ** 2 + (at[:, 2] - centre) ** 2 < 1
        for diffusion, faster in (("split", 1), ("printed", 0.9), ("mu-laplacian", 1.5)):
            folder, module = self.run_of("rising_bubble_3d")
            text = (folder / "case.toml").read_text(encoding="utf-8")
            text = text.replace("spacing = 0.125 ", "spacing = 0.0625 ")
            (folder / "case.toml").write_text(text.replace("[momentum]", f'[momentum]\ndiffusion = "{diffusion}"'),
                                              encoding="utf-8")
            t = np.linspace(0, 7, 71)
            write_table(folder / "series.csv", series_of(t, velocity_bubble_z=np.where(t < 5, 9, 0.2 * faster)))
            high = np.hypot(at[:, 0], at[:, 1]) < 0.5
            write_snapshots(folder / "fluid.vtkhdf", [0, 7], lambda t: at, {
                "phase": lambda p, t: inside,
                "pressure": lambda p, t: 3 - 2 * p[:, 2] + np.where(high & (p[:, 2] > 1), 0.782, 0) + ~near * p[:, 2]})
            runs["fine_" + diffusion.replace("-", "_")] = Results(folder)
        measured = module.measure(runs)
        self.assertAlmostEqual(measured["fine_split_velocity"], 0.2)
        self.assertAlmostEqual(measured["fine_split_growth"], 0)
        self.assertAlmostEqual(measured["fine_excess_over_split"], 0.5)
        self.assertAlmostEqual(measured["fine_excess_over_printed"], 1.5 / 0.9 - 1)
        self.assertLess(measured["fine_printed_pressure_error"], 1e-5)
        self.assertAlmostEqual(measured["fine_mu_laplacian_pressure_error"], 0.782 / 0.759 - 1, places=5)
        self.assertAlmostEqual(measured["fine_split_width"], 1.2, delta=0.02)
        self.assertAlmostEqual(measured["fine_split_height"], 0.8, delta=0.02)
        self.assertEqual(measured["fine_split_left_behind"], 0)
        across, height = module.outline(runs["fine_split"], runs["fine_split"].snapshots()[-1])
        np.testing.assert_allclose(across**2 / 0.6**2 + height**2 / 0.4**2, 1, atol=0.15)


class BubbleInAViscousLiquid(CaseTest):
    def test_the_reynolds_number_is_held_against_the_row_of_the_run(self):
        folder, module = self.run_of("bhaga_weber")
        at = lattice([0, 0, -2], [1, 1, 5], 1 / 16)
        inside = np.hypot(at[:, 0], at[:, 1]) ** 2 / 0.6**2 + (at[:, 2] - 1) ** 2 / 0.4**2 < 1
        t = np.linspace(0, 4.5, 46)
        write_table(folder / "series.csv", series_of(t, velocity_bubble_z=np.where(t < 3.45, 9, 0.36481 * 1.05)))
        write_snapshots(folder / "fluid.vtkhdf", [0, 4.5], lambda t: at, {"phase": lambda p, t: inside})
        measured = module.measure({"m848": Results(folder)})
        self.assertAlmostEqual(measured["m848_reynolds"], 1.05 * 2.3895, delta=1e-3)
        self.assertAlmostEqual(measured["m848_reynolds_error"], 0.05, delta=5e-4)
        self.assertAlmostEqual(measured["m848_difference_from_experiment"], 1.05 * 2.3895 / 2.47 - 1, delta=5e-4)
        self.assertAlmostEqual(measured["m848_growth"], 0)
        self.assertAlmostEqual(measured["m848_width"], 1.2, delta=0.02)
        self.assertAlmostEqual(measured["m848_height"], 0.8, delta=0.02)
        text = (folder / "case.toml").read_text(encoding="utf-8")
        (folder / "case.toml").write_text(text.replace("0.15268", "0.14"), encoding="utf-8")
        with self.assertRaises(ValueError):  # no row has this liquid
            module.measure({"m848": Results(folder)})


if __name__ == "__main__":
    unittest.main()
