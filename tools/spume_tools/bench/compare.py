# SPDX-License-Identifier: MIT
"""Builds two commits side by side, runs the same benchmarks of both in turns and flags what became slower:

    tools/bench-compare REF [REF2] [--filter REGEX] [--rounds N]

REF2 is HEAD when it is not given. Work trees and builds are kept in build/compare. Each round runs the old program and
the new one, in changing order; the ratio of their times is printed with the interval of its median. What is flagged is
measured a second time and counts only when it is flagged again. Exit code 1: a benchmark became slower.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from ..places import HOME
from .ratios import WAITING, judge, undecided

# Short, on one thread, of every kind of routine: one round of one program takes about ten seconds.
QUICK = ("^((sort|images|neighbour_list|pressure_apply|pressure_residual|geometry_sums|pressure_solve|bubble_sums"
         "|depths_below_surface)/particles:10000/arrangement:1/threads:1/|particle_(gather<float>|motion<float>|exclusion|feedback)"
         "/particles:10000/arrangement:1/threads:1/|cell_multigrid_apply/particles:10000/threads:1/"
         "|flow_step<double>/points:64/threads:1/)")


class Failure(Exception):
    pass


def call(command, **options):
    try:
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, **options)
    except FileNotFoundError as error:
        raise Failure(f"{error.filename} is needed and not installed") from error
    if done.returncode != 0:
        raise Failure(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{(done.stdout + done.stderr)[-2000:]}")
    return done.stdout


def built(reference, cache, jobs):
    """The benchmark program of a commit, built in a work tree of its own."""
    commit = call(["git", "-C", HOME, "rev-parse", "--verify", "--end-of-options", reference + "^{commit}"]).strip()
    folder = cache / commit[:12]
    if not (folder / "CMakeLists.txt").exists():
        cache.mkdir(parents=True, exist_ok=True)
        call(["git", "-C", HOME, "worktree", "prune"])
        call(["git", "-C", HOME, "worktree", "add", "--detach", "--force", folder, commit])
    if not (folder / "build" / "build.ninja").exists():
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        call(["cmake", "-S", folder, "-B", folder / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DSPUME_TESTS=OFF",
              *launcher])
    print(f"building {reference} ({commit[:12]})", file=sys.stderr, flush=True)
    call(["ninja", "-C", folder / "build", "-j", jobs, "spume_bench"])
    return folder / "build" / "bench" / "spume_bench"


def measure(program, pattern, arguments):
    """Nanoseconds of each benchmark: the best of some repetitions, for other load slows and never speeds up."""
    text = call([program, f"--benchmark_filter={pattern}", f"--benchmark_min_time={arguments.min_time}",
                 f"--benchmark_repetitions={arguments.repetitions}", "--benchmark_format=json",
                 "--benchmark_display_aggregates_only=false"], env=os.environ | WAITING)
    scale = {"ns": 1, "us": 1e3, "ms": 1e6, "s": 1e9}
    times = {}
    for entry in json.loads(text)["benchmarks"]:
        if entry.get("run_type") == "aggregate" or entry.get("error_occurred"):
            continue
        value = entry[f"{arguments.clock}_time"] * scale[entry["time_unit"]]
        times[entry["run_name"]] = min(value, times.get(entry["run_name"], value))
    return times


def rounds(programs, pattern, arguments):
    """Times by benchmark: two lists, old and new, in pairs."""
    times = {}
    for number in range(arguments.rounds):
        order = (0, 1) if number % 2 == 0 else (1, 0)
        found = [None, None]
        for which in order:
            found[which] = measure(programs[which], pattern, arguments)
        for name in found[0]:
            if name in found[1]:
                pair = times.setdefault(name, ([], []))
                pair[0].append(found[0][name])
                pair[1].append(found[1][name])
        if sys.stderr.isatty():
            print(f"\rround {number + 1} of {arguments.rounds}", end="", file=sys.stderr, flush=True)
    if not times:
        raise Failure(f"no benchmark that both programs have matches {pattern}")
    return times


def exactly(names):
    """A pattern of these names alone; their slashes and colons are plain characters."""
    return "^(" + "|".join(names) + ")$"


def compare(programs, arguments):
    times = rounds(programs, arguments.filter, arguments)
    # Where the noise hides what may be a difference, there are more rounds.
    for _ in range(arguments.patience):
        open_names = [name for name, pair in times.items() if undecided(*pair, arguments.effect)]
        if not open_names:
            break
        for name, pair in rounds(programs, exactly(open_names), arguments).items():
            times[name][0].extend(pair[0])
            times[name][1].extend(pair[1])
    verdicts = {name: judge(*pair, arguments.effect) for name, pair in times.items()}
    flagged = [name for name, verdict in verdicts.items() if verdict.word]
    if flagged:
        again = rounds(programs, exactly(flagged), arguments)
        for name in flagged:
            second = judge(*again[name], arguments.effect) if name in again else None
            if second is None or second.word != verdicts[name].word:
                verdicts[name].word = ""
    width = max(map(len, verdicts))
    print(f"{'benchmark':<{width}}  {'old':>12}  {'new':>12}  {'ratio':>6}  interval")
    for name, verdict in verdicts.items():
        old, new = (f"{min(values) / 1e6:.4g} ms" for values in times[name])
        print(f"{name:<{width}}  {old:>12}  {new:>12}  {verdict.ratio:6.3f}  {verdict.low:.3f} to {verdict.high:.3f}  {verdict.word}")
    return sum(verdict.regression for verdict in verdicts.values())


def main():
    parser = argparse.ArgumentParser(prog="tools/bench-compare", description=__doc__.split("\n")[0])
    parser.add_argument("old", metavar="REF", nargs="?")
    parser.add_argument("new", metavar="REF2", nargs="?", default="HEAD")
    parser.add_argument("--programs", nargs=2, type=Path, metavar=("OLD", "NEW"), help="two benchmark programs in place of commits")
    parser.add_argument("--filter", default=QUICK, help="benchmarks by regular expression; '.' for all")
    parser.add_argument("--rounds", type=int, default=12, help="an even number")
    parser.add_argument("--patience", type=int, default=2, help="how often the rounds are repeated for what stays undecided")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--min-time", type=float, default=0.03, help="seconds of one repetition")
    parser.add_argument("--effect", type=float, default=0.04, help="smallest relative difference that counts")
    parser.add_argument("--clock", choices=["cpu", "real"], default="cpu",
                        help="cpu leaves out what other programs take; real also sees threads that wait")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--cache", type=Path, default=HOME / "build" / "compare")
    arguments = parser.parse_args()
    if arguments.rounds < 6 or arguments.rounds % 2:
        parser.error("--rounds must be even and at least 6: the order of the two programs changes from round to round")
    if (arguments.old is None) == (arguments.programs is None):
        parser.error("give a commit to compare with, or two programs")
    try:
        programs = arguments.programs or [built(reference, arguments.cache, arguments.jobs)
                                          for reference in (arguments.old, arguments.new)]
        slower = compare([program.resolve() for program in programs], arguments)
    except Failure as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 2
    print(f"{slower} slower" if slower else "nothing became slower")
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
