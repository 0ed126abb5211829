// SPDX-License-Identifier: MIT
// Slow twin of the sums of weakly compressible SPH beside wall points, from the definitions in wall_averages.hpp and
// wcsph_sums.hpp: over all pairs of particles, wall points and all their copies at the sides, in double.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "spume/core/kernel.hpp"
#include "spume/core/vec3.hpp"
#include "spume/scene/scene.hpp"

namespace spume::reference {

// A particle, or a wall point, whose velocities are those of the wall.
struct WallSumPoint {
  Vec3 position{}, velocity{}, normal{}, acceleration{};
  double volume = 1, pressure = 0, excess = 0, density = 0, viscosity = 0;
  int phase = 0, body = -1;  // -1: a particle
  bool no_slip = false;
  Vec3 held{};     // its velocity under friction
  Vec3 surface{};  // of a wall point: that of the wall
};

struct WcsphWallSums {
  const Domain& domain;
  double h, particle_volume;
  Vec3 gravity;
  double repulsion;
  std::vector<WallSumPoint> particles, walls;
  bool weighted = false;
  bool adjoint = false;  // the rate of density to the pressure force
  Vec3 left_out{};       // gradient of a linear pressure that pressures are without

  // A copy of a point: itself, or what sides make of it.
  struct Copy {
    Vec3 position{}, reflection{1, 1, 1}, held{1, 1, 1};
    bool mirrored = false;
  };
  void each_copy(const WallSumPoint& point, const std::function<void(const Copy&)>& visit) const {
    for (int code = 0; code < (domain.dimensions == 3 ? 27 : 9); ++code) {
      Copy copy{.position = point.position};
      bool exists = true;
      for (int axis = 0, rest = code; axis < domain.dimensions; ++axis, rest /= 3) {
        if (rest % 3 == 0) continue;
        const int side = rest % 3 - 1;
        const double plane = side == 0 ? domain.lower[axis] : domain.upper[axis];
        const double length = domain.upper[axis] - domain.lower[axis];
        const BoundaryKind kind = domain.sides[axis][side].kind;
        exists = exists && kind != BoundaryKind::open;
        if (kind == BoundaryKind::periodic) {
          copy.position[axis] += side == 0 ? -length : length;
          continue;
        }
        copy.mirrored = true;
        copy.position[axis] = 2 * plane - copy.position[axis];
        copy.reflection[axis] *= -1;
        if (kind == BoundaryKind::free_slip) copy.held[axis] *= -1;
        if (kind == BoundaryKind::no_slip)
          for (double& sign : copy.held) sign *= -1;
      }
      if (exists) visit(copy);
    }
  }
  double q(const Vec3& a, const Vec3& b) const {
    double r2 = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) r2 += (a[axis] - b[axis]) * (a[axis] - b[axis]);
    return std::sqrt(r2) / h;
  }

