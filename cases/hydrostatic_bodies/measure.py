# SPDX-License-Identifier: MIT
"""Buoyancy by Archimedes, and the speed that still water gains."""
import numpy as np

GRAVITY, DENSITY, DEPTH = 9.81, 1000.0, 1.0
PLANE = {"disc": np.pi * 0.2**2, "wedge": 0.5 * (0.6 * 0.35 - 0.25 * 0.05), "box": 0.4 * 0.25}
SPACE = {"ball": 4 / 3 * np.pi * 0.2**3, "wedge": 0.4 * PLANE["wedge"], "box": 0.4 * 0.3 * 0.25}


def errors(run):
    """Largest over time: relative error of the upward force on each body, the force across over the upward one, and the
    speed over sqrt(g H)."""
    space = run.dimensions == 3
    forces, found = run.table("bodies"), {}
    for body, (name, volume) in enumerate((SPACE if space else PLANE).items()):
        rows = forces["body"] == body
        weight = DENSITY * GRAVITY * volume
        found[f"{name}_error"] = float(np.max(np.abs(forces[f"pressure_force_{'z' if space else 'y'}"][rows] / weight - 1)))
        found[f"{name}_across"] = float(np.max(np.abs(forces["pressure_force_x"][rows])) / weight)
    found["speed"] = float(np.max(run.series["max_speed"]) / np.sqrt(GRAVITY * DEPTH))
    return found


def measure(runs):
    return {f"{name}_{quantity}": value for name, run in runs.items() for quantity, value in errors(run).items()}
