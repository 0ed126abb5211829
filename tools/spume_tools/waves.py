# SPDX-License-Identifier: MIT
"""Waves from elevations at fixed places: harmonics, heights, and what travels to and fro; oscillations that decay."""
import numpy as np


def wavenumber(angular_frequency, depth, gravity):
    """Of linear theory, w^2 = g k tanh kh, by Newton's iteration."""
    y = angular_frequency**2 * depth / gravity
    q = y / np.sqrt(np.tanh(y))
    for _ in range(20):
        t = np.tanh(q)
        q -= (q * t - y) / (t + q * (1 - t * t))
    return q / depth


def harmonics(t, elevation, angular_frequency, count=4):
    """Complex amplitudes A_n, n = 0..count, of the sum of Re A_n exp(i n w t), by least squares."""
    orders = np.arange(1, count + 1)
    phase = angular_frequency * np.outer(t, orders)
    basis = np.column_stack([np.ones(len(t)), np.cos(phase), -np.sin(phase)])
    c = np.linalg.lstsq(basis, elevation, rcond=None)[0]
    return np.concatenate([c[:1], c[1:count + 1] + 1j * c[count + 1:]])


def mean_height(t, elevation, angular_frequency):
    """Crest to trough of the mean period, as its first four harmonics describe it."""
    amplitudes = harmonics(t, elevation, angular_frequency)
    phase = np.outer(np.linspace(0, 2 * np.pi, 721), np.arange(len(amplitudes)))
    return float(np.ptp(np.real(np.exp(1j * phase) @ amplitudes)))


def incident_and_reflected(x, amplitudes, k):
    """Complex amplitudes a and b of a exp(-ikx) + b exp(ikx) from those at three or more places, by least squares
    (Mansard and Funke 1980), and the rms of what is left over the amplitude of the incident wave. Places that are half
    a wavelength apart tell nothing apart."""
    basis = np.exp(np.outer(x, [-1j * k, 1j * k]))
    waves = np.linalg.lstsq(basis, amplitudes, rcond=None)[0]
    left = np.sqrt(np.mean(np.abs(basis @ waves - amplitudes)**2))
    return waves[0], waves[1], float(left / np.abs(waves[0]))


def damped_oscillation(t, signal, gamma, omega):
    """(C, S, gamma, omega) of exp(-gamma t)(C cos wt + S sin wt) by Gauss-Newton from the given rates."""
    def basis(gamma, omega):
        return np.exp(-gamma * t)[:, None] * np.column_stack([np.cos(omega * t), np.sin(omega * t)])

    c, s = np.linalg.lstsq(basis(gamma, omega), signal, rcond=None)[0]
    for _ in range(30):
        cosine, sine = basis(gamma, omega).T
        model = c * cosine + s * sine
        jacobian = np.column_stack([cosine, sine, -t * model, t * (s * cosine - c * sine)])
        step = np.linalg.lstsq(jacobian, signal - model, rcond=None)[0]
        c, s, gamma, omega = np.array([c, s, gamma, omega]) + step
    return c, s, gamma, omega
