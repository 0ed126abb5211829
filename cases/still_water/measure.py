# SPDX-License-Identifier: MIT
"""u = 0, whatever the solids are."""
import numpy as np

GRAVITY, DEPTH = 9.81, 0.4


def measure(runs):
    """Over all runs: the largest speed over sqrt(g H), and the largest relative change of the mass."""
    speed = mass = 0.0
    for run in runs.values():
        series = run.series
        speed = max(speed, float(np.max(series["max_speed"])) / np.sqrt(GRAVITY * DEPTH))
        mass = max(mass, float(np.max(np.abs(series["mass"] / series["mass"][0] - 1))))
    return {"largest_speed": speed, "mass_error": mass}
