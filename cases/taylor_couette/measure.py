# SPDX-License-Identifier: MIT
"""Circular Couette flow with R1 = 1, R2 = 2, W1 = 1, nu = 1 against reference/taylor_couette.csv: the spin-up at t = 0.1
and 0.3, and the steady flow u = A r + B/r with its torque 4 pi mu B per length."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

REFERENCE = read_reference(Path(__file__).parent / "reference" / "taylor_couette.csv", ("r", "u_theta"),
                           {"kind": ("steady", "spinup")})
SPINUP = np.asarray(REFERENCE["kind"]) == "spinup"
TIMES = np.array([float(t) if spinup else np.nan for t, spinup in zip(REFERENCE["t"], SPINUP)])
R1, R2 = 1.0, 2.0
A, B = -1 / 3, 4 / 3
TORQUE = 4 * np.pi * B
STEADY = 0.95  # the slowest mode, exp(-9.8 t), has then fallen to 1e-4


def exact(t):
    """r -> u_theta at a time that the table has or that counts as steady, else None."""
    if t >= STEADY:
        return lambda r: A * r + B / r
    rows = SPINUP & np.isclose(TIMES, t, rtol=1e-6)
    if not rows.any():
        return None
    smooth = np.polyfit(REFERENCE["r"][rows] - 1.5, REFERENCE["u_theta"][rows], rows.sum() - 1)
    return lambda r: np.polyval(smooth, r - 1.5)


def polar(snapshot):
    x, y = snapshot.position[:, 0], snapshot.position[:, 1]
    velocity, r = snapshot.field("velocity"), np.hypot(x, y)
    return r, (x * velocity[:, 1] - y * velocity[:, 0]) / r, (x * velocity[:, 0] + y * velocity[:, 1]) / r


def errors(run):
    """Of the last time with an exact profile: rms of the error over the particles, over the speed of the inner wall, 1.
    Torques of both cylinders at the end, averaged over what is steady."""
    result = {}
    for snapshot in run.snapshots():
        solution = exact(snapshot.time) if snapshot.time > 0 else None
        if solution is None:
            continue
        r, turning, outwards = polar(snapshot)
        difference = turning - solution(r)
        result = {"error": float(np.sqrt(np.mean(difference**2))),
                  "largest_error": float(np.max(np.abs(difference))),
                  "radial_flow": float(np.sqrt(np.mean(outwards**2)))}
    forces = run.table("bodies")
    steady = forces["t"] >= STEADY
    if steady.any():
        length = run.bounds()[1][2] - run.bounds()[0][2] if run.dimensions == 3 else 1.0
        for body, name, sign in ((1, "inner", -1), (0, "outer", 1)):
            torque = np.mean(forces["viscous_torque_z"][steady & (forces["body"] == body)]) / length
            result[f"{name}_torque"] = float(torque)
        inner, outer = result["inner_torque"], result["outer_torque"]
        result["torque_error"] = float(max(abs(-inner / TORQUE - 1), abs(outer / TORQUE - 1)))
    return result


def measure(runs):
    found = {name: errors(run) for name, run in runs.items()}
    values = {f"{name}_{quantity}": value for name, of in found.items() for quantity, value in of.items()}
    if "gap_40" in found:
        values["error_ratio"] = found["gap_40"]["error"] / found["gap_20"]["error"]
    return values


def curves(runs):
    figures = []
    for name, run in runs.items():
        radius, lines = np.linspace(R1, R2, 101), []
        for snapshot in run.snapshots():
            solution = exact(snapshot.time) if snapshot.time > 0 else None
            if solution is None:
                continue
            r, turning, _ = polar(snapshot)
            lines.append((f"Spume, t = {snapshot.time:.2g}", r, turning, "."))
            lines.append((f"exact, t = {snapshot.time:.2g}", radius, solution(radius), "k--"))
        figures.append({"file": f"profiles_{name}", "x": "r", "y": "circumferential velocity", "curves": lines})
    return figures
