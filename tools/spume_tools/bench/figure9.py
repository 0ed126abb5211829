# SPDX-License-Identifier: MIT
"""Cost of collisions, motion and flow against the number of particles (de Wit et al. 2024, figure 9)."""
import os
import subprocess
import sys
from pathlib import Path

from ..places import HOME
from ..results import MissingResult, Results

SWARM = HOME / "bench" / "cases" / "swarm.toml"
SWARM_END = 2.0  # its time.end: seven response times, of which the last fifth is timed
PARTS = ("collisions", "motion", "flow")


def part_of(stage, steps):
    """The part of a step that a stage of the ledger belongs to; None for output and for what couples the particles."""
    name = stage["stage"]
    if "exclusion" in name:
        return "collisions"
    if name == "velocity at points" or name.startswith("particle ") and name != "particle feedback":
        return "motion"
    # What the flow does, it does in every step.
    return "flow" if stage["calls"] >= steps and name not in ("particle feedback", "force to modes") else None


def stage_seconds(run):
    """Seconds by what they were spent on, since the run was last resumed, and its steps."""
    steps, stages = run.summary["steps_this_process"], run.ledger["stages"]
    seconds = dict.fromkeys(PARTS, 0.0)
    for stage in stages:
        part = part_of(stage, steps)
        if part is not None:
            seconds[part] += stage["seconds"]
    for part, spent in seconds.items():
        if not spent > 0:
            raise MissingResult(f"{run.folder / 'ledger.json'}: no stage of {part} among "
                                f"{', '.join(stage['stage'] for stage in stages)}")
    return seconds, steps


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


def on_64(bench):
    return cost_against_number(bench, "figure9", 64, (10000, 50000, 262144, 1000000, 2000000))


def on_128(bench):
    return cost_against_number(bench, "figure9_128", 128, (10000, 50000, 262144, 1000000, 2000000))
