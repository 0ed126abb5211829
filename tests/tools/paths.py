# SPDX-License-Identifier: MIT
"""Puts the package behind the tools on the import path of its tests, and starts its modules as the commands do."""
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))


def module(name, *arguments):
    """The command line that runs a module of the package."""
    return [str(ROOT / "tools" / "module"), name, *map(str, arguments)]
