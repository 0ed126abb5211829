# SPDX-License-Identifier: MIT
"""u = -exp(-8 pi^2 t/Re) cos(2 pi x) sin(2 pi y), v = exp(-8 pi^2 t/Re) sin(2 pi x) cos(2 pi y),
K = exp(-16 pi^2 t/Re)/4."""
import numpy as np

from spume_tools.results import observed_order, relative_rms, standard


def reynolds(run):
    return float(run.case["fluid"]["reynolds"])


def exact_velocity(position, t, re):
    x, y = 2 * np.pi * position[:, 0], 2 * np.pi * position[:, 1]
    return np.exp(-8 * np.pi**2 * t / re) * np.column_stack([-np.cos(x) * np.sin(y), np.sin(x) * np.cos(y)])


def errors(run):
    """Velocity: rms over the particles at the end over the initial amplitude 1. Decay: slope of ln K over t > 0.1."""
    last = run.snapshots()[-1]
    exact = exact_velocity(last.position, last.time, reynolds(run))
    t, energy = run.series["t"], run.series["kinetic_energy"]
    late = t >= 0.1
    rate = np.polyfit(t[late], np.log(energy[late]), 1)[0]
    return {
        "velocity_error": relative_rms(last.field("velocity")[:, :2], exact, 1.0),
        "decay_rate_error": abs(rate / (-16 * np.pi**2 / reynolds(run)) - 1),
    }


def measure(runs):
    measured = errors(standard(runs))
    if len(runs) > 1:
        spacings = [run.spacing for run in runs.values()]
        measured["observed_order"] = observed_order(spacings, [errors(run)["velocity_error"] for run in runs.values()])
        for name, run in runs.items():
            measured[f"velocity_error_{name}"] = errors(run)["velocity_error"]
    return measured


def curves(runs):
    t = np.linspace(0, max(run.series["t"][-1] for run in runs.values()), 200)
    lines = [(f"spacing {run.spacing:g}", run.series["t"], run.series["kinetic_energy"], "-") for run in runs.values()]
    lines.append(("exact", t, 0.25 * np.exp(-16 * np.pi**2 * t / reynolds(standard(runs))), "k--"))
    return [{"file": "kinetic_energy_exact", "x": "t", "y": "kinetic energy", "log": "y", "curves": lines}]
