# SPDX-License-Identifier: MIT
"""Does the wave break, when does it overturn, are mass and energy kept, and does the kinetic energy converge?

Breaking: the largest horizontal velocity of liquid over the linear phase speed c = 1/sqrt(2 pi). A crest in which u/c
passes 0.85 goes on to break, one that stays below does not (Barthelemy et al. 2018, J. Fluid Mech. 841:463). The velocity
taken is that exceeded by five particles in every layer across the wave, so that no stray particle decides. It is compared
with that of potential flow on the surface (reference/potential_flow.py), as far as that goes.

Overturning: the surface is no function of x any more. In columns one and a half spacings wide and three deep across the
wave, liquid hangs over a gap of more than three spacings; at least three adjacent columns must show it.
"""
from pathlib import Path

import numpy as np

from spume_tools.results import read_reference, standard

PHASE_SPEED = 1 / np.sqrt(2 * np.pi)
FOLDER = Path(__file__).parent / "reference"
POTENTIAL_FLOW = read_reference(FOLDER / "potential_flow.csv", ("chi", "t", "crest_speed"))


def crest_speeds(run):
    """Times of the snapshots and the crest's velocity over c."""
    lower, upper = run.bounds()
    count = max(1, int(round(5 * (upper[1] - lower[1]) / run.spacing)))
    t, speeds = [], []
    for snapshot in run.snapshots():
        u = snapshot.field("velocity")[:, 0]
        t.append(snapshot.time)
        speeds.append(float(np.partition(u, -count)[-count]) / PHASE_SPEED)
    return np.array(t), np.array(speeds)


def breaking_index(run):
    return float(crest_speeds(run)[1].max())


def potential_flow(run):
    """Times and crest speeds of potential flow for the steepness of a run, up to its end."""
    chi = float(run.case["constants"]["chi"])
    rows = np.isclose(POTENTIAL_FLOW["chi"], chi) & (POTENTIAL_FLOW["t"] <= run.series["t"][-1] + 1e-9)
    return POTENTIAL_FLOW["t"][rows], POTENTIAL_FLOW["crest_speed"][rows]


def overhanging_columns(position, spacing, middle):
    """Columns, in order of x, in which liquid hangs over a gap; a boolean per column. Position (N, 3)."""
    slab = position[np.abs(position[:, 1] - middle) <= 1.5 * spacing]
    columns = max(1, int(round(1 / (1.5 * spacing))))
    index = np.floor((slab[:, 0] % 1.0) * columns).astype(int) % columns
    overhanging = np.zeros(columns, dtype=bool)
    for column in range(columns):
        z = np.sort(slab[index == column, 2])
        gaps = np.nonzero(np.diff(z) > 3 * spacing)[0]
        # Two layers of particles hold about nine of this column; fewer above the gap are spray.
        overhanging[column] = any(len(z) - 1 - gap >= 8 for gap in gaps)
    return overhanging


def is_overturning(position, spacing, middle):
    over = overhanging_columns(position, spacing, middle)
    return bool(np.any(over & np.roll(over, 1) & np.roll(over, -1)))


def overturning_time(run):
    """Time of the first snapshot that shows overturning; nan when none does."""
    lower, upper = run.bounds()
    for snapshot in run.snapshots():
        if is_overturning(snapshot.position, run.spacing, 0.5 * (lower[1] + upper[1])):
            return snapshot.time
    return float("nan")


def wave_energy(run):
    """Kinetic plus potential energy above that of the same mass spread evenly from the bed to z = 0, with g = 1."""
    rest = 0.5 * run.bounds()[0][2] * run.series["mass"][0]
    return run.series["kinetic_energy"] + run.series["potential_energy"] - rest


def energy_growth(run):
    """Largest rise of the wave's energy above any earlier value of it, over its first value."""
    energy = wave_energy(run)
    return float(np.max(energy - np.minimum.accumulate(energy)) / energy[0])


def kinetic_energy(run, t):
    """Per unit area, at the given times."""
    lower, upper = run.bounds()
    return np.interp(t, run.series["t"], run.series["kinetic_energy"]) / np.prod((upper - lower)[:2])


def kinetic_energy_difference(run, other):
    t = np.linspace(0, min(run.series["t"][-1], other.series["t"][-1]), 400)
    a, b = kinetic_energy(run, t), kinetic_energy(other, t)
    return float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)))


def measure(runs):
    run = standard(runs)
    measured = {
        "mass_drift": max(float(np.max(np.abs(r.series["mass"] / r.series["mass"][0] - 1))) for r in runs.values()),
        "energy_growth": max(energy_growth(r) for r in runs.values()),
        "overturning_time": overturning_time(run),
        "breaking_index": breaking_index(run),
    }
    for name in ("chi_030", "chi_033"):
        if name in runs:
            measured[f"breaking_index_{name}"] = breaking_index(runs[name])
            measured[f"breaking_index_{name}_potential_flow"] = float(potential_flow(runs[name])[1].max())
            measured[f"overturning_time_{name}"] = overturning_time(runs[name])
    if {"coarse", "standard", "fine"} <= runs.keys():
        coarse = kinetic_energy_difference(runs["coarse"], runs["standard"])
        fine = kinetic_energy_difference(runs["standard"], runs["fine"])
        measured["kinetic_energy_difference"] = fine
        measured["kinetic_energy_convergence"] = fine / coarse
    return measured


def curves(runs):
    same = {name: run for name, run in runs.items() if not name.startswith("chi_")}
    figures = []
    if len(same) > 1:
        lines = [(f"spacing {run.spacing:.3g}", run.series["t"], kinetic_energy(run, run.series["t"]), "-")
                 for run in same.values()]
        figures.append({"file": "kinetic_energy_resolution", "x": "t", "y": "kinetic energy per area", "curves": lines})
    lines = [(name, run.series["t"], wave_energy(run) / wave_energy(run)[0], "-") for name, run in runs.items()]
    figures.append({"file": "wave_energy", "x": "t", "y": "energy of the wave / its first value", "curves": lines})
    lines = []
    for name, colour in zip((n for n in ("standard", "chi_030", "chi_033") if n in runs), ("C0", "C1", "C2")):
        chi = float(runs[name].case["constants"]["chi"])
        lines.append((f"chi = {chi:g}", *crest_speeds(runs[name]), f"{colour}-"))
        lines.append((f"chi = {chi:g}, potential flow", *potential_flow(runs[name]), f"{colour}--"))
    if lines:
        figures.append({"file": "crest_speed", "x": "t", "y": "u / c of the crest", "curves": lines})
    return figures
