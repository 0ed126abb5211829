# SPDX-License-Identifier: MIT
"""Steady flow past a cylinder in a channel, 2D-1 of Schaefer and Turek (1996): coefficients of drag and lift and the
pressure difference between front and back of the cylinder, averaged over the last third of a run, against
reference/schaefer_turek_1996.csv."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

TABLE = read_reference(Path(__file__).parent / "reference" / "schaefer_turek_1996.csv", (),
                       {"case": ("2D-1", "2D-2")})
REFERENCE = {quantity: float(value) for case, quantity, value in zip(TABLE["case"], TABLE["quantity"], TABLE["value"])
             if case == "2D-1"}
DIAMETER, MEAN_SPEED = 0.1, 0.2


def coefficients(run):
    """Times, drag and lift."""
    forces = run.table("bodies")
    scale = 2 / (MEAN_SPEED**2 * DIAMETER)
    drag, lift = (scale * (forces[f"pressure_force_{axis}"] + forces[f"viscous_force_{axis}"]) for axis in "xy")
    return forces["t"], drag, lift


def measure(runs):
    values = {}
    for name, run in runs.items():
        t, drag, lift = coefficients(run)
        steady = t > 2 / 3 * t[-1]
        probes = run.probes
        late = probes["t"] > 2 / 3 * probes["t"][-1]
        difference = np.mean((probes["front_pressure"] - probes["back_pressure"])[late])
        values |= {f"{name}_drag": float(np.mean(drag[steady])),
                   f"{name}_drag_error": float(abs(np.mean(drag[steady]) / REFERENCE["C_D"] - 1)),
                   f"{name}_lift": float(np.mean(lift[steady])),
                   f"{name}_pressure_difference": float(difference),
                   f"{name}_pressure_error": float(abs(difference / REFERENCE["dp"] - 1))}
    return values


def curves(runs):
    lines, last = [], 0.0
    for name, run in runs.items():
        t, drag, _ = coefficients(run)
        last = max(last, t[-1])
        lines.append((name, t[1:], drag[1:], "-"))
    lines.append(("Schaefer and Turek (1996)", np.array([0, last]), np.full(2, REFERENCE["C_D"]), "k--"))
    return [{"file": "drag", "x": "t", "y": "drag coefficient", "curves": lines}]
