# SPDX-License-Identifier: MIT
"""Frequency of a two-dimensional drop against Lamb and Rayleigh (reference/drop_bubble_frequencies.csv), unbounded and
without viscosity."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference
from spume_tools.waves import damped_oscillation

REFERENCE = Path(__file__).parent / "reference" / "drop_bubble_frequencies.csv"


def exact(run):
    outside, drop = (float(phase["density"]) for phase in run.case["phase"])
    n = int(run.case["constants"]["n"])
    table = read_reference(REFERENCE, ("dim", "rho_d", "rho_c", "n", "omega"))
    for row in zip(*(table[name] for name in ("dim", "rho_d", "rho_c", "n", "omega"))):
        if tuple(float(v) for v in row[:4]) == (2.0, drop, outside, float(n)):
            return float(row[4])
    raise ValueError("the reference has no drop of these fluids")


def moment(run):
    """t and the mean of r^n cos(n theta) over the drop, whose centre is the origin or lies on planes of symmetry through
    it; linear in the amplitude of mode n."""
    n = int(run.case["constants"]["n"])
    t, values = [], []
    for snapshot in run.snapshots():
        inside = snapshot.position[snapshot.field("phase") == 1, :2]
        t.append(snapshot.time)
        values.append(np.mean(((inside[:, 0] + 1j * inside[:, 1]) ** n).real))
    return np.array(t), np.array(values)


def measure(runs):
    measured = {}
    for name, run in runs.items():
        omega = exact(run)
        t, a = moment(run)
        _, _, rate, found = damped_oscillation(t, a, 0.01 * omega, omega)
        measured[f"{name}_frequency_ratio"] = found / omega
        measured[f"{name}_frequency_error"] = abs(found / omega - 1)
        measured[f"{name}_growth_over_frequency"] = -rate / omega
    return measured


def curves(runs):
    lines, longest = [], 0
    for name, run in runs.items():
        t, a = moment(run)
        lines.append((f"Spume, {name}", exact(run) * t, a / a[0], "-"))
        longest = max(longest, exact(run) * t[-1])
    phase = np.linspace(0, longest, 500)
    lines.append(("Lamb, without viscosity", phase, np.cos(phase), "k--"))
    return [{"file": "oscillation", "x": "omega t", "y": "amplitude over that of the start", "curves": lines}]
