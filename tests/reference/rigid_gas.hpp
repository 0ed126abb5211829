// SPDX-License-Identifier: MIT
// Gas exchange of released discs with a liquid of particles, disc by disc and particle by particle: slow twin of
// spume/physics/oxygen/rigid_bubbles.hpp for discs that rise along y at a constant speed, periodic in x.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "spume/core/kernel.hpp"
#include "spume/physics/oxygen/transfer.hpp"

namespace spume::reference {

struct Disc {
  Vec3 centre{}, velocity{};
  double radius = 0;
};

struct RigidGas {
  std::vector<double> change;  // of the concentration of every particle
  double given = 0, conductance = 0;
};

struct Water {
  std::vector<Vec3> position, velocity;
  std::vector<double> dissolved;
  double particle_volume = 0, h = 0, period = 0;
};

// `contents`: of each disc, before.
inline RigidGas rigid_gas(const Water& water, const std::vector<Disc>& discs, const oxygen::Gas& gas,
                          const std::vector<oxygen::Contents>& contents, double dt) {
  RigidGas result{.change = std::vector<double>(water.position.size(), 0.0)};
  for (std::size_t b = 0; b < discs.size(); ++b) {
    const Disc& disc = discs[b];
    std::vector<double> weight(water.position.size());
    double sum = 0, concentration = 0;
    Vec3 mean{};
    for (std::size_t i = 0; i < weight.size(); ++i) {
      double dx = water.position[i][0] - disc.centre[0];
      dx -= water.period * std::round(dx / water.period);
      const double way = std::hypot(dx, water.position[i][1] - disc.centre[1]) - disc.radius;
      const double q = std::max(way, 0.0) / water.h;
      weight[i] = q < WendlandC2::support ? WendlandC2::w(q) : 0;
      sum += weight[i];
      concentration += weight[i] * water.dissolved[i];
      for (std::size_t a = 0; a < 2; ++a) mean[a] += weight[i] * water.velocity[i][a];
    }
    const double slip = std::hypot(disc.velocity[0] - mean[0] / sum, disc.velocity[1] - mean[1] / sum);
    const oxygen::Exchange exchange =
        oxygen::exchange(gas, contents[b], {2 * disc.radius, 2 * std::numbers::pi * disc.radius}, disc.centre[1], slip,
                         concentration / sum, dt);
    result.given += exchange.given;
    result.conductance += exchange.conductance;
    for (std::size_t i = 0; i < weight.size(); ++i)
      result.change[i] += exchange.given * weight[i] / sum / water.particle_volume;
  }
  return result;
}

}  // namespace spume::reference
