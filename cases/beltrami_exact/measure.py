# SPDX-License-Identifier: MIT
"""u = U + exp(-nu k^2 t) ABC(x - U t): exact decay, and the order of every integrator from the stream that carries it."""
import numpy as np

from spume_tools.results import standard

WAVENUMBER = 2 * np.pi


def exact_velocity(position, t, nu, stream):
    """ABC flow with A = B = C = 1 at one point at times t, (len(t), 3)."""
    mean = np.array([stream, stream / 2, 0.0])
    x, y, z = (WAVENUMBER * (position[axis] - mean[axis] * np.asarray(t)) for axis in range(3))
    shape = np.stack([np.sin(z) + np.cos(y), np.sin(x) + np.cos(z), np.sin(y) + np.cos(x)], axis=-1)
    return mean + np.exp(-nu * WAVENUMBER**2 * np.asarray(t))[:, None] * shape


def velocity_error(run):
    """Largest difference of the probes from the exact velocity at the end of the run."""
    nu, stream = 1 / float(run.case["fluid"]["reynolds"]), float(run.case["constants"]["stream"])
    worst = 0.0
    for probe in run.case["probe"]:
        measured = np.stack([run.probes[f"{probe['name']}_velocity_{axis}"] for axis in "xyz"], axis=-1)
        exact = exact_velocity(probe["position"], run.probes["t"], nu, stream)
        worst = max(worst, float(np.max(np.abs(measured[-1] - exact[-1]))))
    return worst


def decay_error(run):
    """Largest relative error of the energy of the part that decays; the stream keeps its own."""
    nu, stream = 1 / float(run.case["fluid"]["reynolds"]), float(run.case["constants"]["stream"])
    exact = 1.5 * np.exp(-2 * nu * WAVENUMBER**2 * run.series["t"]) + 0.5 * 1.25 * stream**2
    return float(np.max(np.abs(run.series["mean_energy"] / exact - 1)))


def errors(run):
    return {"decay_error": decay_error(run), "velocity_error": velocity_error(run)}


def measure(runs):
    measured = {"decay_error": decay_error(runs.get("still") or standard(runs))}
    for name in ("ab2", "rk3", "rk4"):
        if f"{name}-1" in runs and f"{name}-2" in runs:
            coarse, fine = velocity_error(runs[f"{name}-1"]), velocity_error(runs[f"{name}-2"])
            measured[f"velocity_error_{name}"] = fine
            measured[f"order_{name}"] = float(np.log2(coarse / fine))
    return measured


def curves(runs):
    run = standard(runs)
    t = run.series["t"]
    nu, stream = 1 / float(run.case["fluid"]["reynolds"]), float(run.case["constants"]["stream"])
    exact = 1.5 * np.exp(-2 * nu * WAVENUMBER**2 * t) + 0.5 * 1.25 * stream**2
    return [{"file": "energy_exact", "x": "t", "y": "mean energy", "log": "y",
             "curves": [("Spume", t, run.series["mean_energy"], "-"), ("exact", t, exact, "k--")]}]
