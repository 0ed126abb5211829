# SPDX-License-Identifier: MIT
"""Error against run time: tools/work-precision [SWEEP...] [--out DIR] [--seconds S]; the sweeps are the names in sweeps.py.

Each sweep runs a case with an exact or independent answer over resolutions, and at each resolution over the values of one
option after the other, all else at its default. Writes work_precision.csv (a row per run: sweep, resolution, option, value,
error, core-seconds) and a picture per sweep. On the front is a run that no other beats in both. Rows that the table of
--out holds already are not run again, so that a long sweep can be done in pieces.
"""
import argparse
import csv
import os
import resource
import tempfile
import time
from pathlib import Path

from ..results import MissingResult
from ..verify.cases import RunFailed, run_case
from .sweeps import SWEEPS

COLUMNS = ["sweep", "resolution", "option", "value", "error", "seconds", "steps"]
NEAR = 1.10  # a default within ten per cent of the front's time counts as on it
SHORT = 1.0  # core-seconds below which a run is done twice and the lesser time counts


def core_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def front(rows):
    """The rows that no other row beats in both error and time, by growing time."""
    best, chosen = float("inf"), []
    for row in sorted(rows, key=lambda r: (r["seconds"], r["error"])):
        if row["error"] < best:
            best = row["error"]
            chosen.append(row)
    return chosen


def excess(row, rows):
    """Time of a run over the least time of any run that is as accurate: 1 on the front."""
    return row["seconds"] / min(r["seconds"] for r in rows if r["error"] <= row["error"])


def plan(sweep):
    """(resolution, option, value, settings): the defaults first, then each option's values."""
    runs = []
    for resolution, settings in sweep.resolutions.items():
        runs.append((resolution, "default", "", settings))
        for option, values in sweep.options.items():
            for value in values:
                runs.append((resolution, option, str(value), settings + sweep.settings_of(option, value)))
    return runs


def timed_run(program, sweep, settings, label):
    """Error, core-seconds and steps of one run; nan and 0 where it fails, which is said."""
    with tempfile.TemporaryDirectory(prefix="spume-sweep-") as scratch:
        before = core_seconds()
        try:
            run = run_case(program, sweep.folder(Path(scratch)), Path(scratch) / "run", settings, sweep.until, threads=1)
            error, steps = sweep.error(run), run.summary["steps"]
        except (RunFailed, MissingResult) as failure:
            print(f"{label}: {str(failure).splitlines()[-1].strip()}", flush=True)
            error, steps = float("nan"), 0
        return error, core_seconds() - before, steps


def run_sweep(program, name, rows, end):
    sweep = SWEEPS[name]
    done = {(r["sweep"], r["resolution"], r["option"], r["value"]) for r in rows}
    for resolution, option, value, settings in plan(sweep):
        if (name, resolution, option, value) in done:
            continue
        if time.monotonic() > end:
            return False
        error, seconds, steps = timed_run(program, sweep, settings, f"{name} {resolution} {option} {value}")
        if steps > 0 and seconds < SHORT:
            seconds = min(seconds, timed_run(program, sweep, settings, f"{name} {resolution} {option} {value}")[1])
        rows.append({"sweep": name, "resolution": resolution, "option": option, "value": value, "error": error,
                     "seconds": seconds, "steps": steps})
        print(f"{name:<22} {resolution:<10} {option:<28} {value:<18} error {rows[-1]['error']:<10.4g} {rows[-1]['seconds']:.3g} s",
              flush=True)
    return True


def read_rows(path):
    if not path.is_file():
        return []
    with path.open(encoding="utf-8") as file:
        return [row | {key: float(row[key]) for key in ("error", "seconds", "steps")} for row in csv.DictReader(file)]


def write_rows(rows, path):
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows({k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()} for row in rows)


def verdicts(rows):
    """Per sweep and resolution: how far the defaults are from the front, and what would be faster at no more error."""
    lines = []
    for name in dict.fromkeys(row["sweep"] for row in rows):
        mine = [row for row in rows if row["sweep"] == name and row["error"] == row["error"]]
        for row in (r for r in mine if r["option"] == "default"):
            factor = excess(row, mine)
            better = min((r for r in mine if r["error"] <= row["error"]), key=lambda r: r["seconds"])
            words = "on the front" if factor <= NEAR else \
                f"{factor:.2f} times the time of {better['resolution']} with {better['option']} = {better['value']}, error {better['error']:.3g}"
            lines.append(f"{name:<22} {row['resolution']:<10} default: error {row['error']:.3g} in {row['seconds']:.3g} s, {words}")
    return lines


def draw(rows, name, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    mine = [row for row in rows if row["sweep"] == name and row["error"] == row["error"]]
    figure, axis = plt.subplots(figsize=(7.5, 5), layout="constrained")
    colours = plt.cm.tab20.colors
    for number, option in enumerate(dict.fromkeys(row["option"] for row in mine)):
        here = [row for row in mine if row["option"] == option]
        values = {row["value"] for row in here}
        label = (SWEEPS[name].default if name in SWEEPS else option) if option == "default" else \
            f"{option} = {here[0]['value']}" if len(values) == 1 else option
        axis.plot([r["seconds"] for r in here], [r["error"] for r in here], "s" if option == "default" else "o",
                  color="k" if option == "default" else colours[number % len(colours)],
                  markersize=8 if option == "default" else 5, label=label, zorder=3 if option == "default" else 2)
    best = front(mine)
    axis.step([r["seconds"] for r in best], [r["error"] for r in best], "k-", where="post", linewidth=1, label="front")
    for row in best:
        label = row["resolution"] + ("" if row["option"] == "default" else f" {row['option'].split('.')[-1]}={row['value']}")
        axis.annotate(label, (row["seconds"], row["error"]), fontsize=6, xytext=(4, 4), textcoords="offset points")
    axis.set(xscale="log", yscale="log", xlabel="core-seconds", ylabel=SWEEPS[name].quantity if name in SWEEPS else "error",
             title=name.replace("_", " "))
    axis.legend(fontsize=7)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(prog="tools/work-precision", description=__doc__.split("\n")[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("sweeps", nargs="*", metavar="SWEEP", help=", ".join(SWEEPS))
    parser.add_argument("--out", type=Path, default=Path("work_precision"))
    parser.add_argument("--seconds", type=float, default=1e9, help="wall time after which no new run starts")
    arguments = parser.parse_intermixed_args()
    unknown = [name for name in arguments.sweeps if name not in SWEEPS]
    if unknown or not os.access(arguments.program, os.X_OK):
        parser.error(f"{', '.join(unknown) or arguments.program}: not there; the sweeps are {', '.join(SWEEPS)}")
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    arguments.out.mkdir(parents=True, exist_ok=True)
    table = arguments.out / "work_precision.csv"
    rows, end, whole = read_rows(table), time.monotonic() + arguments.seconds, True
    for name in arguments.sweeps or SWEEPS:
        whole = run_sweep(arguments.program.resolve(), name, rows, end) and whole
        write_rows(rows, table)
    for name in dict.fromkeys(row["sweep"] for row in rows):
        draw(rows, name, arguments.out / f"{name}.png")
    print("\n".join(verdicts(rows)))
    if not whole:
        print("the time is over: the same command goes on")
    return 0
