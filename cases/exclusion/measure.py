# SPDX-License-Identifier: MIT
"""Overlap of light bubbles in turbulence with and without excluded volume."""
import numpy as np

from spume_tools.results import read_csv


def last(run, name):
    """Mean over the last fifth of the run."""
    t = run.series["t"]
    return float(np.mean(run.series[name][t >= 0.8 * t[-1]]))


def measure(runs):
    excluded = runs["excluded"]
    out = {"overlap_ratio": last(excluded, "overlap_ratio"),
           "overlap_ratio_error": last(excluded, "overlap_ratio_error"),
           "clipped_force": last(excluded, "clipped_force"),
           "reynolds_lambda": last(excluded, "reynolds_lambda"),
           "kmax_eta": last(excluded, "kmax_eta")}
    if "free" in runs:
        out["free_overlap_ratio"] = float(runs["free"].series["overlap_ratio"][-1])
    return out


def curves(runs):
    runs = {name: run for name, run in runs.items() if "overlap_ratio" in run.series}  # not the flow that both start from
    figures = [{"file": "overlap_ratio", "x": "t", "y": "overlap ratio", "log": "y",
                "curves": [(name, run.series["t"][1:], np.maximum(run.series["overlap_ratio"][1:], 1e-5), "-")
                           for name, run in runs.items()]
                + [("paper, free", np.array([0, 15]), np.array([0.783, 0.783]), "k:"),
                   ("paper, excluded", np.array([0, 15]), np.array([0.005, 0.005]), "k--")]}]
    if all(run.has("particle_overlaps.csv") for run in runs.values()):
        lines = []
        for name, run in runs.items():
            table = read_csv(run.folder / "particle_overlaps.csv")
            rows = table["t"] == table["t"][-1]
            lines.append((name, table["overlap"][rows], table["pairs"][rows], "-"))
        figures.append({"file": "overlaps", "x": "Q / D", "y": "probability density", "log": "y", "curves": lines})
    return figures
