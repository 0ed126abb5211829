# SPDX-License-Identifier: MIT
"""Runs validation cases and prints error against bound.

    spume verify [CASE...]
    python3 -m spume_tools.verify PROGRAM [CASE...] [--quick] [--threads N] [--keep DIR]

Exit code 0 when every bound holds, 1 when one does not or a run failed, 2 when the request makes no sense
or a case cannot be checked: an unknown word in [verify], no bound, a damaged reference. That is found before any run.
130 when it was interrupted, as the run that it had started then is.
"""
import argparse
import json
import math
import sys
import tempfile
import traceback
from pathlib import Path

from ..program import interruptible_main
from ..results import MissingResult, read_case
from .cases import RunFailed, case_folder, cases_with_verification, load_measure, run_case, settings_of, within
from .table import VerifyTable

NAMES = ("quantity", "measured", "bound", "verdict", "seconds")
COLUMNS = "{:<22} {:<34} {:>12} {:>18}  {:<6} {:>8}"


def text_of(bound):
    if bound is None:
        return "-"
    return f"{bound[0]:.5g} .. {bound[1]:.5g}" if isinstance(bound, list) else f"<= {bound:.5g}"


def verification_of(folder, quick):
    """The [verify] table of a case, or with quick its short form; None when it has none. And what is wrong with it."""
    file = folder / "case.toml"
    table = read_case(file).get("verify")
    if table is None:
        return None, []
    problems = VerifyTable(file, file.read_text(encoding="utf-8")).check(table, quick)
    if problems or not quick:
        return table, problems
    short = table.get("quick", False)
    return (short if isinstance(short, dict) else table if short else None), []


def measure_of(folder):
    """The module measure.py of a case, with the references it reads; MissingResult when there is none that measures."""
    module = load_measure(folder)
    if module is None:
        raise MissingResult(f"{folder / 'measure.py'}: not there; add it, with measure(runs) -> {{quantity: value}}")
    if not callable(getattr(module, "measure", None)):
        raise MissingResult(f"{folder / 'measure.py'}: defines no measure(runs); add it, returning {{quantity: value}}")
    return module


def prepare(names, quick):
    """What is to be verified, [(folder, table, measure module)], and everything that is wrong with the request. All of
    it is known before the first run, so that a damaged reference does not cost a simulation."""
    chosen, problems = [], []
    folders = list(dict.fromkeys(case_folder(name) for name in names)) or cases_with_verification()
    for index, folder in enumerate(folders):
        if folder.name in (other.name for other in folders[:index]):
            problems.append(f"{folder}: another case of this name is to be verified too, and the runs of both would share "
                            "a folder; verify one at a time")
        try:
            table, faults = verification_of(folder, quick)
            problems += faults
            if table is not None:
                chosen.append((folder, table, measure_of(folder)))
            elif names:
                missing = "[verify.quick]" if quick else "[verify]"
                problems.append(f"{folder / 'case.toml'}: no {missing} table; add one with bounds"
                                + (", or leave out --quick" if quick else ""))
        except MissingResult as error:
            problems.append(str(error))
    if not chosen and not problems:
        problems.append("no case to verify")
    return chosen, problems


def verify_case(program, folder, table, module, out, threads, draw):
    """Yields rows (quantity, value, bound, verdict, seconds) of one case; draw also writes its comparison figures."""
    runs, seconds = {}, 0.0
    for run in table.get("run") or [{"name": "run"}]:
        print(f"running {folder.name}: {run['name']}", file=sys.stderr, flush=True)
        result = run_case(program, folder, out / run["name"], settings_of(run, runs), run.get("until"), threads)
        runs[run["name"]] = result
        seconds += result.wall_seconds
    measured = module.measure(runs)
    bounds = table["bounds"]
    for quantity, value in measured.items():
        bound = bounds.get(quantity)
        verdict = "" if bound is None else "pass" if math.isfinite(value) and within(value, bound) else "FAIL"
        yield quantity, value, bound, verdict, seconds
    for quantity in bounds.keys() - measured.keys():
        yield quantity, math.nan, bounds[quantity], "FAIL", seconds
    if draw and hasattr(module, "curves"):
        from ..plots.comparison import draw_curves

        plots = out / "plots"
        plots.mkdir(exist_ok=True)
        draw_curves(module.curves(runs), plots)


def main():
    parser = argparse.ArgumentParser(prog="spume verify", description=__doc__.splitlines()[0])
    parser.add_argument("program", metavar="PROGRAM", help="the spume executable")
    parser.add_argument("cases", metavar="CASE", nargs="*", help="names or folders; none: all cases with [verify]")
    parser.add_argument("--quick", action="store_true", help="only what takes seconds")
    parser.add_argument("--threads", type=int, help="threads of each run")
    parser.add_argument("--keep", metavar="DIR", type=Path, help="keep the runs, their plots and verify.json here")
    arguments = parser.parse_intermixed_args()

    try:
        chosen, problems = prepare(arguments.cases, arguments.quick)
    except MissingResult as error:
        chosen, problems = [], [str(error)]
    if problems:
        for problem in dict.fromkeys(problems):
            print(f"error: {problem}", file=sys.stderr)
        return 2
    program = Path(arguments.program)
    if not program.is_file():
        print(f"error: {program}: no such program; build it with tools/build release", file=sys.stderr)
        return 2

    with tempfile.TemporaryDirectory(prefix="spume-verify-") as scratch:
        keep = arguments.keep or Path(scratch)
        if arguments.keep and any((keep / folder.name).exists() for folder, *_ in chosen):
            print(f"error: {keep}: holds earlier runs, and nothing is overwritten; give another folder",
                  file=sys.stderr)
            return 2
        failed, report = [], {}
        for folder, table, module in chosen:
            out = keep / folder.name
            try:
                out.mkdir(parents=True)
                rows = list(verify_case(program.resolve(), folder, table, module, out, arguments.threads,
                                        bool(arguments.keep)))
            except (RunFailed, MissingResult) as error:
                print(f"{folder.name}: {error}", file=sys.stderr, flush=True)
                rows = [("(not measured)", math.nan, None, "FAIL", math.nan)]
            except OSError as error:
                print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
                return 2
            except Exception:  # a fault in one measure.py must not hide the verdicts of the other cases
                traceback.print_exc()
                rows = [("(measure.py failed)", math.nan, None, "FAIL", math.nan)]
            report[folder.name] = [dict(zip(NAMES, row)) for row in rows]
            if not failed and len(report) == 1:
                print(COLUMNS.format("case", "quantity", "measured", "bound", "", "seconds"))
            for quantity, value, bound, verdict, seconds in rows:
                print(COLUMNS.format(folder.name, quantity, f"{value:.5g}", text_of(bound), verdict, f"{seconds:.1f}"),
                      flush=True)
                if verdict == "FAIL":
                    failed.append(f"{folder.name}: {quantity}")
        if arguments.keep:
            (keep / "verify.json").write_text(json.dumps(report, indent=1), encoding="utf-8")
    if failed:
        print(f"{len(failed)} failed: " + "; ".join(failed))
        return 1
    print("every bound holds")
    return 0


def command():
    return interruptible_main(main)
