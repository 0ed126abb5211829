# SPDX-License-Identifier: MIT
"""Start-up of pipe flow against reference/pipe_flow.csv (Szymanski 1932): u over the steady maximum against s = r/R at
times T = nu t / R^2, and the wall stress over its steady value."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

REFERENCE = read_reference(Path(__file__).parent / "reference" / "pipe_flow.csv", ("T", "s", "u_over_Umax", "tau"))
RADIUS = 0.5
NU = 0.1
FORCE = 1.6
STRESS = FORCE * RADIUS / 2  # steady, density 1


def at_time(t):
    return np.isclose(REFERENCE["T"], NU * t / RADIUS**2, rtol=1e-6)


def profile(t):
    """s -> u/Umax at a time of the table, or None: an even polynomial through its points, of the order that they bear."""
    rows = at_time(t)
    if not rows.any():
        return None
    even = np.polyfit(REFERENCE["s"][rows] ** 2, REFERENCE["u_over_Umax"][rows], rows.sum() - 1)
    return lambda s: np.polyval(even, s**2)


def errors(run):
    """Of the last time that the table has: rms of the axial velocity over the particles, over the steady maximum 1; the
    largest velocity across; the axial force on the pipe against that of the exact stress; the dissipation against the
    power of the body force less what the kinetic energy gains."""
    result = None
    for snapshot in run.snapshots():
        exact = profile(snapshot.time)
        if snapshot.time <= 0 or exact is None:
            continue
        velocity, s = snapshot.field("velocity"), np.hypot(*snapshot.position.T[:2]) / RADIUS
        difference = velocity[:, 2] - exact(s)
        result = {"error": float(np.sqrt(np.mean(difference**2))),
                  "largest_error": float(np.max(np.abs(difference))),
                  "cross_flow": float(np.max(np.hypot(*velocity.T[:2])))}
        tau = REFERENCE["tau"][at_time(snapshot.time)][0]
        forces = run.table("bodies")
        length = run.bounds()[1][2] - run.bounds()[0][2]
        row = np.argmin(np.abs(forces["t"] - snapshot.time))
        series = run.series
        after = series["t"] >= snapshot.time / 2
        kept = np.gradient(series["kinetic_energy"], series["t"])[after]
        power = FORCE * series["momentum_z"][after]
        result["dissipation_error"] = float(np.max(np.abs(series["dissipation"][after][:-1] / (power - kept)[:-1] - 1)))
        result["stress_error"] = float(abs(forces["viscous_force_z"][row] / (2 * np.pi * RADIUS * length * STRESS * tau) - 1))
    return result


def measure(runs):
    found = {name: errors(run) for name, run in runs.items()}
    values = {f"{name}_{quantity}": value for name, of in found.items() for quantity, value in of.items()}
    if {"across_10", "across_20"} <= found.keys():
        values["error_ratio"] = found["across_20"]["error"] / found["across_10"]["error"]
    return values


def curves(runs):
    figures = []
    for name, run in runs.items():
        s, lines = np.linspace(0, 1, 101), []
        for snapshot in run.snapshots():
            exact = profile(snapshot.time)
            if snapshot.time <= 0 or exact is None:
                continue
            label = f"T = {NU * snapshot.time / RADIUS**2:.2g}"
            lines.append((f"Spume, {label}", np.hypot(*snapshot.position.T[:2]) / RADIUS, snapshot.field("velocity")[:, 2], "."))
            lines.append((f"exact, {label}", s, exact(s), "k--"))
        figures.append({"file": f"profiles_{name}", "x": "r / R", "y": "axial velocity / steady maximum", "curves": lines})
    return figures
