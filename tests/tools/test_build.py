# SPDX-License-Identifier: MIT
"""tools/build on a project of one file: a checkout that was copied or moved builds its own sources."""
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import paths

PROJECT = """\
cmake_minimum_required(VERSION 3.25)
project(one LANGUAGES NONE)
add_custom_target(copy ALL COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/text ${CMAKE_BINARY_DIR}/text)
"""
PRESETS = """{"version": 6, "configurePresets": [{"name": "release", "generator": "Ninja", "binaryDir": "${sourceDir}/build/release"}]}"""


class Build(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.path = Path(scratch.name)
        self.first = self.path / "first"
        (self.first / "tools").mkdir(parents=True)
        shutil.copy(paths.ROOT / "tools" / "build", self.first / "tools" / "build")
        for name, text in (("CMakeLists.txt", PROJECT), ("CMakePresets.json", PRESETS), ("text", "first")):
            (self.first / name).write_text(text)

    def built(self, folder):
        """What was built, and what the command said."""
        done = subprocess.run([folder / "tools" / "build", "release"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return (folder / "build" / "release" / "text").read_text(), done.stderr

    def test_is_silent_when_nothing_changed_and_builds_what_did(self):
        self.assertEqual(self.built(self.first), ("first", "build: configuring build/release\n"))
        (self.first / "text").write_text("changed")
        self.assertEqual(self.built(self.first), ("changed", ""))

    def test_a_copy_builds_its_own_sources(self):
        self.built(self.first)
        copy = self.path / "copy"
        shutil.copytree(self.first, copy)
        (copy / "text").write_text("copy")
        self.assertEqual(self.built(copy), ("copy", "build: configuring build/release\n"))
        self.assertEqual(self.built(copy), ("copy", ""))

    def test_a_moved_checkout_builds_its_own_sources(self):
        self.built(self.first)
        moved = self.first.rename(self.path / "moved")
        (moved / "text").write_text("moved")
        self.assertEqual(self.built(moved), ("moved", "build: configuring build/release\n"))

    def test_another_name_of_the_same_folder_is_no_other_checkout(self):
        self.built(self.first)
        link = self.path / "link"
        link.symlink_to(self.first)
        self.assertEqual(self.built(link), ("first", ""))


if __name__ == "__main__":
    unittest.main()
