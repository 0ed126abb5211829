# SPDX-License-Identifier: MIT
"""How slip and place depend on the size of a bubble, with and without the fluctuations that are not resolved."""
import numpy as np

from spume_tools.results import hinze_radius, standard

FROM = 8.0
BAND = 0.02  # half height of the slices
SOURCE = 0.02


def bubbles_at(run, height):
    """Radius, slip and distance from the axis of the bubbles near a height, all snapshots from FROM on."""
    snapshots = run.snapshots("bubbles")
    radius, slip, distance = [], [], []
    for k, t in enumerate(snapshots.times):
        if t < FROM:
            continue
        shot = snapshots[k]
        near = np.abs(shot.position[:, 2] - height) < BAND
        radius.append(shot.field("radius")[near])
        slip.append(shot.field("slip")[near])
        distance.append(np.hypot(shot.position[near, 0], shot.position[near, 1]))
    return np.concatenate(radius), np.concatenate(slip), np.concatenate(distance)


def rank_correlation(a, b):
    """Spearman's: the correlation of the ranks."""
    ranks = [np.argsort(np.argsort(x)).astype(float) for x in (a, b)]
    return float(np.corrcoef(*ranks)[0, 1])


def trend(radius, slip, bins=12):
    """Mean and standard deviation of the slip in bins of equal numbers of bubbles."""
    order = np.argsort(radius)
    parts = np.array_split(order, bins)
    return (np.array([radius[p].mean() for p in parts]), np.array([slip[p].mean() for p in parts]),
            np.array([slip[p].std() for p in parts]))


def gas_balance(run):
    s = run.series
    came = s["injected_volume"] + s["entrained_volume"]
    return float(np.max(np.abs(s["bubble_volume"] + s["burst_volume"] - came)) / came[-1])


def measure(runs):
    measured = {"gas_balance": max(gas_balance(run) for run in runs.values())}
    with_noise = bubbles_at(standard(runs), 0.555)
    measured["slip_trend_with"] = rank_correlation(with_noise[0], with_noise[1])
    measured["outward_trend_with"] = rank_correlation(with_noise[0], with_noise[2])
    if "still" in runs:
        still = bubbles_at(runs["still"], 0.555)
        measured["slip_trend"] = rank_correlation(still[0], still[1])
        measured["outward_trend"] = rank_correlation(still[0], still[2])
        (_, mean, scatter), (_, still_mean, still_scatter) = trend(*with_noise[:2]), trend(*still[:2])
        measured["slip_mean_difference"] = float(np.sqrt(np.mean((mean / still_mean - 1) ** 2)))
        measured["slip_scatter_ratio"] = float(np.median(scatter / still_scatter))
    return measured


def curves(runs):
    figures = []
    slips = []
    for name, run in runs.items():
        radius, slip, _ = bubbles_at(run, 0.555)
        chosen = np.random.default_rng(1).permutation(len(radius))[:2000]
        slips.append(("without fluctuations" if name == "still" else "with fluctuations",
                      radius[chosen] / hinze_radius(run), slip[chosen], "."))
    figures.append({"file": "slip_of_size", "x": "radius / Hinze radius", "y": "slip at z = 0.555", "curves": slips})
    for height in (0.1, 0.3, 0.555, 0.8):
        places = []
        for name, run in runs.items():
            radius, _, distance = bubbles_at(run, height)
            chosen = np.random.default_rng(1).permutation(len(radius))[:2000]
            places.append(("without fluctuations" if name == "still" else "with fluctuations",
                           distance[chosen] / SOURCE, radius[chosen] / hinze_radius(run), "."))
        figures.append({"file": f"size_of_place_z{round(1000 * height):04d}", "x": "distance from the axis / source radius",
                        "y": "radius / Hinze radius", "curves": places})
    return figures
