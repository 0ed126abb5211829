# SPDX-License-Identifier: MIT
"""How far the bubbles lift the surface of the column, the flow that they drive, and how fast that mixes a tracer.

What they displace follows from their sizes (`scale` of bodies.csv). The level is the mean of the elevation probes. Growth
makes the column sound, a quarter of a wave in its depth: windows are long against that period, 4 depth / c = 0.08 s.
Snapshots in step with the releases would show that sound as a mean flow, up or down by 0.04 m/s: their interval is no
simple part of the release's, and the mean over the width is taken out, for no water is lost or gained above a level.
"""
import numpy as np
from spume_tools.places import CASES
from spume_tools.verify.cases import load_measure

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
    """Mean over the height of the water of the upward velocity in columns of a centimetre, less that over the width; and
    the share of the water in a column over that of all of them."""
    width = float(run.case["domain"]["upper"][0])
    edges = np.arange(0, width + 0.005, 0.01)
    total, number = np.zeros(len(edges) - 1), np.zeros(len(edges) - 1)
    for snapshot in run.snapshots():
        if snapshot.time < STEADY:
            continue
        x, u = snapshot.position[:, 0], snapshot.field("velocity")[:, 1]
        total += np.histogram(x, edges, weights=u)[0]
        number += np.histogram(x, edges)[0]
    return (edges[1:] + edges[:-1]) / 2, total / np.maximum(number, 1) - total.sum() / number.sum(), number / number.mean()


def recirculation(run):
    """Volume that goes up, and down, a second and unit of depth: the largest stream function of the mean flow."""
    x, upward, share = circulation(run)
    return float(np.abs(np.cumsum(upward * share) * (x[1] - x[0])).max())


def tracers(run):
    return [name for name in ("tracer", "tracer_2") if f"amount_of_{name}" in run.series]


def mixing_times(run):
    """Of each tracer; and its unevenness over time."""
    column = load_measure(CASES / "bubble_column_3d")
    curves = {name: column.unevenness(run, name) for name in tracers(run)}
    return {name: column.mixing_time(*curve) for name, curve in curves.items()}, curves


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
        if tracers(run):
            mixed, curves = mixing_times(run)
            measured[f"{name}_mixing_time"] = mixed["tracer"]
            measured[f"{name}_unevenness_at_end"] = float(curves["tracer"][1][-1])
            if "tracer_2" in mixed:
                measured[f"{name}_effect_of_diffusivity"] = abs(mixed["tracer_2"] / mixed["tracer"] - 1)
    return measured


def curves(runs):
    drawn = [(f"{name}, {tracer}", *curve) for name, run in runs.items() if tracers(run)
             for tracer, curve in mixing_times(run)[1].items()]
    if not drawn:
        return []
    pulse = load_measure(CASES / "bubble_column_3d").PULSE
    return [{"file": "mixing", "x": "time since the pulse [s]", "y": "rms of the tracer's cell means over their mean", "log": "y",
             "curves": [(name, t - pulse, uneven, "-") for name, t, uneven in drawn] +
                       [("95 % mixed", [0, max(t[-1] for _, t, _ in drawn) - pulse], [0.05, 0.05], "k--")]}]
