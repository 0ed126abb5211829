# SPDX-License-Identifier: MIT
"""How far the bubbles lift the surface of the column, and the flow that they drive.

What they displace follows from their sizes (`scale` of bodies.csv). The level is the mean of the elevation probes. Growth
makes the column sound, a quarter of a wave in its depth: windows are long against that period, 4 depth / c = 0.08 s.
"""
import numpy as np

FLAT = (0.5, 1.3)  # before the first bubble reaches the surface, at 1.4 s
STEADY = 1.6  # from then on as many are taken away as set out


def area_of_one(run):
    a, b = (float(axis) for axis in run.case["body"][0]["semi_axes"])
    return np.pi * a * b


def displaced(run):
    """Times, and the area of the bubbles then."""
    rows = run.table("bodies")
    times, index = np.unique(rows["t"], return_inverse=True)
    return times, np.bincount(index, area_of_one(run) * rows["scale"] ** 2)


def level(run):
    names = [name for name in run.probes if name.startswith("level_")]
    return run.probes["t"], np.mean([run.probes[name] for name in names], axis=0)


def circulation(run):
    """Mean over the height of the water of the mean upward velocity, columns of a centimetre."""
    width = float(run.case["domain"]["upper"][0])
    edges = np.arange(0, width + 0.005, 0.01)
    total, number = np.zeros(len(edges) - 1), np.zeros(len(edges) - 1)
    for snapshot in run.snapshots():
        if snapshot.time < STEADY:
            continue
        x, u = snapshot.position[:, 0], snapshot.field("velocity")[:, 1]
        total += np.histogram(x, edges, weights=u)[0]
        number += np.histogram(x, edges)[0]
    return (edges[1:] + edges[:-1]) / 2, total / np.maximum(number, 1)


def recirculation(run):
    """Volume that goes up, and down, a second and unit of depth: the largest stream function of the mean flow."""
    x, upward = circulation(run)
    return float(np.abs(np.cumsum(upward) * (x[1] - x[0])).max())


def measure(runs):
    measured = {}
    for name, run in runs.items():
        width = float(run.case["domain"]["upper"][0])
        times, area = displaced(run)
        t, height = level(run)
        lift, due = height - height[0], np.interp(t, times, area) / width
        flat = (t >= FLAT[0]) & (t < FLAT[1])
        measured[f"{name}_lift_error"] = float(abs(lift[flat].mean() / due[flat].mean() - 1))
        steady = t >= STEADY
        if steady.any():
            measured[f"{name}_steady_lift_error"] = float(abs(lift[steady].mean() / due[steady].mean() - 1))
            measured[f"{name}_bubbles"] = float(due[steady].mean() * width / area_of_one(run))
            measured[f"{name}_upflow"] = float(np.abs(circulation(run)[1]).max())
            measured[f"{name}_recirculation"] = recirculation(run)
    return measured
