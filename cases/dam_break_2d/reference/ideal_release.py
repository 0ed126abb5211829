# SPDX-License-Identifier: MIT
"""The front of a column of ideal liquid that is let go at once: potential flow, boundary elements.

Mixed Eulerian-Lagrangian method (Longuet-Higgins and Cokelet 1976, Proc. R. Soc. A 350:1). The potential on the free
surface follows d phi / dt = |grad phi|^2 / 2 - g y; its normal derivative q solves

    sum over the elements of (phi - phi_i) dG/dn - G q = 0,    G = ln r / (2 pi),

with linear elements, whose integrals are exact, and images in the wall x = 0 and the bottom y = 0. Runge-Kutta of fourth
order; after every step the nodes are spread anew along a cubic spline, closer towards the front.

    /usr/bin/python3 ideal_release.py [NODES]     writes ideal_release.csv
"""
import sys

import numpy as np


def element_integrals(field, nodes):
    """G and dG/dn of every element's two shape functions at every field point: four (points, elements) arrays."""
    start, along = nodes[:-1], np.diff(nodes, axis=0)
    length = np.hypot(*along.T)
    tangent = along / length[:, None]
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    away = field[:, None, :] - start[None]
    a = np.einsum("ijk,jk->ij", away, tangent)
    b = np.einsum("ijk,jk->ij", away, normal)
    b[np.abs(b) < 1e-12] = 0.0

    def antiderivatives(u):
        r2 = np.maximum(u * u + b * b, 1e-300)
        log = 0.5 * np.log(r2)
        angle = np.where(b == 0, 0.0, np.arctan(u / np.where(b == 0, 1.0, b)))
        return u * log - u + b * angle, 0.5 * r2 * log - 0.25 * r2, angle, b * log

    ends = [antiderivatives(length - a), antiderivatives(-a)]
    i0, i1, j0, j1 = (high - low for high, low in zip(*ends))
    second = (i1 + a * i0) / length
    second_slope = (j1 + a * j0) / length
    return i0 - second, second, -(j0 - second_slope), -second_slope


def normal_derivative(nodes, phi):
    count = len(nodes)
    single, double = np.zeros((count, count)), np.zeros((count, count))
    for sign_x in (1, -1):
        for sign_y in (1, -1):
            parts = element_integrals(nodes * [sign_x, sign_y], nodes)
            single[:, :-1] += parts[0]
            single[:, 1:] += parts[1]
            double[:, :-1] += parts[2]
            double[:, 1:] += parts[3]
    return np.linalg.solve(single, double @ phi - double.sum(axis=1) * phi)


def spline(s, values, symmetric):
    """Cubic spline; at each end even (slope zero) or odd (curvature zero)."""
    from scipy.interpolate import CubicSpline
    ends = tuple((1, 0.0) if even else (2, 0.0) for even in symmetric)
    return CubicSpline(s, values, bc_type=ends)


def arc_length(nodes):
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(nodes, axis=0).T))])


def splines(nodes, phi):
    # Along the surface from the wall (x odd, y even) to the bottom (x even, y odd).
    s = arc_length(nodes)
    return s, spline(s, nodes[:, 0], (False, True)), spline(s, nodes[:, 1], (True, False)), spline(s, phi, (True, True))


def rates(nodes, phi):
    s, x, y, potential = splines(nodes, phi)
    tangent = np.stack([x(s, 1), y(s, 1)], axis=1)
    tangent /= np.hypot(*tangent.T)[:, None]
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    velocity = potential(s, 1)[:, None] * tangent + normal_derivative(nodes, phi)[:, None] * normal
    velocity[0, 0] = velocity[-1, 1] = 0.0
    return velocity, 0.5 * np.sum(velocity**2, axis=1) - nodes[:, 1]


def spread(nodes, phi, count, finest):
    """Nodes at even steps of a density that grows towards the front."""
    s, x, y, potential = splines(nodes, phi)
    fine = np.linspace(0, s[-1], 20 * count)
    density = 1 / (finest + 0.05 * (s[-1] - fine))
    density = np.minimum(density, 0.2 / finest)
    place = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
    s = np.interp(np.linspace(0, place[-1], count), place, fine)
    moved = np.stack([x(s), y(s)], axis=1)
    moved[0, 0] = moved[-1, 1] = 0.0
    return moved, potential(s)


def smooth(values, odd_first, odd_last):
    """Five-point filter of Longuet-Higgins and Cokelet, which removes the sawtooth and keeps cubics."""
    first, last = (-1 if odd else 1 for odd in (odd_first, odd_last))
    v = np.concatenate([first * values[2:0:-1], values, last * values[-2:-4:-1]])
    return (-v[:-4] + 4 * v[1:-3] + 10 * v[2:-2] + 4 * v[3:-1] - v[4:]) / 16


def collapse(count, end):
    finest = 1.0 / count
    side = np.linspace(0, 1, count)
    nodes = np.concatenate([np.stack([side, 2 + 0 * side], 1), np.stack([1 + 0 * side, 2 - 2 * side], 1)[1:]])
    # The upper corner is rounded by a tenth: it falls freely and does not reach the front.
    corner = np.hypot(nodes[:, 0] - 0.9, nodes[:, 1] - 1.9)
    outside = (nodes[:, 0] > 0.9) & (nodes[:, 1] > 1.9) & (corner > 0.1)
    nodes[outside] = [0.9, 1.9] + (nodes[outside] - [0.9, 1.9]) * 0.1 / corner[outside][:, None]
    phi = np.zeros(len(nodes))
    nodes, phi = spread(nodes, phi, count, finest)
    t, rows = 0.0, [(0.0, 1.0)]
    while t < end:
        k1 = rates(nodes, phi)
        gap = np.hypot(*np.diff(nodes, axis=0).T)
        speed = np.maximum(np.hypot(*k1[0].T), 1e-3)
        dt = min(0.02, 0.5 * np.min(gap / np.hypot(*np.diff(k1[0], axis=0).T).clip(1e-9)), 3 * np.min(gap / speed[1:]))
        k2 = rates(nodes + 0.5 * dt * k1[0], phi + 0.5 * dt * k1[1])
        k3 = rates(nodes + 0.5 * dt * k2[0], phi + 0.5 * dt * k2[1])
        k4 = rates(nodes + dt * k3[0], phi + dt * k3[1])
        nodes = nodes + dt / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        phi = phi + dt / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
        t += dt
        nodes, phi = spread(nodes, phi, count, finest)
        nodes = np.stack([smooth(nodes[:, 0], True, False), smooth(nodes[:, 1], False, True)], axis=1)
        phi = smooth(phi, False, False)
        rows.append((t, nodes[-1, 0]))
        if len(rows) % 20 == 0:
            area = np.trapz(nodes[:, 1], nodes[:, 0])
            print(f"t = {t:.3f}, T = {t * 2 ** 0.5:.3f}, Z = {nodes[-1, 0]:.4f}, area {area:.4f}, dt {dt:.4f}", flush=True)
    return np.array(rows)


if __name__ == "__main__":
    rows = collapse(int(sys.argv[1]) if len(sys.argv) > 1 else 120, 3.1 / np.sqrt(2))
    T = np.arange(0, 3.05, 0.1)
    Z = np.interp(T, rows[:, 0] * np.sqrt(2), rows[:, 1])
    np.savetxt("ideal_release.csv", np.stack([T, Z], axis=1), delimiter=",", fmt="%.4f")
    print(np.round(Z, 3))
