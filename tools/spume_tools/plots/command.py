# SPDX-License-Identifier: MIT
"""Standard pictures of a run: writes DIR/plots/*.png and prints their names.

Every picture is drawn from what the folder holds. What the case asks for and the folder does not hold is left out with
one line saying so. Exit code 0 when at least one picture was written and no file was damaged, else 2.
"""
import argparse
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from ..results import DamagedResult, MissingResult, Results
from . import bubbles, comparison, planes, point_particles, probes, series, shaded, spectra

PICTURES = [picture for module in (series, planes, shaded, spectra, point_particles, probes, bubbles, comparison)
            for picture in module.PICTURES]


def is_run(results):
    return any(results.has(name) for name in ("series.csv", "summary.json", "log.txt", "fluid.vtkhdf"))


def runs_of(folder):
    """The runs in the subfolders that `spume verify --keep` leaves of a case, by their names."""
    found = [Results(child) for child in sorted(Path(folder).iterdir()) if child.is_dir()] if Path(folder).is_dir() else []
    return {run.folder.name: run for run in found if is_run(run)}


def run_in(folder):
    """The run in a folder; MissingResult when there is none."""
    run = Results(folder)
    if is_run(run):
        return run
    if run.has("case.toml"):
        raise MissingResult(f"{folder}: a case and not a run of it")
    raise MissingResult(f"{folder}: not the folder of a run, with series.csv, summary.json or log.txt")


def main():
    parser = argparse.ArgumentParser(prog="spume plot", description=__doc__.splitlines()[0])
    parser.add_argument("directory", metavar="DIR", help="the folder of a run, or of the runs of a case that verify kept")
    parser.add_argument("--times", metavar="T", nargs="+", type=float, default=(), help="times that particles are drawn at")
    arguments = parser.parse_args()
    folder = arguments.directory
    try:
        runs = runs_of(folder)
        drawn = runs or run_in(folder)
        if not runs:
            drawn.picture_times = arguments.times
    except MissingResult as error:
        print(f"error: {error}; give the folder that 'spume run' made", file=sys.stderr)
        return 2
    out = Path(folder) / "plots"
    files, left_out, damaged = [], {}, set()
    for picture in (comparison.plot_comparison,) if runs else PICTURES:
        try:
            out.mkdir(exist_ok=True)
            files += picture(drawn, out)
        except (MissingResult, ValueError, IndexError, np.linalg.LinAlgError) as error:
            left_out.setdefault(str(error), []).append(picture.__name__[5:].replace("_", " "))
            if isinstance(error, DamagedResult):
                damaged.add(str(error))
        except OSError as error:
            print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
            return 2
        finally:
            plt.close("all")
    for reason, names in left_out.items():
        print(f"{'error: ' if reason in damaged else ''}{', '.join(names)} left out: {reason}", file=sys.stderr)
    for file in files:
        print(file)
    if not files:
        out.rmdir()
        print(f"error: {folder}: nothing to draw", file=sys.stderr)
    return 0 if files and not damaged else 2
