# SPDX-License-Identifier: MIT
"""Where the power of the rising gas goes, the circulation that it drives, and how fast that mixes a tracer.

Gas that rises through the liquid gives the power Q rho g H. Bubbles that slip through the liquid spend V_b rho g |u_b -
u_l| of it, with the gradient of the mixture's pressure in place of rho g, and the liquid dissipates the rest.
"""
import numpy as np

from spume_tools.results import standard

STEADY = 3.0  # bubbles reach the surface at 1.1 s
INLET = 0.011
PULSE = 2.1  # end of the tracer's pulse
SIDE = 0.02  # of the cells whose means tell how even the tracer is


def depth_of(run):
    area = np.prod(np.subtract(run.case["domain"]["upper"], run.case["domain"]["lower"])[:2])
    return run.series["mass"][-1] / float(run.case["fluid"]["density"]) / area, area


def power_balance(run):
    """Gas power, and what slip and dissipation spend of it; means of the steady time."""
    series = run.series
    rows = series["t"] >= STEADY
    t = series["t"][rows]
    depth, area = depth_of(run)
    gas = np.mean(series["bubble_volume"][rows])
    lifted = depth + gas / area  # level of the mixture
    gradient = float(run.case["fluid"]["density"]) * float(run.case["fluid"]["gravity"]) * depth / lifted
    rate = (series["injected_volume"][rows][-1] - series["injected_volume"][rows][0]) / (t[-1] - t[0])
    return (rate * gradient * (lifted - INLET),
            gradient * np.mean(series["bubble_volume"][rows] * series["bubble_slip"][rows]),
            np.mean(series["dissipation"][rows]))


def circulation(run):
    """Mean upward velocity in columns of a centimetre, over the depth of the tank and the height of the water."""
    edges = np.arange(0, float(run.case["domain"]["upper"][0]) + 0.005, 0.01)
    total, number = np.zeros(len(edges) - 1), np.zeros(len(edges) - 1)
    for snapshot in run.snapshots():
        if snapshot.time < STEADY:
            continue
        x, u = snapshot.position[:, 0], snapshot.field("velocity")[:, -1]
        total += np.histogram(x, edges, weights=u)[0]
        number += np.histogram(x, edges)[0]
    return (edges[1:] + edges[:-1]) / 2, total / np.maximum(number, 1)


def unevenness(run, name="tracer"):
    """Times after the pulse, and the rms of the tracer's cell means about the mean, over the mean; in 2-D too."""
    lower, upper = (np.array(run.case["domain"][key], dtype=float) for key in ("lower", "upper"))
    count = np.maximum(1, np.round((upper - lower) / SIDE).astype(int))
    times, uneven = [], []
    for snapshot in run.snapshots():
        if snapshot.time < PULSE:
            continue
        place = np.clip(np.floor((snapshot.position[:, :len(lower)] - lower) / (upper - lower) * count).astype(int), 0, count - 1)
        cell = np.ravel_multi_index(place.T, count)
        number = np.bincount(cell, minlength=count.prod())
        full = number >= 0.3 * np.median(number[number > 0])  # cells of the surface hold a few
        tracer = snapshot.field(name)
        mean = np.bincount(cell, tracer, count.prod())[full] / number[full]
        times.append(snapshot.time)
        uneven.append(np.sqrt(np.average((mean - tracer.mean()) ** 2, weights=number[full])) / tracer.mean())
    return np.array(times), np.array(uneven)


def mixing_time(times, uneven):
    """From the pulse until the cells differ by 5 % rms at most from then on, 95 % mixed; not-a-number where the run ends
    before."""
    uneven_at = np.flatnonzero(uneven > 0.05)
    first = uneven_at[-1] + 1 if uneven_at.size else 0
    return float(times[first] - PULSE) if first < len(times) else float("nan")


def measure(runs):
    run = standard(runs)
    series = run.series
    gas = series["injected_volume"][-1] - series["burst_volume"][-1] - series["bubble_volume"][-1]
    measured = {"gas_balance": float(abs(gas) / series["injected_volume"][-1])}
    if series["t"][-1] <= STEADY + 1:
        return measured
    power, slip, dissipated = power_balance(run)
    upward = circulation(run)[1]
    times, uneven = unevenness(run)
    depth, area = depth_of(run)
    return measured | {
        "power_error": float(abs((slip + dissipated) / power - 1)),
        "share_of_slip": float(slip / power),
        "gas_share": float(np.mean(series["bubble_volume"][series["t"] >= STEADY]) / (depth * area)),
        "upflow": float(upward.max()),
        "downflow": float(-upward.min()),
        "unevenness_at_end": float(uneven[-1]),
        "mixing_time": mixing_time(times, uneven)}


def curves(runs):
    run = standard(runs)
    if run.series["t"][-1] <= STEADY:
        return []
    x, upward = circulation(run)
    times, uneven = unevenness(run)
    return [{"file": "circulation", "x": "x [m]", "y": "mean upward velocity [m/s]", "curves": [("les-sph, 3-D", x, upward, "o-")]},
            {"file": "mixing", "x": "time since the pulse [s]", "y": "rms of the tracer's cell means over their mean", "log": "y",
             "curves": [("les-sph, 3-D", times - PULSE, uneven, "-"), ("95 % mixed", [0, times[-1] - PULSE], [0.05, 0.05], "--")]}]
