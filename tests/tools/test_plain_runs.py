# SPDX-License-Identifier: MIT
"""Cases that compare several runs can be drawn from one alone, as `spume run` and `spume plot` leave it. Needs
build/release/spume."""
import subprocess
import tempfile
import unittest
from pathlib import Path

import paths
from spume_tools.places import CASES
from spume_tools.results import Results
from spume_tools.verify.cases import load_measure

PROGRAM = paths.ROOT / "build" / "release" / "spume"


class PlainRuns(unittest.TestCase):
    def drawn(self, name, *settings):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "run"
            subprocess.run([PROGRAM, "run", CASES / name, "-o", folder, "--quiet", "--threads", "1",
                            *(word for setting in settings for word in ("--set", setting))], check=True, capture_output=True)
            figures = load_measure(CASES / name).curves({"run": Results(folder)})
            return {figure["file"]: {line[0]: line[1:3] for line in figure["curves"]} for figure in figures}

    def test_franke_shows_its_error_beside_the_reference(self):
        errors = self.drawn("franke")["errors"]
        (spacing,), (error,) = errors["gfd, lattice"]
        self.assertEqual(spacing, 0.025)
        self.assertAlmostEqual(error, 0.0139, delta=0.0002)
        self.assertEqual(len(errors["reference, sph, lattice"][0]), 4)

    def test_poiseuille_operators_shows_the_response_of_its_form(self):
        drawn = self.drawn("poiseuille_operators", "domain.upper=[2, 1]")
        y, value = drawn["response"]["split"]
        self.assertAlmostEqual(value[abs(y + 0.5).argmin()], -1, delta=0.05)
        self.assertNotIn("difference", drawn)


if __name__ == "__main__":
    unittest.main()
