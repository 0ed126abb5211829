# SPDX-License-Identifier: MIT
"""Stages of a step of each method, from the ledger of a run, against the limits of the machine.

The least time of a stage is that of the bytes which it streams at the speed of memory, or of one record gathered for
each pair at the speed of gathers, whichever is longer. Sweeps that gather several records a pair, vectors reread from
memory and arithmetic are not in the ledger: the share of the limit is a lower bound, and is left out where a stage
counts neither.
"""
from dataclasses import dataclass
from pathlib import Path

from ..places import CASES, HOME

CASES_OF_BENCH = HOME / "bench" / "cases"
LITTLE, FAR = 0.05, 1 / 3  # of a run; of the limit: a stage above the one and below the other is one to look at


@dataclass(frozen=True)
class Run:
    what: str
    case: Path
    settings: tuple  # of about 1e5 particles
    until: float     # 20 steps or more


RUNS = {
    "les-sph": Run("breaking wave, LES, 126,300 particles", CASES / "breaking_wave" / "case.toml",
                   ("--set", "domain.upper=[1, 0.25, 0.5]", "--set", "output.every=0"), 0.05),
    "gfd": Run("two fluids, 97,336 particles", CASES_OF_BENCH / "two_fluids.toml",
               ("--set", "resolution.spacing=0.021739130434782608"), 0.04),
    "wcsph": Run("one phase, 97,336 particles", CASES_OF_BENCH / "weakly_compressible.toml", (), 0.02),
    "spectral": Run("turbulence on 64^3 points, 262,144 particles that exclude each other", CASES_OF_BENCH / "swarm.toml",
                    ("--set", "particles.count=262144"), 0.5),
}


def entries(run, limits, threads):
    """The stages of a run in the form of benchmark entries, in the order of the ledger. A stage that was called no more than
    twice belongs to the start and the end of the run, as checkpoints do."""
    stages = [stage for stage in run.ledger["stages"] if stage["calls"] > 2 and stage["seconds"] > 0]
    whole = sum(stage["seconds"] for stage in stages)
    size, steps = run.summary["particles"], run.summary["steps_this_process"]
    found = []
    for stage in stages:
        seconds = stage["seconds"]
        entry = {"run_name": f"{stage['stage']}/threads:{threads}", "stage": stage["stage"], "share": seconds / whole,
                 "ns_per_particle": 1e9 * seconds / (size * steps)}
        least = {"memory": stage["bytes"] / limits["memory_bytes_per_second"],
                 "gathers": stage["pairs"] / limits["gathers_per_second"]}
        if stage["bytes"] > 0:
            entry["bytes_per_second"] = stage["bytes"] / seconds
        if stage["pairs"] > 0:
            entry["gathers_per_second"] = stage["pairs"] / seconds
        bound = max(least, key=least.get)
        if least[bound] > 0:
            entry |= {"of_limit": least[bound] / seconds, "bound_by": bound}
        found.append(entry)
    return found


def table(method, run, limits, threads):
    """Markdown. Stages that are far from their limit and not little are in bold type."""
    of = entries(run, limits, threads)
    total = sum(entry["ns_per_particle"] for entry in of)
    lines = [f"`{method}`: {RUNS[method].what}; {run.summary['steps_this_process']} steps, {total:.0f} ns per particle and step.", "",
             "| stage | ns per particle and step | share of the step | share of its limit | bound by |", "|---|---|---|---|---|"]
    for entry in sorted(of, key=lambda e: -e["share"]):
        share = entry.get("of_limit")
        limit = "" if share is None else f"{100 * share:.0f} %"
        if share is not None and share < FAR and entry["share"] > LITTLE:
            limit = f"**{limit}**"
        lines.append(f"| {entry['stage']} | {entry['ns_per_particle']:.3g} | {100 * entry['share']:.1f} % | {limit} | {entry.get('bound_by', '')} |")
    return "\n".join(lines)


def measure(bench, method, threads=2, coarser=()):
    of = RUNS[method]
    return bench.run(of.case, "--threads", str(threads), *of.settings, *coarser, "--until", str(of.until))[0]
