# SPDX-License-Identifier: MIT
"""Random and worst-case scenes, each run for a few seconds and checked: tools/stress METHOD [options].

METHOD is les-sph, spectral, wcsph, still (water at rest over random bodies, by the methods that --kinds names; --sweep
end=20 for 20 sqrt(H/g); see still_scenes.py), faults (kills, full disks, damaged checkpoints and cases; see faults.py)
or long (1e5 steps of small scenes; see long.py).
Writes DIR/stress.csv, DIR/stress.png and, for every run that failed, its case and output in DIR/failures. Exit code 1
if a run failed or crashed. A scene depends on seed and number only: --first N --runs 1 repeats one.
"""
import argparse
import csv
import os
import shutil
import subprocess
import time
from pathlib import Path

import numpy as np

from ..case_file import toml_text
from . import faults, long
from .checks import judge
from .phase_scenes import wcsph_scene
from .scenes import SCENES as DRAWN
from .still_scenes import still_scene

SCENES = DRAWN | {"wcsph": wcsph_scene, "still": still_scene}

OUTCOMES = {"ok": "tab:green", "slow": "tab:olive", "refused": "tab:gray", "stopped": "tab:orange", "failed": "tab:red",
            "crashed": "black"}

OTHERS = {"faults": faults.stress, "long": long.stress}


