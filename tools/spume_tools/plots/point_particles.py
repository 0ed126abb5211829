# SPDX-License-Identifier: MIT
"""Pictures of point particles: positions, clustering, effect on the flow."""
import matplotlib.pyplot as plt
import numpy as np

from ..results.units import field_label
from .planes import field_of, grid_plane, plane_of
from .style import FIELDS, finish, length_label, panels_over_time, time_title, title_of

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
    """Particles of a slab around a plane, two grid spacings thick, over enstrophy (or speed), at the end."""
    grid, bubbles = run.snapshots()[-1], run.snapshots("bubbles")[-1]
    name = "enstrophy" if "vorticity" in grid.fields else "speed"
    plane = plane_of(run)
    panel = grid_plane(run, plane, grid, field_of(grid, name))
    thickness = grid.spacing[plane.normal]
    near = np.abs(bubbles.position[:, plane.normal] - plane.coordinate) < thickness
    place = bubbles.position[near][:, list(plane.axes)]
    shape = (plane.high[1] - plane.low[1]) / (plane.high[0] - plane.low[0])
    figure, axes = plt.subplots(1, 2, figsize=(11.0, np.clip(1.2 + 4.2 * shape, 2.6, 9.0)), layout="compressed")
    for axis, part in zip(axes, (1.0, 0.3)):
        drawn = axis.imshow(panel.values.T, origin="lower", extent=panel.extent, cmap=FIELDS[name],
                            vmax=np.percentile(panel.values, 99.5), interpolation="bilinear", rasterized=True)
        axis.plot(*place.T, "o", color="white", markeredgecolor="black", markeredgewidth=0.2,
                  markersize=1.2 if part == 1 else 3.5)
        low, high = plane.low, plane.low + part * (plane.high - plane.low)
        axis.set(xlabel=length_label("xyz"[plane.axes[0]], run.si), ylabel=length_label("xyz"[plane.axes[1]], run.si),
                 aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axis = "xyz"[plane.normal]
    axes[0].set_title(f"{time_title(grid.time, run.si)}, |{axis} - {plane.coordinate:.3g}| < {thickness:.2g}")
    axes[1].set_title("lower left corner")
    figure.colorbar(drawn, ax=axes, label=field_label(name, run.si), shrink=0.85, extend="max")
    return finish(figure, path, title_of(run))


def draw_series(run, path):
    series = run.series

    def uncertainty(axis, name):
        if name == "overlap_ratio":
            error = 2 * series["overlap_ratio_error"]
            axis.fill_between(series["t"], series[name] - error, series[name] + error, alpha=0.3, linewidth=0)

    figure = panels_over_time(series, [(name, series[name]) for name in PANELS if name in series], uncertainty)
    return finish(figure, path, title_of(run))


def draw_pairs(run, path):
    """Radial distribution function at the first and last time."""
    table = run.table("particle_pairs")
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    for time in np.unique(table["t"])[[0, -1]]:
        rows = (table["t"] == time) & (table["radial_distribution"] > 0)
        axis.loglog(table["distance"][rows], table["radial_distribution"][rows], ".-", label=time_title(time, run.si))
    axis.axhline(1, color="black", linestyle=":")
    axis.set(xlabel=length_label("distance", run.si), ylabel="radial distribution function")
    axis.legend(fontsize=8)
    return finish(figure, path, title_of(run))


def draw_boxes(run, path):
    """Variance of the number of particles in boxes of several sizes over that of random places, first and last time."""
    table = run.table("particle_boxes")
    if not np.any(table["variance"] > 0):
        return []
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    for time in np.unique(table["t"])[[0, -1]]:
        rows = (table["t"] == time) & (table["variance"] > 0)
        axis.loglog(table["side"][rows], table["variance"][rows], "o-", markersize=3, label=time_title(time, run.si))
    axis.axhline(1, color="black", linestyle=":", label="random")
    axis.set(xlabel=length_label("side of the box", run.si), ylabel="variance of the count / Poisson's")
    axis.legend(fontsize=8)
    return [finish(figure, path, title_of(run))]


def draw_overlaps(run, path):
    """Overlaps of the pairs at the last time, where there are any."""
    table = run.table("particle_overlaps")
    rows = table["t"] == table["t"].max()
    if not np.any(table["pairs"][rows] > 0):
        return []
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    axis.semilogy(table["overlap"][rows], table["pairs"][rows], "o-", markersize=3)
    axis.set(xlabel="overlap / diameter", ylabel="probability density", title=time_title(table["t"].max(), run.si))
    return [finish(figure, path, title_of(run))]


PICTURES = (plot_particles,)
