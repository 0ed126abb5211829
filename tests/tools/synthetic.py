# SPDX-License-Identifier: MIT
"""Writes run folders in the program's own formats from functions of position and time, for the tests of the tools."""
import json
from pathlib import Path

import h5py
import numpy as np


def toml_value(value):
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(v) for v in value) + "]"
    return repr(value).lower() if isinstance(value, bool) else repr(value)


def write_case(folder, title, lower, upper, spacing, **domain):
    sides = "\n".join(f"{key} = {toml_value(value)}" for key, value in domain.items())
    (folder / "case.toml").write_text(
        f'title = "{title}"\nmethod = "les-sph"\n[domain]\nlower = {list(lower)}\nupper = {list(upper)}\n{sides}\n'
        f"[resolution]\nspacing = {spacing}\n", encoding="utf-8")


def write_table(path, columns, units=None):
    lines = [f"# {name}: {unit}" for name, unit in (units or {}).items()]
    lines.append(",".join(columns))
    for row in zip(*columns.values()):
        lines.append(",".join(value if isinstance(value, str) else f"{value:.12g}" for value in row))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def lattice(lower, upper, spacing):
    axes = [np.arange(a + spacing / 2, b, spacing) for a, b in zip(lower, upper)]
    return np.column_stack([g.ravel() for g in np.meshgrid(*axes, indexing="ij")])


def write_snapshots(path, times, position, fields):
    """position(t) -> (N, 2 or 3); fields: name -> f(position, t). VTKHDF PolyData with temporal steps."""
    points, data, counts = [], {name: [] for name in fields}, []
    for t in times:
        p = position(t)
        points.append(np.pad(p, ((0, 0), (0, 3 - p.shape[1]))))
        counts.append(len(p))
        for name, f in fields.items():
            values = np.asarray(f(p, t))
            if name == "velocity":
                values = np.pad(values, ((0, 0), (0, 3 - values.shape[1])))
            data[name].append(values)
    number = np.array(counts, "i8")
    first = np.concatenate([[0], np.cumsum(number)[:-1]])
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 0], "i8")
        root.attrs.create("Type", np.array(b"PolyData", dtype="S8"))
        root["NumberOfPoints"] = number
        root["Points"] = np.concatenate(points).astype("f4")
        for name, parts in data.items():
            root[f"PointData/{name}"] = np.concatenate(parts).astype("f4")
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = np.int64(len(times))
        steps["Values"] = np.asarray(times, float)
        steps["PointOffsets"] = first


def write_grid_snapshots(path, times, points, spacing, fields, origin=(0.0, 0.0, 0.0)):
    """fields: name -> f(x, y, z, t) on the grid of (nx, ny, nz) points. VTKHDF ImageData with temporal steps."""
    x, y, z = np.meshgrid(*(o + spacing * np.arange(n) for o, n in zip(origin, points)), indexing="ij")
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array([2, 0], "i8")
        root.attrs.create("Type", np.array(b"ImageData", dtype="S9"))
        root.attrs["WholeExtent"] = np.array([v for n in points for v in (0, n - 1)], "i8")
        root.attrs["Origin"], root.attrs["Spacing"] = np.array(origin), np.full(3, float(spacing))
        for name, f in fields.items():
            root[f"PointData/{name}"] = np.stack([np.swapaxes(f(x, y, z, t), 0, 2) for t in times]).astype("f4")
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = np.int64(len(times))
        steps["Values"] = np.asarray(times, float)


def series_of(times, **columns):
    t = np.asarray(times, float)
    base = {"step": np.arange(len(t)), "t": t, "dt": np.full(len(t), t[1] - t[0] if len(t) > 1 else 1.0)}
    return base | {name: np.broadcast_to(np.asarray(values, float), t.shape) for name, values in columns.items()}


def new_folder(parent, name):
    folder = Path(parent) / name
    folder.mkdir()
    return folder
