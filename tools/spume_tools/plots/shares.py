# SPDX-License-Identifier: MIT
"""The share of the kernel that bodies take at the points of a grid.

Liquid ends at a body, and so do kernel sums of its particles: beside a wall they are half of what they are inside. Divided
by what the bodies leave of the kernel, the sums are those of liquid that goes on behind the wall, and its drawn surface is
that of the body.
"""
import numpy as np

from .bodies import cut, outline, standing
from .style import EDGE, SOLID
from .sums import SUPPORT

# Of the kernel, what is divided by at least: less is left only within bodies and in the narrowest of their corners.
LEAST_LEFT = 0.2
FINER = 4  # samples across a cell of the grid in a plane, along each axis; along one of them cells are cut exactly
FINER_3D = 2
FILLED = 800  # cells along the longer side of a frame, in which bodies are filled


def kernel_weights(spacing, step, d):
    """Offsets in points and weights of the kernel on a grid; the weights add up to 1."""
    reach = int(SUPPORT * spacing / step)
    offsets = np.stack(np.meshgrid(*[np.arange(-reach, reach + 1)] * d, indexing="ij"), -1).reshape(-1, d)
    q = np.linalg.norm(offsets, axis=1) * step / spacing
    weights = np.where(q < SUPPORT, (1 - 0.5 * q) ** 4 * (1 + 2 * q), 0.0)
    return offsets[weights > 0], weights[weights > 0] / weights.sum()


def smeared(covered, spacing, step):
    """The kernel sum of a share that is known at all points of a grid, and goes on at its edges."""
    offsets, weights = kernel_weights(spacing, step, covered.ndim)
    margin = int(np.max(offsets)) if len(offsets) else 0
    wide = np.pad(covered, margin, mode="edge")
    total = np.zeros(covered.shape)
    for offset, weight in zip(offsets, weights):
        total += weight * wide[tuple(slice(margin + k, margin + k + n) for k, n in zip(offset, covered.shape))]
    return total


def covered_cells(lines, low, step, shape, finer=FINER):
    """The share of each cell around the points low + step * (i, j) that lies inside closed lines (N, 2, 2)."""
    columns = low[0] + step * ((np.arange(shape[0] * finer) + 0.5) / finer - 0.5)
    edges = low[1] + step * (np.arange(shape[1] + 1) - 0.5)
    inside = np.zeros((len(columns), shape[1]))
    swap = lines[:, 0, 0] > lines[:, 1, 0]
    left, right = (np.where(swap[:, None], lines[:, one], lines[:, other]) for one, other in ((1, 0), (0, 1)))
    first, last = np.searchsorted(columns, [lines[:, :, 0].min(), lines[:, :, 0].max()]) if len(lines) else (0, 0)
    for i in range(first, last):
        x = columns[i]
        crossed = (left[:, 0] <= x) & (right[:, 0] > x)
        a, b = left[crossed], right[crossed]
        heights = np.sort(a[:, 1] + (b[:, 1] - a[:, 1]) * (x - a[:, 0]) / (b[:, 0] - a[:, 0]))
        for lower, upper in zip(heights[::2], heights[1::2]):
            inside[i] += np.diff(np.clip(edges, lower, upper))
    return np.clip(inside.reshape(shape[0], finer, shape[1]).mean(axis=1) / step, 0, 1)


def joined(total, covered, body):
    """What bodies cover with one more of them, which may be taken away from those before it."""
    covered = 1 - covered if body.outside else covered
    if body.taken_away:
        return None if total is None else np.minimum(total, 1 - covered)
    return covered if total is None else np.maximum(total, covered)


def covered_in_plane(run, plane, time, low, step, shape):
    """The share of each cell of a plane that bodies cover; None without bodies."""
    total = None
    lower, upper = run.bounds()
    reach = SUPPORT * run.spacing
    for body, corners in standing(run, time, (lower - reach, upper + reach), taken_away=True):
        lines = outline(corners) if plane.normal is None else cut(corners, plane.normal, plane.coordinate, plane.axes)
        covered = covered_cells(lines, low, step, shape)
        total = joined(total, covered, body)
    return total


def share_in_plane(run, plane, time, low, step, shape):
    """What covered_in_plane() gives, and the share of the kernel that bodies take; None without bodies."""
    covered = covered_in_plane(run, plane, time, low, step, shape)
    return None if covered is None else (covered, smeared(covered, run.spacing, step))


def fill_bodies(axis, run, plane, time):
    """Fills what bodies cover of a plane, up to its frame, where one path does not tell it: where a plane cuts them, or
    some are taken away from others."""
    low, high = (np.array([limits[side] for limits in (axis.get_xlim(), axis.get_ylim())]) for side in (0, 1))
    step = (high - low).max() / FILLED
    shape = np.ceil((high - low) / step).astype(int) + 1
    covered = covered_in_plane(run, plane, time, low, step, shape)
    if covered is None or covered.max() < 0.5:
        return
    x, y = (low[k] + step * np.arange(shape[k]) for k in (0, 1))
    axis.contourf(x, y, covered.T, levels=[0.5, 2], colors=[SOLID], zorder=2.3)
    if covered.min() < 0.5:
        axis.contour(x, y, covered.T, levels=[0.5], colors=[EDGE], linewidths=0.8, zorder=2.35)


def share_in_space(run, time, low, step, shape):
    """The share of the kernel that bodies take at the points low + step * (i, j, k); None without bodies."""
    total = None
    reach = SUPPORT * run.spacing
    box = low - reach, low + step * (np.array(shape) - 1) + reach
    for body, corners in standing(run, time, box, taken_away=True):
        covered = np.zeros(shape)
        for k in range(shape[2]):
            height = low[2] + k * step
            if corners[:, :, 2].min() < height < corners[:, :, 2].max():
                covered[:, :, k] = covered_cells(cut(corners, 2, height, (0, 1)), low, step, shape[:2], FINER_3D)
        total = joined(total, covered, body)
    return None if total is None else smeared(total, run.spacing, step)


def beside_bodies(sums, share):
    """Kernel sums of liquid, as if it went on behind the walls of bodies."""
    return sums / np.maximum(1 - share, LEAST_LEFT)
