# SPDX-License-Identifier: MIT
"""Standard pictures of a run, or of two runs side by side: writes DIR/plots/* and prints their names.

Every picture is drawn from what the folder holds. What the case asks for and the folder does not hold is left out with
one line saying so. Exit code 0 when at least one picture was written and no file was damaged, else 2.
"""
import argparse
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from ..results import DamagedResult, MissingResult
from . import animation, bubble_views, bubbles, comparison, pair, planes, point_particles, probes, series, spectra, views
from .request import DrawnRun, Request

PICTURES = [picture for module in (series, planes, views, spectra, point_particles, probes, bubbles, bubble_views, comparison)
            for picture in module.PICTURES]


def is_run(results):
    return any(results.has(name) for name in ("series.csv", "summary.json", "log.txt", "fluid.vtkhdf"))


def runs_of(folder):
    """The runs in the subfolders that `spume verify --keep` leaves of a case, by their names."""
    children = sorted(Path(folder).iterdir()) if Path(folder).is_dir() else []
    found = [DrawnRun(child) for child in children if child.is_dir()]
    return {run.folder.name: run for run in found if is_run(run)}


def run_in(folder, request):
    """The run in a folder; MissingResult when there is none."""
    run = DrawnRun(folder, request)
    if is_run(run):
        return run
    if run.has("case.toml"):
        raise MissingResult(f"{folder}: a case and not a run of it")
    raise MissingResult(f"{folder}: not the folder of a run, with series.csv, summary.json or log.txt")


def plane(text):
    """An axis and a coordinate from "y=0.5"."""
    axis, equals, value = text.partition("=")
    if axis not in ("x", "y", "z") or not equals:
        raise argparse.ArgumentTypeError(f"'{text}' is not an axis and a coordinate, such as y=0.5")
    return "xyz".index(axis), number(value, text)


def colour_range(text):
    """A field and the limits of its colours from "speed=0:2"."""
    name, equals, limits = text.partition("=")
    low, colon, high = limits.partition(":")
    if not (name and equals and colon):
        raise argparse.ArgumentTypeError(f"'{text}' is not a field with two limits, such as speed=0:2")
    low, high = number(low, text), number(high, text)
    if not low < high:
        raise argparse.ArgumentTypeError(f"'{text}': the first limit is not below the second")
    return name, (low, high)


def number(text, whole):
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise argparse.ArgumentTypeError(f"'{whole}': '{text}' is not a number")
    return value


def parse():
    parser = argparse.ArgumentParser(prog="spume plot", description=__doc__.splitlines()[0])
    parser.add_argument("directory", metavar="DIR", help="the folder of a run, or of the runs of a case that verify kept")
    parser.add_argument("other", metavar="DIR2", nargs="?", help="another run, drawn beside the first")
    parser.add_argument("--fields", metavar="NAME", nargs="+", default=(),
                        help="fields drawn in a plane: those of the snapshots, speed, enstrophy, velocity_x, ...")
    parser.add_argument("--times", metavar="T", nargs="+", type=float, default=(), help="times of the snapshots that are drawn")
    parser.add_argument("--plane", metavar="AXIS=VALUE", type=plane, help="plane of the fields in 3-D; default: the middle y")
    parser.add_argument("--range", metavar="FIELD=LOW:HIGH", nargs="+", type=colour_range, default=(), help="limits of the colours")
    parser.add_argument("--format", choices=("png", "pdf", "svg"), default="png", help="of the pictures; default: png")
    parser.add_argument("--animate", action="store_true", help="GIFs of all snapshots, with ffmpeg MP4s too, in place of pictures of some")
    return parser.parse_args()


def draw(pictures, drawn, out):
    """Files that were written, reasons why others were not with their names, and which of these are damage."""
    files, left_out, damaged = [], {}, set()
    for picture in pictures:
        try:
            out.mkdir(parents=True, exist_ok=True)
            files += picture(*drawn, out)
        except (MissingResult, ValueError, IndexError, np.linalg.LinAlgError) as error:
            left_out.setdefault(str(error), []).append(picture.__name__[5:].replace("_", " "))
            if isinstance(error, DamagedResult):
                damaged.add(str(error))
        finally:
            plt.close("all")
    return files, left_out, damaged


def draw_into(folder, pictures, drawn, out):
    """Writes pictures of a folder to `out`, prints their names and what was left out; returns the exit code."""
    try:
        files, left_out, damaged = draw(pictures, drawn, out)
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    for reason, names in left_out.items():
        print(f"{'error: ' if reason in damaged else ''}{', '.join(names)} left out: {reason}", file=sys.stderr)
    for file in files:
        print(file)
    if not files:
        for empty in (out, out.parent):
            if empty.name == "plots" or empty == out:
                if empty.is_dir() and not any(empty.iterdir()):
                    empty.rmdir()
        print(f"error: {folder}: nothing to draw", file=sys.stderr)
    return 0 if files and not damaged else 2


def main():
    arguments = parse()
    folder, out = arguments.directory, Path(arguments.directory) / "plots"
    request = Request(tuple(arguments.times), tuple(arguments.fields), arguments.plane, dict(arguments.range))
    plt.rcParams["savefig.format"] = arguments.format
    try:
        runs = {} if arguments.other else runs_of(folder)
        if runs:
            pictures, drawn = (comparison.plot_comparison,), (runs,)
        elif arguments.other:
            first, second = run_in(folder, request), run_in(arguments.other, request)
            pictures, drawn, out = pair.PICTURES, (first, second), out / f"beside_{Path(arguments.other).resolve().name}"
        else:
            pictures, drawn = animation.PICTURES if arguments.animate else PICTURES, (run_in(folder, request),)
    except MissingResult as error:
        print(f"error: {error}; give the folder that 'spume run' made", file=sys.stderr)
        return 2
    try:
        for run in () if runs else drawn:
            planes.refuse_what_is_not_there(run)
    except MissingResult as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return draw_into(folder, pictures, drawn, out)
