# SPDX-License-Identifier: MIT
"""Series solutions of the start-up between plates at y = 0 and y = H = 1 with kinematic viscosity nu.

Couette, wall speed U:     u = U y/H + sum_n 2U/(n pi) (-1)^n exp(-n^2 pi^2 nu t/H^2) sin(n pi y/H)
Poiseuille, body force G:  u = G y(H - y)/(2 nu) - sum_(n odd) 4 G H^2/(nu pi^3 n^3) exp(-n^2 pi^2 nu t/H^2) sin(n pi y/H)
"""
import numpy as np

TERMS = 400


def couette(y, t, nu, wall_speed=1.0):
    n = np.arange(1, TERMS + 1)[:, None]
    terms = 2 * wall_speed / (n * np.pi) * (-1.0) ** n * np.exp(-(n * np.pi) ** 2 * nu * t) * np.sin(n * np.pi * y)
    return wall_speed * y + terms.sum(axis=0)


def poiseuille(y, t, nu, force=0.8):
    n = np.arange(1, TERMS + 1, 2)[:, None]
    terms = 4 * force / (nu * (n * np.pi) ** 3) * np.exp(-(n * np.pi) ** 2 * nu * t) * np.sin(n * np.pi * y)
    return force * y * (1 - y) / (2 * nu) - terms.sum(axis=0)


def exact(run):
    """The solution that the resolved case asks for, told by its body force."""
    return poiseuille if run.case.get("forces", {}).get("body") else couette


def viscosity(run):
    """Of a fluid of groups, or of the phase of another method."""
    if "phase" in run.case:
        return float(run.case["phase"][0]["viscosity"]) / float(run.case["phase"][0]["density"])
    return 1 / float(run.case["fluid"]["reynolds"])


def errors(run):
    """Largest over the snapshots of the rms over particles, and of the largest error, over the steady peak, 1."""
    rms, largest, across = 0.0, 0.0, 0.0
    for snapshot in run.snapshots():
        if snapshot.time <= 0:
            continue
        velocity = snapshot.field("velocity")
        difference = velocity[:, 0] - exact(run)(snapshot.position[:, 1], snapshot.time, viscosity(run))
        rms = max(rms, float(np.sqrt(np.mean(difference**2))))
        largest = max(largest, float(np.max(np.abs(difference))))
        across = max(across, float(np.max(np.abs(velocity[:, 1]))))
    return {"error": rms, "largest_error": largest, "cross_flow": across}


def measure(runs):
    return {f"{name}_{quantity}": value for name, run in runs.items() for quantity, value in errors(run).items()}


def curves(runs):
    figures = []
    for name, run in runs.items():
        y = np.linspace(0, 1, 201)
        lines = []
        snapshots = run.snapshots()
        for index in sorted({1, len(snapshots) // 4, len(snapshots) - 1} & set(range(1, len(snapshots)))):
            snapshot = snapshots[index]
            label = f"t = {snapshot.time:.2g}"
            lines.append((f"Spume, {label}", snapshot.field("velocity")[:, 0], snapshot.position[:, 1], "."))
            lines.append((f"exact, {label}", exact(run)(y, snapshot.time, viscosity(run)), y, "k--"))
        method = "_wcsph" if "phase" in run.case else ""
        figures.append({"file": f"profiles_{exact(run).__name__}{method}", "x": "velocity", "y": "y", "curves": lines})
    return figures
