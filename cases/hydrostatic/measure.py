# SPDX-License-Identifier: MIT
"""p = rho g (H - y), u = 0, with rho = g = H = 1."""
import numpy as np

from spume_tools.results import standard


def errors(run):
    """Pressure: largest over the snapshots after the start of the rms over particles, over rho g H."""
    worst = 0.0
    for snapshot in run.snapshots():
        if snapshot.time > 0:
            difference = snapshot.field("pressure") - (1 - snapshot.position[:, 1])
            worst = max(worst, float(np.sqrt(np.mean(difference**2))))
    series = run.series
    # The height of the centre of mass is the potential energy over the weight.
    height = series["potential_energy"] / series["mass"]
    measured = {"pressure_error": worst, "mass_drift": float(np.max(np.abs(series["mass"] / series["mass"][0] - 1)))}
    late = series["t"] >= 5
    if late.any():
        measured["late_speed"] = float(np.max(series["max_speed"][late]))
        measured["height_drift"] = float(np.ptp(height[late]))
    return measured


def measure(runs):
    return errors(standard(runs))


def curves(runs):
    last = standard(runs).snapshots()[-1]
    y = np.array([0.0, 1.0])
    return [{"file": "pressure_exact", "x": "pressure", "y": "y",
             "curves": [(f"Spume, t = {last.time:g}", last.field("pressure"), last.position[:, 1], "."),
                        ("exact", 1 - y, y, "k--")]}]
