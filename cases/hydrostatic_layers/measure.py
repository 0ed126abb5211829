# SPDX-License-Identifier: MIT
"""Layers at rest, p = g (rho_a (top - y) + (rho_w - rho_a) max(H - y, 0)) up to a constant, H the depth of the water. The
datum of a closed tank is free: the mean difference is taken out. Speeds over sqrt(g H), in the last tenth of the run."""
import numpy as np


def layers(run):
    density = [float(phase["density"]) for phase in run.case["phase"]]
    depth = float(run.case["region"][1]["upper"][1])
    return density[0], density[1], 1 / float(run.case["fluid"]["froude"]) ** 2, depth, float(run.case["domain"]["upper"][1])


def exact_pressure(run, y):
    water, air, g, depth, top = layers(run)
    return g * (air * (top - y) + (water - air) * np.maximum(depth - y, 0))


def errors(run):
    water, _, g, depth, _ = layers(run)
    snapshots = run.snapshots()
    last = snapshots[-1]
    y, phase = last.position[:, 1], last.field("phase")
    error = (last.field("pressure") - exact_pressure(run, y)) / (water * g * depth)
    error = error - error.mean()
    late = run.series["t"] >= 0.9 * run.series["t"][-1]
    spacing = float(run.case["resolution"]["spacing"])
    crossed = np.where(phase == 0, y - depth, depth - y) > spacing
    measured = {
        "pressure_rms": float(np.sqrt(np.mean(error**2))),
        "pressure_max": float(np.abs(error).max()),
        "speed": float(run.series["max_speed"][late].max() / np.sqrt(g * depth)),
        "crossed": float(crossed.mean()),
    }
    for name in ("water", "air"):
        centre = run.series[f"centre_{name}_y"]
        measured[f"centre_{name}"] = float(np.abs(centre - centre[0]).max() / depth)
    return measured


def measure(runs):
    return {f"{name}_{key}": value for name, run in runs.items() for key, value in errors(run).items()}


def curves(runs):
    plots = []
    for name, run in runs.items():
        last = run.snapshots()[-1]
        y = last.position[:, 1]
        order = np.argsort(y)
        exact = exact_pressure(run, y)
        pressure = last.field("pressure")
        plots.append({"file": f"{name}_pressure", "x": "y", "y": "pressure",
                      "curves": [("wcsph", y[order], (pressure - np.mean(pressure - exact))[order], "."),
                                 ("exact", y[order], exact[order], "k--")]})
    return plots
