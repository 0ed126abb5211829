# SPDX-License-Identifier: MIT
"""Head above a sharp-crested weir that a steady flow rate needs, against Rehbock (1929): the discharge that his formula
gives for the head measured, over the one that enters, averaged over the last third of a run; and the volumes that enter
and leave."""
from pathlib import Path

import numpy as np
from spume_tools.results import read_reference

TABLE = read_reference(Path(__file__).parent / "reference" / "weir.csv", ("H", "P", "q"))
GRAVITY = 9.81


def discharge(head, height):
    """Rehbock's."""
    return 2 / 3 * (0.602 + 0.083 * head / height) * np.sqrt(2 * GRAVITY) * head**1.5


def measure(runs):
    values = {}
    for name, run in runs.items():
        constants = run.case["constants"]
        height, given = constants["crest"], constants["q"]
        probes, series = run.probes, run.series
        late = probes["t"] > 2 / 3 * probes["t"][-1]
        level = probes["level"][late]
        head = float(np.mean(level)) - height
        # The channel sloshes: over the last third of the run this rate scattered by 2 % between nine runs that differed in
        # their steps by a few per cent, over the last two thirds by 0.6 %.
        rows = series["t"] > 1 / 3 * series["t"][-1]
        t, leaves = series["t"][rows], series["volume_out"][rows]
        values |= {f"{name}_head": head,
                   f"{name}_head_scatter": float(np.std(level)) / head,
                   f"{name}_discharge_error": float(abs(discharge(head, height) / given - 1)),
                   f"{name}_outflow_error": float(abs(np.polyfit(t, leaves, 1)[0] / given - 1))}
    return values


def curves(runs):
    lines = []
    for name, run in runs.items():
        constants = run.case["constants"]
        lines.append((f"Spume, spacing {run.spacing:g}", run.probes["t"], run.probes["level"] - constants["crest"], "-"))
        row = int(np.argmin(np.abs(TABLE["q"] - constants["q"]) + np.abs(TABLE["P"] - constants["crest"])))
    lines.append(("Rehbock (1929)", np.array([0, run.probes["t"][-1]]), np.full(2, TABLE["H"][row]), "k--"))
    return [{"file": "head", "x": "t [s]", "y": "head above the crest [m]", "curves": lines}]
