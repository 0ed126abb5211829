# SPDX-License-Identifier: MIT
"""spume verify finds out before the first run what it could not check, and leaves nothing behind when it is stopped."""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
from pathlib import Path

import paths
from spume_tools.results import DamagedResult, read_reference
from spume_tools.places import CASES
from spume_tools.verify.cases import load_measure
from spume_tools.verify.table import VerifyTable, fault_of_bound



class Scratch(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.path = Path(self.scratch.name)

    def script(self, text):
        program = self.path / "program"
        program.write_text(f"#!{sys.executable}\n{text}")
        program.chmod(0o755)
        return program

    def case(self, name="dam_break_2d", old="", new=""):
        """A copy of a case with a piece of its file replaced."""
        folder = self.path / f"my_{name}"
        shutil.copytree(CASES / name, folder, ignore=shutil.ignore_patterns("__pycache__", "*.png"))
        text = (folder / "case.toml").read_text()
        self.assertIn(old, text)
        (folder / "case.toml").write_text(text.replace(old, new, 1) if old else text + new)
        return folder


class Requests(Scratch):
    def refused(self, *arguments):
        """The complaint of verify, which must end with exit code 2 and without a run."""
        program = self.script(f"import pathlib, sys\npathlib.Path({str(self.path / 'ran')!r}).touch()\nsys.exit(3)\n")
        done = subprocess.run(paths.module("verify", program, *arguments), capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertFalse((self.path / "ran").exists(), "a run was made")
        self.assertNotIn("Traceback", done.stderr)
        self.assertTrue(all(line.startswith("error: ") for line in done.stderr.splitlines()), done.stderr)
        return done.stderr

    def line_of(self, folder, text, file="case.toml"):
        return 1 + (folder / file).read_text().splitlines().index(text)

    def test_misspelt_bounds_are_refused_with_the_word_that_was_meant(self):
        folder = self.case(old="[verify.quick.bounds]", new="[verify.quick.bonds]")
        line = self.line_of(folder, "[verify.quick.bonds]")
        for arguments in ((folder, "--quick"), (folder,)):
            said = self.refused(*arguments)
            self.assertIn(f"case.toml:{line}: unknown key 'bonds' in [verify.quick]", said)
            self.assertIn("did you mean 'bounds'?", said)
        self.assertIn("[verify.quick] holds no bound", self.refused(folder, "--quick"))

    def test_a_case_without_any_bound_is_refused(self):
        folder = self.case(old="front_error_potential_flow = 0.075\nmass_drift = 1e-12", new="")
        self.assertIn("[verify.quick] holds no bound, so nothing would be checked", self.refused(folder, "--quick"))

    def test_a_named_case_without_a_short_form_is_refused(self):
        self.assertIn("lid_driven_cavity/case.toml: no [verify.quick] table",
                      self.refused("lid_driven_cavity", "taylor_green_2d", "--quick"))

    def test_a_bound_that_is_no_number_is_refused(self):
        folder = self.case(old="front_error = 0.05", new='front_error = "0.05"')
        line = self.line_of(folder, 'front_error = "0.05"')
        self.assertIn(f"case.toml:{line}: front_error = '0.05': not a bound; expected a number", self.refused(folder))

    def test_a_run_without_a_name_is_refused(self):
        folder = self.case(old='name = "coarse"\n', new="")
        line = self.line_of(folder, "[[verify.quick.run]]")
        self.assertIn(f"case.toml:{line}: run 1 of [[verify.quick.run]] has no name", self.refused(folder, "--quick"))

    def test_a_case_without_measures_is_refused(self):
        folder = self.case()
        (folder / "measure.py").write_text("def mesure(runs):\n    return {}\n")
        self.assertIn("measure.py: defines no measure(runs)", self.refused(folder))
        (folder / "measure.py").write_text("x = 1\nif x:\n    y = numpy.nan\n")
        self.assertIn("measure.py:3: cannot be loaded (NameError: name 'numpy' is not defined)", self.refused(folder))
        (folder / "measure.py").write_text("x = 1\ndef measure(runs:\n")
        self.assertIn("measure.py:2: cannot be loaded (SyntaxError", self.refused(folder))
        (folder / "measure.py").unlink()
        self.assertIn("measure.py: not there", self.refused(folder))

    def test_all_faults_of_all_cases_are_said_at_once(self):
        first, second = self.case(new="\n[verify.quik]\n"), self.case("beltrami", "energy_error = 0.01", "energy_error = [2, 1]")
        said = self.refused(first, second)
        self.assertIn("unknown key 'quik' in [verify]; expected quick, run, bounds; did you mean 'quick'?", said)
        self.assertIn("energy_error = [2, 1]: no interval", said)

    def test_two_cases_of_one_name_are_refused(self):
        folder = self.case("beltrami").rename(self.path / "beltrami")
        self.assertIn("another case of this name", self.refused(folder, "beltrami"))

    def test_damaged_references_are_refused_before_any_run(self):
        name = "dambreak2d_martin_moyce_1952.csv"
        good = (CASES / "dam_break_2d" / "reference" / name).read_bytes()
        lines = good.split(b"\n")
        header = lines.index(b"a_inch,T,Z")
        folder = self.case()
        for damage, said in ((b"\x89PNG\xff\x00\x01" + good, f"{name}:1: byte 0x89 is not UTF-8 text"),
                             (b"\n".join(lines[: header + 1]), f"{name}:{header + 1}: no row follows the header"),
                             (good.replace(b"1.125,1.602,1.884", b"1.125,abc,1.884"),
                              f"{name}:{header + 4}: column 'T' holds 'abc'; a finite number was expected"),
                             (good.replace(b"1.125,1.602,1.884", b"1.125,1.602"),
                              f"{name}:{header + 4}: the row holds 2 values, the header names 3 columns"),
                             (good.replace(b"1.125,1.602,1.884", b"1.125,,1.884"), f"{name}:{header + 4}: column 'T' holds ''"),
                             (good.replace(b"a_inch,T,Z", b"a_inch,T"), "the header names no column 'Z'"),
                             (good.replace(b"a_inch,T,Z", b"a_inch,T,z"), f"{name}:{header + 1}: the header names no column 'Z'"),
                             (b"", f"{name}: holds no header line"),
                             (None, f"{name}: cannot be read (No such file or directory)")):
            with self.subTest(expected=said):
                (folder / "reference" / name).unlink()
                if damage is not None:
                    (folder / "reference" / name).write_bytes(damage)
                self.assertIn(said, self.refused(folder, "--quick"))
                (folder / "reference" / name).write_bytes(good)


class Interruption(Scratch):
    """The stand-in tells who it is, waits, and tells which signal ended it, as the program writes its checkpoint."""

    PROGRAM = """
import os, pathlib, signal, sys, time
here = pathlib.Path({here!r})
def stop(number, frame):
    if {deaf}: return
    (here / "stopped").write_text(str(number))
    sys.exit(130)
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP): signal.signal(number, stop)
(here / "pid.part").write_text(str(os.getpid()))
(here / "pid.part").rename(here / "pid")
deadline = time.monotonic() + 60
while time.monotonic() < deadline: time.sleep(0.05)
"""

    def started(self, *arguments, deaf=False):
        """The command with its run under way, and the run's process number."""
        program = self.script(self.PROGRAM.format(here=str(self.path), deaf=deaf))
        (self.path / "tmp").mkdir()
        process = subprocess.Popen(paths.module("verify", program, "taylor_green_2d", *arguments), text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   env=os.environ | {"TMPDIR": str(self.path / "tmp")},
                                   # The tests may themselves run under nohup.
                                   preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL))
        self.addCleanup(process.kill)
        deadline = time.monotonic() + 30
        while not (self.path / "pid").exists():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)
        run = int((self.path / "pid").read_text())
        self.addCleanup(self.kill, run)
        return process, run

    def kill(self, run):
        try:
            os.kill(run, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def check_gone(self, process, run):
        _, said = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, said)
        self.assertNotIn("Traceback", said)
        self.assertRaises(ProcessLookupError, os.kill, run, 0)
        self.assertEqual(list((self.path / "tmp").iterdir()), [])
        return said

    def test_signals_reach_the_run_and_nothing_is_left(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(signal=number.name):
                process, run = self.started()
                process.send_signal(number)
                self.assertIn(f"interrupted by {number.name}", self.check_gone(process, run))
                self.assertEqual((self.path / "stopped").read_text(), str(int(number)))
                shutil.rmtree(self.path / "tmp")
                for name in ("pid", "stopped"):
                    (self.path / name).unlink()

    def test_a_second_signal_ends_a_run_that_does_not_stop(self):
        process, run = self.started(deaf=True)
        process.send_signal(signal.SIGTERM)
        time.sleep(0.5)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGTERM)
        self.check_gone(process, run)


