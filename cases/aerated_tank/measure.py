# SPDX-License-Identifier: MIT
"""An aerated tank beside what is measured of fine bubbles, and its balances of oxygen, COD and nitrogen."""
import numpy as np

from spume_tools.results import standard

DEPTH = 0.4
# Until then the plume rises for the first time.
START = 3.0
# Per metre of submergence: EPA design manuals, new systems of today (Behnisch et al. 2020).
LEAST_SOTE, LARGEST_SOTE = 5.5, 9.8
# ASM1: COD of a gram of nitrate and of dinitrogen; nitrogen of biomass and of its products.
NITRATE, DINITROGEN, BIOMASS, PRODUCTS = -4.57, -1.71, 0.08, 0.06


def amount(run, name):
    return run.series[f"amount_of_{name}"]


def total_cod(run):
    organic = sum(amount(run, name) for name in ("S_I", "S_S", "X_I", "X_S", "X_BH", "X_BA", "X_P"))
    return organic - amount(run, "S_O") + NITRATE * amount(run, "S_NO")


def total_nitrogen(run):
    mineral = sum(amount(run, name) for name in ("S_NO", "S_NH", "S_ND", "X_ND"))
    return mineral + BIOMASS * (amount(run, "X_BH") + amount(run, "X_BA")) + PRODUCTS * amount(run, "X_P")


def supplied(run):
    return run.series["oxygen_from_bubbles"] + run.series["oxygen_from_surface"]


def measure(runs):
    run = standard(runs)
    series = run.series
    rows = series["t"] >= START
    uptake = series["oxygen_uptake"][-1]
    oxygen = amount(run, "S_O")
    dinitrogen = total_nitrogen(run)[0] - total_nitrogen(run)[-1]
    cod = total_cod(run)[-1] - total_cod(run)[0] + DINITROGEN * dinitrogen
    temperature, alpha = (float(run.case["oxygen"][key]) for key in ("temperature", "transfer_factor"))
    sote = 100 * float(np.mean(series["sote"][rows])) / DEPTH
    kla = 3600 * float(np.mean(series["kla"][rows])) / alpha * 1.024 ** (20 - temperature)
    return {
        "oxygen_balance": float(abs(oxygen[-1] - oxygen[0] - supplied(run)[-1] + uptake) / uptake),
        "cod_balance": float(abs(cod - series["source_of_S_S"][-1] + supplied(run)[-1]) / uptake),
        "sote_percent_per_metre": sote,
        "sote_off_range": max(0.0, LEAST_SOTE - sote, sote - LARGEST_SOTE),
        "kla20_per_hour": kla,
        "uptake_rate": float(series["oxygen_uptake_rate"][-1]),
        "mean_speed": float(np.sqrt(2 * np.mean(series["kinetic_energy"][rows]) / series["mass"][-1])),
        "oxygen_at_end": float(series["mean_oxygen"][-1])}


def curves(runs):
    run = standard(runs)
    t = run.series["t"]
    volume = amount(run, "S_I")[0] / 30
    supply = 3600 * np.gradient(supplied(run), t) / volume
    return [{"file": "oxygen_uptake", "x": "t in s", "y": "g/m3/h",
             "curves": [("uptake", t[1:], run.series["oxygen_uptake_rate"][1:], "-"), ("supply", t[1:], supply[1:], "-")]},
            {"file": "oxygen_mean", "x": "t in s", "y": "g/m3",
             "curves": [("dissolved oxygen", t, run.series["mean_oxygen"], "-"),
                        ("S_S", t, amount(run, "S_S") / volume, "-")]}]
