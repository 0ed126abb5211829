# SPDX-License-Identifier: MIT
"""Files of the sources, for the checks."""


def sources(base, suffixes):
    """Files below a folder whose names end so, in order; none where the folder is missing."""
    return sorted(path for path in base.rglob("*") if path.is_file() and path.suffix in suffixes)


def lines_of(file):
    return file.read_text(encoding="utf-8", errors="replace").splitlines()
