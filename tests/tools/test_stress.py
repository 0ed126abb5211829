# SPDX-License-Identifier: MIT
"""tools/stress: its scenes, its checks on run folders written here, its faults, and the command with a stand-in program."""
import csv
import random
import stat
import subprocess
import sys
import tempfile
import textwrap
import tomllib
import unittest
from pathlib import Path

import paths
import numpy as np
from synthetic import lattice, series_of, write_snapshots, write_table

from spume_tools.bench import parts
from spume_tools.case_file import toml_text
from spume_tools.stress import long
from spume_tools.stress.checks import judge
from spume_tools.stress.faults import BASE, damage, mutated_case
from spume_tools.stress.command import SCENES
from spume_tools.stress.phase_scenes import PHASE_SCENES
from spume_tools.stress.scenes import PARTICLE_SCENES, Scene


class Scenes(unittest.TestCase):
    def test_seed_and_number_give_a_scene_back(self):
        for method, make in SCENES.items():
            one, two = (make(np.random.default_rng([1, 7])) for _ in range(2))
            self.assertEqual(toml_text(one.case), toml_text(two.case))
            self.assertNotEqual(toml_text(one.case), toml_text(make(np.random.default_rng([1, 8])).case))

    def test_every_kind_is_a_case_within_the_limits_of_a_short_run(self):
        for kind in PARTICLE_SCENES:
            for seed in range(4):
                scene = SCENES["les-sph"](np.random.default_rng(seed), [kind])
                case = tomllib.loads(toml_text(scene.case))
                volume = np.prod(np.array(case["domain"]["upper"]))
                self.assertEqual(case["title"], kind)
                if kind not in ("cluster", "drop_free", "colliding_drops"):
                    self.assertLessEqual(volume / case["resolution"]["spacing"] ** len(case["domain"]["upper"]), 2000)

    def test_every_kind_of_phases_is_a_case_whose_regions_are_of_its_phases(self):
        for kind in PHASE_SCENES:
            for seed in range(4):
                scene = SCENES["wcsph"](np.random.default_rng(seed), [kind])
                case = tomllib.loads(toml_text(scene.case))
                names = [phase["name"] for phase in case["phase"]]
                densities = [phase["density"] for phase in case["phase"]]
                self.assertTrue(all(region["phase"] in names for region in case["region"]))
                self.assertLessEqual(max(densities) / min(densities), 1.0001e4)
                self.assertGreater(case["time"]["end"], 0)

    def test_still_water_covers_the_floor_of_its_tank_by_either_method(self):
        for kind in ("les-sph", "wcsph"):
            for seed in range(6):
                scene = SCENES["still"](np.random.default_rng(seed), [kind], {"end": 20.0})
                case = tomllib.loads(toml_text(scene.case))
                water = case["region" if kind == "wcsph" else "liquid"][0]
                self.assertEqual((case["method"], water["upper"][:-1]), (kind, case["domain"]["upper"][:-1]))
                self.assertAlmostEqual(case["time"]["end"], 20 * 1.1**0.5)
                self.assertIn(len(case["body"]), (1, 2))

    def test_fixed_values_hold(self):
        scene = SCENES["les-sph"](np.random.default_rng(1), ["vortices"], {"courant": 0.3, "mach": 0.1}, True)
        self.assertEqual((scene.case["time"]["courant"], scene.case["fluid"]["mach"]), (0.3, 0.1))
        self.assertNotIn("turbulence", scene.case)

    def test_cases_of_the_parts_and_faults_are_toml(self):
        for pair in parts.parts().values():
            for case in pair:
                tomllib.loads(toml_text(case))
        for text in BASE.values():
            tomllib.loads(text)


