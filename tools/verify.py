#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Runs validation cases and prints error against bound.

    verify.py PROGRAM [CASE...] [--quick] [--threads N] [--keep DIR]

Exit code 0 when every bound holds, 1 when one does not or a run failed, 2 when the request makes no sense.
"""
import argparse
import json
import math
import sys
import tempfile
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from spume_results import MissingResult, read_case
from spume_verification import (RunFailed, case_folder, cases_with_verification, load_measure, run_case, settings_of,
                                within)

NAMES = ("quantity", "measured", "bound", "verdict", "seconds")
COLUMNS = "{:<22} {:<34} {:>12} {:>18}  {:<6} {:>8}"


def text_of(bound):
    if bound is None:
        return "-"
    return f"{bound[0]:.5g} .. {bound[1]:.5g}" if isinstance(bound, list) else f"<= {bound:.5g}"


def verification_of(folder, quick):
    """The [verify] table of a case, or with quick its short form; None when it has none."""
    table = read_case(folder / "case.toml").get("verify")
    if table is None or not quick:
        return table
    short = table.get("quick", False)
    return short if isinstance(short, dict) else table if short else None


def verify_case(program, folder, table, out, threads, draw):
    """Yields rows (quantity, value, bound, verdict, seconds) of one case; draw also writes its comparison figures."""
    runs, seconds = {}, 0.0
    for run in table.get("run") or [{"name": "run"}]:
        print(f"running {folder.name}: {run['name']}", file=sys.stderr, flush=True)
        result = run_case(program, folder, out / run["name"], settings_of(run, runs), run.get("until"), threads)
        runs[run["name"]] = result
        seconds += result.wall_seconds
    module = load_measure(folder)
    measured = module.measure(runs)
    bounds = table.get("bounds", {})
    for quantity, value in measured.items():
        bound = bounds.get(quantity)
        verdict = "" if bound is None else "pass" if math.isfinite(value) and within(value, bound) else "FAIL"
        yield quantity, value, bound, verdict, seconds
    for quantity in bounds.keys() - measured.keys():
        yield quantity, math.nan, bounds[quantity], "FAIL", seconds
    if draw and hasattr(module, "curves"):
        from spume_figures import draw_curves

        plots = out / "plots"
        plots.mkdir(exist_ok=True)
        draw_curves(module.curves(runs), plots)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", metavar="PROGRAM", help="the spume executable")
    parser.add_argument("cases", metavar="CASE", nargs="*", help="names or folders; none: all cases with [verify]")
    parser.add_argument("--quick", action="store_true", help="only what takes seconds")
    parser.add_argument("--threads", type=int, help="threads of each run")
    parser.add_argument("--keep", metavar="DIR", type=Path, help="keep the runs, their plots and verify.json here")
    arguments = parser.parse_args()

    try:
        folders = [case_folder(name) for name in arguments.cases] or cases_with_verification()
        chosen = [(folder, verification_of(folder, arguments.quick)) for folder in folders]
    except MissingResult as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if arguments.cases and not arguments.quick:
        for folder, table in chosen:
            if table is None:
                print(f"error: {folder / 'case.toml'}: no [verify] table; add one with bounds", file=sys.stderr)
                return 2
    chosen = [(folder, table) for folder, table in chosen if table is not None]
    if not chosen:
        print("error: no case to verify", file=sys.stderr)
        return 2
    program = Path(arguments.program)
    if not program.is_file():
        print(f"error: {program}: no such program; build it with tools/build release", file=sys.stderr)
        return 2

    with tempfile.TemporaryDirectory(prefix="spume-verify-") as scratch:
        keep = arguments.keep or Path(scratch)
        if arguments.keep and any((keep / folder.name).exists() for folder, _ in chosen):
            print(f"error: {keep}: holds earlier runs, and nothing is overwritten; give another folder",
                  file=sys.stderr)
            return 2
        failed, report = [], {}
        for folder, table in chosen:
            out = keep / folder.name
            try:
                out.mkdir(parents=True)
                rows = list(verify_case(program.resolve(), folder, table, out, arguments.threads, bool(arguments.keep)))
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


if __name__ == "__main__":
    sys.exit(main())
