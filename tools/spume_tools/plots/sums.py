# SPDX-License-Identifier: MIT
"""Kernel sums of particles at the points of a grid: how much liquid is there, and fields interpolated between particles.

The kernel is Wendland's C2, W = (1 - q/2)^4 (1 + 2 q) for q = r / spacing < 2 (Wendland 1995). Sums are over particles and
their images beyond walls, solids and periodic sides, as the solver has them.
"""
import numpy as np

SUPPORT = 2.0  # in spacings
BLOCK = 20000  # particles whose distances fit into the cache
BEHIND_FIRST = 1.5  # spacings from an opening, behind the first particles beside it
# Integrals of W in units of the spacing: its sum over a lattice of one spacing, on average over the places of its points.
INTEGRAL = {2: 4 * np.pi / 7, 3: 16 * np.pi / 21}
SIDES = (("left", "right"), ("front", "back"), ("bottom", "top"))


def side_names(dimensions, axis):
    return SIDES[2] if axis == dimensions - 1 else SIDES[axis]


def sides_of(domain, axis):
    """"periodic", or the kinds of the two sides of an axis ("open" where none is named)."""
    if domain.get("xyz"[axis]) == "periodic":
        return "periodic"
    return tuple(domain.get(name, "open") for name in side_names(len(domain["lower"]), axis))


def opened(case, axis):
    """Whether each of the two sides of an axis has an opening."""
    sides = {opening.get("side") for kind in ("inflow", "outflow") for opening in case.get(kind, [])}
    return tuple(name in sides for name in side_names(len(case["domain"]["lower"]), axis))


def continued(case, axis):
    """Whether there are images behind each of the two sides of an axis: liquid ends at open ones without an opening."""
    kinds = sides_of(case["domain"], axis)
    return (True, True) if kinds == "periodic" else tuple(
        kind != "open" or open_there for kind, open_there in zip(kinds, opened(case, axis)))


def boxes_of(case, bounds=None):
    """Lower and upper corners of the solid boxes of a case, within the domain, whose corners may be given."""
    lower, upper = bounds or (np.array(case["domain"]["lower"], float), np.array(case["domain"]["upper"], float))
    boxes = [(np.maximum(box["lower"], lower), np.minimum(box["upper"], upper)) for box in case.get("solid", [])]
    return [(low, high) for low, high in boxes if np.all(high > low)]


def with_images(case, position, reach, bounds=None):
    """Places of the particles and of their images within `reach` of the sides, and the index of the particle of each.

    bounds: lower and upper corner of the domain, where these are not those of the case.
    """
    lower, upper = bounds or (np.array(case["domain"]["lower"], float), np.array(case["domain"]["upper"], float))
    d = len(lower)
    index = np.arange(len(position))
    for low, high in boxes_of(case, bounds):
        at, of = [position], [index]
        for axis in range(d):
            for plane, outward in ((low[axis], -1), (high[axis], 1)):
                depth = (position[:, axis] - plane) * outward
                image = position.copy()
                image[:, axis] = 2 * plane - image[:, axis]
                keep = (depth >= 0) & (depth < reach) & np.all((image[:, :d] > low) & (image[:, :d] < high), axis=1)
                at.append(image[keep])
                of.append(index[keep])
        position, index = np.concatenate(at), np.concatenate(of)
    for axis in range(d):
        kind = sides_of(case["domain"], axis)
        at, of = [position], [index]
        for side, (plane, other) in enumerate(((lower[axis], upper[axis]), (upper[axis], lower[axis]))):
            near = np.abs(position[:, axis] - plane) < reach
            image = position[near].copy()
            if kind == "periodic":
                image[:, axis] += other - plane
            elif not continued(case, axis)[side]:
                continue
            else:
                image[:, axis] = 2 * plane - image[:, axis]
            at.append(image)
            of.append(index[near])
        position, index = np.concatenate(at), np.concatenate(of)
    return position, index


def kernel_sums(position, spacing, origin, step, shape, weights=(), beside=None):
    """Sums of W / (integral of W) at the points origin + step * (i, j[, k]), and the same times each of the weights.

    position (N, 2 or 3): of particles a spacing apart; beside: squared distance of each from the plane of the points,
    for particles of three dimensions that are summed in a plane. Returns an array per sum, of the given shape.
    """
    shape, d = tuple(shape), len(shape)
    reach = SUPPORT * spacing
    out = [np.zeros(int(np.prod(shape))) for _ in range(1 + len(weights))]
    in_plane = beside is not None
    beside = beside if in_plane else np.zeros(len(position))
    across = int(2 * reach / step) + 1
    strides = [int(np.prod(shape[axis + 1:])) for axis in range(d)]
    for start in range(0, len(position), BLOCK):
        part = slice(start, start + BLOCK)
        place = (position[part] - origin) / step
        first = np.ceil(place - reach / step).astype(np.int64)
        # Squared distance and part of the index of a point, per axis and offset; points off the grid are out of reach.
        cells = [first[:, axis] + np.arange(across)[:, None] for axis in range(d)]
        squares = [np.where((cell >= 0) & (cell < shape[axis]), ((cell - place[:, axis]) * step) ** 2, np.inf)
                   for axis, cell in enumerate(cells)]
        parts = [cell * stride for cell, stride in zip(cells, strides)]
        for offset in np.ndindex(*(across,) * d):
            r2 = beside[part] + sum(squares[axis][k] for axis, k in enumerate(offset))
            near = np.flatnonzero(r2 < reach**2)
            if not len(near):
                continue
            q = np.sqrt(r2[near]) / spacing
            w = (1 - 0.5 * q) ** 4 * (1 + 2 * q)
            at = sum(parts[axis][k][near] for axis, k in enumerate(offset))
            for total, weight in zip(out, (None, *weights)):
                total += np.bincount(at, w if weight is None else w * weight[part][near], len(total))
    integral = INTEGRAL[3 if in_plane else d]
    return [total.reshape(shape) / integral for total in out]


def up_to_openings(case, axes, sides, low, step, spacing, sums):
    """Kernel sums at the points low + step * (i, j[, k]), along some axes, as they are without the gaps at openings.

    Particles enter and leave one by one. Where the sums lack some beside an opening they are those behind the first of
    them. sides: lower and upper ends of these axes.
    """
    deep = int(np.ceil(BEHIND_FIRST * spacing / step))
    for k, axis in enumerate(axes):
        for side, has_opening in enumerate(opened(case, axis)):
            rows = [np.moveaxis(one, k, 0) for one in sums]
            inner = int(round((sides[side][k] - low[k]) / step)) + (deep, -deep)[side]
            if not has_opening or not 0 <= inner < len(rows[0]):
                continue
            for row in (range(inner), range(inner + 1, len(rows[0])))[side]:
                lacks = rows[0][row] < rows[0][inner]
                for one in rows:
                    one[row][lacks] = one[inner][lacks]
    return sums
