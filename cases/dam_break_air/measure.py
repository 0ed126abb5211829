# SPDX-License-Identifier: MIT
"""The front of the water along the bottom, and what is dispersed: particles without another of their own phase in the
3 x 3 cells of two spacings around them."""
import numpy as np

# Of the depth of the column: the layer in which the front is looked for.
LAYER = 0.1


def front(snapshot):
    water = snapshot.field("phase") == 0
    low = water & (snapshot.position[:, 1] < LAYER)
    return float(snapshot.position[low, 0].max())


def strays(snapshot, spacing):
    phase = snapshot.field("phase")
    cell = np.floor(snapshot.position[:, :2] / (2 * spacing)).astype(int)
    cell += 1 - cell.min(axis=0)
    alone = 0
    for number in np.unique(phase):
        own = cell[phase == number]
        count = np.zeros(cell.max(axis=0) + 2, dtype=int)
        np.add.at(count, tuple(own.T), 1)
        around = sum(np.roll(count, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1))
        alone += int((around[tuple(own.T)] == 1).sum())
    return alone / len(phase)


def measure(runs):
    measured = {}
    for name, run in runs.items():
        snapshots = run.snapshots()
        measured[f"{name}_strays"] = max(strays(s, float(run.case["resolution"]["spacing"])) for s in snapshots)
        for s in snapshots:
            if abs(s.time - 1.5) < 1e-9:
                measured[f"{name}_front"] = front(s)
    return measured
