// SPDX-License-Identifier: MIT
// An SPH pressure operator assembled by plain loops, for holding solvers against a direct factorisation:
//
//   A_ij = -V^2 w_ij,  w_ij = -2 r.gradW / r^2 (Morris),  A_ii = sum_j V^2 w_ij + V helmholtz + penalty_i,
//
// Wendland C2 kernel, smoothing length 1.3 spacings, support two smoothing lengths, jittered lattice. Walls mirror the
// particles (zero normal gradient), periodic sides wrap. Surface particles, found by their missing neighbours, are
// decoupled rows; those just below carry a smooth penalty.
#pragma once

#include <omp.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/solvers/linear_operator.hpp"

namespace spume::reference {

struct SphSetup {
  int dimensions = 3;
  double spacing = 0.05;
  std::array<double, 3> lower{0, 0, 0}, upper{1, 0.5, 0.5};
  std::array<bool, 3> periodic{};
  std::array<std::array<bool, 2>, 3> wall{};
  std::function<bool(double, double, double)> liquid = [](double, double, double) { return true; };
  bool surface = true;  // false: no particle is pinned (closed or periodic domains)
  bool smooth_penalty = true;
  double helmholtz = 0;  // Ma^2 / dt^2
  double jitter = 0.2;   // of the spacing
};

struct SphSystem {
  std::vector<double> x, y, z;
  std::vector<float> interior, diagonal;
  std::vector<std::uint8_t> pinned;
  double volume = 0;
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix;
  std::size_t size() const { return x.size(); }

  // A smooth pressure-like right-hand side plus noise; zero on pinned rows.
  Eigen::VectorXd right_hand_side(unsigned seed = 7) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 1);
    Eigen::VectorXd b(static_cast<Eigen::Index>(size()));
    for (std::size_t i = 0; i < size(); ++i) {
      const double smooth = std::cos(5 * x[i]) * std::cos(4 * z[i]) + y[i];
      b[static_cast<Eigen::Index>(i)] = pinned[i] ? 0.0 : volume * (smooth + noise(random));
    }
    return b;
  }
};

// dW/dr / r of the Wendland C2 kernel with support `2 h`, normalised in d dimensions.
inline double wendland_gradient_over_r(double r, double h, int dimensions) {
  const double q = r / h;
  if (q >= 2) return 0;
  const double pi = 3.14159265358979323846;
  const double alpha = dimensions == 2 ? 7 / (4 * pi * h * h) : 21 / (16 * pi * h * h * h);
  const double t = 1 - q / 2;
  return -5 * alpha * t * t * t / (h * h);
}
inline double wendland(double r, double h, int dimensions) {
  const double q = r / h;
  if (q >= 2) return 0;
  const double pi = 3.14159265358979323846;
  const double alpha = dimensions == 2 ? 7 / (4 * pi * h * h) : 21 / (16 * pi * h * h * h);
  const double t = 1 - q / 2;
  return alpha * t * t * t * t * (2 * q + 1);
}

