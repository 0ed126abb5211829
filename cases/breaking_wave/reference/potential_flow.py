#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Potential flow of the case's wave, to spectral accuracy: writes potential_flow.csv beside it.

Deep water without viscosity from the initial surface and velocity of case.toml. The liquid is the image of the lower
half-plane u + iv under z(u, t); with w = phi + i theta the complex potential on v = 0 and J = |z_u|^2,

    z_t = z_u (C[g] + i g),  g = -theta_u / J,   phi_t = (theta_u^2 - phi_u^2) / (2 J) - gravity y + phi_u C[g],

where C[f] is the real part of the function analytic below whose imaginary part is f (Dyachenko, Kuznetsov, Spector &
Zakharov 1996, Phys. Lett. A 221:73). Derivatives by FFT, steps by Runge-Kutta of order 4. A run ends where the surface
becomes vertical, where the highest modes are no longer small, or at the end time. Lengths in wavelengths and times in
sqrt(wavelength / gravity) in the file, 2 pi times the lengths in here.
"""
import sys
from pathlib import Path

import numpy as np

GRAVITY = 2 * np.pi
LARGEST_TAIL = 1e-5     # amplitude of the modes from a third of the largest on
LARGEST_ENERGY_ERROR = 1e-4


def conjugate(f):
    modes = np.fft.fft(f)
    return np.fft.ifft(-1j * np.sign(np.fft.fftfreq(len(f))) * modes).real


def derivative(f):
    k = np.fft.fftfreq(len(f), 1 / len(f))
    k[len(f) // 2] = 0
    return np.fft.ifft(1j * k * np.fft.fft(f)).real


def filtered(f):
    k = np.abs(np.fft.fftfreq(len(f)))
    return np.fft.ifft(np.fft.fft(f) * np.exp(-36 * (k / 0.475) ** 24)).real


def initial(chi, n):
    u = 2 * np.pi * np.arange(n) / n

    def eta(x):
        return chi * np.cos(x) + chi**2 / 2 * np.cos(2 * x) + 3 / 8 * chi**3 * np.cos(3 * x)

    y = eta(u)
    for _ in range(2000):
        new = eta(u + conjugate(y))
        change = np.max(np.abs(new - y))
        y = 0.5 * (y + filtered(new))
        if change < 1e-13:
            break
    amplitude = 2 * np.pi * chi * np.sqrt(1 + chi**2) / np.sqrt(2 * np.pi)
    return np.array([y, amplitude * np.sin(u + conjugate(y)) * np.exp(y)])


def parts(state):
    y, phi = state
    x_u, y_u = 1 + derivative(conjugate(y)), derivative(y)
    return x_u, y_u, derivative(phi), -derivative(conjugate(phi))


def rates(state):
    x_u, y_u, phi_u, theta_u = parts(state)
    jacobian = x_u**2 + y_u**2
    g = -theta_u / jacobian
    a = conjugate(g)
    return np.array([y_u * a + x_u * g,
                     (theta_u**2 - phi_u**2) / (2 * jacobian) - GRAVITY * state[0] + phi_u * a])


def energy(state):
    x_u, _, _, theta_u = parts(state)
    level = np.mean(state[0] * x_u)
    return -np.mean(state[1] * theta_u) / 2 + GRAVITY / 2 * (np.mean(state[0] ** 2 * x_u) - level**2)


def run(chi, n, dt, end, every):
    """Rows (chi, t, largest horizontal velocity / c, relative change of the energy, 1 if the surface is vertical)."""
    state, rows, t = initial(chi, n), [], 0.0
    first = energy(state)
    while True:
        x_u, y_u, phi_u, theta_u = parts(state)
        velocity = ((phi_u + 1j * theta_u) / (x_u + 1j * y_u)).real.max() / np.sqrt(GRAVITY)
        change = energy(state) / first - 1
        vertical = x_u.min() <= 0
        over = np.abs(np.fft.fft(state[0]))[n // 3] / n > LARGEST_TAIL or abs(change) > LARGEST_ENERGY_ERROR
        if over and not vertical:
            return rows
        step = round(t / dt)
        if vertical or step % round(every / dt) == 0:
            rows.append((chi, t, velocity, change, int(vertical)))
        if vertical or t > end - dt / 2:
            return rows
        k1 = rates(state)
        k2 = rates(state + dt / 2 * k1)
        k3 = rates(state + dt / 2 * k2)
        k4 = rates(state + dt * k3)
        state = np.array([filtered(f) for f in state + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
        t = (step + 1) * dt


def main():
    table = []
    for chi, n, dt, end in ((0.30, 512, 5e-4, 5), (0.33, 1024, 5e-4, 5), (0.35, 4096, 2e-4, 4), (0.55, 8192, 1e-4, 1)):
        rows = run(chi, n, dt, end, 0.1)
        print(f"chi = {chi}: to t = {rows[-1][1]:.4f}, u/c at most {max(r[2] for r in rows):.4f}, "
              f"{'vertical' if rows[-1][4] else 'not vertical'}, energy within {max(abs(r[3]) for r in rows):.1e}")
        table += rows
    path = Path(__file__).with_suffix(".csv") if len(sys.argv) < 2 else Path(sys.argv[1])
    with open(path, "w", encoding="utf-8") as out:
        out.write("# Potential flow of the wave of ../case.toml in deep water; made by potential_flow.py, which says how.\n"
                  "# t in sqrt(wavelength / gravity); crest_speed: largest horizontal velocity over sqrt(gravity wavelength"
                  " / 2 pi);\n# vertical: 1 at the time at which the front first becomes vertical. A crest beyond 0.85"
                  " goes on to break.\nchi,t,crest_speed,energy_change,vertical\n")
        for row in table:
            out.write("{:g},{:.4f},{:.5f},{:.1e},{}\n".format(*row))


if __name__ == "__main__":
    main()
