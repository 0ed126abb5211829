# SPDX-License-Identifier: MIT
"""Measures of bubbles that depart from a slot, on run folders written from known answers."""
import numpy as np
from case_test import CaseTest
from spume_tools.results import Results
from synthetic import lattice, series_of, write_snapshots, write_table


class BubbleDeparture(CaseTest):
    def test_the_largest_static_bubble(self):
        _, module = self.run_of("bubble_departure")
        # A narrow slot: two sides hold 2 sigma, which is the weight of 2 l_c^2 (planar Tate), and no more by half a slot.
        self.assertAlmostEqual(module.largest_static_area(0.01), 2, delta=0.03)
        # A wider one carries more by the pressure on it.
        self.assertGreater(module.largest_static_area(0.6), module.largest_static_area(0.3))

    def slot_run(self, name, discs, lost=0.0):
        """Air stands on the slot; disc number k, of which discs(t) gives number and height, is in the water at time t."""
        folder, module = self.run_of("bubble_departure")
        at, radius, times = lattice([-3, 0], [3, 6.75], 0.15), 0.6, np.arange(0, 8, 0.5)

        def number(p, t):
            """0 in the water, -1 in the air on the slot and above the water, of a disc its number."""
            found = np.where((np.abs(p[:, 0]) < 0.45) & (p[:, 1] < 0.3) | (p[:, 1] > 5.25), -1, 0)
            for k, height in discs(t):
                found = np.where(p[:, 0] ** 2 + (p[:, 1] - height) ** 2 < radius**2, k, found)
            return found

        write_snapshots(folder / "fluid.vtkhdf", times, lambda t: at, {
            "phase": lambda p, t: number(p, t) != 0, "id": number,
            "density": lambda p, t: np.where(number(p, t) != 0, 0.01 * 1.25, 1.0)})
        write_table(folder / "series.csv", series_of(
            times, volume_water=31.5, volume_in_water=0, volume_out_water=0,
            volume_air=9 + 0.1 * times - np.where(times > 5, lost, 0), volume_in_air=0.1 * times, volume_out_air=0))
        return folder, module.measure({name: Results(folder)}), module

    def test_volumes_and_times_of_departures(self):
        period, radius = 3.0, 0.6
        # A disc leaves every three times, at 1, and rises by one in a time.
        folder, measured, module = self.slot_run(
            "slot", lambda t: [(k + 1, 1.35 + t - left) for k, left in enumerate((1.0, 4.0, 7.0)) if t >= left], lost=0.01)
        self.assertEqual(measured["slot_departures"], 3)
        self.assertAlmostEqual(measured["slot_period"], period)
        self.assertAlmostEqual(measured["slot_volume"], np.pi * radius**2 / 1.25, delta=0.06)
        self.assertAlmostEqual(measured["slot_volume_error"], measured["slot_volume"] / measured["slot_static_limit"] - 1)
        self.assertAlmostEqual(measured["slot_balance"], 0.01)
        # Particles of an incompressible phase keep their volume, whatever the filtered density is.
        text = (folder / "case.toml").read_text(encoding="utf-8")
        (folder / "case.toml").write_text(text.replace('method = "wcsph"', 'method = "gfd"'), encoding="utf-8")
        measured = module.measure({"gfd": Results(folder)})
        self.assertAlmostEqual(measured["gfd_volume"], np.pi * radius**2, delta=0.06)

    def test_a_bubble_that_the_slot_catches_again_departs_once(self):
        heights = {1.0: 1.0, 1.5: 0.6, 2.0: 1.2, 2.5: 1.8}  # at 1.5 it touches the air on the slot
        _, measured, _ = self.slot_run("slot", lambda t: [(1, heights[t])] if t in heights else [])
        self.assertEqual(measured["slot_departures"], 1)
        # Another one on its place is a second departure.
        _, measured, _ = self.slot_run("slot", lambda t: [(1 + (t > 1.5), heights[t])] if t in heights else [])
        self.assertEqual(measured["slot_departures"], 2)

    def neck_run(self, closes_at):
        """A disc of radius 0.7 stands above a neck on the slot, which narrows until then and widens again as fast."""
        folder, module = self.run_of("bubble_departure")
        text = (folder / "case.toml").read_text(encoding="utf-8")
        for old, new in (("q = 0.1", "q = 1.0"), ("surface_tension = 0.99", "surface_tension = 0.02"),
                         ("spacing = 0.15", "spacing = 0.05"), ("[-0.45, 0]", "[-0.2, 0]"), ("[0.45, 0]", "[0.2, 0]")):
            text = text.replace(old, new)
        (folder / "case.toml").write_text(text, encoding="utf-8")
        at, times = lattice([-3, 0], [3, 6.75], 0.05), np.arange(0.1, 3, 0.1)

        def air(p, t):
            x, y = np.abs(p[:, 0]), p[:, 1]
            wide = 0.2 - 0.15 * np.minimum(t, 2 * closes_at - t) / closes_at
            neck = np.where(np.abs(y - 0.4) < 0.1, wide, 0.2)
            return (y < 0.8) & (x < neck) | (x**2 + (y - 1.2) ** 2 < 0.7**2) | (y > 5.25)

        write_snapshots(folder / "fluid.vtkhdf", times, lambda t: at, {
            "phase": air, "id": lambda p, t: np.arange(len(p)), "density": lambda p, t: np.where(air(p, t), 0.01, 1.0)})
        write_table(folder / "series.csv", series_of(
            times, **{f"volume_{kind}{phase}": 0 for kind in ("", "in_", "out_") for phase in ("water", "air")}))
        return module.measure({"flow": Results(folder)})

    def test_the_first_bubble_of_a_flow_is_what_is_above_the_narrowest_neck(self):
        measured = self.neck_run(1.5)
        # (4 * 1.5)^(2/3) / pi^(1/3): the rise t^2 / 6 is the radius sqrt(t / pi).
        self.assertAlmostEqual(measured["flow_flow_limit"], (6 / np.sqrt(np.pi)) ** (2 / 3), places=12)
        self.assertAlmostEqual(measured["flow_neck_at"], 1.5, delta=0.25)  # two particles wide from 1.25 on
        self.assertAlmostEqual(measured["flow_neck"], 0.1, delta=0.06)
        # The disc and 0.1 of the foot of the neck, 0.4 wide.
        self.assertAlmostEqual(measured["flow_volume"], np.pi * 0.7**2 + 0.02, delta=0.05)
        self.assertAlmostEqual(measured["flow_volume_error"], measured["flow_volume"] / measured["flow_flow_limit"] - 1)
