# SPDX-License-Identifier: MIT
"""The table of speeds of the first page: tools/bench report [--rounds N] [--only speeds|stages].

Runs the routines and whole runs of the table, and prints it as Markdown: the machine and how busy it was, its own limits
measured in the same process as the routines, and of every line the median and the range of the rounds. Missed targets
are in bold type. Then one run of each method: nanoseconds per particle and step, share and share of its limit of every
stage. About twelve minutes on two idle cores.
"""
import argparse
import os
import platform
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

from ..places import HOME
from ..results import MissingResult
from . import program, stages
from .roofline import results

BUSY = 0.3  # of a core: another program's share that a step on every core feels


@dataclass(frozen=True)
class Row:
    what: str
    target: float
    unit: str
    command: str
    routine: str = ""  # run_name of a benchmark, and how its entry gives the figure
    figure: Callable | None = None
    whole_run: Callable | None = None
    more_is_better: bool = False

    def missed(self, value):
        return value < self.target if self.more_is_better else value > self.target


def ns_a_particle(entry):
    return entry["time_per_particle"] * 1e9


def million_steps(entry):
    return 1e-6 / entry["time_per_particle"]


def seconds(entry):
    return entry["real_time"] * {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}[entry["time_unit"]]


ROUTINES, RUNS = "tools/bench routines", "tools/bench program"
M_STEPS = "M particle-steps/s"
LES_STEP = "les_sph_step/per_axis:30/threads:2/iterations:10/process_time/real_time"
ROWS = [
    Row("neighbour lists, 1,000,000 particles", 75, "ns per particle", ROUTINES,
        "neighbour_list/particles:1000000/arrangement:1/threads:2/process_time/real_time", ns_a_particle),
    Row("`les-sph`: breaking wave, LES, 126,300 particles", 0.6, M_STEPS, f"{RUNS} step",
        whole_run=lambda bench: bench.particle_steps_per_second(2, 0.2)[0] / 1e6, more_is_better=True),
    Row("`les-sph`: collapse of 100,000 particles", 120, "s per simulated second", f"{RUNS} collapse",
        whole_run=lambda bench: program.collapse_seconds(bench)),
    Row("`les-sph`: bubbles, one per ten particles", 1.2, "us per bubble and step", f"{RUNS} bubbles",
        whole_run=lambda bench: program.bubble_microseconds(bench)[0]),
    Row("`les-sph`: memory of the process", 1000, "bytes per particle", f"{RUNS} memory",
        whole_run=lambda bench: program.peak_bytes(bench)[0]),
    Row("`les-sph`: two threads against one", 1.85, "times", f"{RUNS} threads",
        whole_run=lambda bench: program.thread_ratio(bench), more_is_better=True),
    Row("`gfd`: step over that of `les-sph`, 27,000 particles", 0.8, "times", ROUTINES,
        "gfd_step/per_axis:30/threads:2/iterations:10/process_time/real_time", more_is_better=True),
    Row("`wcsph`: one phase, 97,336 particles, 3-D", 4, M_STEPS, ROUTINES,
        "wcsph_step/per_axis:46/threads:2/iterations:60/process_time/real_time", million_steps, more_is_better=True),
    Row("`wcsph`: two phases, 200,000 particles, 2-D", 8, M_STEPS, ROUTINES,
        "wcsph_step_two_phases/per_axis:400/threads:2/iterations:60/process_time/real_time", million_steps,
        more_is_better=True),
    Row("`spectral`: step, 128^3, double", 0.13, "s", ROUTINES, "flow_step<double>/points:128/threads:2/real_time", seconds),
    Row("`spectral`: motion of 2,097,152 particles in 128^3", 70, "ns per particle and step", ROUTINES,
        "particle_motion<double>/particles:2097152/arrangement:1/threads:2/real_time", ns_a_particle),
]


def processor():
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    entries = dict(line.split(":", 1) for line in lines if ":" in line)
    entries = {key.strip(): value.strip() for key, value in entries.items()}
    flags = entries.get("flags", "").split()
    widest = next((name for flag, name in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in flags), "no AVX2")
    kind = ", a virtual machine" if "hypervisor" in flags else ""
    family = f"family {entries.get('cpu family', '?')}, model {entries.get('model', '?')}"
    return f"{entries.get('model name', platform.machine())} ({family}; {widest}{kind})"


