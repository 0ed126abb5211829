// SPDX-License-Identifier: MIT
// The slow twin of the interpolation stencil: all particles tried, weights from a dense least-squares problem.
#pragma once

#include <array>
#include <vector>

#include "operators/jittered_particles.hpp"

namespace spume::test {

struct DirectStencil {
  std::vector<std::size_t> particle;
  std::vector<std::array<double, 3>> offset;  // from the point to the nearest image of the particle
  std::vector<double> weight;
};

// The weights that minimise sum w^2 / W among those that satisfy the cubic consistency conditions, in the periodic
// unit box: with w = sqrt(W) v, the shortest v with (sqrt(W) P)^T v = e_0. The normal equations that the program solves
// do not appear.
DirectStencil direct_stencil(const JitteredParticles& particles, const std::array<double, 3>& x, double support_radius);

}  // namespace spume::test
