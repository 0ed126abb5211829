# SPDX-License-Identifier: MIT
"""Surge front against Martin and Moyce (1952): Z = x_front/a against T = t sqrt(2 g/a), here a = g = 1."""
from pathlib import Path

import numpy as np

from spume_results import read_csv, standard

REFERENCE = read_csv(Path(__file__).parent / "reference" / "dambreak2d_martin_moyce_1952.csv")
LATEST = 3.0


def points(column, latest=LATEST):
    rows = (REFERENCE["a_inch"] == column) & (REFERENCE["T"] <= latest)
    return REFERENCE["T"][rows], REFERENCE["Z"][rows]


def front(run):
    return run.probes["t"] * np.sqrt(2), run.probes["front"]


def errors(run):
    """Largest relative difference of the front from the experiments up to T = 3, over both columns and for each."""
    t, z = front(run)
    measured = {"front_error": 0.0}
    for column in (1.125, 2.25):
        time, reached = points(column, min(LATEST, t[-1]))
        error = float(np.max(np.abs(np.interp(time, t, z) / reached - 1)))
        measured[f"front_error_{column:g}_inch"] = error
        measured["front_error"] = max(measured["front_error"], error)
    mass = run.series["mass"]
    measured["mass_drift"] = float(np.max(np.abs(mass / mass[0] - 1)))
    return measured


def measure(runs):
    return errors(standard(runs))


def curves(runs):
    lines = [(f"Spume, spacing {run.spacing:g}", *front(run), "-") for run in runs.values()]
    lines += [(f"Martin and Moyce, a = {c:g} in", *points(c, 3.2), style) for c, style in ((1.125, "ko"), (2.25, "ks"))]
    return [{"file": "front_experiment", "x": "T = t sqrt(2g/a)", "y": "Z = x/a", "curves": lines}]
