# SPDX-License-Identifier: MIT
"""Checks the sources: `python3 -m spume_tools.lint ROOT` prints one line per violation and exits 1 if there is any."""
import sys
from pathlib import Path

from . import floors, method_names, silence, sizes

root = Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
found = [line for check in (floors, method_names, silence, sizes) for line in check.violations(root)]
print("\n".join(found), end="\n" if found else "")
sys.exit(1 if found else 0)
