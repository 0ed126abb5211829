# SPDX-License-Identifier: MIT
"""No file is longer than LARGEST lines: a file has one subject."""
from .sources import lines_of, sources

LARGEST = 500
FOLDERS = ("include", "src", "tests", "bench", "tools")


def violations(root):
    """One line per file that is too long."""
    for folder in FOLDERS:
        for file in sources(root / folder, (".hpp", ".cpp", ".py", ".cmake", ".txt", "")):
            length = len(lines_of(file))
            if length > LARGEST:
                yield f"{file.relative_to(root)}:{LARGEST + 1}: error: {length} lines; a file has at most {LARGEST}, split it"
