# SPDX-License-Identifier: MIT
"""Routines against the ceilings of this machine: tools/roofline [--out FILE.png] [--filter REGEX | --method NAME].

The program spume_bench, or the results that it wrote before, is the first argument of this module: it is run, machine limits first, all in one process. The left picture is operations per
second over operations per byte with the ceilings of memory, cache and arithmetic; the right one the share of the limit that
binds (memory, arithmetic or gathers), counted by hand in bench/*.cpp. With --method the stages of a step of that method
(stages.py), by the counts of its ledger, on one and on two threads.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from ..places import HOME
from . import program, stages
from .ratios import WAITING

# One size of each: jittered or sorted particles, and the flow on 128^3 points.
ROUTINES = ("^(machine/|[a-z_]+/particles:100000/arrangement:1/|particle_[a-z_]+(<[a-z]+>)?/particles:1000000/arrangement:1/"
            "|cell_multigrid_[a-z]+/particles:100000/|(flow_step|velocity_on_points|force_to_modes)<[a-z]+>/points:128/)")


def results(source, pattern):
    if source.suffix == ".json":
        return json.loads(source.read_text(encoding="utf-8"))
    command = [str(source.resolve()), f"--benchmark_filter={pattern}", "--benchmark_format=json"]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ | WAITING | {"OMP_PROC_BIND": "true"})
    if done.returncode != 0:
        raise SystemExit(f"error: {source}: exit code {done.returncode}\n{done.stderr[-1000:]}")
    return json.loads(done.stdout)


def split(report):
    """Limits by number of threads, and the routines that were counted against them."""
    limits, routines = {}, []
    for entry in report["benchmarks"]:
        name = entry["run_name"]
        if name.startswith("machine/"):
            limits[int(name.split("threads:")[1].split("/")[0])] = entry
        elif "of_limit" in entry and not (name.startswith("particle_") and "/particles:100000/" in name):
            routines.append(entry)
    return limits, routines


def short(name):
    """The name and the threads, of benchmarks that have them: all routines of one kind have one size."""
    routine, *arguments = name.removesuffix("/real_time").removesuffix("/process_time").split("/")
    threads = [a.split(":")[1] for a in arguments if a.startswith("threads:")]
    return routine + (f", {threads[0]} thread{'s' if threads[0] != '1' else ''}" if threads else "")


def table(limits, routines):
    lines = []
    for threads, limit in sorted(limits.items()):
        lines.append(f"limits on {threads} thread{'s' if threads > 1 else ''}: memory {limit['memory_bytes_per_second'] / 1e9:.1f} GB/s, cache "
                     f"{limit['cache_bytes_per_second'] / 1e9:.0f} GB/s, {limit['flops_per_second'] / 1e9:.0f} GFLOP/s, "
                     f"{limit['gathers_per_second'] / 1e9:.2f} G records of 16 B/s")
    width = max((len(short(r["run_name"])) for r in routines), default=8)
    lines.append(f"{'routine':<{width}}  {'GB/s':>7}  {'GFLOP/s':>8}  {'G gathers/s':>11}  share of the limit")
    for r in routines:
        cell = lambda key: f"{r[key] / 1e9:.2f}" if key in r else "-"
        lines.append(f"{short(r['run_name']):<{width}}  {cell('bytes_per_second'):>7}  {cell('flops_per_second'):>8}  "
                     f"{cell('gathers_per_second'):>11}  {100 * r['of_limit']:.0f} %")
    return "\n".join(lines)


def draw(limits, routines, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np

    from ..plots.labels import free_labels

    numbers = {}  # of the routines, on one thread and on several alike
    for r in routines:
        numbers.setdefault(short(r["run_name"]).split(",")[0], len(numbers) + 1)
    tall = max(6.5, 0.19 * len(numbers) + 0.8)
    figure = plt.figure(figsize=(13, tall))
    roof = figure.add_axes((0.055, 0.5 / tall, 0.45, 1 - 0.9 / tall))
    bars = figure.add_axes((0.69, 0.5 / tall, 0.29, 1 - 0.9 / tall))
    x = np.logspace(-1, 2, 200)
    numbered = lambda r: f"{numbers[short(r['run_name']).split(',')[0]]}"
    for (threads, limit), style in zip(sorted(limits.items()), ("-", "--", ":")):
        peak = limit["flops_per_second"]
        for key, colour in (("memory_bytes_per_second", "tab:blue"), ("cache_bytes_per_second", "tab:cyan")):
            roof.plot(x, np.minimum(x * limit[key], peak) / 1e9, style, color=colour,
                      label=f"{key.split('_')[0]}, {threads} thread{'s' if threads > 1 else ''}")
    counted = [r for r in routines if "flops_per_second" in r and "bytes_per_second" in r
               and not short(r["run_name"]).endswith("threads")]
    points = [(r["flops_per_second"] / r["bytes_per_second"], r["flops_per_second"] / 1e9) for r in counted]
    roof.plot(*np.array(points).reshape(-1, 2).T, "ko", markersize=4)
    roof.set(xscale="log", yscale="log", xlabel="operations per byte", ylabel="GFLOP/s")
    roof.legend(fontsize=7)
    if points:
        free_labels(roof, points, [numbered(r) for r in counted])
    several = sorted({short(r["run_name"]).partition(", ")[2] for r in routines})
    height = 0.8 / len(several)
    for k, threads in enumerate(several):
        here = [r for r in routines if short(r["run_name"]).partition(", ")[2] == threads]
        place = [numbers[short(r["run_name"]).split(",")[0]] + (k - 0.5 * (len(several) - 1)) * height for r in here]
        bars.barh(place, [100 * r["of_limit"] for r in here], height, color=f"C{k}", label=threads)
    bars.set(xlabel="share of the limit that binds [%]", xlim=(0, 100), ylim=(len(numbers) + 0.6, 0.4))
    bars.set_yticks(list(numbers.values()), [f"{name}  {number}" for name, number in numbers.items()], fontsize=7)
    if any(several):
        bars.legend(fontsize=7, ncol=2, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    figure.savefig(path, dpi=110)


def stages_of(method, limits):
    with tempfile.TemporaryDirectory(prefix="spume-bench-") as scratch:
        bench = program.Bench(HOME / "build" / "release" / "spume", scratch)
        return [entry for threads, limit in sorted(limits.items())
                for entry in stages.entries(stages.measure(bench, method, threads), limit, threads) if "of_limit" in entry]


def main():
    parser = argparse.ArgumentParser(prog="tools/roofline", description=__doc__.split("\n")[0])
    parser.add_argument("source", type=Path, metavar="BENCH|RESULTS.json")
    parser.add_argument("--out", type=Path, default=Path("roofline.png"))
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--filter", default=ROUTINES)
    which.add_argument("--method", choices=tuple(stages.RUNS))
    arguments = parser.parse_args()
    limits, routines = split(results(arguments.source, "^machine/" if arguments.method else arguments.filter))
    if arguments.method:
        routines = stages_of(arguments.method, limits)
    if not limits or not routines:
        print("error: the results hold no machine limits or no routine counted against them", file=sys.stderr)
        return 2
    print(table(limits, routines))
    draw(limits, routines, arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
