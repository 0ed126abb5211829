// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/coupling_stability.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace spume {
namespace {

// Velocity of fluid and particles, force at the present time, force of the last step, force used in the last step.
using State = std::array<double, 5>;
using Step = std::array<State, 5>;  // row by row

// One step of length 1.
State stepped(const MotionModel& model, const CouplingScheme& scheme, double alpha, double h, const State& s) {
  const auto& [u, v, present, last, used] = s;
  const double change = alpha * ((1 + scheme.memory) * present - scheme.memory * used);
  const double next_u = u + change;
  const RelaxationCoefficients c = relaxation_coefficients(h);
  const double next_v = model.frozen ? 0
                                     : c.decay * v + h * c.phi1 * (u + next_u) / 2 + c.phi1 * model.beta * change +
                                           h * (c.phi2 - c.phi1 / 2) * change;
  const double force = change - (model.frozen ? 0 : model.density_ratio() * (next_v - v));
  return {next_u, next_v, force + scheme.lead * (force - last), force, present};
}

// Squarings of a step: its 2^32-th power.
constexpr int squarings = 32;

// The largest magnitude of the eigenvalues is the limit of |A^n|^(1/n) (Gelfand). Where |A^n| <= c n^4 rho^n, as of
// five coinciding eigenvalues, the logarithm is off by log(c n^4) / n: 2e-8 for n = 2^32 and c up to e^10.
double spectral_radius(Step power) {
  double logarithm = 0, exponent = 1;
  for (int squaring = 0; squaring <= squarings; ++squaring) {
    double sum = 0;
    for (const State& row : power)
      for (const double entry : row) sum += entry * entry;
    const double norm = std::sqrt(sum);
    if (!(norm > 0)) return norm;  // nothing, or not a number
    logarithm += exponent * std::log(norm);
    exponent /= 2;
    Step square{};
    for (std::size_t i = 0; i < 5; ++i)
      for (std::size_t k = 0; k < 5; ++k)
        for (std::size_t j = 0; j < 5; ++j) square[i][j] += (power[i][k] / norm) * (power[k][j] / norm);
    power = square;
  }
  return std::exp(logarithm);
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
  Step step;
  for (std::size_t column = 0; column < 5; ++column) {
    State unit{};
    unit[column] = 1;
    const State image = stepped(model, scheme, alpha, h, unit);
    for (std::size_t row = 0; row < 5; ++row) step[row][column] = image[row];
  }
  return spectral_radius(step);
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
