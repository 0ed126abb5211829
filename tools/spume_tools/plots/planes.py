# SPDX-License-Identifier: MIT
"""Fields in a plane at several times: particles coloured by a field, or the middle plane of a grid."""
import numpy as np
from matplotlib.collections import EllipseCollection

from .style import FIELDS, chosen_steps, field_norm, plane_panels


def draw_particles(axis, x, y, values, diameter, cmap, norm):
    """Particles as discs of the given diameter in data units, so that they fill the plane at any zoom."""
    discs = EllipseCollection(np.full(len(x), diameter), np.full(len(x), diameter), np.zeros(len(x)), units="xy",
                              offsets=np.column_stack([x, y]), transOffset=axis.transData, cmap=cmap, norm=norm,
                              linewidths=0, rasterized=True)
    discs.set_array(values)
    axis.add_collection(discs)
    return discs


def draw_slices(run, snapshots, name, path):
    """Panels of particles coloured by one field; in 3-D the particles within half a spacing of the middle plane y."""
    lower, upper = run.bounds()
    spacing = run.spacing
    steps = chosen_steps(run, snapshots)
    loaded = []
    for step in steps:
        snapshot = snapshots[int(step)]
        values = snapshot.field(name)
        if values.ndim > 1:
            values = values[:, -1] if run.dimensions == 2 else np.linalg.norm(values, axis=1)
        position = snapshot.position
        if run.dimensions == 3:
            near = np.abs(position[:, 1] - 0.5 * (lower[1] + upper[1])) <= 0.5 * spacing
            position, values = position[near][:, [0, 2]], values[near]
        loaded.append((snapshot.time, position[:, 0], position[:, 1], values))
    norm = field_norm(name, [values for *_, values in loaded])
    # The frame is the liquid's own extent over all times, not an empty domain around it.
    everything = np.concatenate([np.column_stack([x, y]) for _, x, y, _ in loaded])
    corner = np.column_stack([lower[[0, -1]], upper[[0, -1]]])
    low = np.maximum(np.percentile(everything, 0.02, axis=0) - 2 * spacing, corner[:, 0])
    high = np.minimum(np.percentile(everything, 99.98, axis=0) + 2 * spacing, corner[:, 1])

    def draw(axis, index):
        _, x, y, values = loaded[index]
        return draw_particles(axis, x, y, values, 1.1 * spacing, FIELDS.get(name, "viridis"), norm)

    return plane_panels([time for time, *_ in loaded], low, high, draw, ("x", "y" if run.dimensions == 2 else "z"), name, path)


def draw_grid_slices(run, snapshots, name, path):
    """The middle plane y of a field on a grid at up to six times."""
    lower, upper = run.bounds()
    loaded = []
    for step in chosen_steps(run, snapshots):
        snapshot = snapshots[int(step)]
        values = snapshot.field(name)
        loaded.append((snapshot.time, values[:, values.shape[1] // 2, :]))
    norm = field_norm(name, [values.ravel() for _, values in loaded])
    low, high = lower[[0, 2]], upper[[0, 2]]

    def draw(axis, index):
        return axis.imshow(loaded[index][1].T, origin="lower", extent=(low[0], high[0], low[1], high[1]), norm=norm,
                           cmap=FIELDS.get(name, "viridis"), interpolation="bilinear")

    return plane_panels([time for time, _ in loaded], low, high, draw, ("x", "z"), name, path)


def plot_slices(run, out):
    """Particles coloured by each field at up to six times; in 3-D those of the middle plane; or that plane of a grid."""
    if run.on_grid:
        snapshots = run.grid_snapshots()
        derived = {"velocity": "speed", "vorticity": "enstrophy"}
        names = [derived.get(name, name) for name in snapshots.names]
        return [draw_grid_slices(run, snapshots, name, out / f"{name}.png") for name in names if len(snapshots)]
    snapshots = run.snapshots()
    names = [name for name in FIELDS if name == "speed" or name in snapshots.names]
    return [draw_slices(run, snapshots, name, out / f"{name}.png") for name in names if len(snapshots)]


PICTURES = (plot_slices,)
