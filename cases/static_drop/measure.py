# SPDX-License-Identifier: MIT
"""The pressure jump of a drop at rest, sigma / R in two dimensions and 2 sigma / R in three (Young and Laplace), and the
speed of the parasitic currents. R is that of the volume of the drop, which its particles tell exactly. A drop that touches
lower sides is cut by them: they are planes of symmetry through its centre."""
import numpy as np

# In spacings from the interface: beyond the supports in which properties vary.
AWAY = 5.0


def distances(run, position, inside):
    """From the centre of the drop, and its radius."""
    lower, upper = (np.array(run.case["domain"][key], dtype=float) for key in ("lower", "upper"))
    position = position[:, : len(lower)]
    drop = position[inside]
    cut = drop.min(axis=0) < lower + float(run.case["resolution"]["spacing"])
    volume = float(np.prod(upper - lower)) * inside.mean() * 2 ** cut.sum()
    radius = np.sqrt(volume / np.pi) if len(lower) == 2 else np.cbrt(3 * volume / (4 * np.pi))
    return np.linalg.norm(position - np.where(cut, lower, drop.mean(axis=0)), axis=1), radius


def tension(run):
    return float(run.case["interface"]["surface_tension"])


def jump(run):
    snapshot = run.snapshots()[-1]
    inside = snapshot.field("phase") == 1
    position, pressure = snapshot.position, snapshot.field("pressure")
    r, size = distances(run, position, inside)
    distance = r - size
    away = AWAY * float(run.case["resolution"]["spacing"])
    difference = pressure[distance < -away].mean() - pressure[distance > away].mean()
    dimensions = len(run.case["domain"]["lower"])
    return difference / ((dimensions - 1) * tension(run) / size)


def capillary_number(run):
    """Of the largest speed in the second half of the run and the larger viscosity. The first half evens out the steps of
    the lattice that the drop was cut from."""
    speed = np.array([np.linalg.norm(s.field("velocity"), axis=1).max() for s in run.snapshots()])
    viscosity = max(float(phase["viscosity"]) for phase in run.case["phase"])
    return viscosity * float(speed[len(speed) // 2 :].max()) / tension(run)


def measure(runs):
    measured = {}
    for name, run in runs.items():
        measured[f"{name}_jump"] = float(jump(run))
        measured[f"{name}_jump_error"] = abs(float(jump(run)) - 1)
        measured[f"{name}_capillary_number"] = capillary_number(run)
    if "fine" in runs and "ratio_1" in runs:
        measured["parasitic_growth"] = measured["fine_capillary_number"] / measured["ratio_1_capillary_number"]
    return measured


def curves(runs):
    lines = []
    for name, run in runs.items():
        snapshot = run.snapshots()[-1]
        inside = snapshot.field("phase") == 1
        r, _ = distances(run, snapshot.position, inside)
        lines.append((name, r, snapshot.field("pressure"), "."))
    return [{"file": "pressure", "x": "distance from the centre", "y": "pressure", "curves": lines}]
