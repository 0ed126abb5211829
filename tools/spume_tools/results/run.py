# SPDX-License-Identifier: MIT
"""The folder of one run: its tables, snapshots, resolved case, summary and ledger."""
import json
import tomllib
from functools import cached_property
from pathlib import Path

import numpy as np

from .errors import DamagedResult, MissingResult
from .snapshots import GridSnapshots, Snapshots
from .tables import Table, read_csv


def read_case(path):
    """A case file as nested dictionaries."""
    try:
        return tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise MissingResult(f"{path}: cannot be read ({error.strerror})") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise DamagedResult(f"{path}: cannot be read ({error})") from error


class Results:
    """The folder of one run. picture_times: the times that pictures show, where someone has chosen them."""

    picture_times = ()

    def __init__(self, folder, wall_seconds=None):
        self.folder = Path(folder)
        self._wall_seconds = wall_seconds
        if not self.folder.is_dir():
            raise MissingResult(f"{self.folder}: not a folder")

    def has(self, name):
        """Whether the folder holds a file of this name."""
        return (self.folder / name).exists()

    @cached_property
    def series(self):
        """series.csv: quantities of the whole domain, one row per step or per `series_every`."""
        return read_csv(self.folder / "series.csv", words=())

    @cached_property
    def probes(self):
        """probes.csv: probes at points and planes, one row per row of the series."""
        return read_csv(self.folder / "probes.csv", words=())

    @cached_property
    def lines(self):
        """lines.csv: the profiles of all line probes; `line` gives one of them."""
        return read_csv(self.folder / "lines.csv", words=("name",))

    @cached_property
    def spectrum(self):
        """spectrum.csv: energy by wavenumber and time."""
        return read_csv(self.folder / "spectrum.csv", words=())

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
        """Particles of a family ("fluid", "bubbles") over time."""
        return Snapshots(self.folder / f"{family}.vtkhdf")

    def grid_snapshots(self, family="fluid"):
        """Fields on a grid over time."""
        return GridSnapshots(self.folder / f"{family}.vtkhdf")

    @property
    def on_grid(self):
        """Whether the flow lives on a grid and not on particles."""
        return "grid" in self.case.get("resolution", {})

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
        return Table(self.lines.path, {key: column[rows] for key, column in self.lines.items() if key != "name"})

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

    def _json(self, name):
        try:
            return json.loads((self.folder / name).read_text(encoding="utf-8"))
        except OSError as error:
            raise MissingResult(f"{self.folder / name}: cannot be read ({error.strerror})") from error
        except ValueError as error:
            raise DamagedResult(f"{self.folder / name}: cannot be read ({error})") from error
