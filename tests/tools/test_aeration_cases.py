# SPDX-License-Identifier: MIT
"""Measures of the aerated tanks, on run folders written from known answers."""
import numpy as np
from case_test import CaseTest
from spume_tools.places import CASES
from spume_tools.results import Results
from spume_tools.verify.cases import load_measure
from synthetic import lattice, series_of, write_snapshots, write_table


class CleanWater(CaseTest):
    def measured(self, factor=1.0, lost=0.0):
        folder, module = self.run_of("clean_water")
        limit, kla = module.saturation_at_mid_depth(Results(folder)), 2e-3
        t = np.linspace(0, 200, 401)
        oxygen = limit * (1 - np.exp(-factor * kla * t))
        write_table(folder / "series.csv", series_of(
            t, mean_oxygen=oxygen, kla=kla, sotr=3e-4, sote=0.03, amount_of_oxygen=0.016 * oxygen,
            oxygen_in_bubbles=0.01, oxygen_left=t - 0.016 * oxygen, oxygen_released=t + 0.01 + lost))
        return module.measure({"run": Results(folder)})

    def test_the_saturation_is_that_of_the_tables(self):
        folder, module = self.run_of("clean_water")
        self.assertAlmostEqual(module.saturation(20), 9.0924, places=3)
        # 1.958 kPa of the depth over 98.99 kPa of dry air.
        self.assertAlmostEqual(module.saturation_at_mid_depth(Results(folder)) / module.saturation(20), 1.01979, places=4)

    def test_exact_curve_has_no_error(self):
        measured = self.measured()
        self.assertLess(measured["kla_error"], 1e-9)
        self.assertLess(measured["oxygen_balance"], 1e-12)
        self.assertAlmostEqual(measured["sote_percent_per_metre"], 7.5)

    def test_another_rate_and_lost_oxygen_are_seen(self):
        measured = self.measured(1.05, lost=0.1)
        self.assertAlmostEqual(measured["kla_error"], 0.05, places=6)
        self.assertAlmostEqual(measured["oxygen_balance"], 0.1 / 200.11, places=6)


class AeratedTank(CaseTest):
    def measured(self, leak=0.0, uptake_error=0.0, sote=0.03):
        """Biomass that grows on substrate and nitrate that is reduced, written out: Y = 0.67."""
        folder, module = self.run_of("aerated_tank")
        t = np.linspace(0, 100, 101)
        fed, growth, reduced = 0.02 * t, 0.004 * t, 0.001 * t
        uptake = growth * 0.33 / 0.67
        dinitrogen = reduced
        anoxic = 2.86 * 0.67 / 0.33 * reduced
        columns = {name: 0.0 for name in ("S_I", "X_I", "X_S", "X_BA", "X_P", "S_ND", "X_ND")}
        columns |= {"S_S": 5 + fed - (growth + anoxic) / 0.67 + leak * t, "X_BH": 80 + growth + anoxic,
                    "S_NH": 9 - 0.08 * (growth + anoxic), "S_NO": 9 - dinitrogen, "S_O": 1 + 0.001 * t}
        supply = 0.001 * t + uptake + uptake_error * t
        write_table(folder / "series.csv", series_of(
            t, **{f"amount_of_{name}": value for name, value in columns.items()}, source_of_S_S=fed,
            oxygen_from_bubbles=0.9 * supply, oxygen_from_surface=0.1 * supply, oxygen_uptake=uptake,
            oxygen_uptake_rate=20, sote=sote, kla=8e-4, kinetic_energy=0.3, mass=60, mean_oxygen=1))
        return module.measure({"run": Results(folder)})

    def test_growth_by_the_stoichiometry_closes(self):
        measured = self.measured()
        self.assertLess(measured["oxygen_balance"], 1e-9)
        self.assertLess(measured["cod_balance"], 1e-9)
        self.assertEqual(measured["sote_off_range"], 0)
        self.assertAlmostEqual(measured["mean_speed"], 0.1)

    def test_leaks_and_efficiencies_out_of_range_are_seen(self):
        # Uptake at the end: 0.4 * 0.33 / 0.67.
        self.assertAlmostEqual(self.measured(leak=1e-4)["cod_balance"], 1e-2 / 0.19701, places=3)
        self.assertAlmostEqual(self.measured(uptake_error=1e-4)["oxygen_balance"], 1e-2 / 0.19701, places=3)
        self.assertAlmostEqual(self.measured(sote=0.05)["sote_off_range"], 2.7)


