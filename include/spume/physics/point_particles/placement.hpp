// SPDX-License-Identifier: MIT
// Where particles start, and how large they are.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "spume/physics/point_particles/kinds.hpp"
#include "spume/physics/point_particles/particles.hpp"

namespace spume {

struct PlacementOptions {
  Placement kind = Placement::random;
  int clusters = 8;              // clustered
  double cluster_radius = 0.05;  // standard deviation of a cloud / shortest side of the box
  std::vector<std::array<double, 3>> given;
  std::vector<double> diameters;  // one or more
  std::vector<double> shares;     // of the numbers of each; empty: equal
  std::uint64_t seed = 1;
};

// Sets positions (in the box), diameters and identifiers 0, 1, ... of all particles; velocities are zero. Places and
// sizes depend on (seed, identifier) alone. Throws InputError when a lattice of this many does not fit the box (see
// lattice_counts), when fewer positions are given than particles, or a given position is not finite.
void place_particles(const PlacementOptions& options, const std::array<double, 3>& lower,
                     const std::array<double, 3>& length, Particles& particles);

// Particles per axis of a lattice with equal spacings, as nearly as the count allows; the product is the count only if
// the count suits the box.
std::array<std::size_t, 3> lattice_counts(std::size_t count, const std::array<double, 3>& length);

}  // namespace spume
