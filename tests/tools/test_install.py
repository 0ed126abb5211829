# SPDX-License-Identifier: MIT
"""The installed program works without the sources, and its completions name what it has. Needs build/release/spume."""
import os
import subprocess
import tempfile
import unittest
import urllib.request
from pathlib import Path

import paths
from spume_tools.completion import REPEATED
from spume_tools.results import read_case

BUILD = paths.ROOT / "build" / "release"


class Installation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not (BUILD / "spume").is_file():
            raise AssertionError(f"{BUILD / 'spume'} is not there; build it with tools/build release spume")
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.prefix, cls.work = Path(scratch.name) / "prefix", Path(scratch.name) / "work"
        cls.work.mkdir()
        subprocess.run(["cmake", "--install", BUILD, "--prefix", cls.prefix], check=True, capture_output=True, text=True)
        cls.share = cls.prefix / "share" / "spume"

    def spume(self, *arguments, code=0):
        """What the installed program says, in a folder that knows nothing of the sources; nothing of it is read there."""
        environment = {key: value for key, value in os.environ.items() if key not in ("SPUME_HOME", "PYTHONPATH")}
        # Python then says on its error output which files it imports.
        done = subprocess.run([self.prefix / "bin" / "spume", *map(str, arguments)], cwd=self.work, text=True,
                              capture_output=True, env=environment | {"PYTHONVERBOSE": "1"})
        self.assertEqual(done.returncode, code, done.stdout + done.stderr[-2000:])
        self.assertNotIn(str(paths.ROOT) + "/", done.stdout + done.stderr)
        return done


class Program(Installation):
    def test_runs_and_checks_a_case_by_name_and_draws_it(self):
        coarse = ("--set", "resolution.spacing=0.025")
        self.assertIn(str(self.share / "cases" / "breaking_wave" / "case.toml"), self.spume("check", "breaking_wave", *coarse).stdout)
        self.spume("run", "breaking_wave", "--quiet", "--until", "0.02", "-o", "wave", *coarse)
        drawn = self.spume("plot", "wave").stdout.splitlines()
        self.assertIn("wave/plots/energy.png", drawn)
        self.assertTrue(all((self.work / file).is_file() for file in drawn))

    def test_verifies_a_case_by_name(self):
        self.assertIn("every bound holds", self.spume("verify", "couette_poiseuille", "--quick").stdout)
        self.assertIn("the cases are aerated_tank, beltrami,", self.spume("verify", "no_such_case", code=2).stderr)

    def test_its_package_reads_the_results(self):
        self.spume("run", "taylor_green_2d", "--quiet", "--until", "0.01", "--set", "resolution.spacing=0.1", "-o", "vortices")
        read = subprocess.run(["/usr/bin/python3", "-P", "-c", "from spume_tools import results\n"
                               "print(results.Results('vortices').spacing, results.__file__)"], cwd=self.work, check=True, text=True,
                              capture_output=True, env=os.environ | {"PYTHONPATH": str(self.share / "tools")})
        self.assertEqual(read.stdout.split(), ["0.1", str(self.share / "tools" / "spume_tools" / "results" / "__init__.py")])

    def test_shows_results_in_a_browser(self):
        self.spume("run", "taylor_green_2d", "--quiet", "--until", "0.01", "--set", "resolution.spacing=0.1", "-o", "seen")
        with subprocess.Popen([self.prefix / "bin" / "spume", "view", "seen"], cwd=self.work, stdout=subprocess.PIPE, text=True) as program:
            address = program.stdout.readline().split()[-1]
            with urllib.request.urlopen(address) as page:
                self.assertIn(b"<!doctype html>", page.read())
            program.terminate()
            self.assertEqual(program.wait(), 0)

    def test_scales_of_bubbles_are_those_of_the_case(self):
        self.spume("run", "surface_approach", "--quiet", "--until", "0.001", "-o", "approach")
        read = subprocess.run(["/usr/bin/python3", "-P", "-c", "from spume_tools.results import *\n"
                               "run = Results('approach')\nprint(hinze_radius(run), surface_tension(run))"], cwd=self.work, check=True,
                              text=True, capture_output=True, env=os.environ | {"PYTHONPATH": str(self.share / "tools")})
        hinze, tension = map(float, read.stdout.split())
        weber = read_case(self.share / "cases" / "surface_approach" / "case.toml")["bubbles"]["weber"]
        self.assertAlmostEqual(tension, 1 / weber, delta=1e-15 / weber)
        self.assertAlmostEqual(hinze, 0.5 * weber**-0.6, delta=1e-15)

    def test_licence_and_nothing_that_needs_the_sources(self):
        self.assertTrue((self.prefix / "share" / "doc" / "spume" / "LICENSE").is_file())
        package = self.share / "tools" / "spume_tools"
        self.assertFalse((package / "bench").exists() or (package / "lint").exists())


class Completion(Installation):
    def completed(self, *words):
        """What bash offers for the last of these words."""
        script = self.prefix / "share" / "bash-completion" / "completions" / "spume"
        typed = " ".join(f"'{word}'" for word in words)
        done = subprocess.run(["bash", "-c", f"compopt() {{ :; }}; source {script}; COMP_WORDS=({typed}); COMP_CWORD={len(words) - 1}; "
                               '_spume; printf "%s\\n" "${COMPREPLY[@]}"'], cwd=self.work, capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def test_bash_completes_verbs_flags_cases_sections_and_keys(self):
        self.assertEqual(self.completed("spume", "ver"), ["verify"])
        self.assertEqual(self.completed("spume", "run", "--th"), ["--threads"])
        self.assertEqual(self.completed("spume", "verify", "breaking_wave_s"), ["breaking_wave_steepness"])
        self.assertEqual(self.completed("spume", "options", "turb"), ["turbulence"])
        self.assertEqual(self.completed("spume", "check", "x", "--set", "fluid.rey"), ["fluid.reynolds="])
        self.assertEqual(self.completed("spume", "run", "--set", "bubble_cloud.0.numb"), ["bubble_cloud.0.number="])
        (self.work / "results-1").mkdir(exist_ok=True)
        self.assertEqual(self.completed("spume", "plot", "resu"), ["results-1"])
        self.assertEqual(self.completed("spume", "run", "--until", ""), [])

    def test_every_shell_knows_every_verb_and_flag(self):
        share = self.prefix / "share"
        zsh, fish = share / "zsh" / "site-functions" / "_spume", share / "fish" / "vendor_completions.d" / "spume.fish"
        for verb in ("run", "check", "resume", "info", "verify", "plot", "compare", "options"):
            self.assertIn(f"    {verb}) _arguments", zsh.read_text())
            self.assertIn(f"-a {verb} -d", fish.read_text())
            for flag in self.completed("spume", verb, "--"):
                self.assertIn(f"'{'*' if flag == '--set' else ''}{flag}[", zsh.read_text())
                self.assertRegex(fish.read_text(), rf"seen_subcommand_from {verb}'.* -l {flag[2:]} ")

    def test_repeated_sections_are_those_of_the_cases(self):
        found = {name for file in (self.share / "cases").glob("*/case.toml") for name, value in read_case(file).items()
                 if isinstance(value, list)}
        self.assertLessEqual(found, set(REPEATED))
        self.assertLessEqual(set(REPEATED), set(self.completed("spume", "options", "")))


if __name__ == "__main__":
    unittest.main()