  // Gives every wall point its values; `shares` of all particles at point g.
  std::vector<double> shares(std::size_t g) const {
    std::vector<double> share(particles.size());
    double sum = 0;
    for (std::size_t j = 0; j < particles.size(); ++j)
      each_copy(particles[j], [&](const Copy& copy) {
        if (copy.mirrored) return;
        const double w = WendlandC2::w(q(walls[g].position, copy.position));
        share[j] += w;
        sum += w;
      });
    for (double& one : share) one = sum > 0 ? one / sum : 0;
    return share;
  }
  void fill_walls() {
    for (std::size_t g = 0; g < walls.size(); ++g) {
      WallSumPoint& wall = walls[g];
      const Vec3 surface = wall.surface = wall.velocity;
      const std::vector<double> share = shares(g);
      Vec3 u{};
      wall.volume = wall.pressure = wall.density = 0;
      double sum = 0;
      for (std::size_t j = 0; j < particles.size(); ++j) {
        wall.volume += share[j] * particles[j].volume;
        wall.density += share[j] * particles[j].density;
        wall.pressure += share[j] * particles[j].pressure;
        for (std::size_t axis = 0; axis < 3; ++axis) u[axis] += share[j] * particles[j].velocity[axis];
        each_copy(particles[j], [&](const Copy& copy) {
          if (!copy.mirrored) sum += WendlandC2::w(q(wall.position, copy.position));
        });
      }
      for (std::size_t j = 0; j < particles.size(); ++j)
        each_copy(particles[j], [&](const Copy& copy) {
          if (copy.mirrored || !(sum > 0)) return;
          const double w = WendlandC2::w(q(wall.position, copy.position)) / sum;
          for (std::size_t axis = 0; axis < 3; ++axis)
            wall.pressure += w * particles[j].density * (gravity[axis] - wall.acceleration[axis]) *
                             (wall.position[axis] - copy.position[axis]);
        });
      double across = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) across += (u[axis] - surface[axis]) * wall.normal[axis];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        wall.velocity[axis] = u[axis] - 2 * across * wall.normal[axis];
        wall.held[axis] = wall.no_slip ? 2 * surface[axis] - u[axis] : wall.velocity[axis];
      }
    }
  }

  // Of one particle, and the sum of the moduli of its terms, each with the largest kernel gradient.
  struct Sums {
    double rate = 0, diffusion = 0;
    Vec3 viscous{}, pressure{};
    double rate_modulus = 0, diffusion_modulus = 0, viscous_modulus = 0, pressure_modulus = 0, count = 0;
  };
  // What one pair adds; `body_pressure`, `body_viscous`: what it takes from a body, per volume of the particle.
  void add_pair(const WallSumPoint& own, const WallSumPoint& other, const Copy& copy, Sums& s, Vec3& pressure,
                Vec3& viscous) const {
    const double ratio = q(own.position, copy.position);
    if (ratio >= 2) return;
    const double scale = particle_volume * WendlandC2::normalisation(domain.dimensions) /
                         std::pow(h, domain.dimensions + 2) * other.volume;
    const double g = -scale * WendlandC2::f(ratio), most = -scale * WendlandC2::f(0.0);
    const bool wall = other.body >= 0;
    double approach = 0, modulus = 0, distance = 0, p = other.pressure, out_of_pair = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double d = copy.position[axis] - own.position[axis];
      const double u = copy.reflection[axis] * (wall && adjoint ? other.surface : other.velocity)[axis];
      approach += (u - own.velocity[axis]) * d;
      modulus += (std::abs(u) + std::abs(own.velocity[axis])) * std::abs(d);
      distance += std::abs(d);
      p += (other.density * gravity[axis] - left_out[axis]) * (copy.position[axis] - other.position[axis]);
      out_of_pair += left_out[axis] * d;
    }
    const double kappa = wall ? 0 : (other.density - own.density) / (own.density + other.density);
    const double share = weighted ? kappa : 0;
    ++s.count;
    s.rate -= g * (1 + share) * approach;
    s.rate_modulus += most * (1 + std::abs(share)) * modulus;
    if (!wall && own.phase == other.phase) {
      s.diffusion += 2 * g * (other.excess - own.excess);
      s.diffusion_modulus += 2 * most * (std::abs(other.excess) + std::abs(own.excess));
    }
    const double both = own.viscosity + other.viscosity;
    const double mu = wall ? own.viscosity : both > 0 ? 2 * own.viscosity * other.viscosity / both : 0;
    const double of_both = own.pressure + p + share * (own.pressure - p - out_of_pair);
    const double total = of_both + repulsion * std::abs(kappa) * std::abs(of_both);
    s.pressure_modulus += most * (1 + std::abs(share)) *
                          (std::abs(own.pressure) + std::abs(p) + std::abs(out_of_pair)) * (1 + repulsion) * distance;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double u = copy.held[axis] * (wall ? other.held : other.velocity)[axis];
      viscous[axis] = 2 * g * mu * (u - own.velocity[axis]);
      s.viscous[axis] += viscous[axis];
      s.viscous_modulus += 2 * most * mu * (std::abs(u) + std::abs(own.velocity[axis]));
      pressure[axis] = -g * total * (copy.position[axis] - own.position[axis]);
      s.pressure[axis] += pressure[axis];
    }
  }
  // Q_g v_g: the flow into wall point g from all particles that see it or an image of it.
  double flow(std::size_t g) const { return flow_terms(g, false); }
  double flow_modulus(std::size_t g) const { return flow_terms(g, true); }
  double flow_terms(std::size_t g, bool moduli) const {
    double sum = 0;
    for (const WallSumPoint& particle : particles)
      each_copy(walls[g], [&](const Copy& copy) {
        const double ratio = q(particle.position, copy.position);
        if (ratio >= 2) return;
        double along = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double term = (particle.velocity[axis] - copy.reflection[axis] * walls[g].surface[axis]) *
                              (copy.position[axis] - particle.position[axis]);
          along += moduli ? std::abs(term) : term;
        }
        sum -= particle.volume * particle_volume * WendlandC2::normalisation(domain.dimensions) /
               std::pow(h, domain.dimensions + 2) * WendlandC2::f(moduli ? 0.0 : ratio) * along;
      });
    return walls[g].volume * sum;
  }
  Sums sums(std::size_t i) const {
    Sums s;
    Vec3 pressure{}, viscous{};
    for (const auto* points : {&particles, &walls})
      for (std::size_t j = 0; j < points->size(); ++j) {
        const WallSumPoint& other = (*points)[j];
        each_copy(other, [&](const Copy& copy) {
          if (&other == &particles[i] && copy.position == particles[i].position) return;
          add_pair(particles[i], other, copy, s, pressure, viscous);
        });
      }
    return s;
  }
  // On a body: what its points and their images take from the liquid; images give it back reflected.
  struct Force {
    Vec3 pressure{}, viscous{};
    double torque = 0;  // of the pressure, about the last axis
    double modulus = 0, viscous_modulus = 0, count = 0;
  };
  Force force(int body) const {
    Force sum;
    for (const WallSumPoint& own : particles)
      for (const WallSumPoint& wall : walls) {
        if (wall.body != body) continue;
        each_copy(wall, [&](const Copy& copy) {
          Sums s;
          Vec3 pressure{}, viscous{}, back{};
          add_pair(own, wall, copy, s, pressure, viscous);
          const double volume = particle_volume * own.volume;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            back[axis] = -volume * copy.reflection[axis] * pressure[axis];
            sum.pressure[axis] += back[axis];
            sum.viscous[axis] -= volume * copy.held[axis] * viscous[axis];
          }
          sum.torque += wall.position[0] * back[1] - wall.position[1] * back[0];
          sum.modulus += volume * s.pressure_modulus;
          sum.viscous_modulus += volume * s.viscous_modulus;
          sum.count += s.count;
        });
      }
    return sum;
  }
};

}  // namespace spume::reference