class Checks(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        case = {"method": "les-sph", "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0], "bottom": "no-slip", "x": "periodic"},
                "resolution": {"spacing": 0.1}, "fluid": {"froude": 1.0}, "liquid": [{}], "time": {"end": 1.0}}
        self.scene = Scene("pool", case, {}, free_axes=[0])

    def outcome(self, code=0, said="", timed_out=False, last=None, ids=None, method="les-sph", **columns):
        t = np.linspace(0, 1, 11)
        values = {"kinetic_energy": 0.1 - 0.05 * t, "potential_energy": 0.2 + 0 * t, "max_speed": 1.0 + 0 * t, "mass": 1.0 + 0 * t,
                  "momentum_x": 0.3 + 0 * t, "momentum_y": 0 * t,
                  "pressure_residual": 1e-7 + 0 * t, "pressure_tolerance": 2e-7 + 0 * t} | columns
        values["total_energy"] = values["kinetic_energy"] + values["potential_energy"]
        (self.folder / "case.toml").write_text(toml_text(self.scene.case))
        (self.folder / "summary.json").write_text('{"retries": 0}')
        write_table(self.folder / "series.csv", series_of(t, **values))
        grid = lattice([0, 0], [1, 0.5], 0.1)
        where = lambda time: grid if time == 0 or last is None else last(grid.copy())
        write_snapshots(self.folder / "fluid.vtkhdf", [0, 1], where,
                        {"velocity": lambda p, time: p,
                         "id": lambda p, time: (ids(len(p)) if ids and time else np.arange(len(p))).astype(float)})
        return judge(method, self.scene, self.folder, code, said, timed_out)[:2]

    def complaint(self, **changes):
        outcome, complaints = self.outcome(**changes)
        self.assertEqual(outcome, "failed", complaints)
        return complaints[0].split(":")[0]

    def test_a_quiet_run_passes(self):
        self.assertEqual(self.outcome(), ("ok", []))
        self.assertEqual(self.outcome(code=130, timed_out=True)[0], "slow")

    def test_what_is_wrong_is_named(self):
        t = np.linspace(0, 1, 11)
        self.assertEqual(self.complaint(kinetic_energy=0.1 + 0.05 * t), "energy")
        self.assertEqual(self.complaint(momentum_x=0.3 + 0.1 * t), "momentum")
        self.assertEqual(self.complaint(mass=1 + 1e-9 * t), "mass")
        self.assertEqual(self.complaint(pressure_residual=1e-7 + 1e-3 * (t == 0)), "convergence")
        self.assertEqual(self.complaint(pressure_tolerance=2e-7 + 0.02 * (t == 1)), "convergence")
        self.assertEqual(self.complaint(max_speed=np.where(t == 1, np.nan, 1)), "finite")

    def test_water_that_does_not_stay_still_is_named(self):
        t = np.linspace(0, 1, 11)
        self.assertEqual(self.outcome(method="still", max_speed=9e-4 + 0 * t), ("ok", []))
        outcome, complaints = self.outcome(method="still", max_speed=np.where(t < 0.45, 0, 0.2))
        self.assertEqual((outcome, complaints), ("failed", ["rest: 0.2 sqrt(gH), above 0.001 from t = 0.5 on"]))

    def test_energy_that_coupled_particles_cannot_have_supplied_is_seen(self):
        particles = {"count": 1000, "diameter": 0.1, "beta": 3.0, "coupling": "two-way"}
        case = {"method": "spectral", "domain": {"lower": [0.0] * 3, "upper": [2 * np.pi] * 3}, "particles": particles,
                "spectral": {"dealiasing": "padded"}, "time": {"end": 1.0, "courant": 0.4}}
        self.scene = Scene("bubbles", case, {}, conservative=False, loaded=True)
        (self.folder / "case.toml").write_text(toml_text(case))
        (self.folder / "summary.json").write_text('{"retries": 0}')
        places = np.random.default_rng(1).uniform(0, 6, (1000, 3))
        write_snapshots(self.folder / "bubbles.vtkhdf", [0, 1], lambda time: places,
                        {"id": lambda p, time: np.arange(len(p)).astype(float)})
        t = np.linspace(0, 1, 11)

        def judged(**columns):
            values = {"max_speed": 1.0 + 0 * t, "mean_energy": 0.3 + 0 * t, "mean_dissipation": 0.1 + 0 * t, "mean_injection": 0.1 + 0 * t,
                      "balance_residual": 1e-3 + 0 * t} | columns
            write_table(self.folder / "series.csv", series_of(t, **values))
            return judge("spectral", self.scene, self.folder, 0, "", False)[:2]

        self.assertEqual(judged(), ("ok", []))
        self.assertEqual(judged(mean_energy=0.3 + 0.1 * t), ("ok", []))
        self.assertEqual(judged(mean_energy=0.3 * np.exp(16 * t))[0], "failed")
        self.assertEqual(judged(balance_residual=0.3 + 0 * t)[0], "failed")

    def test_lost_and_escaped_particles_are_seen(self):
        def below(grid):
            grid[0, 1] = -0.01
            return grid

        self.assertEqual(self.complaint(last=below), "particles")
        self.assertEqual(self.complaint(last=lambda grid: grid[1:]), "particles")
        self.assertEqual(self.complaint(ids=lambda n: np.arange(n) + 1), "particles")

    def test_exit_codes(self):
        self.assertEqual(self.outcome(code=-11)[0], "crashed")
        self.assertEqual(self.outcome(code=134)[0], "crashed")
        self.assertEqual(self.outcome(code=2, said="case.toml:1:1: error: too thin")[0], "refused")
        self.assertEqual(self.outcome(code=2, said="")[0], "failed")
        self.assertEqual(self.outcome(code=3, said="error: numerical failure at step 3, t = 0.1: too fast")[0], "stopped")
        self.assertEqual(self.outcome(code=3, said="oh")[0], "failed")
        self.assertEqual(self.outcome(code=130)[0], "failed")

    def test_a_run_that_says_that_it_makes_energy_has_stopped(self):
        t = np.linspace(0, 1, 11)
        self.assertEqual(self.outcome(code=3, said="error: at step 3, t = 0.1: energy", kinetic_energy=0.1 + t)[0], "stopped")


class PhaseChecks(unittest.TestCase):
    """Of runs of wcsph: two phases of densities 10 and 1, half of the box each."""

    def outcome(self, scene_changes=None, facts=None, log="", **columns):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        folder = Path(scratch.name)
        case = {"method": "wcsph", "domain": {"lower": [0.0, 0.0], "upper": [1.0, 1.0], "x": "periodic", "y": "periodic"},
                "resolution": {"spacing": 0.1}, "phase": [{"name": "water", "density": 10.0}, {"name": "air", "density": 1.0}],
                "time": {"end": 1.0}} | (scene_changes or {})
        t, still = np.linspace(0, 1, 11), np.zeros(11)
        values = {"kinetic_energy": 0.1 - 0.05 * t, "compression_energy": 0.01 + still, "max_speed": 1 + still} | {
            f"velocity_{name}_{axis}": still for name in ("water", "air") for axis in "xy"} | columns
        (folder / "case.toml").write_text(toml_text(case))
        (folder / "summary.json").write_text('{"retries": 0}')
        (folder / "log.txt").write_text(log)
        write_table(folder / "series.csv", series_of(t, **values))
        grid = lattice([0, 0], [1, 1], 0.1)
        grid[0, 0] = -0.015  # within half a skin of a periodic side
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda time: grid, {
            "phase": lambda p, time: p[:, 1] > 0.5, "id": lambda p, time: np.arange(len(p)).astype(float)})
        return judge("wcsph", Scene("stripes", case, {}, **({"free_axes": [0, 1]} | (facts or {}))), folder, 0, "", False)[:2]

    def test_a_quiet_run_passes_and_what_is_wrong_is_named(self):
        t = np.linspace(0, 1, 11)
        self.assertEqual(self.outcome(), ("ok", []))
        # What the air gains the water loses, by its mass.
        exchanged = {"velocity_air_x": 0.1 * t, "velocity_water_x": -0.01 * t}
        self.assertEqual(self.outcome(**exchanged), ("ok", []))
        self.assertRegex(self.outcome(velocity_air_x=0.1 * t)[1][0], "momentum")
        growing = {"compression_energy": 0.01 + 0.2 * t}
        self.assertRegex(self.outcome(**growing)[1][0], "energy")
        self.assertEqual(self.outcome(log="the density of water has changed by 4 %", **growing), ("ok", []))
        self.assertRegex(self.outcome(max_speed=np.where(t == 1, np.nan, 1))[1][0], "finite")
        self.assertRegex(self.outcome({"lists": {"skin": 0.1}})[1][0], "beyond the left side")

    def test_the_first_row_of_a_scene_with_tension_knows_no_surface_energy(self):
        t = np.linspace(0, 1, 11)
        surface = np.where(t == 0, 0, 1.0)
        tension = {"interface": {"surface_tension": 1.0}}
        self.assertEqual(self.outcome(tension, surface_energy=surface), ("ok", []))
        self.assertRegex(self.outcome(tension, surface_energy=surface + t)[1][0], "energy")


