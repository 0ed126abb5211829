# SPDX-License-Identifier: MIT
"""Surge front against Martin and Moyce (1952) and against potential flow: Z = x_front/a against T = t sqrt(2 g/a), here
a = g = 1.

The clock of the experiment does not start when the liquid does: potential flow from rest (reference/ideal_release.py)
leads every measured point, by the same time in the mean of each column. The mean lead of potential flow is taken off the
measured times; Spume's own result has no part in it.
"""
from pathlib import Path

import numpy as np

from spume_tools.results import read_reference, standard

FOLDER = Path(__file__).parent / "reference"
REFERENCE = read_reference(FOLDER / "dambreak2d_martin_moyce_1952.csv", ("a_inch", "T", "Z"))
IDEAL = read_reference(FOLDER / "ideal_release.csv", ("T", "Z"))
COLUMNS = (1.125, 2.25)
LATEST = 3.0


def points(column, latest=LATEST):
    rows = (REFERENCE["a_inch"] == column) & (REFERENCE["T"] <= latest)
    return REFERENCE["T"][rows], REFERENCE["Z"][rows]


def front(run):
    return run.probes["t"] * np.sqrt(2), run.probes["front"]


def release_delay(column):
    """Mean time by which potential flow reaches the measured places of a column before the experiment."""
    time, reached = points(column)
    return float(np.mean(time - np.interp(reached, IDEAL["Z"], IDEAL["T"])))


def largest_error(run, time, reached):
    t, z = front(run)
    seen = time <= t[-1]
    return float(np.max(np.abs(np.interp(time[seen], t, z) / reached[seen] - 1)))


def errors(run):
    """Largest relative differences of the front up to T = 3."""
    measured = {"front_error": 0.0, "front_error_potential_flow": largest_error(run, IDEAL["T"], IDEAL["Z"])}
    for column in COLUMNS:
        time, reached = points(column)
        error = largest_error(run, time - release_delay(column), reached)
        measured["front_error"] = max(measured["front_error"], error)
        measured[f"front_error_{column:g}_inch"] = error
        measured[f"front_error_{column:g}_inch_published_clock"] = largest_error(run, time, reached)
    mass = run.series["mass"]
    measured["mass_drift"] = float(np.max(np.abs(mass / mass[0] - 1)))
    return measured


def measure(runs):
    return errors(standard(runs))


def curves(runs):
    lines = [(f"Spume, spacing {run.spacing:g}", *front(run), "-") for run in runs.values()]
    lines.append(("potential flow", IDEAL["T"], IDEAL["Z"], "k--"))
    for column, style in zip(COLUMNS, ("ko", "ks")):
        time, reached = points(column, 3.2)
        delay = release_delay(column)
        lines.append((f"Martin and Moyce, a = {column:g} in, T - {delay:.2f}", time - delay, reached, style))
    return [{"file": "front_experiment", "x": "T = t sqrt(2g/a)", "y": "Z = x/a", "curves": lines}]
