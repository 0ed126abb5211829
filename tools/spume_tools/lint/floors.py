# SPDX-License-Identifier: MIT
"""No include goes up a floor, and no method includes another."""
import re

from .sources import lines_of, sources

FLOOR = {
    "core": 1,
    "neighbours": 2, "scene": 2, "io": 2, "geometry": 2,
    "operators": 3, "solvers": 3, "fourier": 3,
    "particles": 4,
    "physics": 5,
    "methods": 6,
    "run": 7,
    "view": 8,
    "cli": 8,
}
# Folders of one floor are strangers, save for these one-way acquaintances.
SAME_FLOOR = {("neighbours", "scene"), ("io", "scene"), ("scene", "geometry"), ("io", "geometry"), ("operators", "fourier"), ("solvers", "operators"), ("cli", "view")}
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]spume/([a-z0-9_]+)/(?:([a-z0-9_]+)/)?')


def violations(root):
    """One line per include that breaks a rule."""
    for base in (root / "include" / "spume", root / "src"):
        for file in sources(base, (".hpp", ".cpp")):
            folders = file.relative_to(base).parts[:-1]
            folder = folders[0] if folders else ""
            if folder not in FLOOR:
                yield f"{file.relative_to(root)}:1: error: folder '{folder}' is on no floor; the floors are {', '.join(FLOOR)}"
                continue
            for number, line in enumerate(lines_of(file), 1):
                match = INCLUDE.match(line)
                fault = fault_of(folders, match[1], match[2]) if match else ""
                if fault:
                    yield f"{file.relative_to(root)}:{number}: error: {fault}"


def fault_of(folders, target, part):
    """What is wrong when a file in these folders includes spume/target/part/...; empty when nothing is."""
    folder = folders[0]
    if target not in FLOOR:
        return f"'{target}' is on no floor"
    if FLOOR[target] > FLOOR[folder]:
        return f"{folder} (floor {FLOOR[folder]}) includes {target} (floor {FLOOR[target]}); an include never goes up"
    if target != folder and FLOOR[target] == FLOOR[folder] and (folder, target) not in SAME_FLOOR:
        return f"{folder} includes {target} of the same floor"
    # A file of methods/ itself, such as the registry, may know them all.
    if folder == target == "methods" and len(folders) > 1 and part not in (None, folders[1]):
        return f"method {folders[1]} includes method {part}; what both need belongs below methods"
    return ""
