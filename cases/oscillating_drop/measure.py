# SPDX-License-Identifier: MIT
"""Frequency and decay of a two-dimensional drop. Frequency: that of potential flow of the run's amplitude in the run's box
(reference/potential_frequencies.csv), times what viscosity takes from it in linear theory (reference/
viscous_frequencies.csv, unbounded); and the linear one without viscosity, drop_bubble_frequencies.csv, Lamb and Rayleigh."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference
from spume_tools.waves import damped_oscillation

FOLDER = Path(__file__).parent / "reference"


def row_of(file, wanted, column):
    """The entry in a column of the row whose columns hold what is wanted."""
    table = read_reference(FOLDER / file, (*wanted, column))
    for k, value in enumerate(table[column]):
        if all(np.isclose(float(table[name][k]), number, rtol=1e-9) for name, number in wanted.items()):
            return float(value)
    raise ValueError(f"{file} has no drop of these fluids: {wanted}")


def fluids(run):
    outside, drop = run.case["phase"]
    rho_c, rho_d = float(outside["density"]), float(drop["density"])
    nu_c, nu_d = float(outside["viscosity"]) / rho_c, float(drop["viscosity"]) / rho_d
    return {"rho_d": rho_d, "rho_c": rho_c, "n": int(run.case["constants"]["n"])}, {"nu_d": nu_d, "nu_c": nu_c}


def inviscid(run):
    return row_of("drop_bubble_frequencies.csv", {"dim": 2, **fluids(run)[0]}, "omega")


def viscous(run, column="omega"):
    densities, viscosities = fluids(run)
    return row_of("viscous_frequencies.csv", {**densities, **viscosities}, column)


def expected(run):
    upper = run.case["domain"]["upper"]
    shape = {"amplitude": float(run.case["constants"]["a"]), "half_width": float(upper[0]), "height": float(upper[1])}
    potential = row_of("potential_frequencies.csv", {**fluids(run)[0], **shape}, "omega")
    return potential * viscous(run) / inviscid(run)


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
        omega = expected(run)
        t, a = moment(run)
        _, _, rate, found = damped_oscillation(t, a, viscous(run, "decay"), omega)
        measured[f"{name}_frequency_ratio"] = found / omega
        measured[f"{name}_frequency_error"] = abs(found / omega - 1)
        measured[f"{name}_frequency_inviscid_ratio"] = found / inviscid(run)
        measured[f"{name}_decay_over_frequency"] = rate / omega
        measured[f"{name}_decay_beyond_theory"] = (rate - viscous(run, "decay")) / omega
    return measured


def curves(runs):
    lines, longest = [], 0
    for name, run in runs.items():
        t, a = moment(run)
        lines.append((f"Spume, {name}", inviscid(run) * t, a / a[0], "-"))
        longest = max(longest, inviscid(run) * t[-1])
    phase = np.linspace(0, longest, 500)
    lines.append(("Lamb, without viscosity", phase, np.cos(phase), "k--"))
    return [{"file": "oscillation", "x": "omega t", "y": "amplitude over that of the start", "curves": lines}]
