#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Checks that no include goes up a floor: floors.py ROOT. Prints one line per violation and exits 1 if there is any."""
import re
import sys
from pathlib import Path

FLOOR = {
    "core": 1,
    "neighbours": 2, "scene": 2, "io": 2,
    "operators": 3, "solvers": 3, "fourier": 3,
    "physics": 4,
    "methods": 5,
    "run": 6,
    "cli": 7,
}
# Folders of one floor are strangers, save for these one-way acquaintances.
SAME_FLOOR = {("neighbours", "scene"), ("io", "scene"), ("operators", "fourier"), ("solvers", "operators")}
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]spume/([a-z_]+)/')


def violations(root):
    for base in (root / "include" / "spume", root / "src"):
        for file in sorted(p for p in base.rglob("*") if p.suffix in (".hpp", ".cpp")):
            folder = file.relative_to(base).parts[0]
            if folder not in FLOOR:
                known = ", ".join(FLOOR)
                yield f"{file.relative_to(root)}:1: error: folder '{folder}' is on no floor; the floors are {known}"
                continue
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
                match = INCLUDE.match(line)
                if not match or match[1] == folder:
                    continue
                target = match[1]
                place = f"{file.relative_to(root)}:{number}"
                if target not in FLOOR:
                    yield f"{place}: error: '{target}' is on no floor"
                elif FLOOR[target] > FLOOR[folder]:
                    yield (f"{place}: error: {folder} (floor {FLOOR[folder]}) includes {target} (floor {FLOOR[target]}); "
                           "an include never goes up")
                elif FLOOR[target] == FLOOR[folder] and (folder, target) not in SAME_FLOOR:
                    yield f"{place}: error: {folder} includes {target} of the same floor"


def main():
    found = list(violations(Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()))
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