def commit():
    done = subprocess.run(["git", "-C", str(HOME), "describe", "--always", "--dirty", "--abbrev=10"], capture_output=True, text=True)
    return done.stdout.strip() or "unknown"


def conditions(limits, load):
    """The machine in words; `limits`: the entry of the benchmark of the machine's limits on two threads."""
    busy = "" if load < BUSY else f": other programs took part of the machine, and these are not its speeds (idle: below {BUSY})"
    return (f"Two threads of {processor()}, {os.cpu_count()} cores; commit {commit()}. Load average before: {load:.1f}{busy}.\n"
            f"Its limits on two threads: memory {limits['memory_bytes_per_second'] / 1e9:.0f} GB/s, cache "
            f"{limits['cache_bytes_per_second'] / 1e9:.0f} GB/s, {limits['flops_per_second'] / 1e9:.0f} GFLOP/s, "
            f"{limits['gathers_per_second'] / 1e9:.1f} G records of 16 bytes a second.")


def number(value):
    """Three significant digits, without an exponent."""
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.3g}"


def line(row, values, share):
    middle = statistics.median(values)
    measured = f"**{number(middle)}**" if row.missed(middle) else number(middle)
    spread = f" ({number(min(values))} to {number(max(values))})" if len(values) > 1 else ""
    of_limit = f"{100 * share:.0f} %" if share is not None else ""
    return f"| {row.what} | {number(row.target)} {row.unit} | {measured}{spread} | {of_limit} | `{row.command}` |"


def routine_rounds(source, rounds):
    """Entries of the benchmarks of the table, by name: one of each round; and the limits of the machine on two threads."""
    names = sorted({row.routine for row in ROWS if row.routine} | {LES_STEP})
    escaped = "|".join(name.replace("<", "[<]").replace(">", "[>]") for name in names)
    found, limits = {name: [] for name in names}, None
    for _ in range(rounds):
        for entry in results(source, f"^(machine/threads:2/.*|{escaped})$")["benchmarks"]:
            if entry["run_name"].startswith("machine/"):
                limits = limits or entry
            elif entry["run_name"] in found:
                found[entry["run_name"]].append(entry)
    missing = [name for name, entries in found.items() if not entries]
    if missing or limits is None:
        raise MissingResult(f"{source} has no benchmark {', '.join(missing) or 'machine/threads:2'}")
    return found, limits


def values_of(row, found):
    entries = found[row.routine]
    if row.figure is None:  # over the step of les-sph, in the same process and round
        return [les["time_per_particle"] / own["time_per_particle"] for own, les in zip(entries, found[LES_STEP])]
    return [row.figure(entry) for entry in entries]


def machine_limits(source):
    """On two threads."""
    found = [entry for entry in results(source, "^machine/threads:2/")["benchmarks"] if entry["run_name"].startswith("machine/")]
    if not found:
        raise MissingResult(f"{source} has no benchmark machine/threads:2")
    return found[0]


def print_speeds(arguments, bench, load):
    found, limits = routine_rounds(arguments.routines, arguments.rounds)
    print(conditions(limits, load) + f" Median of {arguments.rounds} rounds and their range.\n\n"
          "| what | target | measured | share of its limit | command |\n|---|---|---|---|---|", flush=True)
    for row in ROWS:
        if row.whole_run is not None:
            print(line(row, [row.whole_run(bench) for _ in range(arguments.rounds)], None), flush=True)
        else:
            shares = [entry["of_limit"] for entry in found[row.routine] if "of_limit" in entry]
            print(line(row, values_of(row, found), statistics.median(shares) if shares else None), flush=True)
    return limits


def main():
    parser = argparse.ArgumentParser(prog="tools/bench report", description=__doc__.split("\n\n")[1],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("routines", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", choices=("speeds", "stages"))
    arguments = parser.parse_args()
    if arguments.rounds < 1:
        parser.error("--rounds must be at least 1")
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    load = os.getloadavg()[0]
    try:
        with tempfile.TemporaryDirectory(prefix="spume-bench-") as scratch:
            bench = program.Bench(arguments.program.resolve(), scratch)
            if arguments.only == "stages":
                limits = machine_limits(arguments.routines)
                print(conditions(limits, load), flush=True)
            else:
                limits = print_speeds(arguments, bench, load)
            for method in stages.RUNS if arguments.only != "speeds" else ():
                print("\n" + stages.table(method, stages.measure(bench, method), limits, 2), flush=True)
    except MissingResult as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