class Faults(unittest.TestCase):
    def test_damage_damages(self):
        data = bytes(range(256)) * 20
        draw = random.Random(1)
        self.assertGreater(sum(damage(draw, data) != data for _ in range(200)), 190)
        self.assertGreater(len({mutated_case(draw, BASE["les-sph"]) for _ in range(50)}), 45)


class LongRuns(unittest.TestCase):
    def series(self, **columns):
        rows = 400
        rng = np.random.default_rng(3)
        return {"step": np.arange(rows) * 250.0, "t": np.arange(rows) / 10, "mass": np.ones(rows), "max_speed": np.ones(rows),
                "kinetic_energy": 1 + 0.01 * rng.standard_normal(rows)} | columns

    def test_scenes_are_cases(self):
        for make, step in long.SCENES.values():
            self.assertIn("method", tomllib.loads(toml_text(make(step))))

    def test_steady_series_pass_and_drifting_ones_do_not(self):
        steady = self.series()
        self.assertEqual(long.check_series("sustained_flow", steady), [])
        growing = steady["kinetic_energy"] + np.linspace(0, 0.05, 400)
        self.assertRegex(long.check_series("sustained_flow", steady | {"kinetic_energy": growing})[0], "energy")
        losing = 1 - 1e-9 * np.arange(400)
        self.assertRegex(long.check_series("sustained_flow", steady | {"mass": losing})[0], "mass")
        self.assertRegex(long.check_series("pool", steady)[0], "rest")
        fast = self.series(max_speed=0.02 - 0.01 * np.linspace(0, 1, 400))
        self.assertEqual(long.check_series("layers", fast), [])
        self.assertRegex(long.check_series("layers", fast | {"max_speed": fast["max_speed"][::-1]})[0], "rest")

    def test_growing_memory_and_slowing_steps_are_seen(self):
        step = np.linspace(0, 1e5, 200)
        steady = np.column_stack([step, np.full(200, 5e7), 1e-3 * step])
        self.assertEqual(long.check_usage(steady, 1e5)[0], [])
        self.assertRegex(long.check_usage(steady + [0, 1, 0] * (1e5 * np.arange(200))[:, None], 1e5)[0][0], "memory")
        slower = np.column_stack([step, steady[:, 1], 1e-8 * step**2])
        self.assertRegex(long.check_usage(slower, 1e5)[0][0], "speed")


