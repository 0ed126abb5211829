#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes roll_oil.csv and roll_water.csv: the measured roll without the noise of its reading, which twice differentiated
would shake the tank by half of gravity. Quintic smoothing splines that leave 0.01 degrees, the scatter of the readings
about cubics over 0.2 s. Before its first reading the tank is at rest, level."""
from pathlib import Path

import numpy as np
from scipy.interpolate import UnivariateSpline

FOLDER = Path(__file__).parent
ROWS = [line.strip().split(",") for line in open(FOLDER / "sloshing_spheric10.csv") if not line.startswith("#")]
for liquid in ("oil", "water"):
    rows = [row for row in ROWS if row[0] == liquid]
    t, angle = (np.array([float(row[k]) for row in rows]) for k in (1, 2))
    rest = np.arange(-0.5, -0.01, 0.02)
    t, angle = np.append(rest, t), np.append(0 * rest, angle)
    smooth = UnivariateSpline(t, angle, k=5, s=len(t) * 0.01**2)
    with open(FOLDER / f"roll_{liquid}.csv", "w") as file:
        file.write("# Smoothed from sloshing_spheric10.csv by roll.py\nt,angle\n")
        for at in np.arange(-0.1, t[-1] + 1e-9, 0.01):
            file.write(f"{at:.2f},{smooth(at):.6f}\n")
