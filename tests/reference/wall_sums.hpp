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
  // Beside thin bodies: what is seen from a place, another place or a wall point; null: all.
  std::function<bool(const Vec3&, const Vec3&)> sees{};
  std::function<bool(const Vec3&, const WallPoint&)> sees_point{};

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

  // The particles before the tangent plane of a wall point within reach of its mirror, and their periodic copies:
  // offsets from there over h, weights, values.
  struct Near {
    std::vector<Vec3> offset;
    std::vector<double> weight;
    std::vector<Carried> value;
  };
  Near near(const WallPoint& point) const {
    const double reach = (scene.domain.dimensions == 2 ? 1.25 : 1) * support_radius;
    Near found;
    for (std::size_t j = 0; j < particle.size(); ++j)
      for (const Vec3& place : periodic_copies(particle[j])) {
        const Vec3 xi = multiply(1 / smoothing_length, subtract(place, point.mirror));
        if (length(xi) * smoothing_length >= reach || dot(subtract(place, point.foot), point.normal) < 0) continue;
        if (sees && !sees(point.mirror, place)) continue;
        found.offset.push_back(xi);
        found.weight.push_back(WendlandC2::w(2 * length(xi) * smoothing_length / reach));
        found.value.push_back(value[j]);
      }
    return found;
  }

  // The monomials up to an order.
  std::vector<double> monomials(const Vec3& r, int order) const {
    std::vector<double> all;
    const int high = scene.domain.dimensions == 3 ? order : 0;
    for (int k = 0; k <= high; ++k)
      for (int j = 0; j + k <= order; ++j)
        for (int i = 0; i + j + k <= order; ++i)
          all.push_back(std::pow(r[0], i) * std::pow(r[1], j) * std::pow(r[2], k));
    return all;
  }

  // Coefficients of the weighted fit at the place `at`, an offset as those of the particles. `through`: another place,
  // with ten times the weight of all, whose value is zero.
  std::vector<double> coefficients(const Near& around, int order, const Vec3& at, const Vec3* through) const {
    const std::size_t rows = around.offset.size() + (through == nullptr ? 0 : 1);
    const auto columns = static_cast<Eigen::Index>(monomials({}, order).size());
    Eigen::MatrixXd basis(static_cast<Eigen::Index>(rows), columns);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(basis.rows(), basis.rows());
    double sum = 0;
    for (const double weight : around.weight) sum += weight;
    for (std::size_t k = 0; k < rows; ++k) {
      const bool particle_row = k < around.offset.size();
      const double root = std::sqrt(particle_row ? around.weight[k] : 10 * sum);
      const std::vector<double> row = monomials(subtract(particle_row ? around.offset[k] : *through, at), order);
      const auto r = static_cast<Eigen::Index>(k);
      for (Eigen::Index c = 0; c < columns; ++c) basis(r, c) = root * row[static_cast<std::size_t>(c)];
      right(r, r) = root;
    }
    const Eigen::MatrixXd c = test::least_squares(basis, right);
    std::vector<double> of(around.offset.size());
    for (std::size_t k = 0; k < of.size(); ++k) of[k] = c(0, static_cast<Eigen::Index>(k));
    return of;
  }

  // The kernel sum at the mirror of a wall point, of the particles before the wall and of their mirror images.
  double share(const WallPoint& point, const Near& around) const {
    const int d = scene.domain.dimensions;
    const double depth = dot(subtract(point.mirror, point.foot), point.normal);
    double sum = 0;
    for (const Vec3& xi : around.offset) {
      const Vec3 offset = multiply(smoothing_length, xi);
      const double across = depth + dot(offset, point.normal);
      for (const double r2 : {dot(offset, offset), dot(offset, offset) + 4 * across * depth})
        sum += WendlandC2::w(std::sqrt(r2) / smoothing_length);
    }
    return sum * volume * WendlandC2::normalisation(d) / std::pow(smoothing_length, d);
  }

  // Of the fit at the mirror: 2, beside voids of liquid that has no surface the highest whose sum of |c_j| is at
  // most 1.5.
  int order(const WallPoint& point, const Near& around) const {
    if (scene.free_surface || !scene.motions.empty() || share(point, around) >= 0.9) return 2;
    for (int high = 2; high > 0; --high) {
      double moduli = 0;
      for (const double c : coefficients(around, high, {}, nullptr)) moduli += std::abs(c);
      if (moduli <= 1.5) return high;
    }
    return 0;
  }

  // The fit at the mirror of a wall point.
  Carried fit(const WallPoint& point) const {
    const Near around = near(point);
    const std::vector<double> c = coefficients(around, order(point, around), {}, nullptr);
    Carried sum;
    for (std::size_t k = 0; k < c.size(); ++k) {
      sum.scalar += c[k] * around.value[k].scalar;
      sum.velocity = add(sum.velocity, multiply(c[k], around.value[k].velocity));
    }
    return sum;
  }

  // What the polynomial through the velocity of the surface at the foot has at the wall point beside the velocity
  // turned round: a cubic, or a parabola where the cubic would take more than 16 times the velocities per spacing of
  // depth; at most as long as the velocity relative to the surface.
  Vec3 bend(const WallPoint& point, const Vec3& wall, const Vec3& relative) const {
    const Near around = near(point);
    if (order(point, around) < 2) return {};
    const std::vector<double> c = coefficients(around, 2, {}, nullptr);
    const Vec3 foot = multiply(1 / smoothing_length, subtract(point.foot, point.mirror));
    const double depth = length(subtract(point.position, point.foot));
    Vec3 bent{};
    for (const int high : {3, 2}) {
      const std::vector<double> behind = coefficients(around, high, multiply(2, foot), &foot);
      double moduli = 0;
      bent = {};
      for (std::size_t k = 0; k < c.size(); ++k) {
        moduli += std::abs(behind[k] + c[k]);
        bent = add(bent, multiply(behind[k] + c[k], subtract(around.value[k].velocity, wall)));
      }
      if (moduli <= 16 * depth / scene.spacing) break;
    }
    const auto size = [&](const Vec3& v) { return std::hypot(v[0], v[1], scene.domain.dimensions == 3 ? v[2] : 0); };
    return size(bent) > size(relative) ? multiply(size(relative) / size(bent), bent) : bent;
  }

  // What a wall point carries.
  Carried at(const WallPoint& point, const Body& body, bool friction) const {
    Carried carried = fit(point);
    const Vec3 wall = body.velocity ? (*body.velocity)(point.foot, 0) : Vec3{};
    const Vec3 relative = subtract(carried.velocity, wall);
    carried.velocity = friction && body.wall == BoundaryKind::no_slip
                           ? add(subtract(wall, relative), point.past_edge ? Vec3{} : bend(point, wall, relative))
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
    for (std::size_t j = 0; j < particle.size(); ++j)
      if (!sees || sees(particle[i], particle[j])) visit(particle[j], value[j], j == i);
    for (std::size_t g = 0; g < walls.size(); ++g)
      if (!sees_point || sees_point(particle[i], walls[g])) visit(walls[g].position, at_walls[g], false);
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
