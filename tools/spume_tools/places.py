# SPDX-License-Identifier: MIT
"""Where things are, beside this package: the sources and an installation have the same layout."""
from pathlib import Path

HOME = Path(__file__).resolve().parents[2]  # holds tools/spume_tools and cases/
CASES = HOME / "cases"
