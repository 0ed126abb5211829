// SPDX-License-Identifier: MIT
#include "spume/particles/force_potential.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "spume/core/random.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

constexpr double tolerance = 1e-6;
// Evaluations per particle and step; sixteen follow two waves of the force between the centre and a side.
constexpr std::array point_counts = {1, 2, 4, 8, 16};
constexpr int places = 64;
constexpr std::array times = {0.0, 0.37, 0.71, 1.0};  // of the run

struct Quadrature {
  std::vector<double> node, weight;
};

// Gauss-Legendre over [0, 1]: roots of P_n by Newton's method from Tricomi's estimate, which converges for all n used.
Quadrature gauss_legendre(int n) {
  Quadrature rule;
  for (int k = 1; k <= n; ++k) {
    double x = std::cos(std::numbers::pi * (k - 0.25) / (n + 0.5)), slope = 1;
    for (int iteration = 0; iteration < 20; ++iteration) {
      double before = 1, value = x;
      for (int m = 2; m <= n; ++m) {
        const double next = ((2 * m - 1) * x * value - (m - 1) * before) / m;
        before = value, value = next;
      }
      slope = n * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    rule.node.push_back((1 + x) / 2);
    rule.weight.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

// -int f . dl along the straight line from a to b.
double line_integral(const Quadrature& rule, const VectorExpression& force, const Vec3& a, const Vec3& b, double t) {
  double sum = 0;
  for (std::size_t k = 0; k < rule.node.size(); ++k) {
    Vec3 at{};
    for (std::size_t axis = 0; axis < 3; ++axis) at[axis] = a[axis] + rule.node[k] * (b[axis] - a[axis]);
    const Vec3 f = force(at, t);
    for (std::size_t axis = 0; axis < 3; ++axis) sum -= rule.weight[k] * f[axis] * (b[axis] - a[axis]);
  }
  return sum;
}

Vec3 place(const Domain& domain, int k) {
  const auto fraction = random_uniform(1, RandomPurpose::force_sample, static_cast<std::uint64_t>(k), 0, 0);
  Vec3 r{};
  for (int axis = 0; axis < domain.dimensions; ++axis)
    r[axis] = domain.lower[axis] + fraction[axis] * (domain.upper[axis] - domain.lower[axis]);
  return r;
}

}  // namespace

ForcePotential::ForcePotential(const Domain& domain, int points) {
  for (int axis = 0; axis < domain.dimensions; ++axis) centre_[axis] = (domain.lower[axis] + domain.upper[axis]) / 2;
  Quadrature rule = gauss_legendre(points);
  node_ = std::move(rule.node);
  weight_ = std::move(rule.weight);
}

double ForcePotential::operator()(const VectorExpression& force, const Vec3& r, double t) const {
  Vec3 arm;
  for (std::size_t axis = 0; axis < 3; ++axis) arm[axis] = r[axis] - centre_[axis];
  double sum = 0;
  for (std::size_t k = 0; k < node_.size(); ++k) {
    Vec3 at;
    for (std::size_t axis = 0; axis < 3; ++axis) at[axis] = centre_[axis] + node_[k] * arm[axis];
    const Vec3 f = force(at, t);
    sum -= weight_[k] * (f[0] * arm[0] + f[1] * arm[1] + f[2] * arm[2]);
  }
  return sum;
}

bool ForcePotential::follows(const VectorExpression& force, const Domain& domain, double spacing, double end) const {
  const Quadrature exact = gauss_legendre(8);  // over a spacing
  double largest = 0, error = 0;
  for (const double fraction : times)
    for (int k = 0; k < places; ++k) {
      const double t = fraction * end;
      const Vec3 r = place(domain, k);
      largest = std::max(largest, length(force(r, t)));
      const double here = (*this)(force, r, t);
      for (int axis = 0; axis < domain.dimensions; ++axis) {
        Vec3 beside = r;
        beside[axis] += spacing;
        const double difference = (*this)(force, beside, t) - here;
        error = std::max(error, std::abs(difference - line_integral(exact, force, r, beside, t)) / spacing);
        if (!std::isfinite(difference)) return false;
        if (!domain.periodic(axis)) continue;
        Vec3 low = r, high = r;
        low[axis] = domain.lower[axis], high[axis] = domain.upper[axis];
        error = std::max(error, std::abs((*this)(force, high, t) - (*this)(force, low, t)) / spacing);
      }
    }
  return error <= tolerance * largest;
}

std::optional<ForcePotential> ForcePotential::find(const VectorExpression& force, const Domain& domain, double spacing,
                                                   double end) {
  const VectorExpression own = force.clone();
  for (const int points : point_counts) {
    ForcePotential potential(domain, points);
    if (potential.follows(own, domain, spacing, end)) return potential;
  }
  return std::nullopt;
}

}  // namespace spume
