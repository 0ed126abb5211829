# SPDX-License-Identifier: MIT
"""Fields in a plane at several times, interpolated between the particles, or as the grid has them."""
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Rectangle

from ..results import MissingResult
from ..results.units import field_label
from .bodies import draw_shapes, extent_with_bodies, in_parts
from .request import Request, request_of
from .shares import beside_bodies, fill_bodies, share_in_plane
from .style import (EDGE, FIELDS, SIGNED, SOLID, chosen_steps, extension, field_norm, finish, keep_ticks, length_label,
                    panel_grid, panel_size, time_title, title_of)
from .sums import SUPPORT, boxes_of, kernel_sums, up_to_openings, with_images
from .walls import bounds_at, draw_walls, farthest_bounds

FINENESS = 0.5  # distance of the sums of a plane, in spacings; coarser where there are more than MOST along a side
MOST = 600
SEEN = 0.02     # kernel sum from which there are averages: beyond it there is no phase, and no interface
WITHIN = 0.7    # share of a point's cell that a body covers where no liquid is drawn
PIXELS = 600    # along the longer side, at least: between the sums pixels are linear


@dataclass
class Plane:
    """axes: of the picture; normal and its coordinate: None in two dimensions; low, high: corners of what the domain ever
    reaches in it."""

    axes: tuple
    normal: int
    coordinate: float
    low: np.ndarray
    high: np.ndarray


@dataclass
class Panel:
    """values (columns, rows), nan outside the liquid; extent: left, right, bottom, top; low, high: corners of the domain
    then; share: the kernel sums that the surface is drawn from, None on grids; phases: of each phase but the first its
    share, whose half is the interface."""

    time: float
    values: np.ndarray
    extent: tuple
    low: np.ndarray
    high: np.ndarray
    share: np.ndarray = None
    phases: tuple = ()


def plane_of(run):
    """The plane that is asked for, as large as the domain; without a request the middle of the second axis."""
    lower, upper = farthest_bounds(run)
    if run.dimensions == 2:
        return Plane((0, 1), None, None, lower, upper)
    normal, coordinate = request_of(run).plane or (1, 0.5 * (lower[1] + upper[1]))
    if not lower[normal] <= coordinate <= upper[normal]:
        raise MissingResult(f"the plane {'xyz'[normal]} = {coordinate:g} is not in the domain, which reaches from "
                            f"{lower[normal]:g} to {upper[normal]:g}")
    axes = tuple(axis for axis in range(3) if axis != normal)
    return Plane(axes, normal, coordinate, lower[list(axes)], upper[list(axes)])


def field_of(snapshot, name, dimensions=3):
    """A scalar field by name; "velocity_x" and its like are components."""
    if name[-2:] in ("_x", "_y", "_z") and name not in snapshot.fields:
        return snapshot.field(name[:-2])[..., "xyz".index(name[-1])]
    values = snapshot.field(name)
    if values.ndim == (1 if hasattr(snapshot, "position") else 3):
        return values
    # In two dimensions the vorticity has one component, out of the plane.
    return values[..., -1] if name == "vorticity" and dimensions == 2 else np.linalg.norm(values, axis=-1)


def particle_plane(run, plane, snapshot, values):
    """The Shepard average of the particles around each pixel, where their kernel sum is one half or more."""
    spacing = run.spacing
    reach = SUPPORT * spacing
    axes = list(plane.axes)
    bounds = bounds_at(run, snapshot.time)
    position, index = with_images(run.case, snapshot.position, reach, bounds)
    beside = None
    if plane.normal is not None:
        away = position[:, plane.normal] - plane.coordinate
        near = np.abs(away) < reach
        position, index, beside = position[near], index[near], away[near] ** 2
    # The frame is that of the liquid where the domain around it is empty.
    own = position[:, axes]
    if not len(own):
        raise MissingResult(f"no liquid near the plane {'xyz'[plane.normal]} = {plane.coordinate:g} at t = {snapshot.time:g}")
    sides = [corner[axes] for corner in bounds]
    low = np.maximum(sides[0], own.min(axis=0) - spacing)
    high = np.minimum(sides[1], own.max(axis=0) + spacing)
    step = max(FINENESS * spacing, np.max(high - low) / MOST)
    shape = np.maximum(2, np.ceil((high - low) / step - 1e-6).astype(int) + 1)
    phase = snapshot.field("phase") if "phase" in snapshot.fields else np.zeros(len(values))
    inside = [(phase[index] == number).astype(float) for number in np.unique(phase)[1:]]
    sums = kernel_sums(own, spacing, low, step, shape, (values[index], *inside), beside)
    weight, *totals = up_to_openings(run.case, axes, sides, low, step, spacing, sums)
    fine = finer(weight)
    total, *phases = (np.where(fine > SEEN, finer(sums) / np.maximum(fine, SEEN), np.nan) for sums in totals)
    bodies = share_in_plane(run, plane, snapshot.time, low, step, shape)
    weight = finer(weight if bodies is None else beside_bodies(weight, bodies[1]))
    if bodies is not None and plane.normal is not None:
        # Bodies are drawn over the liquid: it ends a little behind their faces.
        weight[finer(bodies[0]) > WITHIN] = np.nan
    drawn = np.where(weight >= 0.5, total, np.nan)
    return Panel(snapshot.time, drawn, extent_of(low, low + (shape - 1) * step, drawn.shape), *sides, weight, tuple(phases))


