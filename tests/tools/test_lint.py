# SPDX-License-Identifier: MIT
"""tools/lint: floors, names of methods and sizes of files, on small trees of their own."""
import subprocess
import tempfile
import unittest
from pathlib import Path

import paths
from spume_tools.lint import floors
from spume_tools.lint.method_names import named


class Tree(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.path = Path(scratch.name)

    def check(self, files):
        for path, text in files.items():
            file = self.path / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        done = subprocess.run(paths.module("lint", self.path), capture_output=True, text=True)
        self.assertEqual(done.stderr, "")
        self.assertEqual(done.returncode, 1 if done.stdout else 0)
        return done.stdout.splitlines()


class Floors(Tree):
    def test_downward_include_is_allowed(self):
        self.assertEqual(self.check({"src/run/a.cpp": '#include "spume/core/array.hpp"\n',
                                     "src/particles/b.cpp": '#include "spume/operators/dots.hpp"\n',
                                     "src/io/c.cpp": '#include "spume/scene/case.hpp"\n'}), [])

    def test_upward_and_sideways_includes_are_named(self):
        said = "\n".join(self.check({"include/spume/core/a.hpp": '#pragma once\n#include "spume/io/x.hpp"\n',
                                     "src/particles/p.cpp": '#include "spume/physics/x.hpp"\n',
                                     "src/scene/b.cpp": '#include "spume/io/x.hpp"\n', "src/tricks/c.cpp": "\n"}))
        self.assertIn("include/spume/core/a.hpp:2: error: core (floor 1) includes io (floor 2)", said)
        self.assertIn("src/particles/p.cpp:1: error: particles (floor 4) includes physics (floor 5)", said)
        self.assertIn("src/scene/b.cpp:1: error: scene includes io of the same floor", said)
        self.assertIn("'tricks' is on no floor", said)

    def test_a_method_includes_no_other(self):
        own, other = '#include "spume/methods/a/x.hpp"\n#include "spume/methods/stage.hpp"\n', '#include "spume/methods/b/x.hpp"\n'
        said = self.check({"src/methods/a/x.cpp": own + other, "include/spume/methods/a/x.hpp": "", "src/methods/registry.cpp": other})
        self.assertEqual(said, ["src/methods/a/x.cpp:3: error: method a includes method b; what both need belongs below methods"])

    def test_this_repository_keeps_to_its_floors(self):
        self.assertEqual(list(floors.violations(paths.ROOT)), [])


class MethodNames(Tree):
    def test_texts_and_identifiers_of_scene_run_and_cli_are_seen_and_comments_are_not(self):
        said = self.check({"src/methods/les_sph/step.cpp": "int les_sph;\n", "src/methods/waves/step.cpp": "",
                           "src/physics/a.cpp": "int les_sph;\n",
                           "src/scene/a.cpp": '// les_sph\nint x = 1\'000;  /* waves\n */ const char* m = "les-sph";\n',
                           "src/run/a.cpp": "char c = '\"'; // waves\nstruct LesSphOptions {};\n",
                           "include/spume/cli/a.hpp": 'auto s = R"(a\n"waves" b)";\nint microwaves;\n'})
        self.assertEqual([line.split(" names")[0] for line in said],
                         ['src/scene/a.cpp:3: error: "les-sph"', "src/run/a.cpp:2: error: LesSphOptions",
                          'include/spume/cli/a.hpp:1: error: R"(a "waves" b)"'])

    def test_spellings_of_a_name(self):
        methods = {"les_sph": ("les", "sph"), "gfd": ("gfd",)}
        for token in ("les_sph", '"les-sph"', "make_les_sph", "LesSph", "check_LesSphOptions", "les_sph_sections"):
            self.assertEqual(named(token, methods), "les_sph", token)
        self.assertEqual(named("GfdOptions", methods), "gfd")
        for token in ("les", "sph", "sph_les", "lessons_sph", "agfd", '"less sphere"'):
            self.assertIsNone(named(token, methods), token)


class Silence(Tree):
    def test_prints_and_exits_outside_the_command_line_are_named(self):
        said = self.check({"src/core/a.cpp": "// std::cerr\nfprintf(stderr, \"x\");\n", "src/cli/main.cpp": "std::cout;\n",
                           "include/spume/core/b.hpp": "if (std::getenv(\"X\"))\nsnprintf(a, n, b);\n"})
        self.assertEqual([line.split("; ")[0] for line in said],
                         ["include/spume/core/b.hpp:1: error: 'getenv(' outside of src/cli",
                          "src/core/a.cpp:2: error: 'fprintf(' outside of src/cli"])


class Sizes(Tree):
    def test_a_file_of_more_than_500_lines_is_named(self):
        said = self.check({"src/core/a.cpp": "\n" * 500, "tools/b.py": "\n" * 501, "cases/c/measure.py": "\n" * 900})
        self.assertEqual(said, ["tools/b.py:501: error: 501 lines; a file has at most 500, split it"])

    def test_the_step_of_a_method_is_a_page(self):
        said = self.check({"src/methods/a/step.cpp": "\n" * 120, "src/methods/b/step.cpp": "\n" * 121, "src/run/step.cpp": "\n" * 300})
        self.assertEqual(said, ["src/methods/b/step.cpp:121: error: 121 lines; the step of a method is a page of at most 120"])


if __name__ == "__main__":
    unittest.main()
