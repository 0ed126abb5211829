// SPDX-License-Identifier: MIT
// Contours of values at nodes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "spume/core/vectors.hpp"
#include "spume/geometry/isosurface.hpp"

namespace spume {
namespace {

// Of a ball of radius 1 off the middle, in a box of 3.
struct Ball {
  NodeGrid grid;
  std::vector<double> nodes;

  Ball(int dimensions, std::size_t cells) {
    grid.spacing = 3.0 / static_cast<double>(cells);
    grid.lower = {-1.5, -1.5, dimensions == 3 ? -1.5 : 0};
    for (int a = 0; a < dimensions; ++a) grid.count[static_cast<std::size_t>(a)] = cells + 1;
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const Vec3 p = subtract(grid.node(k), {0.1234, -0.0567, dimensions == 3 ? 0.0345 : 0});
      nodes.push_back(1 - length(p));
    }
  }
};

struct Measured {
  double size = 0, content = 0;  // length and area; area and volume
};
Measured measured(const Contour& contour, int dimensions) {
  Measured sum;
  const auto at = [&](std::size_t k) { return contour.points[static_cast<std::size_t>(contour.corners[k])]; };
  for (std::size_t k = 0; k < contour.corners.size(); k += static_cast<std::size_t>(dimensions)) {
    const Vec3 a = at(k), b = at(k + 1);
    if (dimensions == 2) {
      sum.size += length(subtract(b, a));
      sum.content += 0.5 * (a[0] * b[1] - a[1] * b[0]);
    } else {
      const Vec3 c = at(k + 2), normal = cross(subtract(b, a), subtract(c, a));
      sum.size += 0.5 * length(normal);
      sum.content += dot(a, normal) / 6;
    }
  }
  return sum;
}

}  // namespace

// Values are linear on the simplices where the distance is curved by 1 / R: the surface lies inside the ball by at most
// h^2 / 8 R, h the longest edge, sqrt(d) spacings, and normals turn by h / R at most. Content and size are then short
// by d^2 spacing^2 / 8 and, with the square of that angle, another d spacing^2 / 2, and fall with the square of the
// spacing.
TEST(Contour, OfABallIsOfSecondOrderAndFacesOutwards) {
  for (const int d : {2, 3}) {
    const double size = d == 3 ? 4 * M_PI : 2 * M_PI, content = d == 3 ? 4 * M_PI / 3 : M_PI;
    std::vector<double> size_error, content_error;
    for (const std::size_t cells : {15, 30, 60}) {
      const Ball ball(d, cells);
      const Measured found = measured(find_contour(ball.grid, ball.nodes, d), d);
      const double h2 = ball.grid.spacing * ball.grid.spacing;
      size_error.push_back(std::abs(found.size / size - 1));
      content_error.push_back(std::abs(found.content / content - 1));
      EXPECT_LT(content_error.back(), d * d * h2 / 8);
      EXPECT_LT(size_error.back(), (d * d / 8.0 + d / 2.0) * h2);
    }
    for (const auto& error : {size_error, content_error})
      for (std::size_t k = 1; k < error.size(); ++k) EXPECT_NEAR(std::log2(error[k - 1] / error[k]), 2, 0.3) << d;
  }
}

TEST(Contour, IsClosed) {
  const Ball flat(2, 20);
  const Contour line = find_contour(flat.grid, flat.nodes, 2);
  std::map<std::int32_t, int> starts, ends;
  for (std::size_t k = 0; k < line.corners.size(); k += 2) ++starts[line.corners[k]], ++ends[line.corners[k + 1]];
  EXPECT_EQ(starts, ends);
  for (const auto& [point, count] : starts) EXPECT_EQ(count, 1);

  const Ball solid(3, 12);
  const Contour surface = find_contour(solid.grid, solid.nodes, 3);
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (std::size_t k = 0; k < surface.corners.size(); k += 3)
    for (std::size_t e = 0; e < 3; ++e) ++edges[{surface.corners[k + e], surface.corners[k + (e + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1U);
  }
}

TEST(Contour, EndsBeforeCellsWithoutValues) {
  for (const int d : {2, 3}) {
    Ball ball(d, 16);
    for (std::size_t k = 0; k < ball.grid.size(); ++k)
      if (ball.grid.node(k)[0] > 0.5) ball.nodes[k] = std::numeric_limits<double>::quiet_NaN();
    const Contour cut = find_contour(ball.grid, ball.nodes, d);
    double farthest = -2;
    for (const Vec3& p : cut.points) farthest = std::max(farthest, p[0]);
    EXPECT_LE(farthest, 0.5);
    EXPECT_GT(farthest, 0.5 - 2 * ball.grid.spacing);
  }
}

}  // namespace spume