inline SphSystem assemble(const SphSetup& setup) {
  SphSystem s;
  const int d = setup.dimensions;
  const double dx = setup.spacing, h = 1.3 * dx, support = 2 * h;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-setup.jitter * dx, setup.jitter * dx);
  std::array<int, 3> count{1, 1, 1};
  for (int a = 0; a < d; ++a) count[a] = static_cast<int>(std::lround((setup.upper[a] - setup.lower[a]) / dx));
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        const std::array<int, 3> at{i, j, k};
        std::array<double, 3> p{0, 0, 0};
        for (int a = 0; a < d; ++a) p[a] = setup.lower[a] + (at[a] + 0.5) * dx;
        if (!setup.liquid(p[0], p[1], p[2])) continue;
        for (int a = 0; a < d; ++a) p[a] += jitter(random);
        s.x.push_back(p[0]);
        s.y.push_back(p[1]);
        s.z.push_back(p[2]);
      }
  const std::size_t n = s.size();
  s.volume = std::pow(dx, d);

  // Images: every particle within the support of a wall or periodic side, repeatedly over the axes.
  struct Point {
    std::array<double, 3> p;
    std::size_t source;
  };
  std::vector<Point> points(n);
  for (std::size_t i = 0; i < n; ++i) points[i] = {{s.x[i], s.y[i], s.z[i]}, i};
  for (int a = 0; a < d; ++a) {
    const std::size_t before = points.size();
    const double length = setup.upper[a] - setup.lower[a];
    for (std::size_t i = 0; i < before; ++i) {
      const Point point = points[i];
      const double low = point.p[a] - setup.lower[a], high = setup.upper[a] - point.p[a];
      const auto image = [&](double coordinate) {
        Point copy = point;
        copy.p[a] = coordinate;
        points.push_back(copy);
      };
      if (setup.periodic[a]) {
        if (low < support) image(point.p[a] + length);
        if (high < support) image(point.p[a] - length);
      } else {
        if (setup.wall[a][0] && low < support) image(setup.lower[a] - low);
        if (setup.wall[a][1] && high < support) image(setup.upper[a] + high);
      }
    }
  }

  // Bins of the support's size.
  std::array<int, 3> bins{1, 1, 1};
  std::array<double, 3> base{0, 0, 0};
  for (int a = 0; a < d; ++a) {
    double lo = 1e300, hi = -1e300;
    for (const Point& point : points) {
      lo = std::min(lo, point.p[a]);
      hi = std::max(hi, point.p[a]);
    }
    base[a] = lo;
    bins[a] = points.empty() ? 1 : static_cast<int>((hi - lo) / support) + 1;
  }
  const auto bin_of = [&](const std::array<double, 3>& p) {
    std::array<int, 3> b{0, 0, 0};
    for (int a = 0; a < d; ++a) b[a] = static_cast<int>((p[a] - base[a]) / support);
    return b;
  };
  std::vector<std::vector<std::size_t>> bin(static_cast<std::size_t>(bins[0]) * bins[1] * bins[2]);
  const auto bin_index = [&](int i, int j, int k) { return (static_cast<std::size_t>(k) * bins[1] + j) * bins[0] + i; };
  for (std::size_t q = 0; q < points.size(); ++q) {
    const auto b = bin_of(points[q].p);
    bin[bin_index(b[0], b[1], b[2])].push_back(q);
  }
  std::vector<std::vector<std::pair<std::size_t, double>>> neighbours(n);
  std::vector<double> kernel_sum(n, 0);
  std::vector<int> neighbour_count(n, 0);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t i = 0; i < n; ++i) {
    const std::array<double, 3> pi{s.x[i], s.y[i], s.z[i]};
    const auto b = bin_of(pi);
    kernel_sum[i] = s.volume * wendland(0, h, d);
    for (int kk = std::max(0, b[2] - 1); kk <= std::min(bins[2] - 1, b[2] + 1); ++kk)
      for (int jj = std::max(0, b[1] - 1); jj <= std::min(bins[1] - 1, b[1] + 1); ++jj)
        for (int ii = std::max(0, b[0] - 1); ii <= std::min(bins[0] - 1, b[0] + 1); ++ii)
          for (const std::size_t q : bin[bin_index(ii, jj, kk)]) {
            if (q == i) continue;
            double r2 = 0;
            for (int a = 0; a < d; ++a) r2 += (pi[a] - points[q].p[a]) * (pi[a] - points[q].p[a]);
            const double r = std::sqrt(r2);
            if (r >= support) continue;
            kernel_sum[i] += s.volume * wendland(r, h, d);
            ++neighbour_count[i];
            if (points[q].source != i)  // a particle and its own mirror image have the same pressure
              neighbours[i].emplace_back(points[q].source, -2 * wendland_gradient_over_r(r, h, d));
          }
  }

  s.interior.assign(n, 1);
  s.pinned.assign(n, 0);
  std::vector<double> blend(n, 1);
  if (setup.surface) {
    // The uppermost layer of a flat surface has 0.63 of the neighbours of a particle inside, the next 0.87.
    const double pi = 3.14159265358979323846, support_radius = support / dx;
    const double inside =
        d == 2 ? pi * support_radius * support_radius : 4.0 / 3 * pi * support_radius * support_radius * support_radius;
    for (std::size_t i = 0; i < n; ++i) s.pinned[i] = neighbour_count[i] + 1 < 0.74 * inside;
    for (std::size_t i = 0; i < n; ++i) {
      bool below_surface = false;
      for (const auto& [j, w] : neighbours[i]) below_surface = below_surface || s.pinned[j];
      if (setup.smooth_penalty && below_surface) blend[i] = std::clamp((kernel_sum[i] - 0.82) / 0.14, 0.05, 1.0);
      s.interior[i] = s.pinned[i] ? 0.0F : static_cast<float>(blend[i]);
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  s.diagonal.resize(n);
  const double v2 = s.volume * s.volume;
  for (std::size_t i = 0; i < n; ++i) {
    double diagonal = 0;
    for (const auto& [j, w] : neighbours[i]) {
      diagonal += v2 * w;
      if (!s.pinned[i] && !s.pinned[j]) entries.emplace_back(static_cast<int>(i), static_cast<int>(j), -v2 * w);
    }
    diagonal += s.volume * setup.helmholtz;
    if (diagonal == 0) diagonal = s.volume / (dx * dx);
    if (!s.pinned[i]) diagonal += (1 - blend[i]) / blend[i] * diagonal;
    entries.emplace_back(static_cast<int>(i), static_cast<int>(i), diagonal);
    s.diagonal[i] = static_cast<float>(diagonal);
  }
  s.matrix.resize(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  s.matrix.setFromTriplets(entries.begin(), entries.end());
  return s;
}

// y = A x with the assembled matrix.
template <class Real>
class SparseOperator final : public LinearOperator<Real> {
 public:
  explicit SparseOperator(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix) : matrix_(matrix.cast<Real>()) {}
  std::size_t size() const override { return static_cast<std::size_t>(matrix_.rows()); }
  void apply(std::span<const Real> x, std::span<Real> y) override {
    ++applications;
    parallel_for(size(), [&](std::size_t i) {
      Real sum = 0;
      for (auto e = matrix_.outerIndexPtr()[i]; e < matrix_.outerIndexPtr()[i + 1]; ++e)
        sum += matrix_.valuePtr()[e] * x[static_cast<std::size_t>(matrix_.innerIndexPtr()[e])];
      y[i] = sum;
    });
  }
  int applications = 0;

 private:
  Eigen::SparseMatrix<Real, Eigen::RowMajor> matrix_;
};

}  // namespace spume::reference
