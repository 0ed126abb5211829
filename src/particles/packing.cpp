// SPDX-License-Identifier: MIT
#include "spume/particles/packing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

constexpr double packed_layers = 4;  // spacings from a body: the support radius, and where it fades into the lattice
// The same of rows at a level surface, which can give way to the side alone: half a column too many crowds them by 5 %.
constexpr double level_layers = 10;
constexpr double coefficient = 0.25;    // of the move: King (3.12)
constexpr double longest_move = 0.1;    // spacings a round
constexpr double still_enough = 0.005;  // spacings: rounds end when nothing moves farther
constexpr int most_rounds = 200;
constexpr int wet_rounds =
    10;  // which wall points are wet is found once in so many: particles move by a spacing at most
// Of the kernel sum of a lattice: half a layer less than full beside a surface. Less is a free surface, and what stands
// within a support radius and a spacing of it stays: there the surface counts the liquid below it.
constexpr double full_share = 0.9;
constexpr double beyond_support = 1.1;
// Of the squared horizontal part of a normal: below it, a wall at 6 degrees, images along the horizontal are far away.
constexpr double least_aside = 0.01;

// 1 for particles that the height of a free surface depends on.
void find_surface(const Arrangement& arrangement, const ParticleStore& particles, const Resolution& resolution,
                  std::vector<std::uint8_t>& sees_surface) {
  const NeighbourList& list = arrangement.list;
  const std::size_t n = particles.size();
  const auto identifier = [&](std::size_t i) { return static_cast<std::size_t>((*particles.identifier)[i]); };
  const double near2 = std::pow(beyond_support * resolution.spacing, 2);
  const auto distance2 = [&](std::size_t i, std::int32_t j) {
    double r2 = 0;
    for (int axis = 0; axis < particles.dimensions; ++axis)
      r2 += std::pow(double{list.coordinate(axis)[j]} - double{list.coordinate(axis)[i]}, 2);
    return r2;
  };
  std::vector<std::uint8_t> surface(n), seen(n);
  with_plain_kernel(particles.dimensions, resolution.kernel, [&]<int dimensions, class Kernel>() {
    const double h = resolution.smoothing_length;
    const double value = particles.volume * Kernel::normalisation(dimensions) / std::pow(h, dimensions);
    parallel_for(n, [&](std::size_t i) {
      double sum = value * Kernel::w(0.0);
      for (const std::int32_t j : list.of(i)) sum += value * Kernel::w(std::sqrt(distance2(i, j)) / h);
      surface[i] = sum < full_share * resolution.lattice.kernel_sum ? 1 : 0;
    });
  });
  parallel_for(n, [&](std::size_t i) {
    seen[i] = surface[i];
    for (const std::int32_t j : list.of(i)) seen[i] = seen[i] != 0 || surface[arrangement.particle_of(j)] != 0 ? 1 : 0;
  });
  parallel_for(n, [&](std::size_t i) {
    bool sees = seen[i] != 0;
    for (const std::int32_t j : list.of(i))
      sees = sees || (seen[arrangement.particle_of(j)] != 0 && distance2(i, j) < near2);
    sees_surface[identifier(i)] = sees ? 1 : 0;
  });
}

}  // namespace

void pack_beside_bodies(Arrangement& arrangement, ParticleStore& particles, Boundary& boundary,
                        const Resolution& resolution, const VectorField& at, bool free_surface, double t) {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  const BodyWalls& bodies = *boundary.bodies();
  const double longest = longest_move * resolution.spacing;
  std::vector<std::uint8_t> sees_surface(n);  // by identifier: the order changes
  VectorScratch way;
  particles.scratch().lease(way, d, n);
  for (int round = 0; round < most_rounds; ++round) {
    arrangement.sort(particles, at);
    boundary.make_images(arrangement, particles, at, 1, {t, t, t}, round % wet_rounds == 0);
    arrangement.find_neighbours(particles, at, {});
    const NeighbourList& list = arrangement.list;
    const auto particle_count = static_cast<std::int32_t>(n);
    double farthest = 0;
    if (round == 0 && free_surface) find_surface(arrangement, particles, resolution, sees_surface);
    with_plain_kernel(d, resolution.kernel, [&]<int dimensions, class Kernel>() {
      const double h = resolution.smoothing_length;
      const double value = particles.volume * Kernel::normalisation(dimensions) / std::pow(h, dimensions);
      farthest = parallel_max(n, 0.0, [&](std::size_t i) {
        for (int axis = 0; axis < d; ++axis) way[axis][i] = 0;
        const double distance = bodies.distance(vector_at(at, d, i));
        // Wall points beside the surface are there or not as a whole: those that move horizontally see their neighbours
        // mirrored at the wall instead, which spaces the first row evenly.
        const bool horizontally = sees_surface[static_cast<std::size_t>((*particles.identifier)[i])] != 0;
        const double reach = (horizontally ? level_layers : packed_layers) * resolution.spacing;
        if (distance >= reach) return 0.0;
        Vec3 gradient{};
        const auto add_neighbour = [&](const Vec3& dr) {
          const double f = value * Kernel::f(length(dr) / h);
          for (int axis = 0; axis < d; ++axis) gradient[axis] -= f * dr[axis];
        };
        // The liquid continues at its level, mirrored along the horizontal: what lies behind the tangent plane moves by
        // `across` for every length that its mirror image lies before it.
        Vec3 normal{}, across{};
        if (horizontally) {
          normal = bodies.normal(vector_at(at, d, i));
          Vec3 aside = normal;
          aside[d - 1] = 0;
          across = multiply(-2 / std::max(dot(aside, aside), least_aside), aside);
          add_neighbour(multiply(distance, across));
        }
        for (const std::int32_t j : list.of(i)) {
          const bool wall_point = j >= particle_count && arrangement.images.wall_point() != nullptr &&
                                  arrangement.images.wall_point()[j - particle_count] >= 0;
          if (horizontally && wall_point) continue;
          Vec3 dr{};
          for (int axis = 0; axis < d; ++axis)
            dr[axis] = double{list.coordinate(axis)[j]} - double{list.coordinate(axis)[i]};
          add_neighbour(dr);
          const double before = distance + dot(dr, normal);
          if (horizontally && before > 0) add_neighbour(add(dr, multiply(before, across)));
        }
        if (horizontally) gradient[d - 1] = 0;
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
