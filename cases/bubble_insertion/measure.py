# SPDX-License-Identifier: MIT
"""Norm of the shift after a bubble has appeared: its peak against the bubble's radius, and how fast it decays."""
import numpy as np

from spume_tools.results import standard


def peak(run):
    """Index and value of the largest root-mean-square shift velocity."""
    norm = run.series["shift_norm"]
    k = int(np.argmax(norm))
    return k, norm[k]


def decay_time(run):
    """In steps: the time constant of an exponential through the peak and the step after it."""
    k, value = peak(run)
    return float(1 / np.log(value / run.series["shift_norm"][k + 1]))


def radius(run):
    return float(run.case["bubble_cloud"][0]["bubble_radius"]) / run.spacing


def printed_norms(run, steps=4):
    """Norm of the shift by King (3.1), (3.11) and (3.12) alone on the lattice of the run, everywhere in full, relative to
    the first: what the formulas give, whatever the program makes of them."""
    count, ratio = round(1 / run.spacing), 1.3
    h = ratio * run.spacing
    volume = 4 / 3 * np.pi * (radius(run) * run.spacing) ** 3
    sites = (np.arange(count) + 0.5) * run.spacing
    place = np.stack(np.meshgrid(sites, sites, sites, indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(count**3).reshape(count, count, count)
    reach = int(np.ceil(2 * ratio)) + 1
    sides = [side for side in np.ndindex(*3 * (2 * reach + 1,))
             if 0 < np.linalg.norm(np.array(side) - reach) < 2 * ratio + 1]

    def nearest(d):
        return d - np.round(d)

    def kernel(q):
        return np.where(q < 2, (1 - q / 2) ** 4 * (2 * q + 1), 0) * 21 / (16 * np.pi)

    norms = []
    for _ in range(steps):
        q = np.linalg.norm(nearest(place - 0.5), axis=1) / h
        own = run.spacing**3 / (1 - kernel(q) / h**3 * volume)
        gradient = np.zeros_like(place)
        for side in sides:
            other = np.roll(number, tuple(reach - k for k in side), (0, 1, 2)).ravel()
            d = nearest(place - place[other])
            q = np.linalg.norm(d, axis=1) / h
            slope = np.where(q < 2, -5 * (1 - q / 2) ** 3, 0) * 21 / (16 * np.pi) / h**5
            tension = 0.2 * (kernel(q) / kernel(1 / ratio)) ** 4
            gradient += ((1 + tension) * own[other] * slope)[:, None] * d
        shift = -(h**2) / 4 * gradient
        norms.append(np.sqrt(np.mean(np.sum(shift**2, axis=1))))
        place = place + shift
    return np.array(norms) / norms[0]


def measure(runs):
    main = {name: run for name, run in runs.items() if name != "drift_removed"}
    run = standard(main)
    printed = {name: float(-1 / np.log(printed_norms(r, 2)[1])) for name, r in main.items()}
    ratios = [decay_time(r) / printed[name] for name, r in main.items()]
    measured = {"decay_time": decay_time(run), "decay_time_printed": printed[next(n for n in main if main[n] is run)],
                **{f"decay_time_{name}": decay_time(r) for name, r in main.items() if r is not run},
                "slowest_over_formulas": max(ratios), "fastest_over_formulas": min(ratios),
                "speed": max(float(r.series["max_speed"].max()) for r in runs.values()),
                "pressure": max(float(np.abs(s.field("pressure")).max()) for s in run.snapshots())}
    if len(main) > 2:
        measured["peak_exponent"] = float(np.polyfit(np.log([radius(r) for r in main.values()]),
                                                     np.log([peak(r)[1] for r in main.values()]), 1)[0])
    if "drift_removed" in runs:
        measured["decay_time_drift_removed"] = decay_time(runs["drift_removed"])
    return measured


def curves(runs):
    lines = []
    for name, run in runs.items():
        k, _ = peak(run)
        norm = run.series["shift_norm"][k:]
        lines.append((f"a / dr = {radius(run):.1f}" + (", drift removed" if name == "drift_removed" else ""),
                      np.arange(len(norm)), norm, "-"))
    n = np.arange(5)
    k, value = peak(standard(runs))
    lines.append(("exp(-1.5 n)", n, value * np.exp(-1.5 * n), "--"))
    lines.append(("the formulas alone", n[:4], value * printed_norms(standard(runs)), "k:"))
    return [{"file": "shift_norm", "x": "steps since the bubble appeared", "y": "rms shift velocity", "curves": lines,
             "log": "y"}]
