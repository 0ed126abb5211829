# SPDX-License-Identifier: MIT
"""In vortices with the stream function psi ~ cos(2 pi x) cos(2 pi y) a scalar 1 + cos(2 pi x) cos(2 pi y) is not
stirred: c = 1 + exp(-8 pi^2 D t) cos(2 pi x) cos(2 pi y)."""
import numpy as np

from spume_tools.results import relative_rms, standard

NAMES = ("dye", "slow_dye")


def diffusivity(run, name):
    return next(float(scalar["diffusivity"]) for scalar in run.case["scalar"] if scalar["name"] == name)


def shape(position):
    return np.cos(2 * np.pi * position[:, 0]) * np.cos(2 * np.pi * position[:, 1])


def error(run, name):
    """rms over the particles at the end over the initial amplitude 1."""
    last = run.snapshots()[-1]
    exact = 1 + np.exp(-8 * np.pi**2 * diffusivity(run, name) * last.time) * shape(last.position)
    return relative_rms(last.field(name), exact, 1.0)


def errors(run):
    measured = {f"{name}_error": error(run, name) for name in NAMES}
    amounts = [run.series[f"amount_of_{name}"] for name in (*NAMES, "layers")]
    measured["amount_change"] = max(float(np.max(np.abs(amount / amount[0] - 1))) for amount in amounts)
    layers = np.concatenate([snapshot.field("layers") for snapshot in run.snapshots()])
    measured["new_extrema"] = float(max(0.0, -layers.min(), layers.max() - 1))
    return measured


def measure(runs):
    measured = errors(standard(runs))
    if len(runs) > 1:
        for name, run in runs.items():
            for scalar in NAMES:
                measured[f"{scalar}_error_{name}"] = error(run, scalar)
    return measured


def amplitude(run, name):
    """Projection on the exact shape, per snapshot."""
    def of(snapshot):
        form = shape(snapshot.position)
        return float(np.dot(snapshot.field(name) - 1, form) / np.dot(form, form))
    snapshots = run.snapshots()
    return [snapshot.time for snapshot in snapshots], [of(snapshot) for snapshot in snapshots]


def curves(runs):
    run = standard(runs)
    t = np.linspace(0, run.series["t"][-1], 200)
    lines = []
    for name in NAMES:
        lines.append((name, *amplitude(run, name), "o"))
        lines.append((f"{name}, exact", t, np.exp(-8 * np.pi**2 * diffusivity(run, name) * t), "k--"))
    return [{"file": "amplitude_exact", "x": "t", "y": "amplitude", "log": "y", "curves": lines}]