class RecordedFlow(CaseTest):
    """Two runs that agree but for what is put into the recorded one."""

    def run_with(self, factor=1.0, leak=0.0, tilt=0.0):
        folder, module = self.run_of("recorded_flow")
        case = (folder / "case.toml").read_text(encoding="utf-8")
        section = "[recorded_flow]\nfrom = 15\nuntil = 45\nlag = 0.5\ncell = 0.05\n\n[biokinetics]"
        (folder / "case.toml").write_text(case.replace("[biokinetics]", section), encoding="utf-8")
        t = np.linspace(0, 300, 301)
        late = np.maximum(t - 45, 0) / 255
        amount = 5e-3 * (1 + (factor - 1) * late)
        uptake = 1e-4 * t
        write_table(folder / "series.csv", series_of(
            t, amount_of_S_O=amount, amount_of_S_S=0.01 + 1e-5 * t, amount_of_S_NH=0.02, amount_of_S_NO=0.1, amount_of_X_BH=10.0,
            oxygen_uptake=uptake, oxygen_from_bubbles=0.9 * np.minimum(uptake, 4.5e-3), oxygen_from_surface=0.1 * np.minimum(uptake, 4.5e-3),
            oxygen_from_record=np.maximum(uptake - 4.5e-3, 0) + amount - amount[0] + leak * late))
        points = lattice((0, 0, 0), (0.3, 0.175, 0.2), 0.025)
        write_snapshots(folder / "fluid.vtkhdf", (0, 60, 120), lambda t: points,
                        {"S_O": lambda r, t: 0.5 * (1 + 0.2 * (r[:, 2] > 0.1) + tilt * np.sign(r[:, 0] - 0.15))})
        return Results(folder), module

    def measured(self, **change):
        full, module = self.run_with()
        return module.measure({"full": full, "recorded": self.run_with(**change)[0]})

    def test_runs_that_agree_have_no_error(self):
        measured = self.measured()
        self.assertLess(measured["recorded_error"], 1e-9)
        self.assertLess(measured["pattern_error"], 1e-6)
        self.assertLess(measured["oxygen_balance"], 1e-9)
        self.assertAlmostEqual(measured["pattern_deviation"], 0.1 / 1.1, places=4)

    def test_drift_leak_and_another_pattern_are_seen(self):
        self.assertAlmostEqual(self.measured(factor=1.03)["recorded_error"], 0.03, places=6)
        self.assertAlmostEqual(self.measured(leak=3e-3)["oxygen_balance"], 0.1, places=6)
        self.assertAlmostEqual(self.measured(tilt=0.04)["pattern_error"], 0.04 / 1.1, places=4)


class BubbleColumnIn3D(CaseTest):
    """Gas whose power goes to slip by nine tenths and to dissipation by one; a tracer whose halves even out exponentially."""

    def measured(self, slip=0.9, lost=0.0, until=14.0):
        folder, module = self.run_of("bubble_column_3d")
        t = np.linspace(0, until, int(10 * until) + 1)
        points = lattice((0, 0, 0), (0.18, 0.06, 0.35), 0.01)
        mass, gas, rate, area = 998 * 0.18 * 0.06 * 0.35, 1e-4, 1.5e-4, 0.18 * 0.06
        gradient = 998 * 9.81 * 0.35 / (0.35 + gas / area)
        power = rate * gradient * (0.35 + gas / area - module.INLET)
        write_table(folder / "series.csv", series_of(
            t, mass=mass, bubble_volume=gas, bubble_slip=slip * power / gradient / gas, dissipation=0.1 * power,
            injected_volume=rate * t, burst_volume=rate * t - gas - lost))
        write_snapshots(folder / "fluid.vtkhdf", [time for time in t if time >= 2], lambda time: points, {
            "velocity": lambda r, time: np.column_stack([0 * r[:, 0], 0 * r[:, 0], 0.1 * np.cos(2 * np.pi * (r[:, 0] / 0.18 - 0.5))]),
            "tracer": lambda r, time: 1 + np.exp(-0.3 * (time - 2.1)) * np.sign(r[:, 0] - 0.09)})
        return module.measure({"standard": Results(folder)})

    def test_known_answers_are_found(self):
        measured = self.measured()
        self.assertLess(measured["gas_balance"], 1e-9)
        self.assertLess(measured["power_error"], 1e-6)
        self.assertAlmostEqual(measured["share_of_slip"], 0.9, places=6)
        # The middle one of the nine cells across holds both halves and is even from the start.
        self.assertAlmostEqual(measured["mixing_time"], np.log(20 * np.sqrt(8 / 9)) / 0.3, delta=0.1)
        self.assertAlmostEqual(measured["upflow"], 0.1, delta=0.002)
        self.assertAlmostEqual(measured["downflow"], 0.1, delta=0.005)

    def test_lost_power_and_gas_and_a_tracer_that_is_not_mixed_are_seen(self):
        self.assertAlmostEqual(self.measured(slip=0.7)["power_error"], 0.2, places=6)
        self.assertAlmostEqual(self.measured(lost=1e-6)["gas_balance"], 1e-6 / 2.1e-3, places=9)
        self.assertTrue(np.isnan(self.measured(until=8.0)["mixing_time"]))


