# SPDX-License-Identifier: MIT
"""What a run left in its folder, as numpy arrays.

    run = Results("runs/breaking_wave-1")
    run.series["t"], run.series["kinetic_energy"]     one row per step
    run.probes["front"]                               one row per step
    run.line("centre", -1)["velocity_x"]              one profile, here of the last time
    run.snapshots("fluid")[-1].position               (N, 3), with .time and .fields["velocity"] (N, 3)
    run.case["resolution"]["spacing"]                 the resolved case file

Every reader raises MissingResult, with the path and what would have written it, when there is nothing to read, and
DamagedResult, one of its kind, when what is there is not what it should be.
"""
import csv
import json
import re
import tomllib
from functools import cached_property
from pathlib import Path

import numpy as np


class MissingResult(Exception):
    """A file or a column that a run did not write."""


class DamagedResult(MissingResult):
    """A file that is there but does not hold what it should."""


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
        unit = self.units.get(name)
        return name.replace("_", " ") + (f" [{unit}]" if unit and unit not in ("1", "-") else "")


def read_rows(path):
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


def wrong_width(path, number, row, header):
    return DamagedResult(f"{path}:{number}: the row holds {len(row)} value{'s' * (len(row) != 1)}, the header names "
                         f"{len(header)} columns ({', '.join(header)}); restore the file")


def read_csv(path, words=None):
    """A CSV file with `#` lines first and then the column names. Numbers become float arrays, else text arrays; with
    words given, only the columns of these names may hold text."""
    path = Path(path)
    comments, (_, header), rows = read_rows(path)
    # The last line of a run that was killed may be cut short; any other of a wrong length is damage.
    if rows and len(rows[-1][1]) < len(header):
        rows.pop()
    for number, row in rows:
        if len(row) != len(header):
            raise wrong_width(path, number, row, header)
    columns = {}
    for index, name in enumerate(header):
        text = [row[index] for _, row in rows]
        try:
            columns[name] = np.array([float(value) if value.strip() else np.nan for value in text])
        except ValueError:
            if words is not None and name not in words:
                line, value = next((line, row[index]) for line, row in rows if row[index].strip() and not is_float(row[index]))
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
    comments, (header_line, header), rows = read_rows(path)
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
            raise wrong_width(path, number, row, header)
        for name, value in zip(header, row):
            if name in words and value.strip() not in words[name]:
                raise DamagedResult(f"{path}:{number}: column '{name}' holds '{value.strip()}'; expected "
                                    f"{' or '.join(words[name])}; restore the file")
            columns[name].append(finite_number(path, number, name, value) if name in numbers else value.strip())
    return Table(path, {name: np.array(values) for name, values in columns.items()}, comments)


