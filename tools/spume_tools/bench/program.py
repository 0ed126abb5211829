# SPDX-License-Identifier: MIT
"""Speed and memory of whole runs: tools/bench program [NAME...]; the names are the keys of MEASUREMENTS.

step      particle-steps per second of breaking_wave, 126,300 particles (width 0.25), before breaking, 2 threads
collapse  wall seconds per simulated second of bench/cases/collapse.toml, 100,000 particles, 2 threads
threads   the step's speed on 2 threads over that on 1, alternating runs
shared    time of two runs at once on the same cores over the time of one alone
bubbles   wall microseconds of all bubble stages per bubble and step, one bubble per ten particles; share with none alive
figure9   milliseconds a step of collisions, motion and flow against the number of particles, for beta = 0, 1 and 3, on
          64^3 points (de Wit et al. 2024, figure 9): table and picture in runs/figure9; ten minutes on two threads,
          or as many as OMP_NUM_THREADS says
figure9_128  the same on 128^3 points and up to 2,000,000 particles, an hour: run only when named
memory    peak memory of the step's run per particle, everything counted
parts     time and arrays of a step with and without each optional part (see parts.py)
"""
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from ..places import CASES, HOME
from ..results import MissingResult, Results
from . import figure9, parts

COLLAPSE = HOME / "bench" / "cases" / "collapse.toml"
BUBBLES = HOME / "bench" / "cases" / "bubbles.toml"
WAVE = CASES / "breaking_wave" / "case.toml"
WIDE = ["--set", "domain.upper=[1, 0.25, 0.5]", "--set", "output.every=0"]


class Bench:
    def __init__(self, program, scratch):
        self.program, self.scratch, self.count = program, Path(scratch), 0

    def start(self, case, *arguments):
        self.count += 1
        out = self.scratch / f"run-{self.count}"
        command = [str(self.program), "run", str(case), "-o", str(out), "--quiet", *arguments]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL), out

    def run(self, case, *arguments):
        """Results and wall seconds of one run, start-up and output included."""
        begin = time.monotonic()
        process, out = self.start(case, *arguments)
        if process.wait() != 0:
            raise MissingResult(f"exit code {process.returncode} from {self.program} run {case}")
        return Results(out), time.monotonic() - begin

    def particle_steps_per_second(self, threads, until):
        run, seconds = self.run(WAVE, *WIDE, "--threads", str(threads), "--until", str(until))
        particles = len(run.snapshots()[0])
        steps = int(run.series["step"][-1])
        return particles * steps / seconds, particles, steps


def step(bench):
    rate, particles, steps = bench.particle_steps_per_second(2, 0.2)
    return f"{rate / 1e6:.3f} M particle-steps/s ({particles} particles, {steps} steps, 2 threads)"


def collapse_seconds(bench):
    run, seconds = bench.run(COLLAPSE, "--threads", "2", "--until", "0.5")
    return seconds / run.series["t"][-1]


def collapse(bench):
    return f"{collapse_seconds(bench):.1f} wall seconds per simulated second to t = 0.5 s, 2 threads"


def thread_ratio(bench):
    rates = {1: [], 2: []}
    for _ in range(2):  # alternating, the best of each counts: other load on the machine slows, it never speeds up
        for count in (1, 2):
            rates[count].append(bench.particle_steps_per_second(count, 0.05)[0])
    return max(rates[2]) / max(rates[1])


def threads(bench):
    return f"2 threads are {thread_ratio(bench):.2f} times as fast as 1"


def shared(bench):
    arguments = (WAVE, *WIDE, "--threads", "2", "--until", "0.05")
    _, alone = bench.run(*arguments)
    begin = time.monotonic()
    both = [bench.start(*arguments)[0] for _ in range(2)]
    if any([process.wait() != 0 for process in both]):
        raise MissingResult("one of two runs at once failed")
    return f"two runs at once take {(time.monotonic() - begin) / alone:.2f} times as long as one ({os.cpu_count()} cores)"


def bubble_microseconds(bench):
    """Per bubble and step; how many bubbles; their share of the step with none alive."""
    def stages(*arguments):
        run, _ = bench.run(BUBBLES, "--threads", "2", *arguments)
        seconds = {entry["stage"]: entry["seconds"] for entry in run.ledger["stages"]}
        of_bubbles = [spent for name, spent in seconds.items() if name.startswith("bubble")]
        if not of_bubbles:
            raise MissingResult(f"{run.folder / 'ledger.json'}: no stage of bubbles among {', '.join(seconds)}")
        return run, sum(of_bubbles), sum(seconds.values())

    run, spent, _ = stages()
    work = float(run.series["bubbles"][1:].sum())
    _, idle, whole = stages("--set", "bubble_cloud.0.time=100")
    return 1e6 * spent / work, run.series["bubbles"][-1], idle / whole


def bubbles(bench):
    cost, count, idle = bubble_microseconds(bench)
    return f"{cost:.2f} us per bubble and step ({count:.0f} bubbles, 2 threads); without any alive {100 * idle:.2f} % of the step"


def peak_bytes(bench):
    """Of the process per particle; how many particles."""
    run, _ = bench.run(WAVE, *WIDE, "--until", "0.01")
    particles = len(run.snapshots()[0])
    return run.summary["peak_resident_bytes"] / particles, particles


def memory(bench):
    each, particles = peak_bytes(bench)
    return f"{each:.0f} bytes per particle at peak, {particles} particles"


MEASUREMENTS = {"memory": memory, "step": step, "collapse": collapse, "threads": threads, "shared": shared,
                "bubbles": bubbles, "parts": parts.table, "figure9": figure9.on_64, "figure9_128": figure9.on_128}
LONG = ("figure9_128",)


def main():
    program, names = Path(sys.argv[1]), sys.argv[2:] or [name for name in MEASUREMENTS if name not in LONG]
    unknown = [name for name in names if name not in MEASUREMENTS]
    if unknown or not program.is_file():
        print(f"error: {', '.join(unknown) or program}: not there; the measurements are {', '.join(MEASUREMENTS)}",
              file=sys.stderr)
        return 2
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    with tempfile.TemporaryDirectory(prefix="spume-bench-") as scratch:
        bench = Bench(program.resolve(), scratch)
        for name in names:
            try:
                print(f"{name:<10} {MEASUREMENTS[name](bench)}", flush=True)
            except MissingResult as error:
                print(f"error: {name}: {error}", file=sys.stderr)
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
