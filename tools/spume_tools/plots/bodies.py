# SPDX-License-Identifier: MIT
"""The walls of bodies in a plane, where they stand at a time: bodies.vtp has them at the start, bodies.csv where they go."""
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from .closing import closed, open_edges
from .style import EDGE, SOLID
from .sums import sides_of


@dataclass
class Body:
    """corners (triangles, 3, 3) at the start; outside: all around the shape is solid; taken_away: from those before it."""

    number: int
    corners: np.ndarray
    outside: bool
    taken_away: bool = False


def bodies_of(run, taken_away=False):
    """The bodies that are walls, in the order of the case; if asked for also those that are taken away from others."""
    path = run.folder / "bodies.vtp"
    if not path.exists():
        return []
    walls, others = _bodies_in(path, path.stat().st_mtime_ns, tuple(map(tuple, run.bounds())))
    return sorted(walls + (others if taken_away else []), key=lambda body: body.number)


@lru_cache(maxsize=4)
def _bodies_in(path, _, bounds):
    """Those that are walls and those that are taken away, of a file as it was at a time."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    surface = reader.GetOutput()
    if not surface.GetNumberOfPolys():
        return [], []
    cells = surface.GetCellData()
    number, wall, inside, subtract = (vtk_to_numpy(cells.GetArray(name)) for name in ("body", "wall", "inside", "subtract"))
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)[corners]
    walls, others = [], []
    for n in np.unique(number):
        own = number == n
        body = Body(int(n), points[own] if len(bounds[0]) == 2 else closed(points[own], *bounds), not inside[own][0],
                    bool(subtract[own][0]))
        if body.taken_away:
            others.append(body)
        elif wall[own][0]:
            walls.append(body)
    return walls, others


def turned(vector, points):
    """Points turned about the direction of a vector by its length in degrees (Rodrigues)."""
    angle = np.radians(np.linalg.norm(vector))
    if angle == 0:
        return points
    k = np.asarray(vector) / np.linalg.norm(vector)
    return (points * np.cos(angle) + np.cross(k, points) * np.sin(angle)
            + np.multiply.outer(points @ k, k) * (1 - np.cos(angle)))


def places(run, body):
    """t -> the corners of a body then."""
    table = run.table("bodies") if run.has("bodies.csv") else {}
    if "position_x" not in table:
        return lambda t: body.corners
    rows = np.flatnonzero(table["body"] == body.number)
    axes = range(run.dimensions)

    def size(row):
        return table["scale"][row] if "scale" in table else 1.0

    def at(t):
        row = rows[np.argmin(np.abs(table["t"][rows] - t))]
        vector = [table[f"turn_{a}"][row] if f"turn_{a}" in table else 0.0 for a in "xyz"]
        position, start = (np.array([table["position_" + "xyz"[a]][r] for a in axes] + [0.0] * (3 - len(axes)))
                           for r in (row, rows[0]))
        return position + turned(vector, size(row) * (body.corners - start))

    return at


def copies(run, corners, lower, upper):
    """A body and those of its copies beyond periodic sides that reach into a box: the corners of each."""
    first, last = (extreme(corners, axis=(0, 1)) for extreme in (np.min, np.max))
    shifts = [np.zeros(3)]
    for axis in range(run.dimensions):
        if sides_of(run.case["domain"], axis) != "periodic":
            continue
        sides = run.bounds()
        period = sides[1][axis] - sides[0][axis]
        # What ends on a side, up to the rounding of corners to floats, does not pass it.
        periods = np.arange(np.floor((lower[axis] - last[axis]) / period + 1e-5) + 1,
                            np.ceil((upper[axis] - first[axis]) / period - 1e-5))
        shifts = [shift + period * k * (np.arange(3) == axis) for shift in shifts for k in periods]
    return [corners + shift for shift in shifts]


def standing(run, time, box=None, taken_away=False):
    """Pairs of a body and its corners at a time, one for each of its copies that reach into a box, or into the domain.

    taken_away: as for bodies_of().
    """
    lower, upper = box or run.bounds()
    pairs = []
    for body in bodies_of(run, taken_away):
        corners = places(run, body)(time)
        if np.ptp(corners) == 0:
            continue  # released later, or gone
        # All around the others is solid.
        pairs += [(body, copy) for copy in ([corners] if body.outside else copies(run, corners, lower, upper))]
    return pairs


def outline(corners):
    """The edges (N, 2, 2) of a shape of two dimensions."""
    return open_edges(corners[:, :, :2])


def one_path(corners, frame=None):
    """Triangles, all counter-clockwise, as one path: drawn one by one they leave seams.

    frame: (left, right, bottom, top), of which the path is what lies outside the triangles: they turn against it.
    """
    rings = np.concatenate([corners, corners[:, :1]], axis=1)[:, :, :2]
    shape = Path(rings.reshape(-1, 2), [Path.MOVETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY] * len(corners))
    if frame is None:
        return shape
    low, high = np.minimum(frame[::2], rings.min(axis=(0, 1))), np.maximum(frame[1::2], rings.max(axis=(0, 1)))
    around = [(low[0], low[1]), (low[0], high[1]), (high[0], high[1]), (high[0], low[1]), (low[0], low[1])]
    return Path.make_compound_path(Path(around, closed=True), shape)


def cut(corners, normal, coordinate, axes):
    """Lines (N, 2, 2) in which triangles cross a plane, which is moved by a rounding so that no corner lies on it."""
    coordinate += 1e-7 * np.ptp(corners[:, :, normal])
    height = corners[:, :, normal] - coordinate
    crossing = (height.min(axis=1) < 0) & (height.max(axis=1) > 0)
    corners, height = corners[crossing], height[crossing]
    first, second = [0, 1, 2], [1, 2, 0]  # of the edges, of which two cross the plane
    crossed = (height[:, first] < 0) != (height[:, second] < 0)
    share = height[:, first] / np.where(crossed, height[:, first] - height[:, second], 1.0)
    ends = corners[:, first] + (corners[:, second] - corners[:, first]) * share[..., None]
    return ends[crossed].reshape(-1, 2, 3)[:, :, list(axes)]


def in_parts(run):
    """Whether the bodies are shapes of which none is taken away from others."""
    return not any(body.taken_away for body in bodies_of(run, taken_away=True))


def draw_shapes(axis, run, time):
    """Bodies of two dimensions, of which none is taken away from others, with their outlines."""
    for body, corners in standing(run, time):
        edges = outline(corners)
        frame = (*axis.get_xlim(), *axis.get_ylim()) if body.outside else None
        axis.add_artist(PathPatch(one_path(corners, frame), facecolor=SOLID, edgecolor="none", zorder=3))
        axis.add_collection(LineCollection(edges, colors=EDGE, linewidths=0.8, zorder=3), autolim=False)


def extent_with_bodies(run, plane, times, frame):
    """The frame widened for bodies that are smaller than nine tenths of the domain."""
    low, high = np.array(frame[::2], float), np.array(frame[1::2], float)
    for body, corners in (pair for time in times for pair in standing(run, time)):
        points = corners[:, :, list(plane.axes)].reshape(-1, 2)
        own_low, own_high = points.min(axis=0), points.max(axis=0)
        if body.outside or np.any(own_high - own_low > 0.9 * (plane.high - plane.low)):
            continue
        margin = 0.05 * (own_high - own_low)
        low = np.maximum(np.minimum(low, own_low - margin), np.minimum(plane.low, low))
        high = np.minimum(np.maximum(high, own_high + margin), np.maximum(plane.high, high))
    return low[0], high[0], low[1], high[1]
