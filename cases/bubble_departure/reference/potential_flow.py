#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A planar bubble on a floor that a constant flow fills through a point, in potential flow: prints the area at which its
foot closes. Lengths and times in which the flow and gravity are 1; the gas has no weight.

The surface from the floor to the top is a row of straight panels with sources, mirrored in the floor and in the plane of
symmetry. Along the surface d phi/dt = |u|^2/2 - z + sigma kappa + C(t); C is such that the area grows at the rate 1, by the
motion of the nodes. The foot slides along the floor at a right angle. Nodes are spread evenly after each step, and waves of
two panels damped.

    potential_flow.py [tension [panels]]
"""
import sys

import numpy as np
from scipy.interpolate import PchipInterpolator

STEP = 0.06     # over the number of panels
LOST = 0.02     # most of the area, in which the nodes then no longer keep up
DAMPING = 0.5   # of waves of two panels, a step
CLOSED = 0.015  # half width


def panel_sources(x, z, x1, z1, x2, z2):
    """Potential and velocity at points of panels of unit sources ln(r)/(2 pi)."""
    length = np.hypot(x2 - x1, z2 - z1)
    tx, tz = (x2 - x1) / length, (z2 - z1) / length
    s, n = (x - x1) * tx + (z - z1) * tz, (z - z1) * tx - (x - x1) * tz
    near, far = np.maximum(s**2 + n**2, 1e-30), np.maximum((s - length) ** 2 + n**2, 1e-30)
    angle = np.arctan2(n * length, n**2 + s**2 - s * length)
    potential = (0.5 * s * np.log(near) - 0.5 * (s - length) * np.log(far) - length + n * angle) / (2 * np.pi)
    along, across = 0.5 * np.log(near / far) / (2 * np.pi), angle / (2 * np.pi)
    return potential, along * tx - across * tz, along * tz + across * tx


def node_velocities(x, z, phi):
    """Of the surface whose nodes have the potential phi but for a constant, where its area grows at the rate 1."""
    dx, dz = np.diff(x), np.diff(z)
    length, count = np.hypot(dx, dz), len(dx)
    at_x, at_z = (x[1:] + x[:-1]) / 2, (z[1:] + z[:-1]) / 2
    potential, u, w = np.zeros((3, count, count))
    own = np.arange(count)
    for sign_x in (1, -1):
        for sign_z in (1, -1):
            ends = (sign_x * x[:-1], sign_z * z[:-1], sign_x * x[1:], sign_z * z[1:])
            found = panel_sources(at_x[:, None], at_z[:, None], *(end[None] for end in ends))
            if sign_x == sign_z == 1:  # on the panel itself: the liquid is on the right of it
                found[1][own, own], found[2][own, own] = 0.5 * dz / length, -0.5 * dx / length
            potential, u, w = potential + found[0], u + found[1], w + found[2]
    to_node = np.zeros((count + 1, count))
    inner = own[1:]
    to_node[inner, inner - 1] = length[1:] / (length[1:] + length[:-1])
    to_node[inner, inner] = 1 - to_node[inner, inner - 1]
    to_u, to_w = to_node.copy(), to_node
    to_u[0, 0] = to_w[-1, -1] = 1  # the foot slides, the top rises
    u, w = to_u @ u, to_w @ w
    growth = (((u[1:] + u[:-1]) * dz[:, None]) + (x[1:] + x[:-1])[:, None] * np.diff(w, axis=0)).sum(axis=0)
    matrix = np.block([[potential, -np.ones((count, 1))], [growth[None], np.zeros((1, 1))]])
    sources = np.linalg.solve(matrix, np.append((phi[1:] + phi[:-1]) / 2, 1.0))[:-1]
    return u @ sources, w @ sources


def mirrored(f, floor, top, count):
    """f along the surface with `count` values beyond both ends, even (1) or odd (-1) about them."""
    return np.concatenate([floor * f[1:count + 1][::-1], f, top * f[-count - 1:-1][::-1]])


def curvature(x, z):
    x, z = mirrored(x, 1, -1, 1), mirrored(z, -1, 1, 1)
    x1, z1, x2, z2 = x[2:] - x[:-2], z[2:] - z[:-2], np.diff(x, 2), np.diff(z, 2)
    return 4 * (x1 * z2 - z1 * x2) / (x1**2 + z1**2) ** 1.5


def spread(x, z, phi):
    s = np.append(0, np.cumsum(np.hypot(np.diff(x), np.diff(z))))
    even = PchipInterpolator(s, np.stack([x, z, phi]), axis=1)(np.linspace(0, s[-1], len(x)))
    result = []
    for f, floor, top in zip(even, (1, -1, 1), (-1, 1, 1)):
        b = mirrored(f, floor, top, 2)
        result.append(f - DAMPING / 16 * (b[:-4] - 4 * b[1:-3] + 6 * b[2:-2] - 4 * b[3:-1] + b[4:]))
    result[0][0], result[1][0], result[0][-1] = even[0][0], 0, 0
    return result


def area(x, z):
    return float(((x[1:] + x[:-1]) * np.diff(z)).sum())


def rates(x, z, phi, tension):
    u, w = node_velocities(x, z, phi)
    return u, w, (u**2 + w**2) / 2 - z + tension * curvature(x, z)


def closing(tension, panels, start=0.15):
    """Rows of time, area, half width of the foot and height of the top, from a half disc at rest until the foot closes."""
    angle = np.linspace(0, np.pi / 2, panels + 1)
    x, z, phi = start * np.cos(angle), start * np.sin(angle), np.zeros(panels + 1)
    time, rows, step = area(x, z), [], STEP / panels
    while x[:panels // 2].min() > CLOSED:
        first = rates(x, z, phi, tension)
        second = rates(*(f + step / 2 * rate for f, rate in zip((x, z, phi), first)), tension)
        x, z, phi = spread(*(f + step * rate for f, rate in zip((x, z, phi), second)))
        phi -= phi.mean()
        time += step
        rows.append((time, area(x, z), x[0], z[-1]))
        if not abs(rows[-1][1] / time - 1) < LOST:
            raise SystemExit(f"the area is {rows[-1][1]:.3f} at t = {time:.3f}: take fewer panels")
    return np.array(rows)


if __name__ == "__main__":
    tension = float(sys.argv[1]) if len(sys.argv) > 1 else 0.0
    panels = int(sys.argv[2]) if len(sys.argv) > 2 else 60
    rows = closing(tension, panels)
    for row in rows[::len(rows) // 15]:
        print("t {:.3f}  area {:.3f}  half width of the foot {:.3f}  top {:.3f}".format(*row))
    print(f"area when the foot closes: {rows[-1][1]:.3f}")
