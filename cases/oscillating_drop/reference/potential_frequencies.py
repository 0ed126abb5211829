# SPDX-License-Identifier: MIT
"""Frequency of a two-dimensional drop of finite amplitude without viscosity, sigma = R = 1, in a box or without bounds.

The interface is r(theta, t), symmetric about the x axis. Potentials are sums of r^m cos(m theta) inside, of r^-m cos(m
theta) outside, and of r^m cos(m theta) there too where walls bound it. With psi = rho_d phi_d - rho_c phi_c on the
interface, each of the four stages of a Runge-Kutta step solves for their coefficients, by least squares: equal normal
velocities, psi, and no flow through the walls; then

    r_t = u_r - r_theta u_theta / r
    psi_t = rho_d (r_t u_r - |u|^2 / 2)_d - rho_c (r_t u_r - |u|^2 / 2)_c - sigma curvature

(Bernoulli on both sides, at constant theta). It starts at rest as the case does, from r = 1 + a cos(n theta) - a^2 / 4.

    /usr/bin/python3 potential_frequencies.py     writes potential_frequencies.csv, in minutes
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "tools"))
from spume_tools.waves import damped_oscillation  # noqa: E402

MODES = 18
BOXES = {2: (4.0, 4.0), 3: (3.0, 3.0)}    # half width and height of the case's domain with its mirror images


class Potentials:
    """Coefficients of the potentials for an interface and its psi."""

    def __init__(self, rho_d, rho_c, box):
        self.densities = rho_d, rho_c
        self.theta = (np.arange(4 * MODES) + 0.5) * np.pi / (4 * MODES)
        self.m = np.arange(1, MODES + 1)
        self.cosine = np.cos(np.outer(self.theta, self.m))
        self.sine = np.sin(np.outer(self.theta, self.m))
        self.walls = None
        if box is not None:
            half_width, height = box
            self.length = max(box)
            s = (np.arange(3 * MODES) + 0.5) / (3 * MODES)
            places = np.concatenate([half_width + 1j * height * s, -half_width + 1j * height * s,
                                     half_width * (2 * s - 1) + 1j * height])[:, None]
            normals = np.repeat([1, -1, 1j], len(s))[:, None]
            self.walls = np.hstack([(-self.m * places**(-self.m - 1.0) * normals).real,
                                    (self.m * places**(self.m - 1.0) * normals).real / self.length**self.m])

    def terms(self, r, scale, sign):
        """Values and both components of the gradients of (r / scale)^(sign m) cos(m theta)."""
        powers = (r[:, None] / scale)**(sign * self.m)
        return (powers * self.cosine, sign * self.m * powers * self.cosine / r[:, None],
                -self.m * powers * self.sine / r[:, None])

    def velocities(self, r, slope, psi):
        """(u_r, u_theta) on the interface, inside and outside."""
        rho_d, rho_c = self.densities
        inside = self.terms(r, 1, 1)
        outside = self.terms(r, 1, -1)
        if self.walls is not None:
            outside = tuple(map(np.hstack, zip(outside, self.terms(r, self.length, 1))))

        def normal(terms):
            return terms[1] - terms[2] * (slope / r)[:, None]
        constant = np.ones((len(r), 1))
        rows = [np.hstack([normal(inside), -normal(outside), 0 * constant]),
                np.hstack([rho_d * inside[0], -rho_c * outside[0], constant])]
        right = [0 * psi, psi]
        if self.walls is not None:
            count = len(self.walls)
            rows.append(np.hstack([np.zeros((count, MODES)), self.walls, np.zeros((count, 1))]))
            right.append(np.zeros(count))
        c = np.linalg.lstsq(np.vstack(rows), np.concatenate(right), rcond=1e-13)[0]
        d, o = c[:MODES], c[MODES:-1]
        return (inside[1] @ d, inside[2] @ d), (outside[1] @ o, outside[2] @ o)


def oscillation(n, amplitude, rho_d, rho_c, box, end, dt=0.0025, every=40):
    """t and the mean of r^n cos(n theta) over the drop."""
    potentials = Potentials(rho_d, rho_c, box)
    m = np.arange(MODES + 1)
    cosine, sine = np.cos(np.outer(potentials.theta, m)), np.sin(np.outer(potentials.theta, m))
    to_modes = np.linalg.pinv(cosine)
    fine = np.linspace(0, np.pi, 801)
    fine_cosine, weights = np.cos(np.outer(fine, m)), np.cos(n * fine)

    def rates(r, psi):
        c = to_modes @ r
        r, slope, bend = cosine @ c, -sine @ (m * c), -cosine @ (m**2 * c)
        drop, outside = potentials.velocities(r, slope, psi)
        r_t = drop[0] - slope / r * drop[1]
        curvature = (r * r + 2 * slope**2 - r * bend) / (r * r + slope**2)**1.5
        gains = [rho * (r_t * u[0] - (u[0]**2 + u[1]**2) / 2) for rho, u in ((rho_d, drop), (rho_c, outside))]
        return r_t, cosine @ (to_modes @ (gains[0] - gains[1] - curvature))

    def moment(r):
        at = fine_cosine @ (to_modes @ r)
        return np.trapz(at**(n + 2) * weights, fine) / (n + 2) / (np.trapz(at**2, fine) / 2)

    r, psi = 1 + amplitude * np.cos(n * potentials.theta) - amplitude**2 / 4, np.zeros(4 * MODES)
    times, moments = [0.0], [moment(r)]
    for step in range(1, round(end / dt) + 1):
        k1 = rates(r, psi)
        k2 = rates(r + dt / 2 * k1[0], psi + dt / 2 * k1[1])
        k3 = rates(r + dt / 2 * k2[0], psi + dt / 2 * k2[1])
        k4 = rates(r + dt * k3[0], psi + dt * k3[1])
        r, psi = (y + dt / 6 * (a + 2 * b + 2 * c + d) for y, a, b, c, d in zip((r, psi), k1, k2, k3, k4))
        if step % every == 0:
            times.append(step * dt)
            moments.append(moment(r))
    return np.array(times), np.array(moments)


def frequency(n, amplitude, rho_d, rho_c, box):
    """That of the cosine that fits three periods."""
    omega = np.sqrt(n * (n * n - 1) / (rho_d + rho_c))
    t, a = oscillation(n, amplitude, rho_d, rho_c, box, 3 * 2 * np.pi / omega)
    return damped_oscillation(t, a, 1e-3 * omega, omega)[3]


def main():
    with open("potential_frequencies.csv", "w") as table:
        table.write("# Two-dimensional drop without viscosity, of finite amplitude, sigma = R = 1, domain 0 where it has no "
                    "bounds: potential_frequencies.py\n")
        table.write("rho_d,rho_c,n,amplitude,half_width,height,omega\n")
        for rho_c in (1.0, 1e-3):
            for n, box in BOXES.items():
                for amplitude, bounds in ((0.05, None), (0.1, None), (0.1, box)):
                    omega = frequency(n, amplitude, 1.0, rho_c, bounds)
                    width, height = bounds or (0, 0)
                    table.write(f"1,{rho_c:g},{n},{amplitude:g},{width:g},{height:g},{omega:.6f}\n")


if __name__ == "__main__":
    main()
