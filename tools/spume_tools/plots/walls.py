# SPDX-License-Identifier: MIT
"""The sides of the domain: where those that move stand at a time, and how planes show them."""
import numpy as np
from matplotlib.patches import Rectangle

from .style import EDGE, SOLID
from .sums import side_names, sides_of

WIDTH = 2.2  # of the lines, in points


def bounds_at(run, time):
    """Lower and upper corner of the domain at a time, as the series has them."""
    return _bounds(run, lambda places, _: np.interp(time, run.series["t"], places))


def farthest_bounds(run):
    """Lower and upper corner of the box that the domain keeps within."""
    return _bounds(run, lambda places, extreme: extreme(places))


def _bounds(run, of_places):
    bounds = run.bounds()
    if not (run.case["domain"].get("wall_velocity") or run.case.get("wavemaker")) or not run.has("series.csv"):
        return bounds
    for axis in range(run.dimensions):
        for side, name in enumerate(side_names(run.dimensions, axis)):
            if f"wall_{name}" in run.series and len(run.series):
                bounds[side][axis] = of_places(run.series[f"wall_{name}"], (np.nanmin, np.nanmax)[side])
    return bounds


def draw_walls(axis, run, plane, low, high, frame):
    """Walls at the sides low and high of a plane as thick lines; what lies behind those within the frame is solid."""
    for k, a in enumerate(plane.axes):
        kinds = sides_of(run.case["domain"], a)
        for side, kind in enumerate(kinds if kinds != "periodic" else ()):
            at, edge, width = (low, high)[side][k], frame[2 * k + side], frame[2 * k + 1] - frame[2 * k]
            if kind == "open" or not frame[2 * k] - 1e-6 * width <= at <= frame[2 * k + 1] + 1e-6 * width:
                continue
            if abs(at - edge) < 1e-3 * width:
                axis.spines[(("left", "right"), ("bottom", "top"))[k][side]].set(linewidth=WIDTH, color=EDGE)
                continue
            corner, size = [frame[0], frame[2]], [frame[1] - frame[0], frame[3] - frame[2]]
            corner[k], size[k] = min(at, edge), abs(edge - at)
            axis.add_patch(Rectangle(corner, *size, facecolor=SOLID, edgecolor="none", zorder=2.4))
            (axis.axvline, axis.axhline)[k](at, linewidth=WIDTH, color=EDGE, zorder=3.6)
