// SPDX-License-Identifier: MIT
#include "facet_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/vectors.hpp"
#include "triangles.hpp"

namespace spume {

double from_facet(const TriangleSurface& surface, std::size_t triangle, const Vec3& p) {
  const auto corner = [&](std::int32_t i) -> const Vec3& { return surface.points[static_cast<std::size_t>(i)]; };
  const auto& [a, b, c] = surface.triangles[triangle];
  return length(subtract(p, nearest_on_triangle(corner(a), corner(b), corner(c), p).point));
}

namespace {

class FacetSweep {
 public:
  FacetSweep(const TriangleSurface& boundary, const NodeGrid& grid)
      : boundary_(boundary), grid_(grid), facet_(grid.size(), none), distance_(grid.size(), infinite) {
    for (std::size_t t = 0; t < boundary.triangles.size(); ++t) seed(t);
    for (int sweep = 0; sweep < (grid.count[2] > 1 ? 8 : 4); ++sweep) hand_on(sweep);
  }
  double distance(std::size_t node) const { return distance_[node]; }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  void offer(std::size_t node, std::size_t facet) {
    const double distance = from_facet(boundary_, facet, grid_.node(node));
    if (distance < distance_[node]) {
      distance_[node] = distance;
      facet_[node] = facet;
    }
  }

  // The nodes within a cell of the box around a facet.
  void seed(std::size_t facet) {
    std::array<std::size_t, 3> first{}, last{};
    for (std::size_t a = 0; a < 3; ++a) {
      double low = infinite, high = -infinite;
      for (const std::int32_t corner : boundary_.triangles[facet]) {
        low = std::min(low, boundary_.points[static_cast<std::size_t>(corner)][a]);
        high = std::max(high, boundary_.points[static_cast<std::size_t>(corner)][a]);
      }
      const double most = static_cast<double>(grid_.count[a] - 1);
      const auto cell = [&](double x) { return (x - grid_.lower[a]) / grid_.spacing; };
      first[a] = static_cast<std::size_t>(std::clamp(std::floor(cell(low)) - 1, 0.0, most));
      last[a] = static_cast<std::size_t>(std::clamp(std::ceil(cell(high)) + 1, 0.0, most));
    }
    for (std::size_t k = first[2]; k <= last[2]; ++k)
      for (std::size_t j = first[1]; j <= last[1]; ++j)
        for (std::size_t i = first[0]; i <= last[0]; ++i) offer(grid_.number(i, j, k), facet);
  }

  // Bit a of `sweep` set: from the upper end of axis a. Nodes take from the neighbours that lie behind.
  void hand_on(int sweep) {
    const auto at = [&](std::size_t a, std::size_t n) { return (sweep >> a & 1) != 0 ? grid_.count[a] - 1 - n : n; };
    for (std::size_t k = 0; k < grid_.count[2]; ++k)
      for (std::size_t j = 0; j < grid_.count[1]; ++j)
        for (std::size_t i = 0; i < grid_.count[0]; ++i) {
          const std::size_t node = grid_.number(at(0, i), at(1, j), at(2, k));
          std::size_t last = facet_[node];
          for (std::size_t back = 1; back < 8; ++back) {
            const std::size_t di = back & 1, dj = back >> 1 & 1, dk = back >> 2;
            if (di > i || dj > j || dk > k) continue;
            const std::size_t facet = facet_[grid_.number(at(0, i - di), at(1, j - dj), at(2, k - dk))];
            if (facet == none || facet == last) continue;
            offer(node, facet);
            last = facet;
          }
        }
  }

  const TriangleSurface& boundary_;
  const NodeGrid& grid_;
  std::vector<std::size_t> facet_;
  std::vector<double> distance_;
};

}  // namespace

std::vector<double> from_facets(const TriangleSurface& boundary, const NodeGrid& grid,
                                const std::vector<double>& nodes) {
  const FacetSweep sweep(boundary, grid);
  std::vector<double> values(grid.size());
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = (nodes[n] > 0 ? -1 : 1) * sweep.distance(n);
  return values;
}

}  // namespace spume
