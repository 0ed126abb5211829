# SPDX-License-Identifier: MIT
"""Pictures of point particles: positions, clustering, effect on the flow."""
import matplotlib.pyplot as plt
import numpy as np

from ..results import read_csv
from .style import FIELDS, finish, panels_over_time

PANELS = ("particle_rms_velocity", "particle_rms_acceleration", "particle_rms_slip", "overlap_ratio",
          "box_count_variance", "correlation_dimension", "particle_work", "clipped_force", "max_volume_fraction",
          "overlapping", "collisions", "kaplan_yorke_dimension")


def plot_particles(run, out):
    """Everything that a run with particles left; nothing for one without."""
    files = []
    if run.has("bubbles.vtkhdf") and run.on_grid:
        files.append(draw_slab(run, out / "bubbles.png"))
    if "particle_rms_velocity" in run.series:
        files.append(draw_series(run, out / "particles.png"))
    if run.has("particle_pairs.csv"):
        files.append(draw_pairs(run, out / "particle_pairs.png"))
    if run.has("particle_boxes.csv"):
        files += draw_boxes(run, out / "particle_boxes.png")
    if run.has("particle_overlaps.csv"):
        files += draw_overlaps(run, out / "particle_overlaps.png")
    return files


def draw_slab(run, path):
    """Particles of a slab around the middle plane y, two grid spacings thick, over enstrophy (or speed), at the end."""
    grid, bubbles = run.grid_snapshots()[-1], run.snapshots("bubbles")[-1]
    name = "enstrophy" if "vorticity" in grid.fields else "speed"
    values = grid.field(name)
    middle = values.shape[1] // 2
    lower, upper = run.bounds()
    image = values[:, middle, :].T
    height = grid.origin[1] + middle * grid.spacing[1]
    near = np.abs(bubbles.position[:, 1] - height) < grid.spacing[1]
    figure, axes = plt.subplots(1, 2, figsize=(11.5, 5.2), constrained_layout=True)
    for axis, part in zip(axes, (1.0, 0.3)):
        drawn = axis.imshow(image, origin="lower", extent=(lower[0], upper[0], lower[2], upper[2]),
                            cmap=FIELDS.get(name, "viridis"), vmax=np.percentile(image, 99.5), interpolation="bilinear")
        axis.plot(bubbles.position[near, 0], bubbles.position[near, 2], "o", color="white", markeredgecolor="black",
                  markeredgewidth=0.2, markersize=1.2 if part == 1 else 3.5)
        axis.set(xlabel="x", ylabel="z", aspect="equal", xlim=(lower[0], lower[0] + part * (upper[0] - lower[0])),
                 ylim=(lower[2], lower[2] + part * (upper[2] - lower[2])))
    axes[0].set_title(f"t = {grid.time:.4g}, |y - {height:.3g}| < {grid.spacing[1]:.2g}")
    figure.colorbar(drawn, ax=axes, label=name, shrink=0.85, extend="max")
    return finish(figure, path)


def draw_series(run, path):
    series = run.series

    def uncertainty(axis, name):
        if name == "overlap_ratio":
            error = 2 * series["overlap_ratio_error"]
            axis.fill_between(series["t"], series[name] - error, series[name] + error, alpha=0.3, linewidth=0)

    figure = panels_over_time(series, [(name, series[name]) for name in PANELS if name in series], uncertainty)
    return finish(figure, path)


def draw_pairs(run, path):
    """Radial distribution function at the first and last time."""
    table = read_csv(run.folder / "particle_pairs.csv")
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    for time in np.unique(table["t"])[[0, -1]]:
        rows = (table["t"] == time) & (table["radial_distribution"] > 0)
        axis.loglog(table["distance"][rows], table["radial_distribution"][rows], ".-", label=f"t = {time:.4g}")
    axis.axhline(1, color="black", linestyle=":")
    axis.set(xlabel="distance", ylabel="radial distribution function")
    axis.legend(fontsize=8)
    return finish(figure, path)


def draw_boxes(run, path):
    """Variance of the number of particles in boxes of several sizes over that of random places, first and last time."""
    table = read_csv(run.folder / "particle_boxes.csv")
    if not np.any(table["variance"] > 0):
        return []
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    for time in np.unique(table["t"])[[0, -1]]:
        rows = (table["t"] == time) & (table["variance"] > 0)
        axis.loglog(table["side"][rows], table["variance"][rows], "o-", markersize=3, label=f"t = {time:.4g}")
    axis.axhline(1, color="black", linestyle=":", label="random")
    axis.set(xlabel="side of the box", ylabel="variance of the count / Poisson's")
    axis.legend(fontsize=8)
    return [finish(figure, path)]


def draw_overlaps(run, path):
    """Overlaps of the pairs at the last time, where there are any."""
    table = read_csv(run.folder / "particle_overlaps.csv")
    rows = table["t"] == table["t"].max()
    if not np.any(table["pairs"][rows] > 0):
        return []
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    axis.semilogy(table["overlap"][rows], table["pairs"][rows], "o-", markersize=3)
    axis.set(xlabel="overlap / diameter", ylabel="probability density", title=f"t = {table['t'].max():.4g}")
    return [finish(figure, path)]


PICTURES = (plot_particles,)
