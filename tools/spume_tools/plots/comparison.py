# SPDX-License-Identifier: MIT
"""A run beside the reference of its case, as the measure.py of the case describes it."""
import matplotlib.pyplot as plt

from ..results import DamagedResult, MissingResult
from ..verify.cases import fault_place, find_case, load_measure
from .style import finish, title_of


def draw_curves(figures, out, title=None):
    """Comparisons as measure.py describes them: a list of
    {"file": stem, "x": label, "y": label, "curves": [(label, x, y, style)], "log": "", "x", "y" or "xy"};
    style is a matplotlib format string: 'o' for measured references, '-' for computed lines, '--' for exact ones.
    """
    files = []
    for description in figures:
        figure, axis = plt.subplots(figsize=(5.6, 4.2))
        for label, x, y, style in description["curves"]:
            axis.plot(x, y, style, label=label, markersize=4, linewidth=1.3, markerfacecolor="none")
        if "x" in description.get("log", ""):
            axis.set_xscale("log")
        if "y" in description.get("log", ""):
            axis.set_yscale("log")
        axis.set(xlabel=description["x"], ylabel=description["y"])
        axis.legend(fontsize=8)
        files.append(finish(figure, out / f"{description['file']}.png", title))
    return files


def plot_reference(run, out):
    """The comparison that the case's own measure.py defines."""
    return plot_comparison({"run": run}, out)


def plot_comparison(runs, out):
    """The same for runs by the names that the case's [[verify.run]] gives them."""
    case = find_case(next(iter(runs.values())))
    module = load_measure(case) if case else None
    if module is None or not hasattr(module, "curves"):
        return []
    try:
        return draw_curves(module.curves(runs), out, title_of(next(iter(runs.values()))))
    except (MissingResult, OSError):
        raise
    except Exception as error:  # a fault in one measure.py must not hide the other pictures
        place = fault_place(case / "measure.py", error)
        raise DamagedResult(f"{place}: curves failed ({type(error).__name__}: {error})") from error


PICTURES = (plot_reference,)
