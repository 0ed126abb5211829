// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/coupling_stability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace spume {
namespace {

// Velocity of fluid and particles, force at the present time, force of the last step, force used in the last step.
using State = Eigen::Matrix<double, 5, 1>;

// One step of length 1.
State stepped(const MotionModel& model, const CouplingScheme& scheme, double alpha, double h, const State& s) {
  const double u = s[0], v = s[1], present = s[2], last = s[3], used = s[4];
  const double change = alpha * ((1 + scheme.memory) * present - scheme.memory * used);
  const double next_u = u + change;
  const RelaxationCoefficients c = relaxation_coefficients(h);
  const double next_v = model.frozen ? 0
                                     : c.decay * v + h * c.phi1 * (u + next_u) / 2 + c.phi1 * model.beta * change +
                                           h * (c.phi2 - c.phi1 / 2) * change;
  const double force = change - (model.frozen ? 0 : model.density_ratio() * (next_v - v));
  return {next_u, next_v, force + scheme.lead * (force - last), force, present};
}

bool stable(const MotionModel& model, const CouplingScheme& scheme, double alpha, double h) {
  // Rounding splits eigenvalues that coincide at 1 by its root.
  return coupling_growth(model, scheme, alpha, h) < 1 + 1e-6;
}

// Steps looked at, in response times, and the ratio of one to the next: an interval of instability is wider than that.
constexpr double shortest = 1e-4, longest = 1e4, next_step = 1.25;
// Of the limits that are returned: far below the margin that a limit of a model needs.
constexpr double accuracy = 1e-3;

}  // namespace

double coupling_growth(const MotionModel& model, const CouplingScheme& scheme, double alpha, double h) {
  Eigen::Matrix<double, 5, 5> step;
  for (int column = 0; column < 5; ++column) step.col(column) = stepped(model, scheme, alpha, h, State::Unit(column));
  return Eigen::EigenSolver<Eigen::Matrix<double, 5, 5>>(step, false).eigenvalues().cwiseAbs().maxCoeff();
}

double stable_coupling_step(const MotionModel& model, const CouplingScheme& scheme, double alpha) {
  double below = 0;
  for (double h = shortest; h <= longest; h *= next_step) {
    if (stable(model, scheme, alpha, h)) {
      below = h;
      continue;
    }
    if (below == 0) return 0;
    double above = h;
    while (above > (1 + accuracy) * below) {
      const double middle = std::sqrt(above * below);
      (stable(model, scheme, alpha, middle) ? below : above) = middle;
    }
    return below;
  }
  return std::numeric_limits<double>::infinity();
}

double stable_volume_fraction(const MotionModel& model, const CouplingScheme& scheme, double most) {
  if (stable(model, scheme, most, shortest)) return most;
  double below = 0, above = most;
  while (above - below > accuracy * most) {
    const double middle = (above + below) / 2;
    (stable(model, scheme, middle, shortest) ? below : above) = middle;
  }
  return below;
}

}  // namespace spume
