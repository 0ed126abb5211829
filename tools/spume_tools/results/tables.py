# SPDX-License-Identifier: MIT
"""Tables in CSV: those that a run writes, and the references that a case holds a run against."""
import csv
import re
from pathlib import Path

import numpy as np

from .errors import DamagedResult, MissingResult


class Table(dict):
    """Columns by name; `units` by name and `comments` (the lines above the header) as text."""

    def __init__(self, path, columns, comments=()):
        super().__init__(columns)
        self.path = path
        self.comments = list(comments)
        self.units = {}
        for line in self.comments:
            for name, unit in re.findall(r"(\w+)\s*(?:[:=]|(?=\[))\s*([^,;]+)", line):
                if name in self:
                    self.units[name] = unit.strip(" []")

    def __missing__(self, name):
        raise MissingResult(f"{self.path}: no column '{name}'; it has {', '.join(self) or 'none'}")

    def __len__(self):
        return 0 if not self.keys() else len(next(iter(self.values())))

    def label(self, name):
        """Name and unit of a column, for an axis."""
        unit = self.units.get(name)
        return name.replace("_", " ") + (f" [{unit}]" if unit and unit not in ("1", "-") else "")


def _read_rows(path):
    """Comments, header and the rows of a CSV file, each row with the number of its line; the header has one too."""
    try:
        raw = path.read_bytes()
        text = raw.decode("utf-8")
    except OSError as error:
        raise MissingResult(f"{path}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise DamagedResult(f"{path}:{line}: byte 0x{raw[error.start]:02x} is not UTF-8 text; a table of numbers was "
                            "expected; restore the file") from error
    lines = list(enumerate(text.replace("\r\n", "\n").split("\n"), 1))
    comments = [line.lstrip("# ") for _, line in lines if line.startswith("#")]
    kept = [(number, line) for number, line in lines if line.strip() and not line.startswith("#")]
    reader = csv.reader(line for _, line in kept)
    try:
        rows = [(kept[reader.line_num - 1][0], row) for row in reader]
    except csv.Error as error:
        raise DamagedResult(f"{path}:{kept[reader.line_num - 1][0]}: not comma-separated text ({error}); restore the "
                            "file") from error
    if not rows:
        raise DamagedResult(f"{path}: holds no header line; expected the names of the columns; restore the file")
    return comments, (rows[0][0], [name.strip() for name in rows[0][1]]), rows[1:]


def _wrong_width(path, number, row, header):
    return DamagedResult(f"{path}:{number}: the row holds {len(row)} value{'s' * (len(row) != 1)}, the header names "
                         f"{len(header)} columns ({', '.join(header)}); restore the file")


def read_csv(path, words=None):
    """A CSV file with `#` lines first and then the column names. Numbers become float arrays, else text arrays; with
    words given, only the columns of these names may hold text."""
    path = Path(path)
    comments, (_, header), rows = _read_rows(path)
    # The last line of a run that was killed may be cut short; any other of a wrong length is damage.
    if rows and len(rows[-1][1]) < len(header):
        rows.pop()
    for number, row in rows:
        if len(row) != len(header):
            raise _wrong_width(path, number, row, header)
    columns = {}
    for index, name in enumerate(header):
        text = [row[index] for _, row in rows]
        try:
            columns[name] = np.array([float(value) if value.strip() else np.nan for value in text])
        except ValueError:
            if words is not None and name not in words:
                line, value = next((line, row[index]) for line, row in rows if row[index].strip() and not _is_float(row[index]))
                raise DamagedResult(f"{path}:{line}: column '{name}' holds '{value}'; a number was expected") from None
            columns[name] = np.array(text, dtype=str)
    return Table(path, columns, comments)


def read_reference(path, numbers, words=None):
    """A reference table that a measure compares with: nothing in it may be missing or damaged.

    numbers: names of the columns that must hold a finite number in every row; words: {name: the words its column may
    hold}. Other columns may hold anything. Raises DamagedResult with file, line and column.
    """
    path, words = Path(path), words or {}
    restore = "restore the file, or correct the names in measure.py"
    comments, (header_line, header), rows = _read_rows(path)
    for name in (*numbers, *words):
        if name not in header:
            raise DamagedResult(f"{path}:{header_line}: the header names no column '{name}', which measure.py needs; it "
                                f"names {', '.join(header)}; {restore}")
    if len(set(header)) != len(header):
        raise DamagedResult(f"{path}:{header_line}: the header names a column twice: {', '.join(header)}; {restore}")
    if not rows:
        raise DamagedResult(f"{path}:{header_line}: no row follows the header; expected at least one; restore the file")
    columns = {name: [] for name in header}
    for number, row in rows:
        if len(row) != len(header):
            raise _wrong_width(path, number, row, header)
        for name, value in zip(header, row):
            if name in words and value.strip() not in words[name]:
                raise DamagedResult(f"{path}:{number}: column '{name}' holds '{value.strip()}'; expected "
                                    f"{' or '.join(words[name])}; restore the file")
            columns[name].append(_finite_number(path, number, name, value) if name in numbers else value.strip())
    return Table(path, {name: np.array(values) for name, values in columns.items()}, comments)


def _is_float(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def _finite_number(path, line, name, text):
    value = float(text) if _is_float(text) else float("nan")
    if not np.isfinite(value):
        raise DamagedResult(f"{path}:{line}: column '{name}' holds '{text.strip()}'; a finite number was expected; "
                            "restore the file")
    return value
