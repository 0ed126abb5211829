# SPDX-License-Identifier: MIT
"""How far what the recorded flow carries is from the run in which the flow goes on.

Compared from the end of the record on: amounts in the tank and the oxygen that was taken up since then, at every whole lag; and the pattern, means of dissolved oxygen in the cells of the record over all snapshots.
"""
import numpy as np

AMOUNTS = ("amount_of_S_O", "amount_of_S_S", "amount_of_S_NH", "amount_of_S_NO", "amount_of_X_BH")


def ends(run):
    return float(run.case["recorded_flow"]["until"])


def pattern(run, begin, side):
    """Dissolved oxygen over its mean in the tank, which falls: mean of the cells over the snapshots from `begin` on."""
    lower, upper = (np.array(run.case["domain"][key], dtype=float) for key in ("lower", "upper"))
    count = np.ceil((upper - lower) / side * (1 - 1e-9)).astype(int)
    total, number = np.zeros(count.prod()), np.zeros(count.prod())
    for snapshot in run.snapshots():
        if snapshot.time <= begin:
            continue
        place = np.floor((snapshot.position - lower) / (upper - lower) * count).astype(int)
        cell = np.ravel_multi_index(np.clip(place, 0, count - 1).T, count)
        oxygen = snapshot.field("S_O")
        total += np.bincount(cell, oxygen / oxygen.mean(), len(total))
        number += np.bincount(cell, minlength=len(total))
    return total / np.maximum(number, 1), number


def errors(full, recorded):
    begin = ends(recorded)
    a, b = full.series, recorded.series
    t = b["t"][b["t"] > begin]
    lag = float(recorded.case["recorded_flow"]["lag"])
    t = t[np.abs((t - begin) / lag - np.round((t - begin) / lag)) < 1e-6]  # between them the record holds its last values
    largest = {}
    for name in AMOUNTS:
        here, there = np.interp(t, b["t"], b[name]), np.interp(t, a["t"], a[name])
        largest[name] = float(np.abs(here / there - 1).max())
    since = [np.interp(t, s["t"], s["oxygen_uptake"]) - np.interp(begin, s["t"], s["oxygen_uptake"]) for s in (b, a)]
    late = t > begin + 0.1 * (t[-1] - begin)  # of a sum that begins at zero
    largest["oxygen_uptake"] = float(np.abs(since[0][late] / since[1][late] - 1).max())
    return largest


def measure(runs):
    full, recorded = runs["full"], runs["recorded"]
    largest = errors(full, recorded)
    measured = {f"{name}_error": value for name, value in largest.items()}
    measured["recorded_error"] = max(largest.values())
    side, begin = float(recorded.case["recorded_flow"]["cell"]), ends(recorded)
    (here, in_here), (there, in_there) = (pattern(run, begin, side) for run in (recorded, full))
    both = np.minimum(in_here, in_there) > 0
    weight = in_there[both]
    measured["pattern_error"] = float(np.sqrt((weight * (here - there)[both] ** 2).sum() / weight.sum()))
    measured["pattern_deviation"] = float(np.sqrt((weight * (there[both] - 1) ** 2).sum() / weight.sum()))
    s = recorded.series
    change = s["amount_of_S_O"] - s["amount_of_S_O"][0]
    given = s["oxygen_from_bubbles"] + s["oxygen_from_surface"] + s["oxygen_from_record"] - s["oxygen_uptake"]
    measured["oxygen_balance"] = float(np.abs(change - given).max() / s["oxygen_uptake"][-1])
    return measured
