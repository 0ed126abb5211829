# SPDX-License-Identifier: MIT
"""Differences between the forms of the momentum diffusion near the interface of two layers, Joubert et al., figures 7 to
9: root mean squares over |y| < 3 h of <mu lap u> by generalised finite differences (12) and by SPH (13) less <div tau>
(19), with their scatter over squares of 20 x 40 particles."""
import numpy as np

OPERATORS = ("gfd", "sph")


def response(run):
    """x, y and the diffusion along x, in the order of the particles' numbers."""
    first = next(iter(run.snapshots()))
    order = np.argsort(first.field("id"))
    return first.position[order, 0], first.position[order, 1], first.field("diffusion")[order, 0]


def differences(runs):
    """{ratio: {name: (rms, standard deviation of the rms of the squares)}}"""
    found = {}
    for name in runs:
        operator, _, ratio = name.partition("_")
        if operator in OPERATORS and f"printed_{ratio}" in runs:
            x, y, value = response(runs[name])
            full = response(runs[f"printed_{ratio}"])[2]
            resolution = runs[name].case["resolution"]
            near = np.abs(y) < 3 * float(resolution["smoothing_ratio"]) * float(resolution["spacing"])
            square = (value - full)**2
            each = [np.sqrt(square[near & (np.floor(x) == k)].mean()) for k in range(int(np.ceil(x.max())))]
            found.setdefault(float(ratio.replace("_", ".")), {})[operator] = (
                float(np.sqrt(square[near].mean())), float(np.std(each)))
    return found


def measure(runs):
    found, measured = differences(runs), {}
    for ratio, each in found.items():
        for operator, (rms, scatter) in each.items():
            measured[f"{operator}_{ratio:g}"] = rms
            measured[f"{operator}_{ratio:g}_scatter"] = scatter
    both = [each for _, each in sorted(found.items()) if len(each) == len(OPERATORS)]
    if both:  # at the largest ratio: at small ones (13) has the noise of SPH alone
        measured["forms_apart"] = abs(both[-1]["sph"][0] / both[-1]["gfd"][0] - 1)
    if len(both) > 1:
        rms = [each["gfd"][0] for each in both]
        measured["growth"] = min(after / before for before, after in zip(rms, rms[1:]))
    return measured


def ratio_of(run):
    below, above = (float(phase["viscosity"]) for phase in run.case["phase"])
    return below / above


def curves(runs):
    found, lines, drawn = differences(runs), [], []
    for operator in OPERATORS:
        points = sorted((ratio, each[operator][0]) for ratio, each in found.items() if operator in each)
        if points:
            lines.append((f"{operator} <mu lap u>", *map(np.array, zip(*points)), "o-" if operator == "gfd" else "s--"))
    if lines:
        drawn.append({"file": "difference", "x": "viscosity ratio", "y": "rms difference from <div tau>", "curves": lines,
                      "log": "xy"})
    lines = []
    for name, run in runs.items():
        if len(runs) > 1 and not name.endswith("_5"):
            continue
        _, y, value = response(run)
        layer = np.floor(y / float(run.case["resolution"]["spacing"]))
        rows = np.unique(layer)
        lines.append((run.case["momentum"]["diffusion"], np.array([y[layer == row].mean() for row in rows]),
                      np.array([value[layer == row].mean() for row in rows]), "-"))
        ratio = ratio_of(run)
    if lines:
        lines.append(("exact", np.array([-1.0, 1.0]), np.array([-1.0, -1.0]), "k:"))
        drawn.append({"file": "response", "x": "y", "y": f"diffusion along x, {ratio:g}:1", "curves": lines})
    return drawn
