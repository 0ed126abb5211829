#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Speed and memory of whole runs: bench_program.py PROGRAM [NAME...]; the names are the keys of MEASUREMENTS.

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
parts     time and arrays of a step with and without each optional part (see bench_parts.py)
"""
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import bench_parts
from spume_results import MissingResult, Results
from spume_verification import CASES

COLLAPSE = CASES.parent / "bench" / "cases" / "collapse.toml"
BUBBLES = CASES.parent / "bench" / "cases" / "bubbles.toml"
SWARM = CASES.parent / "bench" / "cases" / "swarm.toml"
SWARM_END = 2.0  # its time.end: seven response times, of which the last fifth is timed
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


def collapse(bench):
    run, seconds = bench.run(COLLAPSE, "--threads", "2", "--until", "0.5")
    return f"{seconds / run.series['t'][-1]:.1f} wall seconds per simulated second to t = 0.5 s, 2 threads"


def threads(bench):
    rates = {1: [], 2: []}
    for _ in range(2):  # alternating, the best of each counts: other load on the machine slows, it never speeds up
        for count in (1, 2):
            rates[count].append(bench.particle_steps_per_second(count, 0.05)[0])
    return f"2 threads are {max(rates[2]) / max(rates[1]):.2f} times as fast as 1"


def shared(bench):
    arguments = (WAVE, *WIDE, "--threads", "2", "--until", "0.05")
    _, alone = bench.run(*arguments)
    begin = time.monotonic()
    both = [bench.start(*arguments)[0] for _ in range(2)]
    if any([process.wait() != 0 for process in both]):
        raise MissingResult("one of two runs at once failed")
    return f"two runs at once take {(time.monotonic() - begin) / alone:.2f} times as long as one ({os.cpu_count()} cores)"


def bubbles(bench):
    def stages(*arguments):
        run, _ = bench.run(BUBBLES, "--threads", "2", *arguments)
        seconds = {entry["stage"]: entry["seconds"] for entry in run.ledger["stages"]}
        return run, sum(s for name, s in seconds.items() if name.startswith("bubble")), sum(seconds.values())

    run, spent, _ = stages()
    work = float(run.series["bubbles"][1:].sum())
    _, idle, whole = stages("--set", "bubble_cloud.0.time=100")
    return (f"{1e6 * spent / work:.2f} us per bubble and step ({run.series['bubbles'][-1]:.0f} bubbles, 2 threads); "
            f"without any alive {100 * idle / whole:.2f} % of the step")


def memory(bench):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    run, _ = bench.run(WAVE, *WIDE, "--until", "0.01")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    particles = len(run.snapshots()[0])
    # ru_maxrss is the largest child so far, so a larger one before would hide this run.
    note = "" if peak > before else " (an earlier run was as large)"
    return f"{peak * 1024 / particles:.0f} bytes per particle at peak, {particles} particles{note}"


def stage_seconds(run):
    """Seconds by what they were spent on, since the run was last resumed, and its steps."""
    seconds = {entry["stage"]: entry["seconds"] for entry in run.ledger["stages"]}
    calls = {entry["stage"]: entry["calls"] for entry in run.ledger["stages"]}
    total = lambda *names: sum(seconds.get(name, 0.0) for name in names)
    return {"collisions": total("particle exclusion"),
            "motion": total("velocity at points", "particle sort", "particle records", "particle motion"),
            "flow": total("copy of the state", "forcing", "viscosity", "inverse transforms in x", "product in planes",
                          "forward transforms in x", "forward transforms in x, update", "acceptance", "energy balance",
                          "conjugate modes")
            }, calls["energy balance"]


def cost_against_number(bench, name, grid, counts):
    """Runs that settle over four fifths of their time, and are timed over the rest after a resume."""
    folder = Path("runs") / name
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    threads = os.environ.get("OMP_NUM_THREADS", "2")
    for beta in (0, 1, 3):
        for count in counts:
            run, _ = bench.run(SWARM, "--threads", threads, "--until", f"{0.8 * SWARM_END:g}", f"--set=resolution.grid={grid}",
                               f"--set=particles.beta={beta}", f"--set=particles.count={count}")
            command = [str(bench.program), "resume", str(run.folder), "--quiet", "--threads", threads, "--until",
                       f"{SWARM_END:g}"]
            if subprocess.run(command, stdout=subprocess.DEVNULL).returncode != 0:
                raise MissingResult(f"resume of {run.folder} failed")
            seconds, steps = stage_seconds(Results(run.folder))
            rows.append([beta, count, *(1e3 * seconds[part] / steps for part in PARTS)])
            print(f"beta {beta}, {count} particles: " + ", ".join(f"{part} {ms:.1f}" for part, ms in zip(PARTS, rows[-1][2:])),
                  file=sys.stderr, flush=True)
    lines = [f"# milliseconds a step, threads: {threads}", "beta,particles," + ",".join(PARTS)]
    lines += [f"{beta},{count}," + ",".join(f"{ms:.3f}" for ms in times) for beta, count, *times in rows]
    (folder / "figure9.csv").write_text("\n".join(lines) + "\n")
    draw_cost(rows, grid, folder / "figure9.png")
    return "\n".join([f"milliseconds a step on {grid}^3 points, threads: {threads}; {folder}/figure9.png", *lines[1:]])


def draw_cost(rows, grid, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axis = plt.subplots(figsize=(5.6, 4.4))
    for beta in sorted({row[0] for row in rows}):
        of = [row for row in rows if row[0] == beta]
        axis.loglog([row[1] for row in of], [row[2] for row in of], "o-", label=f"collisions, beta = {beta}")
    of = [row for row in rows if row[0] == 3]
    axis.loglog([row[1] for row in of], [row[3] for row in of], "k:", label="motion")
    axis.loglog([row[1] for row in of], [row[4] for row in of], "k--", label="flow")
    axis.axvline(grid**3, color="grey", linestyle="-.", linewidth=0.8)
    axis.set(xlabel="particles", ylabel="ms a step")
    axis.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=130)
    plt.close(figure)


PARTS = ("collisions", "motion", "flow")


def figure9(bench):
    return cost_against_number(bench, "figure9", 64, (10000, 50000, 262144, 1000000, 2000000))


def figure9_128(bench):
    return cost_against_number(bench, "figure9_128", 128, (10000, 50000, 262144, 1000000, 2000000))


MEASUREMENTS = {"memory": memory, "step": step, "collapse": collapse, "threads": threads, "shared": shared,
                "bubbles": bubbles, "parts": bench_parts.table, "figure9": figure9, "figure9_128": figure9_128}
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
