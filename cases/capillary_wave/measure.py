# SPDX-License-Identifier: MIT
"""Frequency and damping of a standing wave on the interface of two fluids against their normal mode (reference/)."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference
from spume_tools.waves import damped_oscillation

REFERENCE = Path(__file__).parent / "reference" / "capillary_wave.csv"


def exact(run):
    """omega and gamma of the normal mode that the resolved case asks for."""
    lower, upper = run.case["phase"]
    rho = [float(lower["density"]), float(upper["density"])]
    k = 2 * np.pi / (float(run.case["domain"]["upper"][0]) - float(run.case["domain"]["lower"][0]))
    omega0 = np.sqrt(float(run.case["interface"]["surface_tension"]) * k**3 / sum(rho))
    damping = float(lower["viscosity"]) / rho[0] * k**2 / omega0
    names = ("rho1", "rho2", "nu_k2_over_w0", "omega_over_w0", "gamma_over_w0")
    table = read_reference(REFERENCE, names, {"kind": ("free", "two")})
    rows = [np.array([float(table[name][i]) for name in names]) for i in range(len(table["kind"]))
            if table["kind"][i] == "two"]
    near = min(rows, key=lambda row: abs(row[0] - rho[0]) + abs(row[1] - rho[1]) + abs(np.log(row[2] / damping)))
    if abs(near[0] - rho[0]) + abs(near[1] - rho[1]) > 1e-9 or abs(near[2] / damping - 1) > 0.01:
        raise ValueError("the reference has no wave of these fluids")
    return near[3] * omega0, near[4] * omega0


def amplitude(run):
    """t and the amplitude of cos(k x) in the interface: twice the mean of cos(k x) over the lower phase, by its area."""
    lower, upper = (np.array(run.case["domain"][key], dtype=float) for key in ("lower", "upper"))
    k = 2 * np.pi / (upper[0] - lower[0])
    t, a = [], []
    for snapshot in run.snapshots():
        below = snapshot.field("phase") == 0
        volume = np.prod(upper - lower) / len(below)
        t.append(snapshot.time)
        a.append(2 * volume * np.cos(k * (snapshot.position[below, 0] - lower[0])).sum() / (upper[0] - lower[0]))
    return np.array(t), np.array(a)


def errors(run):
    """A wave that starts at rest is no pure mode: the first period is left out."""
    omega, gamma = exact(run)
    t, a = amplitude(run)
    late = t > 2 * np.pi / omega
    _, _, found_gamma, found_omega = damped_oscillation(t[late], a[late], gamma, omega)
    return {"frequency_ratio": found_omega / omega, "damping_ratio": found_gamma / gamma,
            "frequency_error": abs(found_omega / omega - 1), "damping_error": abs(found_gamma / gamma - 1)}


def measure(runs):
    if len(runs) == 1:
        return errors(next(iter(runs.values())))
    return {f"{name}_{key}": value for name, run in runs.items() for key, value in errors(run).items()}


def curves(runs):
    lines = []
    for name, run in runs.items():
        t, a = amplitude(run)
        lines.append((f"Spume, {name}", t, a, "-"))
    omega, gamma = exact(run)
    lines.append(("decay of the normal mode", t, a[0] * np.exp(-gamma * t), "k--"))
    return [{"file": "amplitude", "x": "t", "y": "amplitude", "curves": lines}]
