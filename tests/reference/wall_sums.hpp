// SPDX-License-Identifier: MIT
// Slow, obvious twin of walls of bodies: every value at a wall point by a fit over all particles, every sum over all
// particles, wall points and their images.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "spume/core/kernel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/wall_points.hpp"
#include "spume/scene/scene.hpp"
#include "support/direct_solution.hpp"

namespace spume::reference {

// What a point carries.
struct Carried {
  double scalar = 0;
  Vec3 velocity{};
};

struct WallSums {
  const Scene& scene;
  double smoothing_length, support_radius, volume;
  std::vector<Vec3> particle;
  std::vector<Carried> value;

  // All shifts by the periods, and reflections in walls, that a point of the domain may be seen at. `mirrored`: as a
  // free-slip wall has it; `no_slip` walls of the domain turn the velocity round.
  struct Seen {
    Vec3 place;
    Carried value;
  };
  std::vector<Seen> seen_of(const Vec3& place, const Carried& carried, bool friction) const {
    std::vector<Seen> all{{place, carried}};
    for (int axis = 0; axis < scene.domain.dimensions; ++axis) {
      const std::vector<Seen> before = all;
      for (int side = 0; side < 2; ++side)
        for (Seen one : before) {
          const double lower = scene.domain.lower[axis], upper = scene.domain.upper[axis];
          const BoundaryKind kind = scene.domain.sides[axis][side].kind;
          if (kind == BoundaryKind::open) continue;
          if (kind == BoundaryKind::periodic) {
            one.place[axis] += side == 0 ? lower - upper : upper - lower;
          } else {
            one.place[axis] = 2 * (side == 0 ? lower : upper) - one.place[axis];
            if (kind == BoundaryKind::no_slip && friction)
              one.value.velocity = multiply(-1, one.value.velocity);
            else
              one.value.velocity[axis] = -one.value.velocity[axis];
          }
          all.push_back(one);
        }
    }
    return all;
  }

  // Quadratic fit at the mirror of a wall point, over the particles before its tangent plane and their periodic copies.
  Carried fit(const WallPoint& point) const {
    const int d = scene.domain.dimensions;
    const double reach = 1.25 * support_radius;
    std::vector<Vec3> offset;
    std::vector<Carried> values;
    for (std::size_t j = 0; j < particle.size(); ++j)
      for (const Vec3& place : periodic_copies(particle[j])) {
        const Vec3 xi = multiply(1 / smoothing_length, subtract(place, point.mirror));
        if (length(xi) * smoothing_length >= reach || dot(subtract(place, point.foot), point.normal) < 0) continue;
        offset.push_back(xi);
        values.push_back(value[j]);
      }
    const int columns = d == 2 ? 6 : 10;
    const auto rows = static_cast<Eigen::Index>(offset.size());
    Eigen::MatrixXd basis(rows, columns), right(rows, 4);
    for (Eigen::Index k = 0; k < rows; ++k) {
      const auto [x, y, z] = offset[static_cast<std::size_t>(k)];
      Eigen::VectorXd row(columns);
      if (d == 2)
        row << 1, x, y, x * x, x * y, y * y;
      else
        row << 1, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z;
      const double weight =
          std::sqrt(WendlandC2::w(2 * length(offset[static_cast<std::size_t>(k)]) * smoothing_length / reach));
      const Carried& v = values[static_cast<std::size_t>(k)];
      basis.row(k) = weight * row;
      right.row(k) << weight * v.scalar, weight * v.velocity[0], weight * v.velocity[1], weight * v.velocity[2];
    }
    const Eigen::MatrixXd c = test::least_squares(basis, right);
    return {c(0, 0), {c(0, 1), c(0, 2), c(0, 3)}};
  }

  // What a wall point carries.
  Carried at(const WallPoint& point, const Body& body, bool friction) const {
    Carried carried = fit(point);
    const Vec3 wall = body.velocity ? (*body.velocity)(point.foot, 0) : Vec3{};
    const Vec3 relative = subtract(carried.velocity, wall);
    carried.velocity = friction && body.wall == BoundaryKind::no_slip
                           ? subtract(wall, relative)
                           : subtract(carried.velocity, multiply(2 * dot(relative, point.normal), point.normal));
    return carried;
  }

  // sum_j body(d, r, value of j) over all that particle i sees, itself excluded.
  void sum(std::size_t i, const std::vector<WallPoint>& walls, const std::vector<Carried>& at_walls, bool friction,
           const std::function<void(const Vec3&, double, const Carried&)>& body) const {
    const auto visit = [&](const Vec3& place, const Carried& carried, bool itself) {
      bool first = true;
      for (const Seen& one : seen_of(place, carried, friction)) {
        const Vec3 way = subtract(one.place, particle[i]);
        const double r = length(way);
        if (!(itself && first) && r < support_radius) body(way, r, one.value);
        first = false;
      }
    };
    for (std::size_t j = 0; j < particle.size(); ++j) visit(particle[j], value[j], j == i);
    for (std::size_t g = 0; g < walls.size(); ++g) visit(walls[g].position, at_walls[g], false);
  }

  // V F(q) / h^(d+2) with the sign of V grad W = g (r_j - r_i).
  double g(double r) const {
    const int d = scene.domain.dimensions;
    return -volume * WendlandC2::normalisation(d) / std::pow(smoothing_length, d + 2) *
           WendlandC2::f(r / smoothing_length);
  }

 private:
  std::vector<Vec3> periodic_copies(const Vec3& place) const {
    std::vector<Vec3> all{place};
    for (int axis = 0; axis < scene.domain.dimensions; ++axis) {
      if (!scene.domain.periodic(axis)) continue;
      const std::vector<Vec3> before = all;
      for (Vec3 one : before)
        for (const int way : {-1, 1}) {
          Vec3 copy = one;
          copy[axis] += way * (scene.domain.upper[axis] - scene.domain.lower[axis]);
          all.push_back(copy);
        }
    }
    return all;
  }
};

}  // namespace spume::reference
