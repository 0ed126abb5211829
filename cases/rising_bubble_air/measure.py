# SPDX-License-Identifier: MIT
"""The bubble of each run against that of the run "gfd": height of the centre of mass, shape at t = 3.2, what has split off at 4.8.

Difference of two shapes: area that one of the bubbles covers and the other does not, over the area of the bubble; a place
belongs to the phase of the nearest particle. Split off: of the particles of air that are not connected with the largest
group, the share of the bubble on either side of the axis, the smaller of the two; connected are particles less than LINK
spacings apart. Depth of the horseshoe: how far the water below reaches into the bubble on its axis, from its lowest
particles up.
"""
import numpy as np

LINK = 1.6  # between the diagonal of a lattice, 1.41, and its next row, 2
GRID = 0.02  # of the radius


def air(snapshot):
    return snapshot.position[np.asarray(snapshot.field("phase")) == 1][:, :2]


def groups(position, reach):
    """Number of the group of each particle."""
    cell = {}
    for number, key in enumerate(map(tuple, np.floor(position / reach).astype(int))):
        cell.setdefault(key, []).append(number)
    group = np.full(len(position), -1)
    for first in range(len(position)):
        if group[first] >= 0:
            continue
        group[first], waiting = first, [first]
        while waiting:
            i = waiting.pop()
            x, y = np.floor(position[i] / reach).astype(int)
            near = [j for a in (-1, 0, 1) for b in (-1, 0, 1) for j in cell.get((x + a, y + b), []) if group[j] < 0]
            for j in near:
                if np.hypot(*(position[j] - position[i])) < reach:
                    group[j] = first
                    waiting.append(j)
    return group


def split_off(snapshot, spacing):
    bubble = air(snapshot)
    group = groups(bubble, LINK * spacing)
    names, counts = np.unique(group, return_counts=True)
    apart = bubble[group != names[counts.argmax()], 0]
    return float(min((apart < 0).sum(), (apart > 0).sum()) / len(bubble))


def horseshoe_depth(snapshot, spacing):
    bubble = air(snapshot)
    on_axis = bubble[np.abs(bubble[:, 0]) < 1.5 * spacing, 1]
    return float(on_axis.min() - bubble[:, 1].min()) if len(on_axis) else float("nan")


def mask(snapshot, spacing, x, y):
    """Where the particle that is nearest to the points of the grid is of air."""
    position, is_air = snapshot.position[:, :2], np.asarray(snapshot.field("phase")) == 1
    nearest = np.full((len(x), len(y)), np.inf)
    found = np.zeros(nearest.shape, bool)
    reach = 2 * spacing
    near = np.all((position > [x[0] - reach, y[0] - reach]) & (position < [x[-1] + reach, y[-1] + reach]), axis=1)
    for (px, py), phase in zip(position[near], is_air[near]):
        i, j = np.searchsorted(x, [px - reach, px + reach]), np.searchsorted(y, [py - reach, py + reach])
        if i[0] == i[1] or j[0] == j[1]:
            continue
        part = np.s_[i[0]:i[1], j[0]:j[1]]
        distance = (x[i[0]:i[1], None] - px) ** 2 + (y[None, j[0]:j[1]] - py) ** 2
        closer = distance < nearest[part]
        nearest[part][closer] = distance[closer]
        found[part][closer] = phase
    return found


def shape_difference(one, other):
    x, y = np.arange(-2.5, 2.5, GRID), np.arange(0.5, 7, GRID)
    masks = [mask(snapshot, spacing, x, y) for snapshot, spacing in (one, other)]
    return float(np.logical_xor(*masks).sum() / masks[1].sum())


def at(run, time):
    return next((s for s in run.snapshots() if abs(s.time - time) < 1e-6), None)


def height(run, time):
    return float(np.interp(time, run.series["t"], run.series["centre_air_y"]))


def measure(runs):
    measured = {}
    for name, run in runs.items():
        spacing = float(run.case["resolution"]["spacing"])
        end = float(run.series["t"][-1])
        shapes = {time: at(run, time) for time in (1.6, 3.2, 4.8)}
        reference = runs.get("gfd")
        measured[f"{name}_height_end"] = height(run, end)
        if shapes[3.2] is not None:
            measured[f"{name}_horseshoe_depth"] = horseshoe_depth(shapes[3.2], spacing)
        if shapes[4.8] is not None:
            measured[f"{name}_split_off"] = split_off(shapes[4.8], spacing)
        if reference is None or name == "gfd":
            continue
        for time, snapshot in shapes.items():
            other = at(reference, time)
            if snapshot is None or other is None:
                continue
            label = f"{time:.1f}".replace(".", "_")
            measured[f"{name}_height_error_{label}"] = abs(height(run, time) / height(reference, time) - 1)
            measured[f"{name}_shape_difference_{label}"] = shape_difference(
                (snapshot, spacing), (other, float(reference.case["resolution"]["spacing"])))
    return measured


def curves(runs):
    return [{"file": "height", "x": "t sqrt(g/R)", "y": "y of the centre of mass over R",
             "curves": [(name, run.series["t"], run.series["centre_air_y"], "k--" if name == "gfd" else "-")
                        for name, run in runs.items()]}]
