# SPDX-License-Identifier: MIT
"""Volumes (areas, in the plane) with which bubbles leave a slot: slowly, against the largest static bubble on it, and with
a constant flow, against the bubble that its buoyancy accelerates.

Groups are of particles of air less than LINK spacings from each other. A group that reaches neither the slot nor the air
above the water is a bubble; it has departed in the snapshot from which on it is one. One that the slot has caught again
departs once, later. Its volume is the sum of that of its particles: at their densities, or that of all of them alike
where the method is incompressible. The period between departures times the flow rate is a second measure of it.

In a fast flow the next bubble follows through the neck, which gas may hold open: there the first bubble is the air above
the neck when that is narrowest.
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


def air_of(snapshot, spacing, density):
    """Places, volumes and identifiers of the particles of air. `density` at rest; None: particles keep their volume."""
    air = np.asarray(snapshot.field("phase"), int) == 1
    volume = np.full(air.sum(), spacing**2)
    if density is not None:
        volume *= density / np.asarray(snapshot.field("density"), float)[air]
    return snapshot.position[air][:, :2], volume, np.asarray(snapshot.field("id"), int)[air]


def bubbles(snapshot, spacing, top, density, least):
    """Volume, height and identifiers of every group of air of `least` volume between the slot and the air above, the
    lowest first; and the identifiers of the air on the slot."""
    at, volume, name = air_of(snapshot, spacing, density)
    if len(at) == 0:
        return [], np.empty(0, int)
    group = groups(at, spacing)
    found, held = [], np.zeros(len(at), bool)
    for one in np.unique(group):
        own = group == one
        low, high = at[own, 1].min(), at[own, 1].max()
        if low < spacing:
            held |= own
        elif high <= top and volume[own].sum() > least:
            found.append((float(volume[own].sum()), float(np.average(at[own, 1], weights=volume[own])), name[own]))
    return sorted(found, key=lambda bubble: bubble[1]), name[held]


def departures(snapshots, spacing, top, density, least):
    """Times and volumes. A group is a bubble that has departed before where it has most of its particles from it."""
    left = []
    for snapshot in snapshots:
        found, held = bubbles(snapshot, spacing, top, density, least)
        for one in left:
            one["held"] |= np.isin(one["particles"], held).mean() > 0.5
        for volume, _, particles in found:
            same = next((one for one in left if np.isin(particles, one["particles"]).mean() > 0.5), None)
            if same is None:
                left.append({"held": False})
                same = left[-1]
            elif not same["held"]:
                continue
            same |= {"time": snapshot.time, "volume": volume, "particles": particles, "held": False}
    left = sorted(left, key=lambda one: one["time"])
    return np.array([one["time"] for one in left]), np.array([one["volume"] for one in left])


def constant_flow_area(rate, gravity):
    """d/dt(c rho A U) = rho g A, A = Q t, until the rise is the radius: A = (4 c / g)^(2/3) (Q^4 / pi)^(1/3). With the added
    mass of a disc beside a wall as Davidson and Schueler (1960) have that of a sphere, by the dipole of its image:
    c = 1 + 1/2 (for the sphere 1/2 (1 + 3/8) = 11/16)."""
    return (4 * 1.5 / gravity) ** (2 / 3) * (rate**4 / np.pi) ** (1 / 3)


def narrowest_neck(snapshots, spacing, surface, density, slot):
    """Time, width and volume above where the neck of the first bubble is narrowest: least width of the air below its
    widest level, mean of two rows of particles, until it has grown again by a quarter of the slot."""
    edges = np.arange(0, surface, spacing)
    best = (np.nan, np.inf, np.nan)
    for snapshot in snapshots:
        at, volume, _ = air_of(snapshot, spacing, density)
        rows = np.histogram(at[:, 1], edges, weights=volume)[0] / spacing
        width = (rows[1:] + rows[:-1]) / 2
        if width.max() < 1.5 * slot:  # nothing wider than the slot yet
            continue
        neck = int(np.argmin(width[:int(np.argmax(width)) + 1]))
        if width[neck] < best[1]:
            above = (at[:, 1] > edges[neck + 1]) & (at[:, 1] < surface)
            best = (snapshot.time, float(width[neck]), float(volume[above].sum()))
        elif best[1] < slot / 2 and width[neck] > best[1] + slot / 4:
            break
    return best


def of_flow(run, spacing, density, slot, limit):
    water = float(run.case["region"][1]["upper"][1])
    # Half a bubble below the surface: what lies higher is the air above, and waves.
    surface = water - 0.5 * np.sqrt(limit / np.pi)
    time, width, volume = narrowest_neck(run.snapshots(), spacing, surface, density, slot)
    return {"flow_limit": limit, "neck_at": time, "neck": width, "volume": volume, "volume_error": volume / limit - 1}


def of_static(run, spacing, density, limit):
    top = float(run.case["domain"]["upper"][1]) - spacing
    times, volumes = departures(run.snapshots(), spacing, top, density, LEAST * limit)
    mean = float(np.mean(volumes)) if len(volumes) else float("nan")
    return {"static_limit": limit, "departures": len(volumes), "volume": mean, "volume_error": mean / limit - 1,
            "period": float(np.mean(np.diff(times))) if len(times) > 1 else float("nan")}


def measure(runs):
    measured = {}
    for name, run in runs.items():
        spacing = float(run.case["resolution"]["spacing"])
        half_width = float(run.case["inflow"][0]["upper"][0])
        gravity = float(run.case["fluid"]["froude"]) ** -2
        density = [float(phase["density"]) for phase in run.case["phase"]]
        length = np.sqrt(float(run.case["interface"]["surface_tension"]) / (gravity * (density[0] - density[1])))
        static = largest_static_area(half_width / length) * length**2
        flow = constant_flow_area(float(run.case["constants"]["q"]), gravity)
        # The density of particles of gfd is that of the filtered interface.
        at_rest = None if run.case["method"] == "gfd" else density[1]
        own = of_flow(run, spacing, at_rest, 2 * half_width, flow) if flow > static else of_static(
            run, spacing, at_rest, static)
        series = run.series
        own["balance"] = max(abs(float(np.max(np.abs(series[f"volume_{phase}"] - series[f"volume_{phase}"][0] -
                                                     series[f"volume_in_{phase}"] + series[f"volume_out_{phase}"]))))
                             for phase in ("water", "air"))
        own |= {"air_out": float(series["volume_out_air"][-1]), "water_out": float(series["volume_out_water"][-1])}
        measured |= {f"{name}_{key}": value for key, value in own.items()}
    return measured