def extent_of(low, high, shape):
    """Of an image whose outermost pixels have their middles at two corners."""
    half = 0.5 * (high - low) / (np.array(shape) - 1)
    return (low[0] - half[0], high[0] + half[0], low[1] - half[1], high[1] + half[1])


def finer(values):
    """The same values, linearly interpolated to PIXELS at least along the longer side."""
    times = max(1, int(np.ceil(PIXELS / max(values.shape))))
    for axis in (0, 1):
        n = values.shape[axis]
        place = np.linspace(0, n - 1, (n - 1) * times + 1)
        first = np.minimum(place.astype(int), n - 2)
        share = np.expand_dims(place - first, 1 - axis)
        values = (1 - share) * np.take(values, first, axis) + share * np.take(values, first + 1, axis)
    return values


def grid_plane(run, plane, snapshot, values):
    """The field of a periodic grid on a plane, linear between the two layers beside it, exact on one."""
    n = values.shape[plane.normal]
    place = (plane.coordinate - snapshot.origin[plane.normal]) / snapshot.spacing[plane.normal]
    first = int(np.floor(place + 1e-9))
    share = max(0.0, place - first)
    drawn = np.take(values, first % n, axis=plane.normal)
    if share > 1e-9:
        drawn = (1 - share) * drawn + share * np.take(values, (first + 1) % n, axis=plane.normal)
    # The first points follow on the last ones.
    drawn = finer(np.pad(drawn, ((0, 1), (0, 1)), mode="wrap"))
    axes = list(plane.axes)
    low = snapshot.origin[axes]
    high = low + snapshot.spacing[axes] * [values.shape[a] for a in axes]
    return Panel(snapshot.time, drawn, extent_of(low, high, drawn.shape), plane.low, plane.high)


def panels_of(run, name, snapshots, steps):
    plane = plane_of(run)
    panels = []
    for step in steps:
        snapshot = snapshots[int(step)]
        values = field_of(snapshot, name, run.dimensions)
        panels.append((grid_plane if run.on_grid else particle_plane)(run, plane, snapshot, values))
    return plane, panels


def frame_of(panels):
    """Left, right, bottom, top of a frame that holds the liquid of all panels."""
    extents = np.array([panel.extent for panel in panels])
    low, high = np.min([panel.low for panel in panels], axis=0), np.max([panel.high for panel in panels], axis=0)
    return (max(extents[:, 0].min(), low[0]), min(extents[:, 1].max(), high[0]),
            max(extents[:, 2].min(), low[1]), min(extents[:, 3].max(), high[1]))


def widened(values):
    """Values with those of a neighbour in two rows of pixels around them."""
    values = values.copy()
    for rows in (values, values.T, values, values.T):
        for here, there in ((rows[:-1], rows[1:]), (rows[1:], rows[:-1])):
            np.copyto(here, there.copy(), where=np.isnan(here))
    return values


def draw_panel(axis, run, plane, panel, frame, name, norm):
    """One panel with walls and solids; returns the image."""
    surface = panel.share is not None and np.nanmin(panel.share) < 0.5
    image = axis.imshow((widened(panel.values) if surface else panel.values).T, origin="lower", extent=panel.extent, norm=norm,
                        interpolation="nearest", cmap=FIELDS.get(name, "RdBu_r" if name in SIGNED else "viridis"), rasterized=True)
    if surface:
        # Pixels end in steps: they go on a little beyond the surface, and are covered there, up to the edges of the outermost.
        share = np.pad(panel.share, 1, mode="edge").T
        pixel = np.diff(panel.extent)[::2] / panel.share.shape
        extent = panel.extent + np.repeat(pixel, 2) * [-1, 1, -1, 1]
        axis.contourf(share, levels=[-np.inf, 0.5], extent=extent, colors=["white"], origin="lower", zorder=2.1)
        if np.nanmax(share) > 0.5:
            axis.contour(share, levels=[0.5], extent=extent, colors=[EDGE], linewidths=0.7, origin="lower", zorder=2.2)
    for phase in panel.phases:
        if np.nanmin(phase) < 0.5 < np.nanmax(phase):
            for color, width in ((EDGE, 1.8), ("white", 0.8)):  # seen on dark and on light
                axis.contour(phase.T, levels=[0.5], extent=panel.extent, colors=[color], linewidths=width, origin="lower")
    axis.set(xlim=frame[:2], ylim=frame[2:], aspect="equal", title=time_title(panel.time, run.si))
    for side in ("top", "right"):
        axis.spines[side].set_visible(True)
    for low, high in boxes_of(run.case, bounds_at(run, panel.time)):
        if plane.normal is None or low[plane.normal] <= plane.coordinate <= high[plane.normal]:
            corner = low[list(plane.axes)]
            axis.add_patch(Rectangle(corner, *(high - low)[list(plane.axes)], facecolor=SOLID, edgecolor=EDGE, linewidth=0.8, zorder=3))
    if plane.normal is None and in_parts(run):
        draw_shapes(axis, run, panel.time)
    else:
        fill_bodies(axis, run, plane, panel.time)
    draw_walls(axis, run, plane, panel.low, panel.high, frame)
    return image