def is_float(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def finite_number(path, line, name, text):
    value = float(text) if is_float(text) else float("nan")
    if not np.isfinite(value):
        raise DamagedResult(f"{path}:{line}: column '{name}' holds '{text.strip()}'; a finite number was expected; "
                            "restore the file")
    return value


class Fields:
    """Fields by name at one time."""

    def __init__(self, time, fields):
        self.time = time
        self.fields = fields

    def field(self, name):
        if name == "speed":
            return np.linalg.norm(self.field("velocity"), axis=-1)
        if name not in self.fields:
            raise MissingResult(f"snapshot at t = {self.time:g}: no field '{name}'; it has {', '.join(self.fields)}")
        return self.fields[name]


class Snapshot(Fields):
    """Particles at one time: position (N, 3) and fields by name, (N,) or (N, components)."""

    def __init__(self, time, position, fields):
        super().__init__(time, fields)
        self.position = position

    def __len__(self):
        return len(self.position)


class GridSnapshot(Fields):
    """Fields on a uniform grid at one time: fields by name, (nx, ny, nz) or (nx, ny, nz, components)."""

    def __init__(self, time, origin, spacing, fields):
        super().__init__(time, fields)
        self.origin = origin
        self.spacing = spacing

    def field(self, name):
        if name == "enstrophy":
            return np.sum(self.field("vorticity") ** 2, axis=-1)
        return super().field(name)


class Steps:
    """The steps of a VTKHDF file with temporal data; index it for one of them. Derived classes read the rest."""

    contents = None  # what the file should hold, for the message

    def __init__(self, path):
        import h5py

        self.path = Path(path)
        if not self.path.exists():
            raise MissingResult(f"{self.path}: not there; set output.every in the case to have snapshots written")
        try:
            # A run that is still writing holds the lock; reading finished steps is safe.
            with h5py.File(self.path, "r", locking=False) as file:
                root = file["VTKHDF"]
                steps = root["Steps"]
                self.times = np.array(steps["Values"], dtype=float)[: int(steps.attrs["NSteps"])]
                self.names = list(root["PointData"]) if "PointData" in root else []
                self._read_layout(root)
        except (OSError, KeyError, RuntimeError) as error:
            raise DamagedResult(f"{self.path}: not a VTKHDF file {self.contents} ({error})") from error

    def __len__(self):
        return len(self.times)

    def __getitem__(self, index):
        import h5py

        if not -len(self) <= index < len(self):
            raise IndexError(index)
        try:
            with h5py.File(self.path, "r", locking=False) as file:
                return self._read(file["VTKHDF"], index % len(self))
        except (OSError, KeyError, RuntimeError) as error:
            raise DamagedResult(f"{self.path}: step {index % len(self)} cannot be read ({error})") from error

    def nearest(self, time):
        return self[int(np.argmin(np.abs(self.times - time)))]


class Snapshots(Steps):
    """Particles: PolyData, each step a Snapshot."""

    contents = "with steps"

    def _read_layout(self, root):
        self._first = np.array(root["Steps"]["PointOffsets"], dtype=np.int64)
        self._count = np.array(root["NumberOfPoints"], dtype=np.int64)

    def _read(self, root, index):
        rows = slice(int(self._first[index]), int(self._first[index] + self._count[index]))
        fields = {name: np.array(root["PointData"][name][rows]) for name in self.names}
        return Snapshot(float(self.times[index]), np.array(root["Points"][rows], dtype=float), fields)


class GridSnapshots(Steps):
    """Fields on a grid: ImageData, each step a GridSnapshot."""

    contents = "of fields on a grid"

    def _read_layout(self, root):
        self.origin, self.spacing = np.array(root.attrs["Origin"]), np.array(root.attrs["Spacing"])

    def _read(self, root, index):
        # The file holds z, y, x.
        fields = {name: np.swapaxes(np.array(root["PointData"][name][index]), 0, 2) for name in self.names}
        return GridSnapshot(float(self.times[index]), self.origin, self.spacing, fields)


class Results:
    """The folder of one run. picture_times: the times that pictures show, where someone has chosen them."""

    picture_times = ()

    def __init__(self, folder, wall_seconds=None):
        self.folder = Path(folder)
        self._wall_seconds = wall_seconds
        if not self.folder.is_dir():
            raise MissingResult(f"{self.folder}: not a folder")

    def has(self, name):
        return (self.folder / name).exists()

    @cached_property
    def series(self):
        return read_csv(self.folder / "series.csv", words=())

    @cached_property
    def probes(self):
        return read_csv(self.folder / "probes.csv", words=())

    @cached_property
    def lines(self):
        return read_csv(self.folder / "lines.csv", words=("name",))

    @cached_property
    def spectrum(self):
        return read_csv(self.folder / "spectrum.csv", words=())

    @cached_property
    def case(self):
        return read_case(self.folder / "case.toml")

    @cached_property
    def summary(self):
        return self._json("summary.json")

    @cached_property
    def ledger(self):
        return self._json("ledger.json")

    @property
    def wall_seconds(self):
        return self._wall_seconds if self._wall_seconds is not None else self.summary.get("wall_seconds")

    def snapshots(self, family="fluid"):
        return Snapshots(self.folder / f"{family}.vtkhdf")

    def grid_snapshots(self, family="fluid"):
        return GridSnapshots(self.folder / f"{family}.vtkhdf")

    @property
    def on_grid(self):
        """Whether the flow lives on a grid and not on particles."""
        return "grid" in self.case.get("resolution", {})

    def line_names(self):
        return list(dict.fromkeys(self.lines["name"]))

    def line_times(self, name):
        return np.unique(self.lines["t"][self.lines["name"] == name])

    def line(self, name, time_index=-1):
        """The profile of a line probe at one of its times: columns s, x, y, z, velocity_x, ..., pressure."""
        times = self.line_times(name)
        if not len(times):
            raise MissingResult(f"{self.lines.path}: no line '{name}'; it has {', '.join(self.line_names())}")
        rows = (self.lines["name"] == name) & (self.lines["t"] == times[time_index])
        return Table(self.lines.path, {key: column[rows] for key, column in self.lines.items() if key != "name"})

    @property
    def spacing(self):
        resolution = self.case["resolution"]
        if "spacing" in resolution:
            return float(resolution["spacing"])
        lower, upper = self.bounds()
        return float(np.min((upper - lower) / np.array(resolution["grid"])))

    @property
    def dimensions(self):
        return len(self.case["domain"]["lower"])

    def bounds(self):
        """Lower and upper corner of the domain, in 2 or 3 numbers."""
        return np.array(self.case["domain"]["lower"], float), np.array(self.case["domain"]["upper"], float)

    def _json(self, name):
        try:
            return json.loads((self.folder / name).read_text(encoding="utf-8"))
        except OSError as error:
            raise MissingResult(f"{self.folder / name}: cannot be read ({error.strerror})") from error
        except ValueError as error:
            raise DamagedResult(f"{self.folder / name}: cannot be read ({error})") from error


def read_case(path):
    try:
        return tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise MissingResult(f"{path}: cannot be read ({error.strerror})") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise DamagedResult(f"{path}: cannot be read ({error})") from error


def standard(runs):
    """The run named "standard"; where there is none, the first."""
    return runs.get("standard") or next(iter(runs.values()))


def relative_rms(measured, exact, scale):
    """Root mean square of the difference (over all components), divided by the scale."""
    difference = np.asarray(measured, float) - np.asarray(exact, float)
    return float(np.sqrt(np.mean(np.sum(difference.reshape(len(difference), -1) ** 2, axis=1))) / scale)


def observed_order(spacings, errors):
    """Slope of log error against log spacing by least squares."""
    return float(np.polyfit(np.log(spacings), np.log(errors), 1)[0])
