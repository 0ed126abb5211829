// SPDX-License-Identifier: MIT
// Averages of the liquid over planes across the domain.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/particles/point_sampler.hpp"

namespace spume {
namespace {

// A corner of a cell, and how far its wet share lies above one half: below zero in a body.
struct Corner {
  Vec3 point{};
  double wetness = 0;
};

// A piece of the plane and its centroid. A length in two dimensions.
struct Piece {
  double area = 0;
  Vec3 moment{};  // area times centroid

  void add(double part, const Vec3& centroid) {
    area += part;
    for (std::size_t a = 0; a < 3; ++a) moment[a] += part * centroid[a];
  }
};

// Where the wetness, linear between two corners of different sign, is zero.
Vec3 crossing(const Corner& a, const Corner& b) {
  const double t = a.wetness / (a.wetness - b.wetness);
  Vec3 point;
  for (std::size_t c = 0; c < 3; ++c) point[c] = a.point[c] + t * (b.point[c] - a.point[c]);
  return point;
}

// The wet outline of a segment (two corners) or a triangle (three).
std::vector<Vec3> wet_outline(std::span<const Corner> corners) {
  std::vector<Vec3> outline;
  const std::size_t edges = corners.size() == 2 ? 1 : corners.size();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Corner &here = corners[k], &next = corners[(k + 1) % corners.size()];
    if (here.wetness >= 0) outline.push_back(here.point);
    if (k < edges && (here.wetness >= 0) != (next.wetness >= 0)) outline.push_back(crossing(here, next));
  }
  return outline;
}

void add_segment(std::span<const Corner> corners, Piece& piece) {
  const std::vector<Vec3> ends = wet_outline(corners);
  if (ends.size() < 2) return;
  Vec3 middle;
  double length2 = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    middle[c] = 0.5 * (ends[0][c] + ends[1][c]);
    length2 += (ends[1][c] - ends[0][c]) * (ends[1][c] - ends[0][c]);
  }
  piece.add(std::sqrt(length2), middle);
}

// a, b: the axes of the plane.
void add_triangle(std::span<const Corner> corners, std::size_t a, std::size_t b, Piece& piece) {
  const std::vector<Vec3> outline = wet_outline(corners);
  for (std::size_t k = 2; k < outline.size(); ++k) {
    const Vec3 &p = outline[0], &q = outline[k - 1], &r = outline[k];
    const double area = 0.5 * std::abs((q[a] - p[a]) * (r[b] - p[b]) - (q[b] - p[b]) * (r[a] - p[a]));
    Vec3 centroid;
    for (std::size_t c = 0; c < 3; ++c) centroid[c] = (p[c] + q[c] + r[c]) / 3;
    piece.add(area, centroid);
  }
}

// Equal cells of about one spacing on a plane, and their corners.
struct PlaneCells {
  std::vector<std::size_t> axes;  // of the plane: one in two dimensions
  std::array<std::size_t, 2> cells{1, 1}, corners{1, 1};
  Vec3 lower{}, side{};

  PlaneCells(const WallPositions& walls, int dimensions, std::size_t axis, double position, double spacing) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a) {
      if (a == axis) continue;
      const double length = walls[a][1] - walls[a][0];
      const std::size_t k = axes.size();
      cells[k] = static_cast<std::size_t>(std::max(1.0, std::round(length / spacing)));
      corners[k] = cells[k] + 1;
      side[a] = length / static_cast<double>(cells[k]);
      lower[a] = walls[a][0];
      axes.push_back(a);
    }
    lower[axis] = position;
  }
  // The point i, j cells from the lower corner.
  Vec3 point(double i, double j) const {
    Vec3 r = lower;
    r[axes[0]] += i * side[axes[0]];
    if (axes.size() == 2) r[axes[1]] += j * side[axes[1]];
    return r;
  }
};

}  // namespace

PlaneSample PointSampler::plane_average(int axis, double position) const {
  const auto& walls = state_.boundary->walls;
  const auto normal = static_cast<std::size_t>(axis);
  PlaneSample result;
  result.scalars.assign(state_.scalars.size(), PlaneSample::nothing);
  if (position < walls[normal][0] || position > walls[normal][1]) return result;  // a wall has moved past it
  const PlaneCells plane(walls, state_.particles->dimensions, normal, position, state_.resolution->spacing);

  const BodyWalls* const bodies = state_.boundary->bodies();
  std::vector<Corner> corners(plane.corners[0] * plane.corners[1]);
  parallel_for(corners.size(), [&](std::size_t k) {
    const auto column = k % plane.corners[0], row = k / plane.corners[0];
    const Vec3 point = plane.point(static_cast<double>(column), static_cast<double>(row));
    corners[k] = {point, wet_share(point) - 0.5};
    if (bodies == nullptr) return;
    // Up to the surface of a body, from which a distance of a spacing counts as wet all round.
    const double from_body = bodies->distance(point) / (2 * state_.resolution->spacing);
    corners[k].wetness = from_body < 0 ? from_body : std::min(corners[k].wetness, from_body);
  });

  const auto wet_piece = [&](std::size_t i, std::size_t j) {
    Piece piece;
    const Corner* first = &corners[j * plane.corners[0] + i];
    if (plane.axes.size() == 1) {
      add_segment(std::span(first, 2), piece);
    } else {
      const Corner* above = first + plane.corners[0];
      add_triangle(std::array{first[0], first[1], above[1]}, plane.axes[0], plane.axes[1], piece);
      add_triangle(std::array{first[0], above[1], above[0]}, plane.axes[0], plane.axes[1], piece);
    }
    return piece;
  };

  struct Sum {
    double area = 0;
    std::vector<double> scalars;
    Vec3 velocity{};

    void add(double weight, const Sum& other) {
      area += weight * other.area;
      scalars.resize(std::max(scalars.size(), other.scalars.size()));
      for (std::size_t k = 0; k < other.scalars.size(); ++k) scalars[k] += weight * other.scalars[k];
      for (std::size_t c = 0; c < 3; ++c) velocity[c] += weight * other.velocity[c];
    }
  };
  const Sum total = parallel_reduce(
      plane.cells[0] * plane.cells[1], Sum{},
      [&](std::size_t first, std::size_t last) {
        Sum sum;
        for (std::size_t k = first; k < last; ++k) {
          const std::size_t i = k % plane.cells[0], j = k / plane.cells[0];
          const Vec3 middle = plane.point(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5);
          if (inside_solid(state_.boundary->domain(), middle)) continue;
          const Piece piece = wet_piece(i, j);
          if (!(piece.area > 0)) continue;
          Vec3 centroid = piece.moment;
          for (double& component : centroid) component /= piece.area;
          PointSample one = fit(centroid);
          sum.add(piece.area, {1, std::move(one.scalars), one.velocity});
        }
        return sum;
      },
      [](const Sum& a, const Sum& b) {
        Sum sum = a;
        sum.add(1, b);
        return sum;
      });
  if (!(total.area > 0)) return result;
  result.area = total.area;
  for (std::size_t k = 0; k < result.scalars.size(); ++k) result.scalars[k] = total.scalars[k] / total.area;
  for (std::size_t c = 0; c < 3; ++c) result.velocity[c] = total.velocity[c] / total.area;
  return result;
}

}  // namespace spume
