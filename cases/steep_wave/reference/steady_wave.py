#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Steady periodic wave of finite height by the stream function (Rienecker and Fenton 1981); prints steady_wave.csv.

In the frame of the wave, with the bed at y = 0, wavenumber k and mean depth d,

    psi = -c y + sum_j B_j sinh(j k y) / cosh(j k d) cos(j k x)

holds Laplace's equation and the bed. At the N + 1 points between crest and trough psi and the Bernoulli sum are uniform;
the mean depth and the height close the system, solved by least squares from the linear wave in nine steps of the height.
c is the speed where the mean velocity below the troughs vanishes. Needs python3-scipy; takes a second.
"""
import numpy as np
from scipy.optimize import least_squares

WAVENUMBER, DEPTH, STEEPNESS = 2 * np.pi, 0.5, 0.35  # k, d, k H / 2; gravity 1
HARMONICS = 10


def steady_wave(harmonics=HARMONICS):
    """Mean depth and harmonics of the elevation, speed of the wave and harmonics of u over cosh(j k y)."""
    k, d, n = WAVENUMBER, DEPTH, harmonics
    j, x = np.arange(1, n + 1), np.pi * np.arange(n + 1) / n
    cosine, sine = np.cos(np.outer(x, j)), np.sin(np.outer(x, j))

    def residual(unknown, height):
        eta, b, (c, flux, head) = unknown[:n + 1], unknown[n + 1:2 * n + 1], unknown[2 * n + 1:]
        up, across = np.cosh(np.outer(k * eta, j)) / np.cosh(j * k * d), np.sinh(np.outer(k * eta, j)) / np.cosh(j * k * d)
        u, v = -c + k * (up * cosine) @ (j * b), k * (across * sine) @ (j * b)
        mean = (eta[0] / 2 + eta[1:-1].sum() + eta[-1] / 2) / n
        return np.concatenate([-c * eta + (across * cosine) @ b + flux, (u**2 + v**2) / 2 + eta - head,
                               [mean - d, eta[0] - eta[-1] - height]])

    height, speed = 2 * STEEPNESS / k, np.sqrt(np.tanh(k * d) / k)
    unknown = np.concatenate([d + 0.1 * height * np.cos(x), [0.1 * height / (k * speed)], np.zeros(n - 1),
                              [speed, speed * d, d + speed**2 / 2]])
    for part in np.linspace(0.2, 1, 9):
        unknown = least_squares(residual, unknown, args=(part * height,), xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    eta, b = unknown[:n + 1], unknown[n + 1:2 * n + 1]
    # Cosine series through the points: the first and the last harmonic count half.
    weight = np.where((np.arange(n + 1) == 0) | (np.arange(n + 1) == n), 0.5, 1.0)
    elevation = 2 / n * weight * (np.cos(np.outer(np.arange(n + 1), x)) @ (weight * eta))
    return elevation, np.concatenate([[unknown[2 * n + 1]], b * j * k / np.cosh(j * k * d)])


def main():
    for harmonic, values in enumerate(zip(*steady_wave())):
        print(f"{harmonic}," + ",".join(f"{value:.10g}" for value in values))


if __name__ == "__main__":
    main()