class References(Scratch):
    def test_numbers_words_and_other_columns(self):
        path = self.path / "r.csv"
        path.write_text("# source\nkind,x,note\nu, 1.5 ,\nv,2,abc\n")
        table = read_reference(path, ("x",), {"kind": ("u", "v")})
        self.assertEqual((list(table["x"]), list(table["kind"]), list(table["note"])), ([1.5, 2.0], ["u", "v"], ["", "abc"]))
        path.write_text("kind,x\nu,1.5\nw,2\n")
        with self.assertRaisesRegex(DamagedResult, r"r.csv:3: column 'kind' holds 'w'; expected u or v"):
            read_reference(path, ("x",), {"kind": ("u", "v")})

    def test_the_reference_of_every_case_is_whole(self):
        for folder in sorted(path.parent for path in CASES.glob("*/measure.py")):
            with self.subTest(case=folder.name):
                self.assertTrue(callable(load_measure(folder).measure))
                self.assertNotRegex((folder / "measure.py").read_text(), r"read_csv\([^)]*reference")


class Tables(unittest.TestCase):
    def problems(self, text, quick=False):
        return VerifyTable("case.toml", text).check(tomllib.loads(text)["verify"], quick)

    def test_those_of_all_cases_are_sound(self):
        for path in sorted(CASES.glob("*/case.toml")):
            with self.subTest(case=path.parent.name):
                self.assertEqual(self.problems(path.read_text(), True) + self.problems(path.read_text()), [])

    def test_every_key_of_a_run_is_looked_at(self):
        bounds = "[verify.bounds]\ne = 1\n"
        for text, said in (('name = "a/b"', "4: name = 'a/b'; expected letters"),
                           ("name = 3", "4: name = 3; expected letters"),
                           ('name = "a"\nset = "x=1"', "5: set = 'x=1'; expected a list"),
                           ('name = "a"\nset = ["x"]', "5: set = ['x']; expected a list"),
                           ('name = "a"\nuntil = "1"', "5: until = '1'; expected a time above 0"),
                           ('name = "a"\nuntil = true', "5: until = True; expected a time above 0"),
                           ('name = "a"\nstart = "b"', "5: start = 'b' is no run before this one"),
                           ('name = "a"\nuntill = 2', "5: unknown key 'untill' in [[verify.run]]; expected name, set, until, "
                                                      "start; did you mean 'until'?"),
                           ('name = "a"\n[[verify.run]]\nname = "a"', "6: name = 'a' is that of an earlier run")):
            with self.subTest(text=text):
                problems = self.problems(f"{bounds}[[verify.run]]\n{text}\n")
                self.assertEqual(len(problems), 1, problems)
                self.assertTrue(problems[0].startswith(f"case.toml:{said}"), problems[0])

    def test_bounds_hold_numbers_that_can_bound_something(self):
        for bound in (0, 1e-12, 3, [0, 1], [-1.5, 2], [1, float("inf")], [4, 4]):
            self.assertEqual(fault_of_bound(bound), "", bound)
        for bound in ("1", True, -1, float("nan"), float("inf"), [1], [1, 2, 3], [2, 1], ["0", 1], [0, float("nan")],
                      [float("-inf"), float("inf")], {"upper": 1}):
            self.assertNotEqual(fault_of_bound(bound), "", bound)

    def test_tables_of_a_wrong_kind_are_said(self):
        for text, said in (("verify = 3", "expected a table"), ("[verify]\nbounds = 3", "bounds = 3; expected a table"),
                           ("[verify]\nquick = 3\n[verify.bounds]\ne = 1", "case.toml:2: quick = 3; expected true, false"),
                           ("[verify.run]\nname = 'a'\n[verify.bounds]\ne = 1", "expected tables [[verify.run]]")):
            self.assertTrue(any(said in problem for problem in self.problems(text)), self.problems(text))


if __name__ == "__main__":
    unittest.main()