def plane_figure(run, name, plane, panels, norm, ends, most=None):
    """Panels of one plane with one colour bar."""
    frame = extent_with_bodies(run, plane, [panel.time for panel in most or panels], frame_of(most or panels))
    width, height = frame[1] - frame[0], frame[3] - frame[2]
    rows, columns = panel_grid(len(panels), width, height)
    size = panel_size(rows, columns, width, height)
    figure, axes = plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True, constrained_layout=True,
                                figsize=(columns * (width * size + 0.15) + 1.5, rows * (height * size + 0.35) + 0.8))
    for axis in axes.flat[len(panels):]:
        axis.remove()
    for axis, panel in zip(axes.flat, panels):
        image = draw_panel(axis, run, plane, panel, frame, name, norm)
    for axis in axes.flat[max(0, len(panels) - columns):len(panels)]:  # the lowest of each column
        axis.set_xlabel(length_label("xyz"[plane.axes[0]], run.si))
        axis.tick_params(labelbottom=True)
    for axis in axes[:, 0]:
        axis.set_ylabel(length_label("xyz"[plane.axes[1]], run.si))
    figure.colorbar(image, ax=[a for a in axes.flat if a.figure], label=field_label(name, run.si), shrink=0.9, extend=ends,
                    aspect=30)
    where = "" if plane.normal is None else f", {'xyz'[plane.normal]} = {plane.coordinate:.4g}" + (" m" if run.si else "")
    figure.suptitle(f"{title_of(run)}: {field_label(name)}{where}")
    keep_ticks(figure, axes.flat[:len(panels)])
    # Narrow panels have less room than was meant for them between the labels of one another.
    place, inches = axes[0, 0].get_position(original=True), figure.get_size_inches()
    lacks = np.maximum(0, size * np.array([width, height]) - inches * place.size)
    figure.set_size_inches(inches + lacks * [columns, rows])
    return figure


def draw_slices(run, snapshots, name, path):
    """One field at up to six times."""
    plane, panels = panels_of(run, name, snapshots, chosen_steps(run, snapshots))
    samples = [panel.values for panel in panels]
    norm = field_norm(name, samples, request_of(run).ranges.get(name))
    return finish(plane_figure(run, name, plane, panels, norm, extension(norm, samples)), path)


def drawn_fields(run, snapshots):
    """The fields asked for; without a request the scalars that the run has of those that are worth it."""
    asked = request_of(run).fields
    if asked:
        return asked
    names = set(snapshots.names) | {"speed"} if "velocity" in snapshots.names else set(snapshots.names)
    if run.on_grid and "vorticity" in names:
        names = names - {"vorticity"} | {"enstrophy"}
    return [name for name in FIELDS if name in names]


def refuse_what_is_not_there(run):
    """Raises MissingResult for fields, ranges, times and a plane that are asked for and that the run does not have."""
    request = request_of(run)
    snapshots = run.snapshots() if request != Request() else ()
    if not len(snapshots):
        return
    plane_of(run)
    for name in (*request.fields, *request.ranges):
        field_of(snapshots[0], name, run.dimensions)
    first, last = snapshots.times[0], snapshots.times[-1]
    late = 0.5 * (last - first) / max(len(snapshots) - 1, 1)  # half of what lies between two
    for time in request.times:
        if not first - late - 1e-9 <= time <= last + late + 1e-9:
            raise MissingResult(f"no snapshot near t = {time:g}; the run has them from {first:g} to {last:g}")


def plot_slices(run, out):
    """Each field in a plane at up to six times: the middle of the second axis, or what is asked for."""
    snapshots = run.snapshots()
    if not len(snapshots):
        return []
    return [draw_slices(run, snapshots, name, out / f"{name}.png") for name in drawn_fields(run, snapshots)]


PICTURES = (plot_slices,)
