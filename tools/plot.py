#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Standard pictures of a run: plot.py DIR [--times T...] writes DIR/plots/*.png and prints their names.

Every picture is drawn from what the folder holds. What the case asks for and the folder does not hold is left out with
one line saying so. Exit code 0 when at least one picture was written and no file was damaged, else 2.
"""
import argparse
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from spume_bubbles import PICTURES as BUBBLE_PICTURES
from spume_figures import (FIELDS, draw_curves, draw_grid_slices, draw_side_view, draw_slices, finish,
                           has_free_surface)
from spume_particle_figures import plot_particles
from spume_results import DamagedResult, MissingResult, Results, read_csv
from spume_verification import fault_place, find_case, load_measure


def asks_for_spectra(case):
    return case.get("output", {}).get("spectrum_every", 0) > 0


def asks_for_probes(case, lines):
    """Whether the case has a probe that is a line, or one that is not."""
    return any((probe.get("kind") == "line") == lines for probe in case.get("probe", []))


def plot_energy(run, out):
    """Kinetic energy, and with gravity the changes of potential and total energy, and the rate of dissipation."""
    series = run.series
    t = series["t"]
    has_potential = "potential_energy" in series and np.ptp(series["potential_energy"]) > 0
    dissipates = "dissipation" in series and np.nanmax(np.abs(series["dissipation"]), initial=0) > 0
    figure, axes = plt.subplots(1, 1 + dissipates, figsize=(5.2 * (1 + dissipates), 3.8), squeeze=False)
    left = axes[0, 0]
    left.plot(t, series["kinetic_energy"], label="kinetic")
    if has_potential:
        rest = series["potential_energy"][0]
        left.plot(t, series["potential_energy"] - rest, label="potential, change from the start")
        left.plot(t, series["kinetic_energy"] + series["potential_energy"] - rest, "k", label="sum")
    left.set(xlabel=series.label("t"), ylabel=series.label("kinetic_energy") if not has_potential else "energy")
    left.legend()
    if dissipates:
        axes[0, 1].plot(t, series["dissipation"], color="C3")
        axes[0, 1].set(xlabel=series.label("t"), ylabel=series.label("dissipation"))
    return [finish(figure, out / "energy.png")]


def plot_numerics(run, out):
    """What tells whether the run was healthy: step, iterations, largest speed, divergence, drift of mass."""
    series = run.series
    panels = [(name, series[name]) for name in ("dt", "pressure_iterations", "max_speed", "max_divergence",
                                                 "pressure_residual", "surface_particles") if name in series]
    if "mass" in series and series["mass"][0]:
        panels.append(("relative drift of mass", series["mass"] / series["mass"][0] - 1))
    panels = [(name, values) for name, values in panels if np.isfinite(values).any()]
    if not panels:
        return []
    columns = min(3, len(panels))
    rows = -(-len(panels) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(4.2 * columns, 2.8 * rows), squeeze=False)
    for axis in axes.flat[len(panels):]:
        axis.remove()
    for axis, (name, values) in zip(axes.flat, panels):
        axis.plot(series["t"], values, linewidth=0.9)
        axis.set(xlabel=series.label("t"), ylabel=series.label(name))
        positive = values[np.isfinite(values) & (values > 0)]
        if len(positive) and positive.max() > 300 * np.median(positive):
            axis.set_yscale("log")
    return [finish(figure, out / "numerics.png")]


def plot_ledger(run, out):
    """Share of each stage in the time of the run, the largest first, with its cost."""
    if not run.has("ledger.json"):
        return []
    ledger = run.ledger
    stages = sorted(ledger["stages"], key=lambda stage: stage["seconds"])
    whole = ledger["wall_seconds"]
    if not stages or not whole > 0:
        return []
    figure, axis = plt.subplots(figsize=(6.4, 1 + 0.24 * len(stages)))
    shares = [100 * stage["seconds"] / whole for stage in stages]
    axis.barh([stage["stage"] for stage in stages], shares, color="tab:blue")
    for row, (stage, share) in enumerate(zip(stages, shares)):
        work, unit = (stage["pairs"], "pair") if stage["pairs"] else (stage["particles"], "particle")
        cost = f"{1e9 * stage['seconds'] / work:.3g} ns per {unit}" if work else f"{stage['seconds']:.3g} s"
        axis.text(share, row, " " + cost, va="center", fontsize=7)
    axis.set(xlabel=f"share of {whole:.3g} s, %", xlim=(0, 1.35 * max(shares)), title=f"the rest is {max(0, 100 - sum(shares)):.1f} %")
    axis.tick_params(axis="y", labelsize=8)
    return [finish(figure, out / "ledger.png")]


def plot_slices(run, out):
    """Particles coloured by each field at up to six times; in 3-D those of the middle plane; or that plane of a grid."""
    if run.on_grid:
        snapshots = run.grid_snapshots()
        derived = {"velocity": "speed", "vorticity": "enstrophy"}
        names = [derived.get(name, name) for name in snapshots.names]
        return [draw_grid_slices(run, snapshots, name, out / f"{name}.png") for name in names if len(snapshots)]
    snapshots = run.snapshots()
    names = [name for name in FIELDS if name == "speed" or name in snapshots.names]
    return [draw_slices(run, snapshots, name, out / f"{name}.png") for name in names if len(snapshots)]


def plot_side_view(run, out):
    """The liquid of a 3-D scene with a free surface, shaded, seen from the side and above."""
    if run.dimensions != 3 or run.on_grid or not has_free_surface(run):
        return []
    return [draw_side_view(run, run.snapshots(), out / "side_view.png")]


def plot_spectra(run, out):
    if not run.has("spectrum.csv") and not asks_for_spectra(run.case):
        return []
    spectrum = run.spectrum
    times = np.unique(spectrum["t"])
    chosen = times[np.unique(np.linspace(0, len(times) - 1, min(6, len(times))).astype(int))]
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    for time, colour in zip(chosen, plt.cm.viridis(np.linspace(0, 0.9, len(chosen)))):
        rows = (spectrum["t"] == time) & (spectrum["wavenumber"] > 0) & (spectrum["energy"] > 0)
        axis.loglog(spectrum["wavenumber"][rows], spectrum["energy"][rows], color=colour, label=f"t = {time:.3g}")
    # The reference slope passes through the last spectrum, a little above it, in the middle of its range.
    if rows.sum() > 4:
        k, energy = spectrum["wavenumber"][rows], spectrum["energy"][rows]
        middle = len(k) // 4
        span = k[max(1, middle // 2): max(4, int(0.6 * len(k)))]
        axis.loglog(span, 2.5 * energy[middle] * (span / k[middle]) ** (-5 / 3), "k--", label="slope -5/3")
        axis.set_ylim(max(energy.max() * 1e-8, 0.3 * energy.min()), 10 * energy.max())
    axis.set(xlabel=spectrum.label("wavenumber"), ylabel=spectrum.label("energy"))
    axis.legend(fontsize=8)
    return [finish(figure, out / "spectrum.png")]


def plot_turbulence(run, out):
    """Scales and gradient statistics of a homogeneous flow against time."""
    series = run.series
    panels = [name for name in ("mean_dissipation", "reynolds_lambda", "kmax_eta", "integral_scale", "gradient_skewness",
                                "gradient_flatness", "balance_residual") if name in series]
    panels = [name for name in panels if np.isfinite(series[name]).any()]
    if not panels:
        return []
    rows = -(-len(panels) // 3)
    figure, axes = plt.subplots(rows, 3, figsize=(12.6, 2.8 * rows), squeeze=False)
    for axis in axes.flat[len(panels):]:
        axis.remove()
    for axis, name in zip(axes.flat, panels):
        axis.plot(series["t"], series[name], linewidth=0.9)
        if name == "mean_dissipation" and np.any(series["mean_injection"] != 0):
            axis.plot(series["t"], series["mean_injection"], "k--", label="injection")
            axis.legend(fontsize=8)
        axis.set(xlabel=series.label("t"), ylabel=series.label(name))
    return [finish(figure, out / "turbulence.png")]


def plot_gradient_pdf(run, out):
    """Probability densities of the velocity gradients at the last time, beside the normal one."""
    if not run.has("gradient_pdf.csv"):
        return []
    table = read_csv(run.folder / "gradient_pdf.csv")
    rows = table["t"] == table["t"].max()
    value = table["gradient"][rows]
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    for name in ("longitudinal", "transverse"):
        density = table[name][rows]
        axis.semilogy(value[density > 0], density[density > 0], label=name)
    axis.semilogy(value, np.exp(-value**2 / 2) / np.sqrt(2 * np.pi), "k--", label="normal")
    lowest = min(table[name][rows][table[name][rows] > 0].min() for name in ("longitudinal", "transverse"))
    axis.set(xlabel="velocity gradient / standard deviation", ylabel="probability density", ylim=(lowest / 2, 2),
             title=f"t = {table['t'].max():.4g}")
    axis.legend(fontsize=8)
    return [finish(figure, out / "gradient_pdf.png")]


def plot_probes(run, out):
    """Every probe against time, one panel per quantity."""
    if not run.has("probes.csv") and not asks_for_probes(run.case, lines=False):
        return []
    probes = run.probes
    groups = {}
    for name in probes:
        if name == "t" or not np.isfinite(probes[name]).any():
            continue
        for suffix in ("_pressure", "_velocity_x", "_velocity_y", "_velocity_z", "_area"):
            if name.endswith(suffix):
                groups.setdefault(suffix[1:].replace("_", " "), []).append((name[: -len(suffix)], name))
                break
        else:
            groups.setdefault("elevation, wetted length, front", []).append((name, name))
    if not groups:
        return []
    figure, axes = plt.subplots(len(groups), 1, figsize=(6.4, 2.8 * len(groups)), squeeze=False)
    for axis, (quantity, members) in zip(axes.flat, groups.items()):
        for label, name in members:
            axis.plot(probes["t"], probes[name], linewidth=1, label=label)
        axis.set(xlabel=probes.label("t"), ylabel=quantity)
        axis.legend(fontsize=8, ncol=2)
    return [finish(figure, out / "probes.png")]


def plot_lines(run, out):
    """Profiles along every line probe at up to six times."""
    if not run.has("lines.csv") and not asks_for_probes(run.case, lines=True):
        return []
    files = []
    for name in run.line_names():
        times = run.line_times(name)
        chosen = np.unique(np.linspace(0, len(times) - 1, min(6, len(times))).astype(int))
        quantities = [q for q in ("velocity_x", "velocity_y", "velocity_z", "pressure") if q in run.lines]
        figure, axes = plt.subplots(1, len(quantities), figsize=(3.8 * len(quantities), 3.6), squeeze=False)
        for index, colour in zip(chosen, plt.cm.viridis(np.linspace(0, 0.9, len(chosen)))):
            profile = run.line(name, index)
            for axis, quantity in zip(axes.flat, quantities):
                axis.plot(profile["s"], profile[quantity], color=colour, label=f"t = {times[index]:.3g}")
                axis.set(xlabel=f"distance along {name}", ylabel=run.lines.label(quantity))
        axes.flat[0].legend(fontsize=8)
        files.append(finish(figure, out / f"line_{name}.png"))
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
        return draw_curves(module.curves(runs), out)
    except (MissingResult, OSError):
        raise
    except Exception as error:  # a fault in one measure.py must not hide the other pictures
        place = fault_place(case / "measure.py", error)
        raise DamagedResult(f"{place}: curves failed ({type(error).__name__}: {error})") from error


PICTURES = (plot_energy, plot_numerics, plot_ledger, plot_turbulence, plot_slices, plot_side_view, plot_spectra,
            plot_gradient_pdf, plot_particles, plot_probes, plot_lines, *BUBBLE_PICTURES, plot_reference)


def is_run(results):
    return any(results.has(name) for name in ("series.csv", "summary.json", "log.txt", "fluid.vtkhdf"))


def runs_of(folder):
    """The runs in the subfolders that `spume verify --keep` leaves of a case, by their names."""
    found = [Results(child) for child in sorted(Path(folder).iterdir()) if child.is_dir()] if Path(folder).is_dir() else []
    return {run.folder.name: run for run in found if is_run(run)}


def run_in(folder):
    """The run in a folder; MissingResult when there is none."""
    run = Results(folder)
    if is_run(run):
        return run
    if run.has("case.toml"):
        raise MissingResult(f"{folder}: a case and not a run of it")
    raise MissingResult(f"{folder}: not the folder of a run, with series.csv, summary.json or log.txt")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("directory", metavar="DIR", help="the folder of a run, or of the runs of a case that verify kept")
    parser.add_argument("--times", metavar="T", nargs="+", type=float, default=(), help="times that particles are drawn at")
    arguments = parser.parse_args()
    folder = arguments.directory
    try:
        runs = runs_of(folder)
        drawn = runs or run_in(folder)
        if not runs:
            drawn.picture_times = arguments.times
    except MissingResult as error:
        print(f"error: {error}; give the folder that 'spume run' made", file=sys.stderr)
        return 2
    out = Path(folder) / "plots"
    files, left_out, damaged = [], {}, set()
    for picture in (plot_comparison,) if runs else PICTURES:
        try:
            out.mkdir(exist_ok=True)
            files += picture(drawn, out)
        except (MissingResult, ValueError, IndexError, np.linalg.LinAlgError) as error:
            left_out.setdefault(str(error), []).append(picture.__name__[5:].replace("_", " "))
            if isinstance(error, DamagedResult):
                damaged.add(str(error))
        except OSError as error:
            print(f"error: {error.filename}: {error.strerror}", file=sys.stderr)
            return 2
        finally:
            plt.close("all")
    for reason, names in left_out.items():
        print(f"{'error: ' if reason in damaged else ''}{', '.join(names)} left out: {reason}", file=sys.stderr)
    for file in files:
        print(file)
    if not files:
        out.rmdir()
        print(f"error: {folder}: nothing to draw", file=sys.stderr)
    return 0 if files and not damaged else 2


if __name__ == "__main__":
    sys.exit(main())
