# SPDX-License-Identifier: MIT
"""The folder of one run: its tables, snapshots, resolved case, summary and ledger."""
import json
import tomllib
from functools import cached_property
from pathlib import Path

import numpy as np

from .errors import DamagedResult, MissingResult
from .snapshots import GridSnapshots, Snapshots, open_snapshots
from .tables import Table, read_csv
from .units import in_si_units


def read_case(path):
    """A case file as nested dictionaries."""
    try:
        return tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise MissingResult(f"{path}: cannot be read ({error.strerror})") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise DamagedResult(f"{path}: cannot be read ({error})") from error


class Results:
    """The folder of one run, also of one that is still writing.

    Tables and the case are read once, when they are first asked for; refresh() has them read again. Raises
    MissingResult where the folder does not hold what is asked for, and DamagedResult where it is not what it should be.
    """

    def __init__(self, folder, wall_seconds=None):
        self.folder = Path(folder)
        self._wall_seconds = wall_seconds
        if not self.folder.is_dir():
            raise MissingResult(f"{self.folder}: not a folder")

    def __repr__(self):
        try:
            what = f"{self.case.get('title', 'no title')!r}, {self.case.get('method', 'no method')}"
            return f"Results({str(self.folder)!r}: {what}, {len(self.series)} rows to t = {self.series['t'][-1]:.6g})"
        except (MissingResult, IndexError):
            return f"Results({str(self.folder)!r})"

    def refresh(self):
        """Forgets what was read, so that what a run has written since is seen. Returns the run itself."""
        for name, value in vars(type(self)).items():
            if isinstance(value, cached_property):
                vars(self).pop(name, None)
        return self

    def has(self, name):
        """Whether the folder holds a file of this name."""
        return (self.folder / name).exists()

    def table(self, name, words=()):
        """A table of the run by the name of its file without ".csv"; words: its columns that hold text."""
        return self._with_units(read_csv(self.folder / f"{name}.csv", words=words))

    @cached_property
    def series(self):
        """series.csv: quantities of the whole domain, one row per step or per `series_every`."""
        return self.table("series")

    @cached_property
    def probes(self):
        """probes.csv: probes at points and planes, one row per row of the series; nan where a probe is not in liquid."""
        return self.table("probes")

    @cached_property
    def lines(self):
        """lines.csv: the profiles of all line probes; `line` gives one of them."""
        return self.table("lines", words=("name",))

    @cached_property
    def spectrum(self):
        """spectrum.csv: energy by wavenumber and time."""
        return self.table("spectrum")

    @cached_property
    def case(self):
        """The resolved case, defaults filled in, as nested dictionaries."""
        return read_case(self.folder / "case.toml")

    @cached_property
    def summary(self):
        """summary.json: final values, derived scales, versions, times."""
        return self._json("summary.json")

    @cached_property
    def ledger(self):
        """ledger.json: calls, seconds, pairs and bytes of every stage, in "stages"."""
        return self._json("ledger.json")

    @property
    def wall_seconds(self):
        """Of the process that made the run, start included where the caller timed it."""
        return self._wall_seconds if self._wall_seconds is not None else self.summary.get("wall_seconds")

    def snapshots(self, family="fluid"):
        """Snapshots of a family ("fluid", "bubbles") over time, as a sequence: particles (Snapshots), or fields on a grid
        (GridSnapshots) where the flow lives on one."""
        return open_snapshots(self.folder / f"{family}.vtkhdf")

    def grid_snapshots(self, family="fluid"):
        """Fields on a grid over time; DamagedResult where the family consists of particles."""
        return GridSnapshots(self.folder / f"{family}.vtkhdf")

    @property
    def on_grid(self):
        """Whether the flow lives on a grid and not on particles."""
        return "grid" in self.case.get("resolution", {})

    @property
    def si(self):
        """Whether the case is in SI units, and not in dimensionless groups."""
        return in_si_units(self.case)

    def line_names(self):
        """Names of the line probes, in their order."""
        return list(dict.fromkeys(self.lines["name"]))

    def line_times(self, name):
        """Times at which a line probe has profiles."""
        return np.unique(self.lines["t"][self.lines["name"] == name])

    def line(self, name, time_index=-1):
        """The profile of a line probe at one of its times: columns s, x, y, z, velocity_x, ..., pressure."""
        times = self.line_times(name)
        if not len(times):
            raise MissingResult(f"{self.lines.path}: no line '{name}'; it has {', '.join(self.line_names())}")
        rows = (self.lines["name"] == name) & (self.lines["t"] == times[time_index])
        return self._with_units(Table(self.lines.path, {key: column[rows] for key, column in self.lines.items()
                                                        if key != "name"}, self.lines.comments))

    @property
    def spacing(self):
        """Distance of particles, or of grid points where it is smallest."""
        resolution = self.case["resolution"]
        if "spacing" in resolution:
            return float(resolution["spacing"])
        lower, upper = self.bounds()
        return float(np.min((upper - lower) / np.array(resolution["grid"])))

    @property
    def dimensions(self):
        """2 or 3."""
        return len(self.case["domain"]["lower"])

    def bounds(self):
        """Lower and upper corner of the domain, in 2 or 3 numbers."""
        return np.array(self.case["domain"]["lower"], float), np.array(self.case["domain"]["upper"], float)

    def derived(self, name):
        """A scale that the run derived from its case and wrote into summary.json, such as "hinze_radius"; None when the
        run has none."""
        return self.summary.get("derived", {}).get(name)

    def _with_units(self, table):
        if self.has("case.toml"):
            table.si = self.si
            table.dimensions = len(self.case.get("domain", {}).get("lower", (0, 0, 0)))
        return table

    def _json(self, name):
        try:
            return json.loads((self.folder / name).read_text(encoding="utf-8"))
        except OSError as error:
            raise MissingResult(f"{self.folder / name}: cannot be read ({error.strerror})") from error
        except ValueError as error:
            raise DamagedResult(f"{self.folder / name}: cannot be read ({error})") from error
