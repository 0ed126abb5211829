# SPDX-License-Identifier: MIT
"""Tables in CSV: those that a run writes, and the references that a case holds a run against."""
import csv
import re
from pathlib import Path

import numpy as np

from .errors import DamagedResult, MissingResult
from .units import unit_of


class Table(dict):
    """Columns by name, as arrays of one length.

    path: of the file; comments: the lines above its header; units: by column, what these lines say of it, a unit or a
    note; si, dimensions: whether the run is in SI units, and 2 or 3.
    """

    si, dimensions = False, 3

    def __init__(self, path, columns, comments=()):
        super().__init__(columns)
        self.path = path
        self.comments = list(comments)
        self.units = {}
        for line in self.comments:
            # As runs write them, one in a line; names may hold blanks. References may give several.
            name, colon, unit = line.partition(": ")
            if colon and name in self:
                self.units[name] = unit.strip()
                continue
            for name, unit in re.findall(r"(\w+)\s*(?:[:=]|(?=\[))\s*([^,;]+)", line):
                if name in self:
                    self.units[name] = unit.strip(" []")

    def __missing__(self, name):
        raise MissingResult(f"{self.path}: no column '{name}'; it has {', '.join(self) or 'none'}")

    def __len__(self):
        """The number of rows."""
        return 0 if not self.keys() else len(next(iter(self.values())))

    def __repr__(self):
        return f"Table({str(self.path)!r}: {len(self)} rows of {', '.join(self)})"

    def unit(self, name):
        """The symbol of the unit of a column, None where it has none."""
        return unit_of(name, self.units.get(name), self.si, self.dimensions)

    def label(self, name):
        """Name and unit of a column, for an axis."""
        unit = self.unit(name)
        return name.replace("_", " ") + (f" [{unit}]" if unit else "")


def _read_rows(path, of_a_run=False):
    """Comments, header and the rows of a CSV file, each row with the number of its line; the header has one too.

    of_a_run: a last line without its end is one that the program is writing, or was killed while it wrote it, and does
    not count, whatever its number of values.
    """
    try:
        raw = path.read_bytes()
        text = raw.decode("utf-8")
    except OSError as error:
        raise MissingResult(f"{path}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise DamagedResult(f"{path}:{line}: byte 0x{raw[error.start]:02x} is not UTF-8 text; a table of numbers was "
                            "expected; restore the file") from error
    if of_a_run:
        text = text[: text.rfind("\n") + 1]
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
    """A CSV file with `#` lines first and then the column names. Numbers become float arrays, else text arrays.

    words: given for the tables of a run: the names of the columns that may hold text. Their last line counts when it is
    complete. Raises MissingResult, or DamagedResult with file, line and column.
    """
    path = Path(path)
    comments, (_, header), rows = _read_rows(path, of_a_run=words is not None)
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
