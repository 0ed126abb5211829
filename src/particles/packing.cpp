// SPDX-License-Identifier: MIT
#include "spume/particles/packing.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

constexpr double packed_layers = 4;     // spacings from a body: the support radius, and where it fades into the lattice
constexpr double coefficient = 0.25;    // of the move: King (3.12)
constexpr double longest_move = 0.1;    // spacings a round
constexpr double still_enough = 0.005;  // spacings: rounds end when nothing moves farther
constexpr int most_rounds = 60;
// Of the kernel sum of a lattice: half a layer less than full beside a surface. Less is a free surface.
constexpr double full_share = 0.9;

}  // namespace

void pack_beside_bodies(Arrangement& arrangement, ParticleStore& particles, Boundary& boundary,
                        const Resolution& resolution, const VectorField& at, double t) {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  const BodyWalls& bodies = *boundary.bodies();
  const double reach = packed_layers * resolution.spacing, longest = longest_move * resolution.spacing;
  VectorScratch way;
  particles.scratch().lease(way, d, n);
  for (int round = 0; round < most_rounds; ++round) {
    arrangement.sort(particles, at);
    boundary.make_images(arrangement, particles, at, 1, t);
    arrangement.find_neighbours(particles, at, {});
    const NeighbourList& list = arrangement.list;
    double farthest = 0;
    with_plain_kernel(d, resolution.kernel, [&]<int dimensions, class Kernel>() {
      const double h = resolution.smoothing_length;
      const double value = particles.volume * Kernel::normalisation(dimensions) / std::pow(h, dimensions);
      farthest = parallel_max(n, 0.0, [&](std::size_t i) {
        for (int axis = 0; axis < d; ++axis) way[axis][i] = 0;
        const double distance = bodies.distance(vector_at(at, d, i));
        if (distance >= reach) return 0.0;
        Vec3 gradient{};
        double sum = value * Kernel::w(0.0);
        for (const std::int32_t j : list.of(i)) {
          Vec3 dr{};
          double r2 = 0;
          for (int axis = 0; axis < d; ++axis) {
            dr[axis] = double{list.coordinate(axis)[j]} - double{list.coordinate(axis)[i]};
            r2 += dr[axis] * dr[axis];
          }
          const double q = std::sqrt(r2) / h;
          sum += value * Kernel::w(q);
          for (int axis = 0; axis < d; ++axis) gradient[axis] -= value * Kernel::f(q) * dr[axis];
        }
        if (sum < full_share * resolution.lattice.kernel_sum) return 0.0;
        // Less and less towards the lattice, which stays.
        Vec3 move = multiply(-coefficient * std::min(1.0, 2 * (1 - distance / reach)), gradient);
        const double size = length(move);
        if (size > longest) move = multiply(longest / size, move);
        for (int axis = 0; axis < d; ++axis) way[axis][i] = move[axis];
        return std::min(size, longest);
      });
    });
    parallel_for(n, [&](std::size_t i) {
      Vec3 place = add(vector_at(at, d, i), vector_at(way, d, i));
      boundary.apply_walls(boundary.walls, place, nullptr);
      for (int axis = 0; axis < d; ++axis) {
        (*at[axis])[i] = place[axis];
        (*particles.position[axis])[i] = place[axis];
      }
    });
    if (farthest < still_enough * resolution.spacing) break;
  }
  particles.scratch().release(way);
  arrangement.sort(particles, at);
}

}  // namespace spume
