// SPDX-License-Identifier: MIT
// Slow twins of surface_layers.hpp, in double, from the definitions there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "reference/sph_sums.hpp"

namespace spume::reference {

// What a point counts in the column that measures the depth: `across` from the normal and `down` it, in spacings.
inline double column_weight(int dimensions, double across, double down) {
  const double x = across, z = down;
  double spline = x >= 2 ? 0 : x >= 1 ? std::pow(2 - x, 3) / 6 : 2.0 / 3 - x * x + x * x * x / 2;
  if (dimensions == 3) spline *= 15 / (7 * std::numbers::pi);
  const double ramp = z <= 0.2 ? 1 : z >= 2.2 ? 0 : z < 1.2 ? 1 - std::pow(z - 0.2, 2) / 2 : std::pow(2.2 - z, 2) / 2;
  return spline * ramp;
}

// Depth in spacings of what holds so much in its column.
inline double depth_of_column(int dimensions, double content) {
  double lattice = 0;
  for (int row = 0; row < 3; ++row)
    for (int k = -2; k <= 2; ++k)
      for (int l = dimensions == 3 ? -2 : 0; l <= (dimensions == 3 ? 2 : 0); ++l)
        lattice += column_weight(dimensions, std::hypot(k, l), row);
  return std::clamp(0.5 + content - lattice, 0.25, 2.0);
}

// Sums over all particles and images. normals: of near-surface particles, of length 1; 0 at all others.
class SurfaceLayers {
 public:
  SurfaceLayers(const SphSums& sums, const PlainKernel& kernel, double spacing, std::vector<Vector> normals)
      : sums_(sums), kernel_(kernel), spacing_(spacing), normals_(std::move(normals)) {
    own_depth_.resize(normals_.size());
    for (std::size_t i = 0; i < normals_.size(); ++i)
      if (near_surface(i)) own_depth_[i] = own_depth(i);
  }

  bool near_surface(std::size_t i) const { return dot(normals_[i], normals_[i]) > 0; }

  double depth(std::size_t i) const {
    if (!near_surface(i)) return spacing_;  // of a near-surface particle without a normal
    double weights = 0, sum = 0;
    each(i, [&](std::size_t j, const Vector& d, const Vector&) {
      if (!near_surface(j)) return;
      const double out = std::abs(dot(d, normals_[i])) / spacing_;
      const double weight = kernel_.w(length(d) / sums_.width(i)) * std::max(0.0, 1 - 2 * out);
      weights += weight;
      sum += weight * own_depth_[j];
    });
    return sum / weights;
  }

  // Particle by particle: whether it or an image of it is within reach of a near-surface particle.
  std::vector<bool> upper() const {
    std::vector<bool> near(normals_.size());
    for (std::size_t i = 0; i < near.size(); ++i)
      if (near_surface(i))
        each(i,
             [&](std::size_t j, const Vector& d, const Vector&) { near[j] = near[j] || length(d) < 1.8 * spacing_; });
    return near;
  }

  struct Shared {
    Vector value{};
    double of_normals = 0;  // length of the sum of the normals: they may cancel
    double c = 0;
  };
  Shared shared(std::size_t i, const std::vector<Vector>& vectors) const {
    Vector n{};
    double of_near = 0, weights = 0, sum = 0;
    each(i, [&](std::size_t j, const Vector& d, const Vector& reflection) {
      if (!near_surface(j)) return;
      const double x = std::max(0.0, 1 - dot(d, d) / std::pow(1.8 * spacing_, 2));
      for (int a = 0; a < 3; ++a) n[a] += x * x * reflection[a] * normals_[j][a];
      of_near += x * x;
    });
    const double size = length(n);
    for (double& component : n) component /= size;
    const double c = near_surface(i) ? 1 : std::min(1.0, of_near / 0.4);
    each(i, [&](std::size_t j, const Vector& d, const Vector& reflection) {
      const double weight = kernel_.w(length(d) / sums_.width(i)) * std::max(0.0, 1 - std::abs(dot(d, n)) / spacing_);
      weights += weight;
      for (int a = 0; a < 3; ++a) sum += weight * reflection[a] * vectors[j][a] * n[a];
    });
    for (double& component : n) component *= c * sum / weights;
    return {n, size, c};
  }

 private:
  static double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  static double length(const Vector& v) { return std::sqrt(dot(v, v)); }

  // Of particle i by itself.
  double own_depth(std::size_t i) const {
    double content = 0;
    each(i, [&](std::size_t j, const Vector& d, const Vector&) {
      const double z = -dot(d, normals_[i]);
      content +=
          sums_.volume_ratio(j) *
          column_weight(kernel_.dimensions, std::sqrt(std::max(0.0, dot(d, d) - z * z)) / spacing_, z / spacing_);
    });
    return spacing_ * depth_of_column(kernel_.dimensions, content);
  }

  // visit(source, r_j - r_i, reflection) for every point in the support around a particle, which is one of them.
  template <class Visit>
  void each(std::size_t i, Visit&& visit) const {
    const auto& points = sums_.points();
    for (std::size_t j = 0; j < points.size(); ++j) {
      Vector d{};
      for (int a = 0; a < kernel_.dimensions; ++a) d[a] = points[j].position[a] - points[i].position[a];
      if (length(d) < kernel_.support() * sums_.width(i) && sums_.seen(i, j))
        visit(points[j].source, d, points[j].reflection);
    }
  }

  const SphSums& sums_;
  PlainKernel kernel_;
  double spacing_;
  std::vector<Vector> normals_;
  std::vector<double> own_depth_;
};

}  // namespace spume::reference
