# SPDX-License-Identifier: MIT
"""A Wigley hull at rest against Archimedes, and under way its bow wave beside what a stream can rise to."""
import numpy as np

GRAVITY, DENSITY = 9.81, 1000.0
LENGTH, BEAM, DRAFT = 1.0, 0.2, 0.1
SPEED, RAMP, START = 1.25, 0.6, 0.7
# The integral of the hull's half widths below the water, of the half of the hull that lies in the tank.
DISPLACEMENT = 4 / 9 * LENGTH * BEAM * DRAFT / 2


def way(t):
    return SPEED * t**2 / (2 * RAMP) if t < RAMP else SPEED * (t - RAMP / 2)


def rest(run):
    """Largest over time: error of the upward force over the weight of the water that the hull takes the place of, the force
    along it over that weight, and the speed over sqrt(g T)."""
    forces, weight = run.table("bodies"), DENSITY * GRAVITY * DISPLACEMENT
    return {"force_error": float(np.max(np.abs(forces["pressure_force_z"] / weight - 1))),
            "force_along": float(np.max(np.abs(forces["pressure_force_x"])) / weight),
            "speed": float(np.max(run.series["max_speed"]) / np.sqrt(GRAVITY * DRAFT))}


def under_way(run):
    """At the end: the height of the wave at the bow over U^2 / 2g, and how far behind the stem its crest is, over L; the
    resistance over the weight, over the last quarter."""
    snapshot, spacing = run.snapshots()[-1], run.spacing
    stem = START + LENGTH / 2 + way(snapshot.time)
    x, y, z = snapshot.position.T
    near = (np.abs(x - stem) < 0.25 * LENGTH) & (y > -0.2 * LENGTH)
    crest = np.argmax(np.where(near, z, -np.inf))
    forces = run.table("bodies")
    late = forces["t"] > 0.75 * forces["t"][-1]
    return {"bow_wave": float((z[crest] + 0.5 * spacing) / (SPEED**2 / (2 * GRAVITY))),
            "crest_behind_stem": float((stem - x[crest]) / LENGTH),
            "resistance": float(-np.mean(forces["pressure_force_x"][late]) / (DENSITY * GRAVITY * DISPLACEMENT))}


def measure(runs):
    return {f"{name}_{quantity}": value for name, run in runs.items()
            for quantity, value in (rest(run) if name.startswith("rest") else under_way(run)).items()}
