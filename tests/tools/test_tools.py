# SPDX-License-Identifier: MIT
"""Pictures, verification and convergence as commands, with a stand-in for the program."""
import json
import stat
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path
from unittest import mock

import paths
import numpy as np
from spume_tools.plots import probes, series
from spume_tools.results import Results
from synthetic import lattice, new_folder, series_of, write_case, write_snapshots, write_table

PNG = b"\x89PNG\r\n\x1a\n"


def call(module, *arguments):
    return subprocess.run(paths.module(module, *arguments), capture_output=True, text=True)


class Scratch(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.path = Path(self.scratch.name)


class Plotting(Scratch):
    def pictures(self, folder):
        done = call("plots", folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        files = [Path(line) for line in done.stdout.splitlines()]
        for file in files:
            self.assertTrue(file.read_bytes().startswith(PNG), file)
        return {file.name for file in files}, done.stderr

    def test_two_dimensional_run_with_everything(self):
        folder = new_folder(self.path, "run")
        write_case(folder, "Taylor-Green vortices in two dimensions", [0, 0], [1, 1], 0.1, x="periodic", y="periodic")
        with (folder / "case.toml").open("a") as file:
            file.write("[fluid]\nreynolds = 100\n")
        t = np.linspace(0, 1, 50)
        write_table(folder / "series.csv", series_of(t, kinetic_energy=np.exp(-t), dissipation=np.exp(-t), mass=1,
                                                     pressure_iterations=7, max_speed=1), {"t": "s"})
        grid = lattice([0, 0], [1, 1], 0.1)
        write_snapshots(folder / "fluid.vtkhdf", [0, 0.5, 1], lambda t: grid,
                        {"velocity": lambda p, t: p, "pressure": lambda p, t: p[:, 0], "id": lambda p, t: p[:, 0]})
        write_table(folder / "probes.csv", {"t": t, "A_pressure": t, "A_velocity_x": t, "front": t})
        write_table(folder / "lines.csv", {"t": [0.0] * 3, "name": ["centre"] * 3, "s": [0, 1, 2], "x": [0, 1, 2],
                                           "velocity_x": [1, 2, 3], "pressure": [1, 2, 3]})
        write_table(folder / "spectrum.csv", {"t": np.repeat([0.0, 1.0], 9), "wavenumber": np.tile(np.arange(9), 2),
                                              "energy": np.tile(np.arange(9.0, 0, -1), 2)})
        names, complaints = self.pictures(folder)
        self.assertEqual(names, {"energy.png", "numerics.png", "speed.png", "pressure.png", "spectrum.png", "probes.png",
                                 "line_centre.png", "kinetic_energy_exact.png"})
        self.assertEqual(complaints, "")

    def test_the_power_of_ten_of_an_energy_is_beside_the_names_of_its_curves(self):
        folder = new_folder(self.path, "run")
        write_case(folder, "Much energy", [0, 0], [1, 1], 0.1)
        write_table(folder / "series.csv", series_of([0, 1.0], kinetic_energy=[0, 2e6], potential_energy=[1e6, -2e6]))
        with mock.patch.object(series, "finish", side_effect=lambda figure, *_: figure):
            figure, = series.plot_energy(Results(folder), folder)
        figure.tight_layout()
        figure.canvas.draw()
        left = figure.axes[0]
        power = left.yaxis.get_offset_text()
        self.assertEqual(power.get_text(), "1e6")
        self.assertFalse(left.get_legend().get_window_extent().overlaps(power.get_window_extent()))

    def test_areas_of_planes_are_no_elevations(self):
        folder = new_folder(self.path, "run")
        t = np.linspace(0, 1, 5)
        write_table(folder / "probes.csv", {"t": t, "gate_area": t, "gate_pressure": t, "gate_velocity_x": t, "front": t})
        with mock.patch.object(probes, "finish", side_effect=lambda figure, *_: figure):
            figure, = probes.plot_probes(Results(folder), folder)
        drawn = {axis.get_ylabel(): [line.get_label() for line in axis.get_lines()] for axis in figure.axes}
        self.assertEqual(drawn, {"area": ["gate"], "pressure": ["gate"], "velocity x": ["gate"],
                                 "elevation, wetted length, front": ["front"]})

    def test_quantities_of_probes_are_told_by_the_names_of_the_case(self):
        columns = {name: np.ones(2) for name in ("t", "gate", "gate_west_temperature", "gate_west_velocity_x", "gate_pressure")}
        self.assertEqual(probes.quantities_of(columns, ["gate", "gate_west"]),
                         {"elevation, wetted length, front": [("gate", "gate")], "temperature": [("gate_west", "gate_west_temperature")],
                          "velocity x": [("gate_west", "gate_west_velocity_x")], "pressure": [("gate", "gate_pressure")]})

    def test_shares_of_the_stages_are_drawn(self):
        folder = new_folder(self.path, "run")
        write_table(folder / "series.csv", series_of([0, 1.0], kinetic_energy=1))
        stage = {"stage": "move", "calls": 3, "seconds": 1.5, "share": 0.75, "particles": 3e3, "pairs": 0, "bytes": 0}
        (folder / "ledger.json").write_text(json.dumps({"wall_seconds": 2.0, "stages": [stage, stage | {"stage": "pressure", "pairs": 9e4}]}))
        self.assertEqual(self.pictures(folder)[0], {"energy.png", "numerics.png", "ledger.png"})

    def test_three_dimensional_run_with_a_surface_is_shaded(self):
        folder = new_folder(self.path, "run")
        write_case(folder, "Some wave", [0, 0, -0.5], [1, 0.2, 0.5], 0.05, x="periodic", y="periodic", top="open")
        write_table(folder / "series.csv", series_of([0, 1.0], kinetic_energy=1, potential_energy=[1, 2],
                                                     surface_particles=10))
        grid = lattice([0, 0, -0.5], [1, 0.2, 0], 0.05)
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: grid, {"velocity": lambda p, t: p})
        names, _ = self.pictures(folder)
        self.assertEqual(names, {"energy.png", "numerics.png", "speed.png", "side_view.png"})

    def test_series_alone_is_enough_and_the_rest_is_said(self):
        folder = new_folder(self.path, "run")
        write_table(folder / "series.csv", series_of([0, 1.0], kinetic_energy=1))
        names, complaints = self.pictures(folder)
        self.assertEqual(names, {"energy.png", "numerics.png"})
        self.assertRegex(complaints, r"(?m)^slices left out: .*fluid.vtkhdf: not there; ")
        self.assertRegex(complaints, r"(?m)^side view, .* left out: .*case.toml: cannot be read ")

    def test_what_the_case_did_not_ask_for_is_not_missed(self):
        folder = self.wave_run()
        self.assertEqual(self.pictures(folder)[1], "")
        with (folder / "case.toml").open("a") as file:
            file.write('[output]\nspectrum_every = 0.5\n[[probe]]\nname = "a"\nkind = "line"\n[[probe]]\nname = "b"\n')
        complaints = self.pictures(folder)[1]
        for name in ("spectra", "lines", "probes"):
            self.assertRegex(complaints, f"(?m)^{name} left out: ")

    def wave_run(self, title="Some wave"):
        folder = new_folder(self.path, "run")
        write_case(folder, title, [0, 0], [1, 1], 0.1, top="open")
        write_table(folder / "series.csv", series_of([0, 1.0], kinetic_energy=1))
        write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: lattice([0, 0], [1, 1], 0.1), {"velocity": lambda p, t: p})
        return folder

    def test_a_damaged_file_is_an_error_and_the_rest_is_drawn(self):
        folder = self.wave_run()
        whole = (folder / "fluid.vtkhdf").read_bytes()
        (folder / "fluid.vtkhdf").write_bytes(whole[: len(whole) // 2])
        done = call("plots", folder)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, r"\Aerror: slices left out: .*fluid.vtkhdf: not a VTKHDF file.*\n\Z")
        self.assertEqual({Path(line).name for line in done.stdout.splitlines()}, {"energy.png", "numerics.png"})

    def test_a_folder_that_is_no_run_is_one_error_and_stays_as_it_is(self):
        empty, case = new_folder(self.path, "empty"), new_folder(self.path, "case")
        write_case(case, "Some wave", [0, 0], [1, 1], 0.1)
        for folder in (empty, case, self.path / "nowhere"):
            done = call("plots", folder)
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, r"\Aerror: .*; give the folder that 'spume run' made\n\Z")
            self.assertFalse((folder / "plots").exists())

    def test_runs_that_verify_kept_are_compared(self):
        for name in ("standard", "a_05"):
            folder = self.path / "kept" / name
            folder.mkdir(parents=True)
            (folder / "case.toml").write_text((paths.ROOT / "cases" / "bubble_insertion" / "case.toml").read_text())
            norm = np.exp(-np.arange(21.0))
            write_table(folder / "series.csv", series_of(np.linspace(0, 0.02, 21), shift_norm=norm, max_speed=0 * norm))
        names, _ = self.pictures(self.path / "kept")
        self.assertEqual(names, {"shift_norm.png"})

    def test_nothing_to_draw_is_an_error(self):
        folder = new_folder(self.path, "run")
        (folder / "log.txt").touch()
        done = call("plots", folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("nothing to draw", done.stderr)
        self.assertFalse((folder / "plots").exists())

    def test_reference_is_that_of_the_case_that_was_run(self):
        case = new_folder(self.path, "mine")
        (case / "measure.py").write_text(
            "def curves(runs):\n"
            '    return [{"file": "mine", "x": "x", "y": "y", "curves": [("reference", [0, 1], [0, 1], "o")]}]\n')
        # The title is that of another case, which would draw its own.
        folder = self.wave_run("Taylor-Green vortices in two dimensions")
        for path in (case / "case.toml", "mine/case.toml"):
            (folder / "summary.json").write_text(json.dumps({"case": str(path)}))
            names, complaints = self.pictures(folder)
            self.assertEqual((names, complaints), ({"energy.png", "numerics.png", "speed.png", "mine.png"}, ""))
        (case / "measure.py").write_text("def curves(runs):\n    return runs['other']\n")
        done = call("plots", folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("error: reference left out: ", done.stderr)
        self.assertIn("mine/measure.py:2: curves failed (KeyError: 'other')", done.stderr)


# Answers `run CASE -o DIR ...` with a series that holds the exact Taylor-Green decay times a factor, or fails.
PROGRAM = """\
    #!{python}
    import sys
    sys.path[:0] = [{here!r}]
    from pathlib import Path
    import numpy as np
    from synthetic import *
    arguments = sys.argv[1:]
    settings = [arguments[i + 1] for i, a in enumerate(arguments) if a == "--set"]
    spacing = next((float(s.split("=")[1]) for s in settings if s.startswith("resolution.spacing")), 0.01)
    if {fail}:
        print("step 7: speed is not finite", file=sys.stderr)
        sys.exit(3)
    assert arguments[0] == "run" and "--quiet" in arguments
    folder = Path(arguments[arguments.index("-o") + 1])
    folder.mkdir()
    (folder / "case.toml").write_text(Path(arguments[1]).read_text().replace("spacing = 0.01", f"spacing = {{spacing}}"))
    t = np.linspace(0, 1, 101)
    factor = 1 + {error} * (spacing / 0.01) ** 2
    write_table(folder / "series.csv", series_of(t, kinetic_energy=0.25 * np.exp(-0.16 * np.pi**2 * t * factor)))
    grid = lattice([0, 0], [1, 1], 0.05)
    x, y = 2 * np.pi * grid.T
    u = np.exp(-0.08 * np.pi**2) * np.column_stack([-np.cos(x) * np.sin(y), np.sin(x) * np.cos(y)])
    write_snapshots(folder / "fluid.vtkhdf", [0, 1], lambda t: grid, {{"velocity": lambda p, t: factor * u}})
"""


class Verifying(Scratch):
    def program(self, error=0.001, fail=False):
        path = self.path / "program"
        path.write_text(textwrap.dedent(PROGRAM).format(python=sys.executable, here=str(Path(__file__).parent),
                                                        error=error, fail=fail))
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return path

    def test_passes_and_keeps_runs_plots_and_figures(self):
        done = call("verify", self.program(), "taylor_green_2d", "--keep", self.path / "kept", "--threads", 2)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("every bound holds", done.stdout)
        report = json.loads((self.path / "kept" / "verify.json").read_text())["taylor_green_2d"]
        values = {row["quantity"]: row["measured"] for row in report}
        self.assertAlmostEqual(values["decay_rate_error"], 0.001, places=9)
        self.assertAlmostEqual(values["observed_order"], 2, places=2)
        self.assertTrue((self.path / "kept" / "taylor_green_2d" / "plots" / "kinetic_energy_exact.png").is_file())
        again = call("verify", self.program(), "taylor_green_2d", "--keep", self.path / "kept")
        self.assertEqual(again.returncode, 2)
        self.assertIn("nothing is overwritten", again.stderr)

    def test_bound_exceeded_is_exit_code_1(self):
        done = call("verify", self.program(error=0.02), "taylor_green_2d")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, r"decay_rate_error +0\.02 +<= 0\.01 +FAIL")

    def test_quick_runs_the_short_form(self):
        done = call("verify", self.program(), "taylor_green_2d", "--quick", "--keep", self.path / "kept")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        runs = {p.name for p in (self.path / "kept" / "taylor_green_2d").iterdir()} - {"plots"}
        self.assertEqual(runs, {"coarse"})

    def test_failing_program_is_exit_code_1_with_its_words(self):
        done = call("verify", self.program(fail=True), "taylor_green_2d")
        self.assertEqual(done.returncode, 1)
        self.assertIn("exit code 3", done.stderr)
        self.assertIn("step 7: speed is not finite", done.stderr)

    def test_bad_requests_are_exit_code_2(self):
        self.assertEqual(call("verify", self.program(), "no_such_case").returncode, 2)
        self.assertEqual(call("verify", self.path / "missing", "beltrami").returncode, 2)

    def test_convergence_of_a_case_without_errors_is_a_bad_request(self):
        done = call("verify.convergence", self.program(), "clustering", 0.04)
        self.assertEqual((done.returncode, "defines no errors(run)" in done.stderr), (2, True), done.stderr)

    def test_convergence_table_shows_the_order(self):
        done = call("verify.convergence", self.program(), "taylor_green_2d", 0.04, 0.02, 0.01, "--keep", self.path / "kept")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"observed order +2\.00 +2\.00")
        self.assertTrue((self.path / "kept" / "error_against_time.png").is_file())


if __name__ == "__main__":
    unittest.main()
