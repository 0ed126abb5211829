# SPDX-License-Identifier: MIT
"""First impact on the sensor against SPHERIC benchmark 10: when, and how hard."""
from pathlib import Path

import numpy as np

REFERENCE = Path(__file__).parent / "reference" / "sloshing_spheric10.csv"
AFTER = 2.0     # s; until 1.3 s the sensor is under the first, slow wave
ONSET = 50.0    # Pa; the sensor reads within 20 Pa of zero before
WITHIN = 0.12   # s after the onset, as long as the measured record


def measured(liquid):
    rows = [line.strip().split(",") for line in REFERENCE.read_text().splitlines()
            if line.startswith(f"{liquid}_impact,")]
    return np.array([float(row[1]) for row in rows]), 100 * np.array([float(row[3]) for row in rows])


def impact(t, p):
    onset = t[np.flatnonzero((t > AFTER) & (p > ONSET))[0]]
    return onset, float(np.max(p[(t >= onset) & (t <= onset + WITHIN)]))


def errors(run, name):
    t, p = run.probes["t"], np.nan_to_num(run.probes["sensor_pressure"])
    (onset, peak), (expected, expected_peak) = impact(t, p), impact(*measured("water" if "water" in name else "oil"))
    return {f"{name}_impact_time_error": onset / expected - 1, f"{name}_peak": peak,
            f"{name}_measured_peak": expected_peak}


def measure(runs):
    return {key: value for name, run in runs.items() for key, value in errors(run, name).items()}
