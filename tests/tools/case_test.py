# SPDX-License-Identifier: MIT
"""What tests of the measures of cases share."""
import shutil
import tempfile
import unittest

import paths
from spume_tools.places import CASES
from spume_tools.verify.cases import load_measure
from synthetic import new_folder


class CaseTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.count = 0

    def run_of(self, name):
        """A new run folder with the case's own file as the resolved case, and the case's measure.py."""
        self.count += 1
        folder = new_folder(self.scratch.name, f"{name}-{self.count}")
        shutil.copy(CASES / name / "case.toml", folder / "case.toml")
        return folder, load_measure(CASES / name)
