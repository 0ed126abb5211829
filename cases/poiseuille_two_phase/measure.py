# SPDX-License-Identifier: MIT
"""Start-up of the flow of two fluids between plates at y = -1 and 1, mu = chi for y < 0 and 1 for y > 0, rho = G = 1.

Steady (Bird, Stewart & Lightfoot; values in reference/poiseuille_two_phase.csv): mu u' = c - y, u(-1) = u(1) = 0.
Start-up: u_t = 1 + (mu u')' by finite volumes, 800 cells with the harmonic mean of mu at their faces, exact in time by
their eigenvectors; their steady profile is within 2e-6 of the peak.
"""
import functools

import numpy as np

CELLS = 800


def steady(y, chi):
    """From mu u' = c - y and u(-1) = u(1) = 0: u = (c y - y^2/2)/mu + d."""
    lower, upper = 1 / chi, 1.0
    # u(-1) = (-c - 1/2)/chi + d = 0, u(1) = c - 1/2 + d = 0
    c = (upper - lower) / (2 * (upper + lower))
    d = 0.5 - c
    return (c * y - y**2 / 2) / np.where(y < 0, chi, 1.0) + d


@functools.lru_cache(maxsize=4)
def modes(chi):
    """Rates, modes and their shares of a unit force."""
    width = 2 / CELLS
    mu = np.where(np.arange(CELLS) < CELLS // 2, chi, 1.0)
    face = 2 * mu[1:] * mu[:-1] / (mu[1:] + mu[:-1]) / width**2
    below = np.concatenate([[2 * mu[0] / width**2], face])
    above = np.concatenate([face, [2 * mu[-1] / width**2]])
    matrix = np.diag(below + above) - np.diag(face, 1) - np.diag(face, -1)
    rate, vector = np.linalg.eigh(matrix)
    return rate, vector, vector.sum(axis=0)


def startup(y, t, chi):
    rate, vector, share = modes(chi)
    width = 2 / CELLS
    centre = -1 + (np.arange(CELLS) + 0.5) * width
    profile = vector @ (share * (1 - np.exp(-rate * t)) / rate)
    at = np.concatenate([[-1], centre, [1]])
    return np.interp(y, at, np.concatenate([[0], profile, [0]]))


def ratio(run):
    phases = run.case["phase"]
    return float(phases[0]["viscosity"]) / float(phases[1]["viscosity"])


def errors(run):
    """Largest over the snapshots of the rms over particles, and of the largest error, over the steady peak."""
    chi = ratio(run)
    peak = float(np.max(steady(np.linspace(-1, 1, 2001), chi)))
    rms, largest, across = 0.0, 0.0, 0.0
    for snapshot in run.snapshots():
        if snapshot.time <= 0:
            continue
        velocity = snapshot.field("velocity")
        difference = velocity[:, 0] - startup(snapshot.position[:, 1], snapshot.time, chi)
        rms = max(rms, float(np.sqrt(np.mean(difference**2))) / peak)
        largest = max(largest, float(np.max(np.abs(difference))) / peak)
        across = max(across, float(np.max(np.abs(velocity[:, 1]))) / peak)
    return {"error": rms, "largest_error": largest, "cross_flow": across}


def measure(runs):
    measured = {f"{name}_{quantity}": value for name, run in runs.items() for quantity, value in errors(run).items()}
    for name in runs:
        coarse = f"{name}_coarse"
        if coarse in runs:
            spacing = [float(runs[key].case["resolution"]["spacing"]) for key in (coarse, name)]
            error = [measured[f"{key}_error"] for key in (coarse, name)]
            measured[f"{name}_order"] = float(np.log(error[0] / error[1]) / np.log(spacing[0] / spacing[1]))
    return measured


def curves(runs):
    figures = []
    for name, run in runs.items():
        chi = ratio(run)
        y = np.linspace(-1, 1, 401)
        snapshot = run.snapshots()[-1]
        figures.append(
            {
                "file": f"profile_{name}",
                "x": "velocity",
                "y": "y",
                "curves": [
                    (f"Spume, t = {snapshot.time:.2g}", snapshot.field("velocity")[:, 0], snapshot.position[:, 1], "."),
                    (f"exact, t = {snapshot.time:.2g}", startup(y, snapshot.time, chi), y, "k--"),
                ],
            }
        )
    return figures
