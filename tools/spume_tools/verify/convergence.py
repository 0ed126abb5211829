# SPDX-License-Identifier: MIT
"""Error against spacing and against run time.

    tools/convergence CASE SPACING... [--set K=V] [--until T] [--threads N] [--keep DIR]

Prints a table and, with --keep, writes convergence.csv and convergence.png beside the runs.
"""
import argparse
import sys
import tempfile
from pathlib import Path

from ..program import interruptible_main
from ..results import MissingResult, observed_order
from .cases import RunFailed, case_folder, load_measure, run_case


def main():
    parser = argparse.ArgumentParser(prog="tools/convergence", description=__doc__.splitlines()[0])
    parser.add_argument("program", metavar="PROGRAM", type=Path)
    parser.add_argument("case", metavar="CASE")
    parser.add_argument("spacings", metavar="SPACING", nargs="+", type=float)
    parser.add_argument("--set", dest="settings", action="append", default=[], metavar="K=V")
    parser.add_argument("--until", type=float)
    parser.add_argument("--threads", type=int)
    parser.add_argument("--keep", metavar="DIR", type=Path)
    arguments = parser.parse_args()
    try:
        folder = case_folder(arguments.case)
        module = load_measure(folder)
        if module is None or not hasattr(module, "errors"):
            raise MissingResult(f"{folder / 'measure.py'}: defines no errors(run)")
    except MissingResult as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    try:
        with tempfile.TemporaryDirectory(prefix="spume-convergence-") as scratch:
            keep = arguments.keep or Path(scratch)
            keep.mkdir(parents=True, exist_ok=True)
            rows = []
            for spacing in arguments.spacings:
                settings = [*arguments.settings, f"resolution.spacing={spacing!r}"]
                run = run_case(arguments.program.resolve(), folder, keep / f"spacing-{spacing:g}", settings,
                               arguments.until, arguments.threads)
                rows.append((spacing, run.wall_seconds, module.errors(run)))
                if len(rows) == 1:
                    print("".join(f"{name:>24}" for name in ("spacing", "seconds", *rows[0][2])))
                print("".join(f"{value:>24.6g}" for value in (*rows[-1][:2], *rows[-1][2].values())), flush=True)
            names = list(rows[0][2])
            if len(rows) > 1:
                orders = [observed_order([r[0] for r in rows], [abs(r[2][name]) for r in rows]) for name in names]
                print("".join(f"{text:>24}" for text in ("observed order", "", *(f"{order:.2f}" for order in orders))))
            if arguments.keep:
                write(keep, rows, names)
    except (RunFailed, MissingResult) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


def write(keep, rows, names):
    from ..plots.comparison import draw_curves

    lines = [",".join(("spacing", "seconds", *names))]
    for spacing, seconds, errors in rows:
        lines.append(",".join(f"{value:.8g}" for value in (spacing, seconds, *errors.values())))
    (keep / "convergence.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    by = [("error_against_spacing", "spacing", 0), ("error_against_time", "wall seconds", 1)]
    draw_curves([{"file": file, "x": label, "y": "error", "log": "xy",
                  "curves": [(name, [r[column] for r in rows], [abs(r[2][name]) for r in rows], "o-")
                             for name in names]}
                 for file, label, column in by], keep)


if __name__ == "__main__":
    sys.exit(interruptible_main(main))
