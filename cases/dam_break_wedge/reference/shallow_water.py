# SPDX-License-Identifier: MIT
"""Depth at the gauge by the shallow-water equations without friction: Godunov's method of first order with HLL fluxes and
the hydrostatic reconstruction of Audusse et al. (2004). Writes shallow_water.csv; argument: number of cells."""
import sys
from pathlib import Path

import numpy as np

GRAVITY, LENGTH, GAUGE, END, EVERY = 9.81, 38.0, 19.5, 18.0, 0.05


def solve(cells):
    dx = LENGTH / cells
    x = (np.arange(cells) + 0.5) * dx
    bed = np.maximum(0, 0.4 - np.abs(x - 28.5) * 0.4 / 3)
    h = np.where(x < 15.5, 0.75, np.where(x > 28.5, np.maximum(0.15 - bed, 0), 0))
    q, t, rows = np.zeros(cells), 0.0, []
    while t < END:
        u = q * 2 * h / (h * h + np.maximum(h * h, 1e-8))
        dt = 0.45 * dx / np.max(np.abs(u) + np.sqrt(GRAVITY * h))
        hh, uu, bb = np.r_[h[0], h, h[-1]], np.r_[-u[0], u, -u[-1]], np.r_[bed[0], bed, bed[-1]]
        top = np.maximum(bb[:-1], bb[1:])
        hl, hr, ul, ur = np.maximum(0, hh[:-1] + bb[:-1] - top), np.maximum(0, hh[1:] + bb[1:] - top), uu[:-1], uu[1:]
        cl, cr = np.sqrt(GRAVITY * hl), np.sqrt(GRAVITY * hr)
        sl, sr = np.minimum(0, np.minimum(ul - cl, ur - cr)), np.maximum(0, np.maximum(ul + cl, ur + cr))
        width = np.maximum(sr - sl, 1e-12)
        mass = (sr * hl * ul - sl * hr * ur + sl * sr * (hr - hl)) / width
        push = (sr * (hl * ul**2 + GRAVITY * hl**2 / 2) - sl * (hr * ur**2 + GRAVITY * hr**2 / 2)
                + sl * sr * (hr * ur - hl * ul)) / width
        left, right = push + GRAVITY * (hh[:-1]**2 - hl**2) / 2, push + GRAVITY * (hh[1:]**2 - hr**2) / 2
        h = np.maximum(0, h - dt / dx * np.diff(mass))
        q = q - dt / dx * (left[1:] - right[:-1])
        t += dt
        rows.append((t, h[int(GAUGE / dx)]))
    return np.array(rows)


if __name__ == "__main__":
    t, depth = solve(int(sys.argv[1])).T
    times = np.arange(0, END, EVERY)
    with (Path(__file__).parent / "shallow_water.csv").open("w") as out:
        out.write("# Depth at x = 19.5 m by the shallow-water equations without friction: shallow_water.py 1900\nt,depth\n")
        for at in times:
            out.write(f"{at:.2f},{np.interp(at, t, depth, left=0.0):.4f}\n")
