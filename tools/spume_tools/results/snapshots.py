# SPDX-License-Identifier: MIT
"""Snapshots of a run: VTKHDF files with temporal data, as particles or as fields on a grid."""
import time
from pathlib import Path

import numpy as np

from .errors import DamagedResult, MissingResult

PATIENCE = 5.0  # seconds that a snapshot may take to be written while it is being read
PAUSE = 0.05


class Fields:
    """Fields by name at one time."""

    def __init__(self, time, fields):
        self.time = time
        self.fields = fields

    def field(self, name):
        """A field by name; "speed" is the magnitude of the velocity. MissingResult when there is none."""
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
        """The number of particles."""
        return len(self.position)

    def __repr__(self):
        return f"Snapshot(t = {self.time:g}: {len(self)} particles with {', '.join(self.fields)})"


class GridSnapshot(Fields):
    """Fields on a uniform grid at one time: fields by name, (nx, ny, nz) or (nx, ny, nz, components).

    origin, spacing: place of the first point and distances of the points, three numbers each.
    """

    def __init__(self, time, origin, spacing, fields):
        super().__init__(time, fields)
        self.origin = origin
        self.spacing = spacing

    def __repr__(self):
        shape = " x ".join(map(str, next(iter(self.fields.values())).shape[:3])) if self.fields else "no"
        return f"GridSnapshot(t = {self.time:g}: {shape} points with {', '.join(self.fields)})"

    def axis(self, k):
        """Coordinates of the points along axis 0, 1 or 2."""
        return self.origin[k] + self.spacing[k] * np.arange(next(iter(self.fields.values())).shape[k])

    def field(self, name):
        """As Fields.field; "enstrophy" is the square of the vorticity."""
        if name == "enstrophy":
            return np.sum(self.field("vorticity") ** 2, axis=-1)
        return super().field(name)


class Steps:
    """The steps that a VTKHDF file with temporal data held when it was opened, as a sequence of snapshots that are read
    when they are asked for. times: of all steps; names: of the fields. A run may go on writing to the file."""

    contents = None  # what the file should hold, for the message

    def __init__(self, path):
        self.path = Path(path)
        if not self.path.exists():
            raise MissingResult(f"{self.path}: not there; set output.every in the case to have snapshots written")
        self._consistent(self._read_head, lambda error: f"not a VTKHDF file {self.contents} ({error})")

    def __len__(self):
        return len(self.times)

    def __repr__(self):
        span = f", t = {self.times[0]:g} to {self.times[-1]:g}" if len(self) else ""
        return f"{type(self).__name__}({str(self.path)!r}: {len(self)} steps{span}, {', '.join(self.names)})"

    def __getitem__(self, index):
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        step = int(index) % len(self)
        return self._consistent(lambda root: self._read(root, step), lambda error: f"step {step} cannot be read ({error})")

    def nearest(self, time):
        """The step nearest to a time."""
        if not len(self):
            raise MissingResult(f"{self.path}: holds no step yet")
        return self[int(np.argmin(np.abs(self.times - time)))]

    def _read_head(self, root):
        steps = root["Steps"]
        times = np.array(steps["Values"], dtype=float)[: int(steps.attrs["NSteps"])]
        self.names = list(root["PointData"]) if "PointData" in root else []
        self._read_layout(root)
        self.times = times

    def _state(self):
        """Changes while a snapshot is written: size and time of the file, and the journal that the program keeps."""
        status = self.path.stat()
        return status.st_size, status.st_mtime_ns, self.path.with_name(self.path.name + ".journal").exists()

    def _consistent(self, read, message):
        """read(root) of a file that nobody writes to meanwhile. A snapshot that is being written is waited for."""
        import h5py

        until = time.monotonic() + PATIENCE
        while True:
            before, failure = self._state(), None
            try:
                # A run that is writing holds the lock.
                with h5py.File(self.path, "r", locking=False) as file:
                    result = read(file["VTKHDF"])
            except (OSError, KeyError, RuntimeError, ValueError) as error:
                failure = error
                time.sleep(PAUSE)
            after = self._state()
            if (before == after and not after[2]) or time.monotonic() > until:
                if failure is not None:
                    raise DamagedResult(f"{self.path}: {message(failure)}") from failure
                return result
            time.sleep(PAUSE)


class Snapshots(Steps):
    """Particles: PolyData, each step a Snapshot."""

    contents = "with steps of particles"

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


class _AnySteps(Steps):
    """Tells which kind a file is of."""

    contents = "with steps"

    def _read_layout(self, root):
        self.on_grid = "WholeExtent" in root.attrs


def open_snapshots(path):
    """The snapshots of a file: GridSnapshots where it holds fields on a grid, else Snapshots."""
    return (GridSnapshots if _AnySteps(path).on_grid else Snapshots)(path)
