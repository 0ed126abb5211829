# SPDX-License-Identifier: MIT
"""No file is longer than LARGEST lines: a file has one subject. The step of a method is a page."""
from .sources import lines_of, sources

LARGEST = 500
PAGE = 120
FOLDERS = ("include", "src", "tests", "bench", "tools")


def violations(root):
    """One line per file that is too long."""
    for folder in FOLDERS:
        for file in sources(root / folder, (".hpp", ".cpp", ".py", ".cmake", ".txt", "")):
            path, length = file.relative_to(root), len(lines_of(file))
            if length > LARGEST:
                yield f"{path}:{LARGEST + 1}: error: {length} lines; a file has at most {LARGEST}, split it"
            elif path.match("src/methods/*/step.cpp") and length > PAGE:
                yield f"{path}:{PAGE + 1}: error: {length} lines; the step of a method is a page of at most {PAGE}"
