// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/self_disturbance.hpp"

#include <algorithm>
#include <complex>
#include <stdexcept>
#include <vector>

#include "spume/operators/b_spline.hpp"
#include "spume/operators/spline_field.hpp"
#include "spume/physics/point_particles/coupling_stability.hpp"

namespace spume {
namespace {

// Gauss and Legendre's rule of eight points on [0, 1].
struct Point {
  double place, weight;
};
constexpr int points = 8;
constexpr std::array<Point, points> legendre() {
  constexpr double x[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  constexpr double w[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
  std::array<Point, points> rule{};
  for (std::size_t i = 0; i < 4; ++i) {
    rule[3 - i] = {(1 - x[i]) / 2, w[i] / 2};
    rule[4 + i] = {(1 + x[i]) / 2, w[i] / 2};
  }
  return rule;
}
constexpr std::array<Point, points> rule = legendre();

// The places in a cell that the factor goes through, eta = 0, 3/4 and 1.
constexpr double nodes[3] = {0, 0.25, 0.5};

std::array<double, 3> lagrange(double eta) {
  return {(1 - eta) * (0.75 - eta) / 0.75, eta * (1 - eta) / (0.75 * 0.25), eta * (eta - 0.75) / 0.25};
}

// A(t, xi): spread by linear weights, seen through the splines.
template <int order>
double seen_of(double t, double xi, double prefilter) {
  double weight[order], slope[order];
  BSpline<order>::weights(xi, weight, slope);
  std::complex<double> seen = 0;
  for (int j = 0; j < order; ++j) seen += weight[j] * std::polar(1.0, (j - BSpline<order>::below) * t);
  return prefilter * (((1 - xi) + xi * std::polar(1.0, -t)) * seen).real();
}

double seen(int order, double t, double xi) {
  double value = 0;
  // The prefilter is a function of the angle alone, which a fine grid has as well.
  constexpr int fine = 1 << 20;
  const double prefilter = b_spline_prefilter(order, static_cast<int>(std::lround(t / (2 * M_PI) * fine)), fine);
  with_spline_order(order, [&](auto of) { value = seen_of<of()>(t, xi, prefilter); });
  return value;
}

struct Axis {
  double mean = 0;
  std::array<double, 3> at{};  // the nodes
};

Axis axis_of(int order, double t) {
  Axis axis;
  for (const Point& p : rule) axis.mean += p.weight * seen(order, t, p.place / 2);  // even about the middle of the cell
  for (std::size_t n = 0; n < 3; ++n) axis.at[n] = seen(order, t, nodes[n]);
  return axis;
}

}  // namespace

SelfDisturbance::SelfDisturbance(const std::array<double, 3>& spacing, const std::array<double, 3>& kept,
                                 double viscosity, int spline_order)
    : viscosity_(viscosity) {
  if (!(viscosity > 0)) throw std::invalid_argument("the disturbance of a force needs a viscosity above 0");
  std::array<double, 3> largest;
  for (std::size_t i = 0; i < 3; ++i) largest[i] = kept[i] / spacing[i];
  // Of each node of the integral over an octant, which is cut into pyramids with their top at k = 0, where 1/k^2 is
  // integrable: k_i = s q_i largest_i on the face q_f = 1, dk = largest_x largest_y largest_z s^2 ds dq dq.
  const double scale = 8 / std::pow(2 * M_PI, 3) * largest[0] * largest[1] * largest[2];
  std::array<std::array<double, 27>, 3> at_nodes{};
  for (int b = 0; b < bands; ++b) {
    const double upper = std::pow(0.5, b), lower = b + 1 < bands ? upper / 2 : 0;
    const double k_most = upper * std::hypot(largest[0], largest[1], largest[2]);
    const double k_least = std::max(lower, upper / 16) * *std::min_element(largest.begin(), largest.end());
    std::array<std::array<double, 3>, bins> steady{};
    for (const Point& s : rule) {
      const double share = lower + s.place * (upper - lower);
      for (std::size_t face = 0; face < 3; ++face)
        for (const Point& p : rule)
          for (const Point& q : rule) {
            std::array<double, 3> k{};
            k[face] = share * largest[face];
            k[(face + 1) % 3] = share * p.place * largest[(face + 1) % 3];
            k[(face + 2) % 3] = share * q.place * largest[(face + 2) % 3];
            const double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
            const double weight = scale * share * share * s.weight * (upper - lower) * p.weight * q.weight;
            std::array<Axis, 3> axis;
            for (std::size_t i = 0; i < 3; ++i) axis[i] = axis_of(spline_order, k[i] * spacing[i]);
            const double place = std::log(std::sqrt(k2) / k_least) / std::log(k_most / k_least) * bins;
            const auto bin = static_cast<std::size_t>(std::clamp(place, 0.0, bins - 1.0));
            for (std::size_t d = 0; d < 3; ++d) {
              const double solenoidal = weight * (1 - k[d] * k[d] / k2);
              const double mean = solenoidal * axis[0].mean * axis[1].mean * axis[2].mean;
              bins_[static_cast<std::size_t>(b)][bin].weight[d] += mean;
              steady[bin][d] += mean / (viscosity * k2);
              steady_[d][static_cast<std::size_t>(b)] += mean / (viscosity * k2);
              for (std::size_t n = 0; n < 27; ++n)
                at_nodes[d][n] +=
                    solenoidal * axis[0].at[n / 9] * axis[1].at[n / 3 % 3] * axis[2].at[n % 3] / (viscosity * k2);
            }
          }
    }
    double weight = 0, sum = 0;
    for (std::size_t n = 0; n < bins; ++n) {
      Bin& bin = bins_[static_cast<std::size_t>(b)][n];
      const double total = bin.weight[0] + bin.weight[1] + bin.weight[2];
      const double slow = steady[n][0] + steady[n][1] + steady[n][2];
      bin.rate = slow > 0 ? total / slow : 0;
      weight += total;
      sum += slow;
    }
    rate_[static_cast<std::size_t>(b)] = weight / sum;
  }
  for (std::size_t d = 0; d < 3; ++d) {
    double rest = 0;
    for (std::size_t b = 1; b < bands; ++b) rest += steady_[d][b];
    for (std::size_t n = 0; n < 27; ++n) factor_[d][n] = (at_nodes[d][n] - rest) / steady_[d][0];
  }
}

SelfDisturbance::Step SelfDisturbance::step(const CouplingScheme& scheme, double dt, double previous) const {
  Step out;
  const double ratio = scheme.memory > 0 && previous > 0 ? dt / previous : 0;
  for (std::size_t b = 0; b < bands; ++b) {
    Step::Band& band = out.band[b];
    std::array<double, 3> steady{};
    for (const Bin& bin : bins_[b]) {
      if (!(bin.rate > 0)) continue;
      const double decay = std::exp(-bin.rate * dt), lost = -std::expm1(-bin.rate * dt);
      // Multistep schemes and the midpoint rule of their first step multiply the force by the viscous decay after it.
      const double now = scheme.memory == 0 ? lost / bin.rate
                         : previous > 0     ? dt * (1 + scheme.memory * ratio) * decay
                                            : dt * std::exp(-bin.rate * dt / 2);
      const double before = -dt * scheme.memory * ratio * decay * std::exp(-bin.rate * previous);
      for (std::size_t d = 0; d < 3; ++d) {
        band.now[d] += bin.weight[d] * now;
        band.before[d] += bin.weight[d] * before;
        steady[d] += bin.weight[d] * (now + before) / lost;
      }
    }
    // Such that a steady force has what it has in the sum of the modes.
    for (std::size_t d = 0; d < 3; ++d)
      band.decay[d] = steady[d] > 0 ? std::max(0.0, 1 - (band.now[d] + band.before[d]) / steady[d]) : 0;
    band.rate = rate_[b] * dt;
    band.sweeping = 4 / (3 * M_PI) * std::sqrt(rate_[b] / viscosity_) * dt;
  }
  return out;
}

std::array<double, 3> SelfDisturbance::place_factor(const std::array<double, 3>& xi) const {
  std::array<std::array<double, 3>, 3> basis;
  for (std::size_t i = 0; i < 3; ++i) basis[i] = lagrange(4 * xi[i] * (1 - xi[i]));
  std::array<double, 3> out{};
  for (std::size_t n = 0; n < 9; ++n) {
    const double across = basis[0][n / 3] * basis[1][n % 3];
    for (std::size_t d = 0; d < 3; ++d)
      out[d] += across * (basis[2][0] * factor_[d][3 * n] + basis[2][1] * factor_[d][3 * n + 1] +
                          basis[2][2] * factor_[d][3 * n + 2]);
  }
  return out;
}

std::array<double, 3> SelfDisturbance::steady_mobility() const {
  std::array<double, 3> out{};
  for (std::size_t d = 0; d < 3; ++d)
    for (const double share : steady_[d]) out[d] += share;
  return out;
}

}  // namespace spume
