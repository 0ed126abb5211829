#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Steady lid-driven cavity by vorticity and stream function, central differences, Heun steps: what second order costs
on a uniform grid at Re = 3200. Prints its errors against ghia1982.csv and spectral.csv.

    dw/dt + u dw/dx + v dw/dy = lap w / Re,   lap psi = -w,   u = dpsi/dy, v = -dpsi/dx,

psi = 0 on the walls, wall vorticity by Woods' second-order formula, the Poisson equation by sine transforms.
Takes some minutes.
"""
import csv
from pathlib import Path

import numpy as np


def centre_lines(re, end, n=128):
    """Coordinates, u along x = 0.5 and v along y = 0.5. First axis x, second y."""
    h = 1 / n
    k = np.arange(1, n)
    sine = np.sin(np.pi * np.outer(k, k) / n) * np.sqrt(2 / n)
    eigenvalue = (2 - 2 * np.cos(np.pi * k / n)) / h**2
    eigenvalue = eigenvalue[:, None] + eigenvalue[None, :]
    w, psi = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))

    def rate(w):
        psi[1:-1, 1:-1] = sine @ ((sine @ w[1:-1, 1:-1] @ sine) / eigenvalue) @ sine
        w[0, :] = -3 * psi[1, :] / h**2 - 0.5 * w[1, :]
        w[-1, :] = -3 * psi[-2, :] / h**2 - 0.5 * w[-2, :]
        w[:, 0] = -3 * psi[:, 1] / h**2 - 0.5 * w[:, 1]
        w[:, -1] = -3 * psi[:, -2] / h**2 - 0.5 * w[:, -2] - 3 / h
        u = (psi[1:-1, 2:] - psi[1:-1, :-2]) / (2 * h)
        v = -(psi[2:, 1:-1] - psi[:-2, 1:-1]) / (2 * h)
        laplacian = (w[2:, 1:-1] + w[:-2, 1:-1] + w[1:-1, 2:] + w[1:-1, :-2] - 4 * w[1:-1, 1:-1]) / h**2
        return (laplacian / re - u * (w[2:, 1:-1] - w[:-2, 1:-1]) / (2 * h)
                - v * (w[1:-1, 2:] - w[1:-1, :-2]) / (2 * h))

    dt = min(0.2 * h * h * re, 0.4 * h)
    for _ in range(int(np.ceil(end / dt))):
        first = rate(w)
        ahead = w.copy()
        ahead[1:-1, 1:-1] += dt * first
        w[1:-1, 1:-1] += 0.5 * dt * (first + rate(ahead))
    u = np.gradient(psi[n // 2, :], h, edge_order=2)
    v = -np.gradient(psi[:, n // 2], h, edge_order=2)
    u[0], u[-1], v[0], v[-1] = 0, 1, 0, 0
    return np.linspace(0, 1, n + 1), u, v


def table(name):
    lines = Path(__file__).with_name(name).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def main():
    for n in (64, 80):
        x, u, v = centre_lines(3200, 120, n)
        for name in ("ghia1982.csv", "spectral.csv"):
            for profile, values in (("u", u), ("v", v)):
                rows = [row for row in table(name) if row["profile"] == profile]
                error = max(abs(np.interp(float(row["coordinate"]), x, values) - float(row["re3200"])) for row in rows)
                print(f"{n} x {n}, {profile}, {name}: {error:.4f}")


if __name__ == "__main__":
    main()
