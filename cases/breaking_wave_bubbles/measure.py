# SPDX-License-Identifier: MIT
"""When the wave strikes, how the entrained volume grows, and how the bubbles are distributed over sizes.

Slopes are those of the density of radii over all snapshots from 0.2 after the impact on: super-Hinze between twice the
Hinze radius and three quarters of the spacing, below the cut that the spacing imposes; sub-Hinze between a tenth of the
Hinze radius and itself, and between three tenths and itself: below 0.28, at 1/300, entrainment pays every radius that it tries,
which makes the density flat at any spacing.
"""
import numpy as np

from spume_tools.results import MissingResult, bubble_radii, density, hinze_radius, slope, standard

SETTLED = 0.2  # after the impact


def impact_time(run):
    """First entrainment: the dissipation at the surface has passed its threshold."""
    entrained = run.series["entrained_volume"] > 0
    return float(run.series["t"][np.argmax(entrained)]) if entrained.any() else float("nan")


def late(run):
    return run.series["t"] >= impact_time(run) + SETTLED


def ratio(run):
    rows = late(run)
    return run.series["bubbles_below_hinze"][rows] / np.maximum(run.series["bubbles_above_hinze"][rows], 1)


def slopes(run):
    values = bubble_radii(run, impact_time(run) + SETTLED)
    return {"super_hinze_slope": slope(values, 2, 0.75 * run.spacing / hinze_radius(run)),
            "sub_hinze_slope": slope(values, 0.1, 1), "upper_sub_hinze_slope": slope(values, 0.3, 1)}


def volume_share(run):
    """Gas alive over liquid, mean of the last tenth of the run."""
    t = run.series["t"]
    rows = t >= 0.9 * t[-1]
    return float(np.mean(run.series["bubble_volume"][rows] / run.series["mass"][rows]))


def entrained_share(run):
    """All gas entrained so far over liquid."""
    return float(run.series["entrained_volume"][-1] / run.series["mass"][0])


def growth_exponent(run):
    """Power of the time since the impact with which the gas alive grows, by least squares of the logarithms."""
    rows = late(run)
    return float(np.polyfit(np.log(run.series["t"][rows] - impact_time(run)),
                            np.log(run.series["bubble_volume"][rows]), 1)[0])


def gas_balance(run):
    s = run.series
    came = s["injected_volume"] + s["entrained_volume"]
    return float(np.max(np.abs(s["bubble_volume"] + s["burst_volume"] - came)) / came[-1])


def measure(runs):
    run = standard(runs)
    measured = {"gas_balance": max(gas_balance(r) for r in runs.values()), "impact_time": impact_time(run)}
    rows = late(run)
    if rows.sum() < 10 or run.series["t"][-1] < 2:
        return measured
    measured["growth_exponent"] = growth_exponent(run)
    measured["volume_share"] = volume_share(run)
    measured |= slopes(run)
    measured["ratio"] = float(np.mean(ratio(run)))
    measured["ratio_steadiness"] = float(np.std(ratio(run)) / np.mean(ratio(run)))
    for name, other in runs.items():
        if other is run:
            continue
        label = name.removeprefix("dr_")
        measured[f"entrained_ratio_{label}"] = entrained_share(other) / entrained_share(run)
        measured[f"volume_ratio_{label}"] = volume_share(other) / volume_share(run)
        measured[f"growth_exponent_{label}"] = growth_exponent(other)
        try:
            measured |= {f"{quantity}_{name}": value for quantity, value in slopes(other).items()}
        except MissingResult:
            continue
        measured[f"ratio_{name}"] = float(np.mean(ratio(other)))
    if "dr_150" in runs:
        measured["ratio_rise"] = measured["ratio_dr_150"] / measured["ratio"]
    if "dr_200" in runs:
        measured["sub_hinze_steepens"] = measured["sub_hinze_slope"] - measured["sub_hinze_slope_dr_200"]
    return measured


def curves(runs):
    def label(run):
        return f"spacing 1/{round(1 / run.spacing)}"

    volumes = [(label(r), r.series["t"] - impact_time(r), r.series["bubble_volume"] / r.series["mass"], "-")
               for r in runs.values()]
    ratios = [(label(r), r.series["t"][late(r)] - impact_time(r), ratio(r), "-") for r in runs.values()]
    sizes = []
    for r in runs.values():
        values = bubble_radii(r, impact_time(r) + SETTLED)
        if len(values) > 100:
            centre, value, _ = density(values)
            sizes.append((label(r), centre, value, "o-"))
    at_hinze = np.interp(0, np.log(sizes[0][1]), sizes[0][2]) if sizes else 1
    below, above = np.array([0.1, 1]), np.array([1, 8])
    sizes += [("slope -3/2", below, at_hinze * below**-1.5, "--"), ("slope -10/3", above, at_hinze * above ** (-10 / 3), "--")]
    return [{"file": "volume", "x": "t - impact", "y": "gas / liquid volume", "curves": volumes},
            {"file": "ratio", "x": "t - impact", "y": "bubbles below / above the Hinze radius", "curves": ratios},
            {"file": "sizes", "x": "radius / Hinze radius", "y": "density", "log": "xy", "curves": sizes}]
