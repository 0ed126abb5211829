// SPDX-License-Identifier: MIT
#include "solid_moments.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume {

SolidMoments moments_of(const Combination& solid, const Bounds& bounds, int dimensions) {
  const auto d = static_cast<std::size_t>(dimensions);
  const std::size_t per_axis = dimensions == 3 ? 64 : 512;
  std::array<std::size_t, 3> count{1, 1, 1};
  Vec3 step{1, 1, 1};
  for (std::size_t a = 0; a < d; ++a) {
    count[a] = per_axis;
    step[a] = (bounds.upper[a] - bounds.lower[a]) / static_cast<double>(per_axis);
  }
  struct Sums {
    double inside = 0;
    Vec3 first{};
    std::array<double, 6> second{};  // xx yy zz xy yz zx
  };
  const Vec3 middle = multiply(0.5, add(bounds.lower, bounds.upper));
  const double cell_side = dimensions == 3 ? std::cbrt(step[0] * step[1] * step[2]) : std::sqrt(step[0] * step[1]);
  const Sums sums = parallel_reduce(
      count[1] * count[2], Sums{},
      [&](std::size_t first, std::size_t last) {
        Sums sum;
        for (std::size_t row = first; row < last; ++row)
          for (std::size_t i = 0; i < count[0]; ++i) {
            const std::size_t j = row % count[1], k = row / count[1];
            Vec3 p{bounds.lower[0] + (static_cast<double>(i) + 0.5) * step[0],
                   bounds.lower[1] + (static_cast<double>(j) + 0.5) * step[1],
                   d == 3 ? bounds.lower[2] + (static_cast<double>(k) + 0.5) * step[2] : 0.0};
            const double share = std::clamp(0.5 - solid.distance(p) / cell_side, 0.0, 1.0);
            p = subtract(p, middle);
            sum.inside += share;
            const std::array<double, 6> products{p[0] * p[0], p[1] * p[1], p[2] * p[2],
                                                 p[0] * p[1], p[1] * p[2], p[2] * p[0]};
            for (std::size_t a = 0; a < 3; ++a) sum.first[a] += share * p[a];
            for (std::size_t a = 0; a < 6; ++a) sum.second[a] += share * products[a];
          }
        return sum;
      },
      [](Sums a, const Sums& b) {
        a.inside += b.inside;
        for (std::size_t k = 0; k < 3; ++k) a.first[k] += b.first[k];
        for (std::size_t k = 0; k < 6; ++k) a.second[k] += b.second[k];
        return a;
      });
  const double cell = step[0] * step[1] * step[2];
  SolidMoments moments;
  moments.volume = sums.inside * cell;
  if (!(sums.inside > 0)) return moments;
  const Vec3 c = multiply(1 / sums.inside, sums.first);
  moments.centroid = add(middle, c);
  std::array<double, 6> s{};
  const std::array<double, 6> shift{c[0] * c[0], c[1] * c[1], c[2] * c[2], c[0] * c[1], c[1] * c[2], c[2] * c[0]};
  for (std::size_t a = 0; a < 6; ++a) s[a] = cell * (sums.second[a] - sums.inside * shift[a]);
  moments.inertia = {{{s[1] + s[2], -s[3], -s[5]}, {-s[3], s[0] + s[2], -s[4]}, {-s[5], -s[4], s[0] + s[1]}}};
  return moments;
}

RotationMatrix inertia_about(const RotationMatrix& central, double mass, const Vec3& away) {
  RotationMatrix moved = central;
  const double size2 = dot(away, away);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) moved[i][j] += mass * ((i == j ? size2 : 0) - away[i] * away[j]);
  return moved;
}

}  // namespace spume
