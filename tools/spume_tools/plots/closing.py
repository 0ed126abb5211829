# SPDX-License-Identifier: MIT
"""Surfaces of bodies that go on beyond the domain: they are written as far as it, open at their ends, and closed here."""
import numpy as np

NEAR = 1e-6  # of the size of a surface: its corners are floats


def names_of(corners):
    """For each corner of triangles the number of its place, and a corner that is at each place."""
    places = np.round((corners - corners.min(axis=(0, 1))) / np.ptp(corners, axis=(0, 1)).max() / NEAR)
    _, first, names = np.unique(places.reshape(-1, places.shape[-1]), axis=0, return_index=True, return_inverse=True)
    return names.reshape(corners.shape[:2]), corners.reshape(-1, corners.shape[-1])[first]


def open_edges(corners):
    """The edges (N, 2, 2 or 3) that belong to one of some triangles alone, in its direction."""
    edges = np.concatenate([corners[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    names, _ = names_of(edges)
    _, first, count = np.unique(np.sort(names, axis=1), axis=0, return_index=True, return_counts=True)
    return edges[first[count == 1]]


def closed(corners, lower, upper):
    """Triangles (N, 3, 3), outwards, and what closes their surface.

    A pile, whose open ends lie in two planes across an axis, has these closed; a bed or a beach, which is a sheet over the
    box, becomes the solid that lies behind it.
    """
    if not len(open_edges(corners)):
        return corners
    names, places = names_of(corners)
    corners = places[names]  # what is cut must have no cracks
    edges = open_edges(corners)
    size = np.ptp(corners, axis=(0, 1)).max()
    middles, low, high = edges.mean(axis=1), edges.min(axis=(0, 1)), edges.max(axis=(0, 1))
    away = np.max(np.minimum(middles - low, high - middles), axis=0)
    if np.any((away < NEAR * size) & (high - low > NEAR * size)):
        axis = int(np.argmax((away < NEAR * size) & (high - low > NEAR * size)))
        return np.concatenate([corners, *(lid(edges[np.abs(middles[:, axis] - end) < NEAR * size])
                                          for end in (low[axis], high[axis]))])
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
    axis = int(np.argmax(np.abs(normal)))
    ends = min(lower[axis], corners[..., axis].min()) - 0.1 * size, max(upper[axis], corners[..., axis].max()) + 0.1 * size
    behind = ends[0] if normal[axis] > 0 else ends[1]

    def moved(points):
        points = points.copy()
        points[..., axis] = behind
        return points

    start, end = edges[:, 0], edges[:, 1]
    return np.concatenate([corners, moved(corners)[:, ::-1], np.stack([end, start, moved(start)], axis=1),
                           np.stack([end, moved(start), moved(end)], axis=1)])


def lid(edges):
    """Triangles from the edges of a ring to its middle."""
    return np.stack([edges[:, 1], edges[:, 0], np.broadcast_to(edges.mean(axis=(0, 1)), (len(edges), 3))], axis=1)
