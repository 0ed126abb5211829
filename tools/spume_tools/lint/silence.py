# SPDX-License-Identifier: MIT
"""Numerical code neither prints nor exits, nor asks the environment: src/cli does, and what keeps a file for the user."""
import re

from .sources import lines_of, sources

SPEAKING = re.compile(r"\b(?:f?printf|f?puts|exit|abort)\s*\(|\bstd::c(?:out|err|log)\b|\bgetenv\s*\(")
# The wisdom of transforms stands in the user's cache.
ALLOWED = {("src/fourier/line_transform.cpp", "getenv")}


def violations(root):
    """One line per place that prints, exits or asks."""
    for folder in ("include", "src"):
        for file in sources(root / folder, (".hpp", ".cpp")):
            path = file.relative_to(root).as_posix()
            if path.startswith("src/cli/"):
                continue
            for number, line in enumerate(lines_of(file), 1):
                found = SPEAKING.search(line.split("//")[0])
                if found and not any(path == file and call in found[0] for file, call in ALLOWED):
                    yield f"{path}:{number}: error: '{found[0]}' outside of src/cli; throw an error, or return what is to be said"
