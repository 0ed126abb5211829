# SPDX-License-Identifier: MIT
"""First trough and first peak of the heave against linear potential theory (impulse response)."""
from pathlib import Path

import numpy as np

from spume_tools.results import standard

REFERENCE = Path(__file__).parent / "reference" / "floating_box.csv"
RISE = 0.01  # of the start, from where the box floats at y = 0
BEAM, DRAFT, DEPTH = "0.3", "0.1", "0.4"


def theory():
    """Times of the first peak and trough after the release, and the heave there over that of the start."""
    for line in REFERENCE.read_text().splitlines():
        cells = line.strip().split(",")
        if cells[0] == "period" and cells[1:4] == [BEAM, DRAFT, DEPTH]:
            return [float(cell) for cell in cells[4:8]]
    raise ValueError(f"no period of this box in {REFERENCE}")


def extreme(t, x, sign):
    """The first extreme after the start, by the parabola through its three rows."""
    k = 1 + np.flatnonzero((sign * x[1:-1] > sign * x[:-2]) & (sign * x[1:-1] >= sign * x[2:]) & (sign * x[1:-1] > 0))[0]
    a, b, c = np.polyfit(t[k - 1 : k + 2] - t[k], x[k - 1 : k + 2], 2)
    return t[k] - b / (2 * a), c - b * b / (4 * a)


def errors(run):
    rows = run.table("bodies")
    t, heave = rows["t"], rows["position_y"] / RISE
    peak_time, peak, trough_time, trough = theory()
    found_trough, found_peak = extreme(t, heave, -1), extreme(t[t > trough_time], heave[t > trough_time], 1)
    return {"period_error": found_peak[0] / peak_time - 1, "half_period_error": found_trough[0] / trough_time - 1,
            "peak": found_peak[1], "peak_of_theory": peak, "trough": found_trough[1], "trough_of_theory": trough}


def measure(runs):
    return {quantity: float(value) for quantity, value in errors(standard(runs)).items()}
