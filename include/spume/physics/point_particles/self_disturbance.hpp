// SPDX-License-Identifier: MIT
// The velocity that a particle sees of its own force. Drag laws are about the velocity of the fluid without the
// particle; the grid gives the velocity with it, which the force of the particle has changed by a part that grows as D
// / spacing.
//
// A force F per density at X is spread by linear weights, changes the modes of the flow and comes back through the
// splines at X. In units of the spacing, with k_i spacing_i = t_i and the fraction xi_i of the cell, an axis
// contributes
//   A_i(t, xi) = Re [((1 - xi) + xi exp(-i t)) P(t) sum_j B_j(xi) exp(i j t)],   P the prefilter of the spline,
// and the velocity that F leaves after a time tau in an unbounded fluid is F K(tau),
//   K_d(tau) = (2 pi)^-3 integral (1 - k_d^2 / k^2) A_x A_y A_z exp(-nu k^2 tau) dk     over the wavenumbers of the
//   grid
// (components off the diagonal are below 0.3 % of it). The integral runs over the modes that the flow integrates, so
// that nothing is fitted; images of a periodic box stay, as other particles do. Particles keep it as the sum of `bands`
// velocities, of nested boxes of wavenumbers that halve from one to the next: u_b' = -lambda_b u_b + w_b F, lambda_b
// such that a steady force ends with the velocity of the integral.
//
// Compared with a factor of the steady drag (Horwitz and Mani 2016; Balachandar, Liu and Lakhote 2019) this holds in
// transients, for steps longer than the time of the grid, and where the factor would have to be negative (D above two
// spacings); it is the exact disturbance of Gualtieri et al. (2015) for the smoothing that the grid makes.
//
// What drifts away from its disturbance at a speed s sees less of it: of a wavenumber k the share
//   q = 3/2 ((1 + 1/S^2) atan(S)/S - 1/S^2),   S = s / (nu k)           (Oseen, for a force along the drift)
// is left; the rate is raised by 1/q - 1 = 4/(3 pi) (sqrt(S^2 + b^2) - b), b = 1.061, within 1 % of it.
#pragma once

#include <array>
#include <cmath>

namespace spume {

struct CouplingScheme;

class SelfDisturbance {
 public:
  static constexpr int bands = 4;

  // Along each axis the spacing and the largest wavenumber kept times it, pi for all. `viscosity` above 0.
  SelfDisturbance(const std::array<double, 3>& spacing, const std::array<double, 3>& kept, double viscosity,
                  int spline_order);

  // What a step of the flow does to the velocity of a band, component by component:
  //   u <- decay u + now F + before F_before,
  // the mean over the modes of the band of the scheme that integrates them, with the force and that of the step before.
  struct Step {
    struct Band {
      std::array<double, 3> decay{}, now{}, before{};
      double rate = 0, sweeping = 0;  // lambda dt; 4/(3 pi) sqrt(lambda / nu) dt
    };
    std::array<Band, bands> band;
  };
  // previous: the length of the step before, 0 in the first.
  Step step(const CouplingScheme& scheme, double dt, double previous) const;

  // By how much drift at the square of a speed lowers what is left of a band after a step.
  static double swept(const Step::Band& band, double speed_2) {
    constexpr double steady = 1.061 * 4 / (3 * M_PI);
    return std::exp(steady * band.rate -
                    std::sqrt(band.sweeping * band.sweeping * speed_2 + steady * steady * band.rate * band.rate));
  }

  // Of a particle at the fraction xi of its cell, the velocity of band 0 over its mean over the cell.
  std::array<double, 3> place_factor(const std::array<double, 3>& xi) const;

  // Velocity of a steady force over force per density, the mean over the cell.
  std::array<double, 3> steady_mobility() const;

 private:
  static constexpr int bins = 8;  // of the rates within a band
  struct Bin {
    std::array<double, 3> weight{};  // of K_d at tau = 0
    double rate = 0;
  };
  double viscosity_;
  std::array<std::array<Bin, bins>, bands> bins_{};
  std::array<std::array<double, bands>, 3> steady_{};  // share of a band of the steady mobility
  std::array<double, bands> rate_{};
  // The factor is quadratic in eta_i = 4 xi_i (1 - xi_i) along each axis, through eta = 0, 3/4 and 1.
  std::array<std::array<double, 27>, 3> factor_{};
};

}  // namespace spume
