# SPDX-License-Identifier: MIT
"""The bubble joins the air above: when, what is left dispersed, and what becomes of the volumes.

Joined: half of the particles of the bubble belong to the group of the air above. Groups are of particles of one phase
that are less than LINK spacings from each other. Strays: particles without another of their own phase in the 3 x 3 cells
of two spacings around them. Volumes are sums of mass over density.
"""
import numpy as np
from spume_tools.places import CASES
from spume_tools.verify.cases import load_measure

LINK = 1.6  # between the diagonal of a lattice, 1.41, and its next row, 2


def groups(position, spacing):
    return load_measure(CASES / "rising_bubble_air").groups(position, LINK * spacing)


def strays(snapshot, spacing):
    return load_measure(CASES / "dam_break_air").strays(snapshot, spacing)


def phase(snapshot):
    return np.asarray(snapshot.field("phase"), int)


def bubble_ids(first):
    """Of the air that is below the water."""
    ids, at = np.asarray(first.field("id"), int), first.position
    water_top = at[phase(first) == 0, 1].max()
    return ids[(phase(first) == 1) & (at[:, 1] < water_top)]


def joined_share(snapshot, bubble, spacing):
    """Of the particles of the bubble, those of the largest group of air, which is the air above."""
    air = phase(snapshot) == 1
    group = groups(snapshot.position[air][:, :2], spacing)
    names, counts = np.unique(group, return_counts=True)
    own = np.isin(np.asarray(snapshot.field("id"), int)[air], bubble)
    return float(np.mean(group[own] == names[counts.argmax()]))


def volumes(snapshot, densities, spacing):
    """Of each phase over that at rest."""
    density, of = np.asarray(snapshot.field("density"), float), phase(snapshot)
    return [float(np.mean(rest / density[of == number])) for number, rest in enumerate(densities)]


def measure(runs):
    measured = {}
    for name, run in runs.items():
        spacing = float(run.case["resolution"]["spacing"])
        densities = [one["density"] for one in run.case["phase"]]
        snapshots = run.snapshots()
        bubble = bubble_ids(snapshots[0])
        share = np.array([joined_share(s, bubble, spacing) for s in snapshots])
        over = np.array([volumes(s, densities, spacing) for s in snapshots])
        joined = next((s.time for s, part in zip(snapshots, share) if part > 0.5), float("nan"))
        measured |= {f"{name}_joined_at": joined, f"{name}_joined_share_end": float(share[-1]),
                     f"{name}_strays": max(strays(s, spacing) for s in snapshots),
                     f"{name}_volume_water": float(np.max(np.abs(over[:, 0] / over[0, 0] - 1))),
                     f"{name}_volume_air": float(np.max(np.abs(over[:, 1] / over[0, 1] - 1))),
                     f"{name}_lost": int(abs(len(snapshots[-1].position) - len(snapshots[0].position)))}
    return measured
