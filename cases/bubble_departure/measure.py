# SPDX-License-Identifier: MIT
"""Volumes (areas, in the plane) with which bubbles leave a slot, against the largest static bubble on it.

Groups are of particles of air less than LINK spacings from each other. A group that reaches neither the slot nor the air
above the water is a bubble; it has departed in the first snapshot in which it is one. Its volume is the sum of that of
its particles: at their densities, or that of all of them alike where the method is incompressible. The period between departures times the flow rate is a second measure of it.
"""
import numpy as np
from spume_tools.places import CASES
from spume_tools.verify.cases import load_measure

LINK = 1.6  # between the diagonal of a lattice, 1.41, and its next row, 2
LEAST = 0.25  # of the largest static bubble: what is less is a satellite


def largest_static_area(half_width):
    """Of planar bubbles on a slot, lengths in sqrt(sigma / (g drho)): d theta / ds = k - z from the top down, k the
    curvature there, over all k; the sides pass the rims of the slot."""
    k = np.linspace(0.8, 6, 2001)
    x, z, theta, area = (np.zeros_like(k) for _ in range(4))
    step, largest = 2e-3, 0.0
    for _ in range(4000):
        # The midpoint rule.
        mid = theta + 0.5 * step * (k - z)
        way = 0.5 * step * np.sin(theta)
        dx, dz = step * np.cos(mid), step * np.sin(mid)
        grown = 2 * (x + 0.5 * dx) * dz
        at_rim = (x > half_width) & (x + dx <= half_width) | (x < half_width) & (x + dx >= half_width)
        if np.any(at_rim):
            share = (half_width - x[at_rim]) / dx[at_rim]
            largest = max(largest, float(np.max(area[at_rim] + share * grown[at_rim])))
        theta = theta + step * (k - (z + way))
        x, z, area = x + dx, z + dz, area + grown
        alive = x > -half_width
        k, x, z, theta, area = k[alive], x[alive], z[alive], theta[alive], area[alive]
    return largest


def groups(position, spacing):
    return load_measure(CASES / "rising_bubble_air").groups(position, LINK * spacing)


def bubbles(snapshot, spacing, top, half_width, density):
    """Volume and height of every group of air between the slot and the air above. `density` at rest; None: particles
    keep their volume."""
    phase = np.asarray(snapshot.field("phase"), int)
    at = snapshot.position[phase == 1][:, :2]
    if len(at) == 0:
        return []
    volume = np.full(len(at), spacing**2)
    if density is not None:
        volume *= density / np.asarray(snapshot.field("density"), float)[phase == 1]
    group = groups(at, spacing)
    found = []
    for name in np.unique(group):
        own = group == name
        low, high = at[own, 1].min(), at[own, 1].max()
        if low < spacing or high > top:
            continue
        found.append((float(volume[own].sum()), float(np.average(at[own, 1], weights=volume[own]))))
    return found


def departures(snapshots, spacing, top, half_width, density, least):
    """Times and volumes: a bubble is new where the lowest one is lower than the lowest before."""
    times, volumes, lowest = [], [], np.inf
    for snapshot in snapshots:
        large = [one for one in bubbles(snapshot, spacing, top, half_width, density) if one[0] > least]
        now = min((height for _, height in large), default=np.inf)
        if now < lowest - spacing:
            times.append(snapshot.time)
            volumes.append(min(large, key=lambda one: one[1])[0])
        lowest = now if large else np.inf
    return np.array(times), np.array(volumes)


def measure(runs):
    measured = {}
    for name, run in runs.items():
        spacing = float(run.case["resolution"]["spacing"])
        slot = run.case["inflow"][0]
        half_width = float(slot["upper"][0])
        limit = largest_static_area(half_width)
        top = float(run.case["domain"]["upper"][1]) - spacing
        # The density of particles of gfd is that of the filtered interface.
        density = None if run.case["method"] == "gfd" else float(run.case["phase"][1]["density"])
        times, volumes = departures(run.snapshots(), spacing, top, half_width, density, LEAST * limit)
        series = run.series
        balance = max(abs(float(np.max(np.abs(series[f"volume_{phase}"] - series[f"volume_{phase}"][0] -
                                              series[f"volume_in_{phase}"] + series[f"volume_out_{phase}"]))))
                      for phase in ("water", "air"))
        period = float(np.mean(np.diff(times))) if len(times) > 1 else float("nan")
        measured |= {f"{name}_static_limit": limit, f"{name}_departures": len(volumes),
                     f"{name}_volume": float(np.mean(volumes)) if len(volumes) else float("nan"),
                     f"{name}_volume_error": float(np.mean(volumes) / limit - 1) if len(volumes) else float("nan"),
                     f"{name}_period": period, f"{name}_balance": balance,
                     f"{name}_air_out": float(series["volume_out_air"][-1]),
                     f"{name}_water_out": float(series["volume_out_water"][-1])}
    return measured
