# SPDX-License-Identifier: MIT
"""Heights and pressures against the MARIN experiment (Kleefsman et al. 2005, SPHERIC benchmark 2)."""
from pathlib import Path

import numpy as np

from spume_tools.results import read_reference, standard

FOLDER = Path(__file__).parent / "reference"
REFERENCE = read_reference(FOLDER / "spheric2_kleefsman.csv", ("t", "H1", "H2", "H3", "H4", "P1", "P3"))
DEPTH = 0.55
LATEST = 2.0
# A quarter of the measured peak of P1, far above the noise before impact. The experiment passes it at 0.396 s, within
# 4 ms of the first rise, and peaks at 0.415 s.
ARRIVAL_PRESSURE = 2800.0


def arrival(t, pressure):
    """First time at which the pressure exceeds the threshold; nan when it never does."""
    above = np.nonzero(pressure > ARRIVAL_PRESSURE)[0]
    return float(t[above[0]]) if len(above) else float("nan")


def errors(run):
    """Heights: rms of the difference from the experiment to 2 s, and its largest value, over the depth 0.55 m."""
    probes = run.probes
    rows = REFERENCE["t"] <= min(LATEST, probes["t"][-1])
    t = REFERENCE["t"][rows]
    measured = {}
    for gauge in ("H1", "H2", "H3", "H4"):
        height = np.nan_to_num(probes[gauge])  # no liquid above the gauge: height 0
        difference = np.interp(t, probes["t"], height) - REFERENCE[gauge][rows]
        # The samples of the reference are closer together around the impact: weigh them by the time they stand for.
        measured[f"{gauge}_error"] = float(np.sqrt(np.trapz(difference**2, t) / (t[-1] - t[0])) / DEPTH)
        measured[f"{gauge}_largest_error"] = float(np.max(np.abs(difference)) / DEPTH)
    measured["P1_arrival"] = arrival(probes["t"], probes["P1_pressure"])
    measured["P1_arrival_experiment"] = arrival(REFERENCE["t"], REFERENCE["P1"])
    early = probes["t"] < 0.6
    measured["P1_peak"] = float(np.nanmax(probes["P1_pressure"][early]))
    measured["P1_peak_time"] = float(probes["t"][early][np.nanargmax(probes["P1_pressure"][early])])
    if "mass" in run.series:  # not of methods whose particles stay
        mass = run.series["mass"]
        measured["mass_drift"] = float(np.max(np.abs(mass / mass[0] - 1)))
    return measured


def measure(runs):
    return errors(standard(runs))


def curves(runs):
    run = standard(runs)
    figures = []
    rows = REFERENCE["t"] <= max(LATEST, run.probes["t"][-1])
    for stem, names, suffix, label in (("heights_experiment", ("H2", "H4"), "", "height [m]"),
                                       ("pressures_experiment", ("P1", "P3"), "_pressure", "pressure [Pa]")):
        lines = []
        for name, colour in zip(names, ("C0", "C1")):
            lines.append((f"{name}, Spume", run.probes["t"], run.probes[name + suffix], f"{colour}-"))
            lines.append((f"{name}, experiment", REFERENCE["t"][rows], REFERENCE[name][rows], f"{colour}--"))
        figures.append({"file": stem, "x": "t [s]", "y": label, "curves": lines})
    return figures
