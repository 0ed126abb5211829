# SPDX-License-Identifier: MIT
"""Spectra and probability densities of a homogeneous flow."""
import matplotlib.pyplot as plt
import numpy as np

from .style import evenly, finish, shades, time_title, title_of


def asks_for_spectra(case):
    return case.get("output", {}).get("spectrum_every", 0) > 0


def plot_spectra(run, out):
    if not run.has("spectrum.csv") and not asks_for_spectra(run.case):
        return []
    spectrum = run.spectrum
    times = np.unique(spectrum["t"])
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    for time, colour in shades(times[evenly(len(times))]):
        rows = (spectrum["t"] == time) & (spectrum["wavenumber"] > 0) & (spectrum["energy"] > 0)
        axis.loglog(spectrum["wavenumber"][rows], spectrum["energy"][rows], color=colour, label=time_title(time, run.si))
    # The reference slope passes through the last spectrum, a little above it, in the middle of its range.
    if rows.sum() > 4:
        k, energy = spectrum["wavenumber"][rows], spectrum["energy"][rows]
        middle = len(k) // 4
        span = k[max(1, middle // 2): max(4, int(0.6 * len(k)))]
        axis.loglog(span, 2.5 * energy[middle] * (span / k[middle]) ** (-5 / 3), "k--", label="slope -5/3")
        axis.set_ylim(max(energy.max() * 1e-8, 0.3 * energy.min()), 10 * energy.max())
    axis.set(xlabel=spectrum.label("wavenumber"), ylabel=spectrum.label("energy"))
    axis.legend(fontsize=8)
    return [finish(figure, out / "spectrum.png", title_of(run))]


def plot_gradient_pdf(run, out):
    """Probability densities of the velocity gradients at the last time, beside the normal one."""
    if not run.has("gradient_pdf.csv"):
        return []
    table = run.table("gradient_pdf")
    rows = table["t"] == table["t"].max()
    value = table["gradient"][rows]
    figure, axis = plt.subplots(figsize=(5.2, 4.2))
    for name in ("longitudinal", "transverse"):
        density = table[name][rows]
        axis.semilogy(value[density > 0], density[density > 0], label=name)
    axis.semilogy(value, np.exp(-value**2 / 2) / np.sqrt(2 * np.pi), "k--", label="normal")
    lowest = min(table[name][rows][table[name][rows] > 0].min() for name in ("longitudinal", "transverse"))
    axis.set(xlabel="velocity gradient / standard deviation", ylabel="probability density", ylim=(lowest / 2, 2),
             title=time_title(table["t"].max(), run.si))
    axis.legend(fontsize=8)
    return [finish(figure, out / "gradient_pdf.png", title_of(run))]


PICTURES = (plot_spectra, plot_gradient_pdf)