def run_program(program, arguments, seconds):
    """Exit code, what it said, whether the clock ended it. A first signal asks, a second one kills."""
    process = subprocess.Popen([str(program), *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               errors="replace")
    try:
        return process, process.communicate(timeout=seconds)[1], False
    except subprocess.TimeoutExpired:
        process.terminate()
    try:
        return process, process.communicate(timeout=30)[1], True
    except subprocess.TimeoutExpired:
        process.kill()
        return process, process.communicate()[1] + "\nkilled: it did not end 30 s after SIGTERM", True


def run_scene(program, method, scene, folder, seconds):
    case = folder / "case.toml"
    folder.mkdir(parents=True)
    case.write_text(toml_text(scene.case), encoding="utf-8")
    begin = time.monotonic()
    process, said, timed_out = run_program(
        program, ["run", case, "-o", folder / "run", "--quiet", "--threads", "1"], seconds)
    outcome, complaints, figures = judge(method, scene, folder / "run", process.returncode, said, timed_out)
    (folder / "said.txt").write_text(said, encoding="utf-8")
    return outcome, complaints, figures | {"seconds": time.monotonic() - begin}


def save_picture(rows, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    planes = [("courant", "mach"), ("courant", "reynolds"), ("courant", "jitter"), ("bubble_radius", "alpha"),
              ("courant", "grid"), ("courant", "ratio"), ("response_time", "diameter"), ("volume_fraction", "diameter")]
    logarithmic = {"reynolds", "ratio", "bubble_radius", "response_time", "diameter"}
    planes = [p for p in planes if sum(all(isinstance(r.get(k), (int, float)) for k in p) for r in rows) > 1]
    columns = len(planes) + 1
    figure, axes = plt.subplots(1, columns, figsize=(4.2 * columns, 4.2), layout="constrained", squeeze=False)
    figure.get_layout_engine().set(wspace=0.06)
    for axis, (x, y) in zip(axes[0], planes):
        for outcome, colour in OUTCOMES.items():
            here = [r for r in rows if r["outcome"] == outcome and isinstance(r.get(x), (int, float)) and isinstance(r.get(y), (int, float))]
            if here:
                axis.scatter([r[x] for r in here], [r[y] for r in here], c=colour, s=22 if outcome == "ok" else 40, label=outcome,
                             alpha=0.8, edgecolors="none")
        axis.set(xlabel=x.replace("_", " "), ylabel=y.replace("_", " "), xscale="log" if x in logarithmic else "linear",
                 yscale="log" if y in logarithmic else "linear")
    kinds = sorted({r["kind"] for r in rows})
    left = np.zeros(len(kinds))
    for outcome, colour in OUTCOMES.items():
        counts = np.array([sum(r["kind"] == kind and r["outcome"] == outcome for r in rows) for kind in kinds])
        if counts.any():
            axes[0][-1].barh([kind.replace("_", " ") for kind in kinds], counts, left=left, color=colour, label=outcome)
            left += counts
    axes[0][-1].set(xlabel="runs")
    axes[0][-1].legend(fontsize=8, ncol=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    figure.savefig(path, dpi=110)


def save_table(rows, path):
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows({key: f"{v:.6g}" if isinstance(v, float) else v for key, v in row.items()} for row in rows)


def sweep_values(texts):
    """--sweep name=a,b,c --sweep ... -> one mapping for each combination."""
    combinations = [{}]
    for text in texts:
        name, _, values = text.partition("=")
        combinations = [c | {name: float(v)} for c in combinations for v in values.split(",")]
    return combinations


def stress(arguments, out):
    combinations = sweep_values(arguments.sweep)
    rows, begin = [], time.monotonic()
    for number in range(arguments.first, arguments.first + arguments.runs * len(combinations)):
        if time.monotonic() - begin > arguments.seconds:
            print(f"stress: the time is over after {len(rows)} runs; --first {number} goes on")
            break
        # A sweep repeats the same scenes over its values.
        scene_number, fixed = divmod(number, len(combinations))
        rng = np.random.default_rng([arguments.seed, scene_number])
        scene = SCENES[arguments.method](rng, arguments.kinds, combinations[fixed], arguments.plain)
        folder = out / f"run-{number}"
        outcome, complaints, figures = run_scene(arguments.program, arguments.method, scene, folder, arguments.each)
        row = {"number": number, "kind": scene.kind, "outcome": outcome, **scene.parameters, **figures, "complaint": "; ".join(complaints)}
        rows.append(row)
        if outcome != "ok":
            print(f"{number:5d} {scene.kind:<16} {outcome:<8} {'; '.join(complaints)[:220]}", flush=True)
        if outcome in ("failed", "crashed"):
            failures = out / "failures"
            failures.mkdir(exist_ok=True)
            shutil.move(folder, failures / folder.name)
        else:
            shutil.rmtree(folder)
    return rows


def main():
    parser = argparse.ArgumentParser(prog="tools/stress", description=__doc__.split("\n")[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("method", choices=[*SCENES, *OTHERS])
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    parser.add_argument("--seconds", type=float, default=150, help="wall time after which no new run starts")
    parser.add_argument("--steps", type=int, default=100000, help="of each long run")
    parser.add_argument("--each", type=float, default=6, help="wall time of one run")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="*", help="kinds of scenes; all without it")
    parser.add_argument("--plain", action="store_true", help="numerical options and closures keep their defaults")
    parser.add_argument("--sweep", action="append", default=[], metavar="NAME=V,V,...", help="the same scenes over values of a parameter")
    parser.add_argument("--out", type=Path, default=Path("stress"))
    arguments = parser.parse_args()
    if not os.access(arguments.program, os.X_OK):
        parser.error(f"{arguments.program}: not a program")
    arguments.program = arguments.program.resolve()
    arguments.out.mkdir(parents=True, exist_ok=True)
    if any(arguments.out.glob("stress.csv")):
        parser.error(f"{arguments.out} holds results already; give another --out")
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    rows = OTHERS.get(arguments.method, stress)(arguments, arguments.out)
    save_table(rows, arguments.out / "stress.csv")
    if rows and arguments.method in SCENES:
        save_picture(rows, arguments.out / "stress.png")
    counts = {outcome: sum(row["outcome"] == outcome for row in rows) for outcome in OUTCOMES}
    print(", ".join(f"{count} {outcome}" for outcome, count in counts.items() if count) + f"; see {arguments.out}")
    return 1 if counts["failed"] or counts["crashed"] else 0
