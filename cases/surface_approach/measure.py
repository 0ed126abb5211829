# SPDX-License-Identifier: MIT
"""Bubbles that rise to a surface: where they rest, how fast they brake, whether they come back down.

Places of rest count from the uppermost particles, where King's surface (p = 0) lies and the proximity of (3.30) is one;
the liquid of this program ends half a spacing above them.
"""
import numpy as np

from spume_tools.results import bubble_traces, standard, surface_tension

SURFACE = 0.4
HALF = 0.5    # of the run: from then on all have arrived
FINAL = 0.9   # from then on the place of rest is taken


def depth(trace, spacing):
    """Below the surface of the liquid, in spacings."""
    return (SURFACE - trace["z"]) / spacing


def place_of_rest(trace, spacing, end):
    """Below the uppermost particles, in spacings."""
    return float(np.mean(depth(trace, spacing)[trace["t"] >= FINAL * end])) - 0.5


def weber(run, trace):
    """Of the bubble and its largest upward speed, the terminal velocity before it brakes."""
    return trace["radius"][0] * trace["velocity_z"].max() ** 2 / surface_tension(run)


def braking_time(trace):
    """From 95 to 30 % of the terminal velocity, the last and the first time of these."""
    w = trace["velocity_z"] / trace["velocity_z"].max()
    last_fast = np.nonzero(w > 0.95)[0][-1]
    slow = np.nonzero((w < 0.3) & (np.arange(len(w)) > last_fast))[0]
    times = trace["t"]
    if not len(slow):
        return float("nan")
    # Straight lines between the rows of the table.
    def crossing(level, after):
        k = after
        while w[k] > level:
            k += 1
        part = (w[k - 1] - level) / (w[k - 1] - w[k])
        return times[k - 1] + part * (times[k] - times[k - 1])

    return crossing(0.3, last_fast + 1) - crossing(0.95, last_fast + 1)


def measure(runs):
    run = standard(runs)
    bubbles = sorted(bubble_traces(run).values(), key=lambda trace: trace["radius"][0])
    end = run.series["t"][-1]
    late = [trace["t"] >= HALF * end for trace in bubbles]
    rest = [place_of_rest(trace, run.spacing, end) for trace in bubbles]
    arrival = [float(depth(trace, run.spacing)[np.argmax(rows)]) - 0.5 for trace, rows in zip(bubbles, late)]
    braking = [braking_time(trace) for trace in bubbles]
    measured = {"bubbles": float(len(bubbles)),
                "smallest_weber": weber(run, bubbles[0]), "largest_weber": weber(run, bubbles[-1]),
                "deepest_rest": max(max(rest), 0.0), "highest_rest": max(-min(rest), 0.0),
                "deepest_rest_below_liquid_surface": max(rest) + 0.5, "deepest_half_way": max(arrival),
                "rebound": max(float(np.max(d - np.minimum.accumulate(d)))
                               for d in (depth(trace, run.spacing) for trace in bubbles)),
                "braking_order": float(np.sum(np.diff(braking) > 0)),
                "resting_slip": max(float(np.abs(t["velocity_z"][rows]).max() / t["velocity_z"].max())
                                    for t, rows in zip(bubbles, late))}
    return measured


def curves(runs):
    run = standard(runs)
    places, speeds = [], []
    for trace in bubble_traces(run).values():
        # Time counts from when the bubble is two spacings below the surface.
        start = trace["t"][np.argmax(SURFACE - trace["z"] < 2 * run.spacing)]
        label = f"We_b = {weber(run, trace):.2g}"
        places.append((label, trace["t"] - start, (SURFACE - trace["z"]) / run.spacing, "-"))
        speeds.append((label, trace["t"] - start, trace["velocity_z"] / trace["velocity_z"].max(), "-"))
    return [{"file": "distance", "x": "time since two spacings below the surface", "y": "distance to the surface / spacing",
             "curves": places},
            {"file": "speed_of_approach", "x": "time since two spacings below the surface",
             "y": "vertical speed / terminal velocity", "curves": speeds}]
