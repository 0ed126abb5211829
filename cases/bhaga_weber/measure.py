# SPDX-License-Identifier: MIT
"""Terminal Reynolds number rho U D / mu of the bubble against the correlation of Bhaga and Weber (1981) and their
measurement, and its shape. A quarter is computed, on the axis x = y = 0."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

TABLE = read_reference(Path(__file__).parent / "reference" / "bhaga_weber.csv",
                       ("Eo", "Re_star", "Re_corr", "Re_exp_RECALLED"))
LAST = 1.0  # the speed is the mean over as much time at the end


def published(run, quantity):
    """Of the row with the Eotvos number of the run and the nearest Re* = sqrt(g D) D / nu."""
    liquid, tension = run.case["phase"][0], float(run.case["interface"]["surface_tension"])
    eotvos, star = float(liquid["density"]) / tension, float(liquid["density"]) / float(liquid["viscosity"])
    rows = np.isclose(TABLE["Eo"], eotvos, rtol=1e-2)
    nearest = np.argmin(np.abs(TABLE["Re_star"][rows] / star - 1))
    if abs(TABLE["Re_star"][rows][nearest] / star - 1) > 0.01:
        raise ValueError(f"no row of bhaga_weber.csv has Eo = {eotvos:.4g} and Re* = {star:.4g}")
    return float(TABLE[quantity][rows][nearest])


def speed(run):
    """Mean over the last unit of time, and by how much its second half differs from the first, over it."""
    t, values = np.asarray(run.series["t"]), np.asarray(run.series["velocity_bubble_z"])
    last, late = t >= t[-1] - LAST, t >= t[-1] - LAST / 2
    mean = float(values[last].mean())
    return mean, float(values[late].mean() - values[last & ~late].mean()) / mean


def size(snapshot):
    """Width and height of the ellipsoid that has the second moments of the bubble."""
    bubble = snapshot.position[snapshot.field("phase") == 1]
    across = (bubble[:, 0] ** 2 + bubble[:, 1] ** 2) / 2
    return float(2 * np.sqrt(5 * across.mean())), float(2 * np.sqrt(5 * bubble[:, 2].var()))


def measure(runs):
    measured = {}
    for name, run in runs.items():
        liquid = run.case["phase"][0]
        mean, growth = speed(run)
        reynolds = mean * float(liquid["density"]) / float(liquid["viscosity"])
        width, height = size(run.snapshots()[-1])
        measured.update({f"{name}_reynolds": reynolds,
                         f"{name}_reynolds_error": abs(reynolds / published(run, "Re_corr") - 1),
                         f"{name}_difference_from_experiment": reynolds / published(run, "Re_exp_RECALLED") - 1,
                         f"{name}_growth": growth, f"{name}_width": width, f"{name}_height": height})
    return measured


def curves(runs):
    lines = []
    for name, run in runs.items():
        liquid = run.case["phase"][0]
        star = float(liquid["density"]) / float(liquid["viscosity"])
        t = np.asarray(run.series["t"])
        lines.append((f"Spume, {name}", t, star * np.asarray(run.series["velocity_bubble_z"]), "-"))
        lines.append((f"correlation, {name}", t[[0, -1]], np.full(2, published(run, "Re_corr")), "k--"))
    return [{"file": "reynolds", "x": "t sqrt(g / D)", "y": "Re = rho u D / mu", "curves": lines}]