class BubbleColumn(CaseTest):
    """Two bubbles, the second of half the length, that lift the surface by what they displace; liquid that goes up in the
    middle as a cosine."""

    def measured(self, lift=1.0, turned=1.0, breath=0.0, **tracers):
        """With a breath the snapshots show the water going up everywhere. Of a tracer the rate with which halves even out."""
        folder, module = self.run_of("bubble_column")
        t = np.linspace(0, 2.5, 251)
        area = np.pi * 0.007 * 0.0045 * (1 + 0.25) * (t > 0)
        write_table(folder / "bodies.csv", {"t": np.repeat(t, 2), "body": np.tile([0, 1], t.size),
                                            "scale": np.tile([1, 0.5], t.size) * np.repeat(t > 0, 2)})
        write_table(folder / "probes.csv", {"t": t, "level_1": 0.35 + lift * area / 0.18, "level_2": 0.35 + lift * area / 0.18})
        points = lattice((0, 0), (0.18, 0.35), 0.01)
        halves = {name: lambda r, time, rate=rate: 1 + np.exp(-rate * (time - 2.1)) * np.sign(r[:, 0] - 0.09)
                  for name, rate in tracers.items()}
        times = (0, 1, 1.6, 2.5) + tuple(np.arange(2.6, 14, 0.1) if tracers else ())
        write_snapshots(folder / "fluid.vtkhdf", times, lambda time: points, {
            "velocity": lambda r, time: np.column_stack(
                [0 * r[:, 0], breath + (time >= 1.6) * turned * -0.1 * np.cos(2 * np.pi * r[:, 0] / 0.18)])} | halves)
        write_table(folder / "series.csv", series_of(t, **{f"amount_of_{name}": 1 for name in tracers}))
        return module.measure({"column": Results(folder)})

    def test_known_answers_are_found(self):
        measured = self.measured()
        self.assertLess(measured["column_lift_error"], 1e-9)
        self.assertLess(measured["column_steady_lift_error"], 1e-9)
        self.assertAlmostEqual(measured["column_bubbles"], 1.25, places=9)
        # The quarters of the wave lie between edges of the columns, half a centimetre off: cos(2 pi 0.5 / 18) of it.
        self.assertAlmostEqual(measured["column_recirculation"], 0.1 * 0.18 / (2 * np.pi) * np.cos(np.pi / 18), delta=2e-5)

    def test_a_lower_lift_and_a_weaker_flow_are_seen(self):
        self.assertAlmostEqual(self.measured(lift=0.9)["column_lift_error"], 0.1, places=9)
        ratio = self.measured(turned=0.5)["column_recirculation"] / self.measured()["column_recirculation"]
        self.assertAlmostEqual(ratio, 0.5, places=6)

    def test_sound_in_step_with_the_snapshots_is_no_circulation(self):
        self.assertAlmostEqual(self.measured(breath=0.05)["column_recirculation"], self.measured()["column_recirculation"])

    def test_mixing_times_of_two_tracers(self):
        measured = self.measured(tracer=0.3, tracer_2=0.31)
        self.assertAlmostEqual(measured["column_mixing_time"], np.log(20 * np.sqrt(8 / 9)) / 0.3, delta=0.1)
        self.assertAlmostEqual(measured["column_effect_of_diffusivity"], 1 - 0.3 / 0.31, delta=0.02)
        self.assertNotIn("column_mixing_time", self.measured())
        self.assertTrue(np.isnan(self.measured(tracer=0.1)["column_mixing_time"]))

    def test_mixed_is_what_stays_even(self):
        column = load_measure(CASES / "bubble_column_3d")
        self.assertAlmostEqual(column.mixing_time(np.array([2.1, 3, 4, 5, 6]), np.array([2, 0.04, 0.06, 0.05, 0.01])), 2.9)