# Says that every second run blew up in words, and crashes on one.
PROGRAM = """\
    #!{python}
    import os, sys
    number = int(os.path.basename(os.path.dirname(sys.argv[2])).split("-")[1])
    if number == 2:
        os.abort()
    print("error: numerical failure at step 1, t = 0: too fast" if number % 2 else "case.toml:1:1: error: no", file=sys.stderr)
    sys.exit(2)
"""


class Command(unittest.TestCase):
    def test_keeps_the_case_of_a_crash_and_writes_table_and_picture(self):
        with tempfile.TemporaryDirectory() as scratch:
            program = Path(scratch) / "program"
            program.write_text(textwrap.dedent(PROGRAM).format(python=sys.executable))
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            out = Path(scratch) / "out"
            done = subprocess.run(paths.module("stress", program, "les-sph", "--runs", 4, "--out", out), capture_output=True, text=True)
            self.assertEqual(done.returncode, 1, done.stderr)
            with (out / "stress.csv").open() as file:
                self.assertEqual([row["outcome"] for row in csv.DictReader(file)], ["refused", "refused", "crashed", "refused"])
            self.assertTrue((out / "failures" / "run-2" / "case.toml").is_file())
            self.assertTrue((out / "stress.png").read_bytes().startswith(b"\x89PNG"))


if __name__ == "__main__":
    unittest.main()
