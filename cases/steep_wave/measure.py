# SPDX-License-Identifier: MIT
"""Elevation of a steady wave, probed at twenty points, against the exact profile that travels on unchanged.

Errors are in wavelengths and belong to the last period of the run. `profile_error` is the largest difference at any
point and row; `phase_error` the largest distance by which the profile would have to be moved for the smallest sum of
squares, and `shape_error` the rms of what then remains.
"""
from pathlib import Path

import numpy as np

from spume_tools.results import MissingResult, read_reference, standard

FOLDER = Path(__file__).parent / "reference"
REFERENCE = read_reference(FOLDER / "steady_wave.csv", ("harmonic", "elevation", "velocity"))
SPEED = REFERENCE["velocity"][0]
PERIOD = 1 / SPEED
PROBES = [f"eta_{k:02d}" for k in range(20)]
POINTS = np.arange(20) / 20


def profile(x):
    """Exact elevation at distances x from a crest."""
    return np.cos(2 * np.pi * np.asarray(x)[..., None] * REFERENCE["harmonic"]) @ REFERENCE["elevation"]


def slope(x):
    k = 2 * np.pi * REFERENCE["harmonic"]
    return -np.sin(np.asarray(x)[..., None] * k) @ (k * REFERENCE["elevation"])


def lag(x, elevation):
    """Distance by which the exact profile at x is to be moved forward to fit the elevations, by Gauss-Newton."""
    distance = 0.0
    for _ in range(20):
        gradient = -slope(x - distance)
        distance += gradient @ (elevation - profile(x - distance)) / (gradient @ gradient)
    return distance


def elevations(run):
    """Times and elevations [time, probe] of the last period of a run."""
    t = run.probes["t"]
    rows = t > t[-1] - PERIOD * 1.0001
    if t[-1] < 0.999 * PERIOD:
        raise MissingResult(f"{run.folder}: the run is shorter than a period of {PERIOD:.4g}")
    return t[rows], np.column_stack([run.probes[name] for name in PROBES])[rows]


def errors(run):
    t, eta = elevations(run)
    x = POINTS - SPEED * t[:, None]
    lags = np.array([lag(row, values) for row, values in zip(x, eta)])
    series = run.series
    return {
        "profile_error": float(np.max(np.abs(eta - profile(x)))),
        "phase_error": float(np.max(np.abs(lags))),
        "shape_error": float(np.sqrt(np.mean((eta - profile(x - lags[:, None]))**2))),
        "kinetic_energy_ratio": float(series["kinetic_energy"][-1] / series["kinetic_energy"][0]),
        "mass_drift": float(np.max(np.abs(series["mass"] / series["mass"][0] - 1))),
    }


def measure(runs):
    return errors(standard(runs))


def curves(runs):
    run = standard(runs)
    t, eta = elevations(run)
    distance = (POINTS - SPEED * t[-1] + 0.5) % 1 - 0.5
    order, x = np.argsort(distance), np.linspace(-0.5, 0.5, 201)
    return [{"file": "profile_exact", "x": "distance from the crest / wavelength", "y": "elevation / wavelength",
             "curves": [("Spume, at the end", distance[order], eta[-1][order], "o"),
                        ("exact", x, profile(x), "k-")]}]
