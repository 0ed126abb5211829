# SPDX-License-Identifier: MIT
"""Mean vertical velocity of the liquid against distance from the axis, beside the Gaussian of a free plume."""
import numpy as np

from spume_tools.results import MissingResult, standard

HEIGHTS = {"z0453": 0.453, "z0555": 0.555}
FROM = 8.0    # means are of the last half of a run, and never from before this: the plume has reached the surface
RINGS = 4     # rings in a spacing: particles lie anywhere between the sites of the lattice


def averaged_from(run):
    return max(FROM, 0.5 * run.series["t"][-1])


def profile(run, height):
    """Mean distance and vertical velocity of rings around the axis, within a spacing of the height."""
    snapshots = run.snapshots()
    width = run.spacing / RINGS
    sums = np.zeros((3, round(0.5 / width)))
    for k, t in enumerate(snapshots.times):
        if t < averaged_from(run):
            continue
        snapshot = snapshots[k]
        near = np.abs(snapshot.position[:, 2] - height) < run.spacing
        r = np.hypot(snapshot.position[near, 0], snapshot.position[near, 1])
        keep = r < sums.shape[1] * width
        ring = (r[keep] / width).astype(int)
        sums[0] += np.bincount(ring, snapshot.field("velocity")[near, 2][keep], sums.shape[1])
        sums[1] += np.bincount(ring, r[keep], sums.shape[1])
        sums[2] += np.bincount(ring, minlength=sums.shape[1])
    if not sums[2].all():
        raise MissingResult(f"{run.folder}: too few snapshots from t = {averaged_from(run):g} on")
    return sums[1] / sums[2], sums[0] / sums[2]


def centre_and_width(r, w):
    """Velocity on the axis from a line through w against r^2 where w is above three quarters of its largest, and the radius of
    1/e of it."""
    near = r < r[np.argmax(w < 0.75 * w.max())]
    centre = np.polyfit(r[near] ** 2, w[near], 1)[1]
    level = centre / np.e
    k = int(np.argmax(w < level))
    return centre, r[k - 1] + (w[k - 1] - level) / (w[k - 1] - w[k]) * (r[k] - r[k - 1])


def gas_balance(run):
    """Relative error of injected + entrained = alive + burst over all rows."""
    s = run.series
    came = s["injected_volume"] + s["entrained_volume"]
    return float(np.max(np.abs(s["bubble_volume"] + s["burst_volume"] - came)) / came[-1])


def of_profiles(run, suffix):
    """What is measured of the mean profiles of a run."""
    measured = {}
    for name, height in HEIGHTS.items():
        r, w = profile(run, height)
        centre, width = centre_and_width(r, w)
        difference = w / centre - np.exp(-((r / width) ** 2))
        inner = r / width < 1.5
        measured[f"gaussian_rms_{name}{suffix}"] = float(np.sqrt(np.mean(difference[inner] ** 2)))
        measured[f"far_excess_{name}{suffix}"] = float(np.mean(difference[~inner & (r / width < 3)]))
        measured[f"axis_velocity_{name}{suffix}"] = float(centre)
        measured[f"width_{name}{suffix}"] = float(width)
    return measured


def measure(runs):
    measured = {"gas_balance": max(gas_balance(r) for r in runs.values())}
    for name, run in runs.items():
        if run.series["t"][-1] > FROM:
            measured |= of_profiles(run, "" if run is standard(runs) else f"_{name}")
    for name, other in runs.items():
        late = (other.series["t"] >= 6) & (other.series["t"] <= 12)
        if late.any():
            measured[f"mean_dissipation_{name}"] = float(np.mean(other.series["dissipation"][late]))
    return measured


def curves(runs):
    run = standard(runs)
    figures = [{"file": "mean_dissipation", "x": "t", "y": "mean dissipation rate", "log": "y",
                "curves": [(f"spacing {r.spacing:.3g}", r.series["t"][1:], r.series["dissipation"][1:], "-")
                           for r in runs.values()]}]
    if run.series["t"][-1] <= FROM:
        return figures
    lines = []
    for name, height in HEIGHTS.items():
        r, w = profile(run, height)
        centre, width = centre_and_width(r, w)
        lines.append((f"z = {height}", r / width, w / centre, "o"))
    x = np.linspace(0, 3, 100)
    lines.append(("exp(-(r/b)^2)", x, np.exp(-(x**2)), "--"))
    figures.append({"file": "profiles_gaussian", "x": "r / b", "y": "w / w on the axis",
                    "curves": [(label, a[a <= 3], b[a <= 3], style) for label, a, b, style in lines]})
    return figures
