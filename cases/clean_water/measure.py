# SPDX-License-Identifier: MIT
"""The clean-water test of ASCE 2-06: C(t) = C_inf - (C_inf - C_0) exp(-kLa t), with C_inf the saturation at mid-depth."""
import numpy as np

from spume_tools.results import standard

STANDARD_ATMOSPHERE = 101325.0
# Until then the first bubbles rise and the water starts to turn.
START = 5.0
DEPTH = 0.4


def saturation(celsius):
    """Fresh water below moist air at one atmosphere, g/m3 (Benson & Krause 1984)."""
    x = 1 / (celsius + 273.15)
    return np.exp(-139.34411 + x * (1.575701e5 + x * (-6.642308e7 + x * (1.2438e10 - x * 8.621949e11))))


def saturation_at_mid_depth(run):
    temperature = float(run.case["oxygen"]["temperature"])
    x = 1 / (temperature + 273.15)
    vapour = STANDARD_ATMOSPHERE * np.exp(11.8571 - x * (3840.70 + x * 216961))
    weight = float(run.case["fluid"]["density"]) * float(run.case["fluid"]["gravity"])
    return saturation(temperature) * (1 + weight * DEPTH / 2 / (STANDARD_ATMOSPHERE - vapour))


def fitted(run):
    """kLa and C_0 of the logarithm of the deficit, and the rows that they are fitted to."""
    t, c = run.series["t"], run.series["mean_oxygen"]
    rows = t >= START
    slope, start = np.polyfit(t[rows], np.log(saturation_at_mid_depth(run) - c[rows]), 1)
    return -slope, start, rows


def balance(run):
    """Oxygen that came with the gas less what is found of it, over what came."""
    last = {name: run.series[name][-1] for name in
            ("oxygen_released", "oxygen_in_bubbles", "oxygen_left", "amount_of_oxygen")}
    released = last.pop("oxygen_released")
    return float(abs(released - sum(last.values())) / released)


def measure(runs):
    run = standard(runs)
    kla, _, rows = fitted(run)
    summed = float(np.mean(run.series["kla"][rows]))
    sote = float(np.mean(run.series["sote"][rows]))
    return {
        "kla_error": abs(kla / summed - 1),
        "kla_per_hour": 3600 * kla,
        "kla_summed_per_hour": 3600 * summed,
        "oxygen_balance": balance(run),
        "sotr_grams_per_hour": 3600 * float(np.mean(run.series["sotr"][rows])),
        "sote_percent_per_metre": 100 * sote / DEPTH}


def curves(runs):
    run = standard(runs)
    kla, start, _ = fitted(run)
    t = run.series["t"]
    limit = saturation_at_mid_depth(run)
    return [{"file": "oxygen_fitted", "x": "t in s", "y": "dissolved oxygen in g/m3",
             "curves": [("run", t, run.series["mean_oxygen"], "-"),
                        ("fit", t, limit - np.exp(start - kla * t), "k--")]}]
