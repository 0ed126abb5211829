# SPDX-License-Identifier: MIT
"""Snapshots of a run: VTKHDF files with temporal data, as particles or as fields on a grid."""
from pathlib import Path

import numpy as np

from .errors import DamagedResult, MissingResult


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
        return len(self.position)


class GridSnapshot(Fields):
    """Fields on a uniform grid at one time: fields by name, (nx, ny, nz) or (nx, ny, nz, components)."""

    def __init__(self, time, origin, spacing, fields):
        super().__init__(time, fields)
        self.origin = origin
        self.spacing = spacing

    def field(self, name):
        """As Fields.field; "enstrophy" is the square of the vorticity."""
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
        """The step nearest to a time."""
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
