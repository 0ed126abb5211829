# SPDX-License-Identifier: MIT
"""Frequency and decay of the modes of a viscous two-dimensional drop in a viscous fluid, sigma = R = 1, linear theory.

Normal modes exp(i n theta + s t) of the stream function (Miller and Scriven 1968, J. Fluid Mech. 32:417, in two dimensions):
A r^n + B I_n(r sqrt(s/nu_d)) inside, C r^-n + D K_n(r sqrt(s/nu_c)) outside. Velocity and shear stress are continuous at
r = 1, the normal stress jumps by sigma (n^2 - 1) u_r / s; s is where the determinant of these four conditions vanishes.

    /usr/bin/python3 viscous_frequencies.py     writes viscous_frequencies.csv
"""
import numpy as np
from scipy.special import ive, kve

CASES = [(1.0, 1.0, 5e-3, 5e-3), (1.0, 1.0, 1e-4, 1e-4), (1.0, 1e-3, 2e-3, 2e-2)]    # rho_d, rho_c, nu_d, nu_c


def solutions(s, n, drop, outside):
    """(f, f', f'') of the stream function at r = 1 of the four solutions; Bessel functions over their value there."""
    q, p = np.sqrt(s / drop), np.sqrt(s / outside)
    inside = q * ive(n - 1, q) / ive(n, q) - n
    beyond = -p * kve(n - 1, p) / kve(n, p) - n
    return [(1, n, n * (n - 1)), (1, inside, q * q + n * n - inside), (1, -n, n * (n + 1)), (1, beyond, p * p + n * n - beyond)]


def determinant(s, n, rho_d, rho_c, nu_d, nu_c):
    columns = []
    for k, (f, slope, bend) in enumerate(solutions(s, n, nu_d, nu_c)):
        sign, rho, mu = (1, rho_d, rho_d * nu_d) if k < 2 else (-1, rho_c, rho_c * nu_c)
        pressure = (-rho_d * s, 0, rho_c * s, 0)[k]
        normal = sign * (pressure - 2 * mu * n * (slope - f)) - (k < 2) * (n * n - 1) * n * f / s
        columns.append([sign * f, sign * slope, sign * mu * (slope - bend - n * n * f), normal])
    rows = np.array(columns).T
    return np.linalg.det(rows / np.abs(rows).max(axis=1, keepdims=True))


def rate(n, *fluids):
    """s by the secant method, from the frequency of Lamb and Rayleigh."""
    omega = np.sqrt(n * (n * n - 1) / (fluids[0] + fluids[1]))
    s, last = complex(-0.005, 0.99) * omega, complex(-0.01, 1) * omega
    value, before = determinant(s, n, *fluids), determinant(last, n, *fluids)
    while abs(s - last) > 1e-12:
        s, last, before = s - value * (s - last) / (value - before), s, value
        value = determinant(s, n, *fluids)
    return s


def main():
    with open("viscous_frequencies.csv", "w") as table:
        table.write("# Linear modes of a two-dimensional viscous drop, sigma = R = 1: viscous_frequencies.py\n")
        table.write("rho_d,rho_c,nu_d,nu_c,n,omega,decay\n")
        for fluids in CASES:
            for n in (2, 3):
                s = rate(n, *fluids)
                table.write(",".join(f"{v:g}" for v in (*fluids, n)) + f",{s.imag:.8f},{-s.real:.8f}\n")


if __name__ == "__main__":
    main()
