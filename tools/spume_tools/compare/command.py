# SPDX-License-Identifier: MIT
"""Two runs side by side: what they cost, what they differ in, their verdicts and every quantity that both recorded.

The second run is interpolated to the times of the first. The pictures are those of `spume plot DIR DIR2`. Exit code 0
when the runs were compared, whether they agree or not, else 2.
"""
import argparse
import signal
import sys
from pathlib import Path

from ..plots.command import draw_into, run_in
from ..plots.pair import IGNORED, PICTURES, names_of
from ..plots.request import Request
from ..results import MissingResult
from .differences import compared, costs, differing_options, verdicts

# How the program works is told in the part on cost.
NUMERICS = IGNORED | {"dt"}


def columns(rows):
    """Lines of a table: the first column to the left, the others to the right."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return ["  " + "  ".join(cell.ljust(w) if k == 0 else cell.rjust(w) for k, (cell, w) in enumerate(zip(row, widths))).rstrip()
            for row in rows]


def value_of(option):
    return "-" if option is None else f"{option:.6g}" if isinstance(option, float) else str(option)


def shortened(text, most=48):
    return text if len(text) <= most else text[: most - 3] + "..."


def table_of(tables, title):
    """Lines for one pair of tables."""
    found, end = compared(tables, NUMERICS)
    rows = [("", "first", "second", "difference", "largest", "at t")]
    for d in found:
        relative = (lambda value: f"{100 * value / d.scale:.3g} %") if d.scale > 0 else (lambda value: f"{value:.3g}")
        rows.append((d.name + (f" [{d.unit}]" if d.unit else ""), f"{d.first:.6g}", f"{d.second:.6g}",
                     relative(d.second - d.first), relative(d.largest), f"{d.at:.4g}"))
    return [f"{title} at t = {end:.6g}; differences of the largest size of the first run:", *columns(rows)]


def lines_of(first, second):
    """The whole comparison as text."""
    names = names_of(first, second)
    said = [f"first   {names[0]}: {first.case.get('title', '')}", f"second  {names[1]}: {second.case.get('title', '')}", ""]
    rows = costs(first, second)
    if rows:
        said += columns([("", "first", "second"), *rows]) + [""]
    options = [(key, shortened(value_of(a)), shortened(value_of(b))) for key, a, b in differing_options(first, second)]
    said += ["options that differ:", *columns([("", "first", "second"), *options])] if options else ["no option differs"]
    said.append("")
    rows = verdicts(first, second)
    if rows:
        said += ["verdicts:", *columns([("", "first", "second"), *rows]), ""]
    said += table_of((first.series, second.series), "series")
    if first.has("probes.csv") and second.has("probes.csv"):
        said += ["", *table_of((first.probes, second.probes), "probes")]
    return said


def main():
    parser = argparse.ArgumentParser(prog="spume compare", description=__doc__.splitlines()[0])
    parser.add_argument("first", metavar="DIR", help="the folder of a run")
    parser.add_argument("second", metavar="DIR2", help="the folder of another")
    parser.add_argument("--no-pictures", action="store_true", help="the table alone")
    arguments = parser.parse_args()
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # a reader that has seen enough, such as head, ends the table
    try:
        runs = [run_in(folder, Request()) for folder in (arguments.first, arguments.second)]
        print("\n".join(lines_of(*runs)), flush=True)
    except MissingResult as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    if arguments.no_pictures:
        return 0
    print()
    out = Path(arguments.first) / "plots" / f"beside_{Path(arguments.second).resolve().name}"
    return draw_into(arguments.first, PICTURES, runs, out)
