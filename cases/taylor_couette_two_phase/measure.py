# SPDX-License-Identifier: MIT
"""Circular Couette flow of two liquids, the inner cylinder turning with W1, against the exact steady flow: u = A r + B/r
in each liquid, equal velocities and equal stresses -2 mu B/r^2 at the interface."""
import numpy as np

R1, RI, R2, W1 = 1.0, 1.5, 2.0, 1.0


def coefficients(inner, outer):
    """A, B of the inner liquid and of the outer one, by their viscosities."""
    rows = [[R1, 1 / R1, 0, 0], [0, 0, R2, 1 / R2], [RI, 1 / RI, -RI, -1 / RI], [0, inner, 0, -outer]]
    return np.linalg.solve(rows, [W1 * R1, 0, 0, 0])


def exact(r, inner, outer):
    a, b, c, d = coefficients(inner, outer)
    return np.where(r < RI, a * r + b / r, c * r + d / r)


def viscosities(run):
    return tuple(float(run.case["phase"][k]["viscosity"]) for k in (1, 0))


def polar(snapshot):
    x, y = snapshot.position[:, 0], snapshot.position[:, 1]
    velocity, r = snapshot.field("velocity"), np.hypot(x, y)
    return r, (x * velocity[:, 1] - y * velocity[:, 0]) / r


def errors(run):
    """At the end of the run: rms over the particles of the error of the circumferential velocity, over the speed of the
    inner wall; and of the torques on the cylinders, 4 pi mu B per length."""
    r, turning = polar(run.snapshots()[-1])
    inner, outer = viscosities(run)
    difference = turning - exact(r, inner, outer)
    torque = 4 * np.pi * inner * coefficients(inner, outer)[1]
    forces = run.table("bodies")
    last = {body: forces["viscous_torque_z"][forces["body"] == body][-1] for body in (0, 1)}
    return {"error": float(np.sqrt(np.mean(difference**2))),
            "inner_torque_error": float(abs(-last[1] / torque - 1)),
            "outer_torque_error": float(abs(last[0] / torque - 1))}


def measure(runs):
    found = {name: errors(run) for name, run in runs.items()}
    values = {f"{name}_{quantity}": value for name, of in found.items() for quantity, value in of.items()}
    for ratio in ("02", "5", "100"):
        coarse, fine = f"ratio_{ratio}_coarse", f"ratio_{ratio}"
        if coarse in found and fine in found:
            values[f"ratio_{ratio}_order"] = float(np.log2(found[coarse]["error"] / found[fine]["error"]))
    return values


def curves(runs):
    figures = []
    for name, run in runs.items():
        radius = np.linspace(R1, R2, 201)
        r, turning = polar(run.snapshots()[-1])
        figures.append({"file": f"profile_{name}", "x": "r", "y": "circumferential velocity",
                        "curves": [("Spume", r, turning, "."), ("exact", radius, exact(radius, *viscosities(run)), "k--")]})
    return figures
