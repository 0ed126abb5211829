# SPDX-License-Identifier: MIT
"""Dam break over a triangular sill: depth at a gauge before it. How deep the stream is before and behind the bore that the
sill sends back, against reference/hiver_gauge4.csv; when the bore passes, against the shallow-water equations without
friction, reference/shallow_water.csv: the floor of the flume has some, of the scene none."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference, standard

REFERENCE = read_reference(Path(__file__).parent / "reference" / "hiver_gauge4.csv", ("t", "depth"))
LIMIT = read_reference(Path(__file__).parent / "reference" / "shallow_water.csv", ("t", "depth"))
STREAM = (5.0, 13.0)  # s: the front has passed, the bore has not come
BEHIND = (1.0, 4.0)  # s after the bore: its head, a breaker, has passed
LEVEL = 0.38  # m: half way between the depths before the bore and behind it, 0.27 and 0.49


def passes(t, depth):
    """When the bore first reaches half its height, between two rows."""
    late = t > STREAM[0] + 3
    t, depth = t[late], depth[late]
    k = np.flatnonzero(depth > LEVEL)[0]
    if k == 0:
        return float(t[0])
    return float(t[k - 1] + (LEVEL - depth[k - 1]) / (depth[k] - depth[k - 1]) * (t[k] - t[k - 1]))


def behind_bore(t, depth):
    since = t - passes(t, depth)
    return float(np.mean(depth[(since > BEHIND[0]) & (since < BEHIND[1])]))


def measured(run):
    probes = run.probes
    depth = np.nan_to_num(probes["gauge"])
    return probes["t"], depth


def measure(runs):
    t, depth = measured(standard(runs))
    own, theirs = REFERENCE["t"], REFERENCE["depth"]
    stream = (own > STREAM[0]) & (own < STREAM[1])
    even = np.linspace(own[0], own[-1], 2000)
    # The surface of the stream is rough: means over 0.4 s.
    smooth = np.array([np.mean(depth[np.abs(t - at) < 0.2]) for at in own[stream]])
    return {"bore_time": passes(t, depth),
            "bore_time_error": passes(t, depth) / passes(LIMIT["t"], LIMIT["depth"]) - 1,
            "bore_time_from_experiment": passes(t, depth) / passes(own, theirs) - 1,
            "stream_depth_error": float(np.mean(smooth) / np.mean(theirs[stream]) - 1),
            "stream_depth_rms": float(np.sqrt(np.mean((smooth - theirs[stream]) ** 2))),
            "bore_depth_error": behind_bore(t, depth) / behind_bore(even, np.interp(even, own, theirs)) - 1,
            "arrival": float(t[np.flatnonzero(depth > 0.05)[0]])}


def curves(runs):
    run = standard(runs)
    return [{"file": "gauge", "x": "t [s]", "y": "depth [m]",
             "curves": [(f"Spume, spacing {run.spacing:g}", *measured(run), "-"),
                        ("shallow water, no friction", LIMIT["t"], LIMIT["depth"], "k--"),
                        ("Hiver (2000)", REFERENCE["t"], REFERENCE["depth"], "ko")]}]
