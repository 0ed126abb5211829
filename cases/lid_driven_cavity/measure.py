# SPDX-License-Identifier: MIT
"""Centre-line profiles against Ghia, Ghia and Shin (1982), averaged over the last five outputs."""
from pathlib import Path

import numpy as np

from spume_tools.results import read_reference

PROFILES = {"profile": ("u", "v")}
FOLDER = Path(__file__).parent / "reference"
REFERENCE = read_reference(FOLDER / "ghia1982.csv", ("coordinate", "re100", "re400", "re1000", "re3200"), PROFILES)
EXACT = read_reference(FOLDER / "spectral.csv", ("coordinate", "re100", "re400", "re1000", "re3200"), PROFILES)
# profile -> line probe, its coordinate, its velocity component
LINES = {"u": ("vertical", "y", "velocity_x"), "v": ("horizontal", "x", "velocity_y")}


def column(run):
    re = float(run.case["fluid"]["reynolds"])
    return f"re{re:.0f}"


def profile(run, kind, outputs=5):
    name, coordinate, component = LINES[kind]
    count = min(outputs, len(run.line_times(name)))
    lines = [run.line(name, -1 - k) for k in range(count)]
    return lines[0][coordinate], np.mean([line[component] for line in lines], axis=0)


def reference(kind, re, table=REFERENCE):
    """Coordinates and velocities of the table; the point that the publication misprints is left out (see README)."""
    rows = table["profile"] == kind
    coordinate, velocity = table["coordinate"][rows], table[re][rows]
    printed_right = ~((kind == "v") & (re == "re400") & (coordinate == 0.9063))
    return coordinate[printed_right], velocity[printed_right]


def errors(run):
    """Largest difference from the published table over the lid speed, per profile; the same and rms from the spectral
    solution; and how much the flow still changes from output to output."""
    measured = {}
    for kind in LINES:
        coordinate, velocity = profile(run, kind)
        for quantity, table in (("error", REFERENCE), ("difference_spectral", EXACT)):
            x, expected = reference(kind, column(run), table)
            difference = np.interp(x, coordinate, velocity) - expected
            measured[f"{kind}_{quantity}"] = float(np.max(np.abs(difference)))
        measured[f"{kind}_rms_spectral"] = float(np.sqrt(np.mean(difference**2)))
        name, _, component = LINES[kind]
        if len(run.line_times(name)) > 1:
            change = run.line(name, -1)[component] - run.line(name, -2)[component]
            measured[f"{kind}_change"] = float(np.sqrt(np.mean(change**2)))
    return measured


def measure(runs):
    measured = {f"{quantity}_{name}": value for name, run in runs.items() for quantity, value in errors(run).items()}
    if {"re3200", "re3200_coarse"} <= runs.keys():
        spacings = np.log(runs["re3200_coarse"].spacing / runs["re3200"].spacing)
        for kind in LINES:
            ratio = measured[f"{kind}_rms_spectral_re3200_coarse"] / measured[f"{kind}_rms_spectral_re3200"]
            measured[f"{kind}_order_re3200"] = float(np.log(ratio) / spacings)
    return measured


def curves(runs):
    figures = []
    for kind, (_, coordinate_name, _) in LINES.items():
        lines = []
        finest = {}
        for run in runs.values():
            if column(run) not in finest or run.spacing < finest[column(run)].spacing:
                finest[column(run)] = run
        for k, run in enumerate(finest.values()):
            colour = f"C{k}"
            coordinate, velocity = profile(run, kind)
            lines.append((f"Spume, {column(run)}", coordinate, velocity, f"{colour}-"))
            lines.append((f"Ghia et al., {column(run)}", *reference(kind, column(run)), f"{colour}o"))
        figures.append({"file": f"profile_{kind}", "x": coordinate_name, "y": kind, "curves": lines})
    return figures
