# SPDX-License-Identifier: MIT
"""Volume of air entrained by waves of different steepness, and when entrainment begins."""
import numpy as np


def steepness(run):
    return float(run.case["constants"]["chi"])


def entrained(run):
    """All that was entrained by the end, over the volume of liquid."""
    return float(run.series["entrained_volume"][-1] / run.series["mass"][-1])


def onset(run, least=1e-5):
    """Time at which the entrained share passes `least`; infinite when it never does."""
    passed = run.series["entrained_volume"] / run.series["mass"] > least
    return float(run.series["t"][np.argmax(passed)]) if passed.any() else float("inf")


def speed_over_phase_speed(run):
    """Largest speed of the liquid until the first bubble, over sqrt(g / k) sqrt(1 + chi^2): above 0.85 a wave breaks."""
    before = run.series["entrained_volume"] == 0
    phase_speed = np.sqrt((1 + steepness(run) ** 2) / (2 * np.pi))
    return float(np.max(run.series["max_speed"][before]) / phase_speed)


def gas_balance(run):
    s = run.series
    came = s["injected_volume"] + s["entrained_volume"]
    return float(np.max(np.abs(s["bubble_volume"] + s["burst_volume"] - came)) / max(came[-1], 1e-300))


def measure(runs):
    waves = sorted(runs.values(), key=steepness)
    volume, start = [entrained(r) for r in waves], [onset(r) for r in waves]
    measured = {"gas_balance": max(gas_balance(r) for r in waves),
                "order_of_volume": float(np.sum(np.diff(volume) < 0)),
                "order_of_onset": float(sum(b > a for a, b in zip(start, start[1:])))}
    by_chi = {round(100 * steepness(r)): r for r in waves}
    for chi, run in by_chi.items():
        measured[f"entrained_chi_{chi:03d}"] = entrained(run)
        measured[f"onset_chi_{chi:03d}"] = onset(run)
        measured[f"speed_over_phase_speed_chi_{chi:03d}"] = speed_over_phase_speed(run)
    if {35, 40} <= by_chi.keys() and entrained(by_chi[40]) > 0:
        measured["volume_ratio_035_040"] = entrained(by_chi[35]) / entrained(by_chi[40])
    return measured


def curves(runs):
    waves = sorted(runs.values(), key=steepness)
    alive = [(f"chi = {steepness(r):.2f}", r.series["t"], r.series["bubble_volume"] / r.series["mass"], "-") for r in waves]
    total = [("entrained by the end", [steepness(r) for r in waves], [entrained(r) for r in waves], "o-")]
    return [{"file": "volume", "x": "t", "y": "gas / liquid volume", "curves": alive},
            {"file": "entrained_of_steepness", "x": "chi", "y": "entrained gas / liquid volume", "curves": total}]
