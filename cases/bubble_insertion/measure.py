# SPDX-License-Identifier: MIT
"""Norm of the shift after a bubble has appeared: its peak against the bubble's radius, and how fast it decays."""
import numpy as np

from spume_results import standard


def peak(run):
    """Index and value of the largest root-mean-square shift velocity."""
    norm = run.series["shift_norm"]
    k = int(np.argmax(norm))
    return k, norm[k]


def decay_time(run):
    """In steps: the time constant of an exponential through the peak and the step after it."""
    k, value = peak(run)
    return float(1 / np.log(value / run.series["shift_norm"][k + 1]))


def radius(run):
    return float(run.case["bubble_cloud"][0]["bubble_radius"]) / run.spacing


def measure(runs):
    main = {name: run for name, run in runs.items() if name != "drift_removed"}
    run = standard(main)
    measured = {"decay_time": decay_time(run),
                **{f"decay_time_{name}": decay_time(r) for name, r in main.items() if r is not run},
                "speed": max(float(r.series["max_speed"].max()) for r in runs.values()),
                "pressure": max(float(np.abs(s.field("pressure")).max()) for s in run.snapshots())}
    if len(main) > 2:
        measured["peak_exponent"] = float(np.polyfit(np.log([radius(r) for r in main.values()]),
                                                     np.log([peak(r)[1] for r in main.values()]), 1)[0])
    if "drift_removed" in runs:
        measured["decay_time_drift_removed"] = decay_time(runs["drift_removed"])
    return measured


def curves(runs):
    lines = []
    for name, run in runs.items():
        k, _ = peak(run)
        norm = run.series["shift_norm"][k:]
        lines.append((f"a / dr = {radius(run):.1f}" + (", drift removed" if name == "drift_removed" else ""),
                      np.arange(len(norm)), norm, "-"))
    n = np.arange(5)
    k, value = peak(standard(runs))
    lines.append(("exp(-1.5 n)", n, value * np.exp(-1.5 * n), "--"))
    return [{"file": "shift_norm", "x": "steps since the bubble appeared", "y": "rms shift velocity", "curves": lines,
             "log": "y"}]
