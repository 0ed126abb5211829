# SPDX-License-Identifier: MIT
"""Errors and orders of convergence, as the measures of the cases use them."""
import numpy as np


def standard(runs):
    """The run named "standard"; where there is none, the first."""
    return runs.get("standard") or next(iter(runs.values()))


def relative_rms(measured, exact, scale):
    """Root mean square of the difference (over all components), divided by the scale."""
    difference = np.asarray(measured, float) - np.asarray(exact, float)
    return float(np.sqrt(np.mean(np.sum(difference.reshape(len(difference), -1) ** 2, axis=1))) / scale)


def observed_order(spacings, errors):
    """Slope of log error against log spacing by least squares."""
    return float(np.polyfit(np.log(spacings), np.log(errors), 1)[0])
