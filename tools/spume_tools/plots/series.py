# SPDX-License-Identifier: MIT
"""Quantities over time: energy, numerics, turbulence; and the time that each stage took."""
import matplotlib.pyplot as plt
import numpy as np

from .style import finish, panels_over_time, title_of


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
    left.set(xlabel=series.label("t"), ylabel=series.label("kinetic_energy") if not has_potential else series.label("kinetic_energy").replace("kinetic ", ""))
    # Above, as curves fill the frame, and above the power of ten that the axis has there.
    left.legend(loc="lower left", bbox_to_anchor=(0, 1.05), ncols=3, columnspacing=1, handlelength=1.4)
    if dissipates:
        axes[0, 1].plot(t, series["dissipation"], color="C3")
        axes[0, 1].set(xlabel=series.label("t"), ylabel=series.label("dissipation"))
    return [finish(figure, out / "energy.png", title_of(run))]


def plot_numerics(run, out):
    """What tells whether the run was healthy: step, iterations, largest speed, divergence, drift of mass."""
    series = run.series
    steps = {"dt": np.where(series["dt"] > 0, series["dt"], np.nan)}  # the first row precedes all steps
    panels = [(name, steps.get(name, series[name])) for name in ("dt", "pressure_iterations", "max_speed", "max_divergence",
                                                 "pressure_residual", "surface_particles") if name in series]
    if "mass" in series and series["mass"][0]:
        panels.append(("relative drift of mass", series["mass"] / series["mass"][0] - 1))
    figure = panels_over_time(series, panels)
    return [finish(figure, out / "numerics.png", title_of(run))] if figure else []


def cost_of(stage, item):
    """What a stage takes per pair, per item where it has no pairs, or in all."""
    work, item = (stage["pairs"], "pair") if stage["pairs"] else (stage["particles"], item)
    if not work:
        return f"{stage['seconds']:.3g} s"
    seconds = stage["seconds"] / work
    unit, length = next(((unit, length) for unit, length in (("ns", 1e-9), ("µs", 1e-6), ("ms", 1e-3)) if seconds < 999.5 * length),
                        ("s", 1.0))
    return f"{seconds / length:.3g} {unit} per {item}"


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
    item = "point" if run.has("case.toml") and run.on_grid else "particle"
    for row, (stage, share) in enumerate(zip(stages, shares)):
        axis.text(share, row, " " + cost_of(stage, item), va="center", fontsize=7)
    axis.set(xlabel=f"share of the run's {whole:.3g} s of wall time [%]", xlim=(0, 1.35 * max(shares)),
             title=f"all else: {max(0, 100 - sum(shares)):.1f} %")
    axis.tick_params(axis="y", labelsize=8)
    return [finish(figure, out / "ledger.png", title_of(run))]


def plot_turbulence(run, out):
    """Scales and gradient statistics of a homogeneous flow against time."""
    series = run.series
    names = [name for name in ("mean_dissipation", "reynolds_lambda", "kmax_eta", "integral_scale", "gradient_skewness",
                               "gradient_flatness", "balance_residual") if name in series]

    def injection(axis, name):
        if name == "mean_dissipation" and np.any(series["mean_injection"] != 0):
            axis.plot(series["t"], series["mean_injection"], "k--", label="injection")
            axis.legend(fontsize=8)

    figure = panels_over_time(series, [(name, series[name]) for name in names], injection)
    return [finish(figure, out / "turbulence.png", title_of(run))] if figure else []


PICTURES = (plot_energy, plot_numerics, plot_ledger, plot_turbulence)
