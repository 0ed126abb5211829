// SPDX-License-Identifier: MIT
#include "spume/particles/layer_settling.hpp"

#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"
#include "spume/core/vectors.hpp"
#include "spume/operators/sph_operators.hpp"

namespace spume {
namespace {

constexpr double off_lattice = 0.2;            // spacings along each axis at most; 0.1 and 0.3 end in the same speeds
constexpr double longest_settling_move = 0.1;  // spacings a round
// Of h^2 grad C, and of the last round's move (the heavy ball of Polyak 1964), which stands eigenvalues of the moves up
// to 2 (1 + kept_of_move): with 1 particles below the ceiling never came to rest.
constexpr double settling_coefficient = 0.5, kept_of_move = 0.9;
constexpr int even_after = 100;  // rounds: neighbours are evenly spaced, no layer has stretched
constexpr int most_settling_rounds = 4000;

}  // namespace

// Its pressure stays that of the layer at its height.
void LayerSettling::move(std::size_t i, const Vec3& way) const {
  const int dimensions = particles.dimensions;
  const Vec3 before = vector_at(particles.position, dimensions, i), free = add(before, way);
  Vec3 r = free;
  boundary.apply_walls(boundary.walls, r, nullptr);
  double head = 0;
  for (int axis = 0; axis < dimensions; ++axis) {
    // Particles go round periodic sides when lists are made.
    if (scene.domain.periodic(axis)) r[axis] = free[axis];
    head += gravity[axis] * (r[axis] - before[axis]);
    (*particles.position[axis])[i] = r[axis];
  }
  excess[i] = law(i).excess(law(i).pressure(excess[i]) + law(i).density * head);
}

// `way` is that of the last round, by identifier, as the order of the particles changes. Returns the largest
// acceleration over that of gravity.
double LayerSettling::step(VectorScratch& way) const {
  const int dimensions = particles.dimensions;
  const double g = length(gravity), h = resolution.smoothing_length,
               longest = longest_settling_move * resolution.spacing;
  double worst = 0;
  with_forces([&](const Forces& now) {
    worst = parallel_max(particles.size(), 0.0, [&](std::size_t i) {
      const auto id = static_cast<std::size_t>((*particles.identifier)[i]);
      const double rho = law(i).density;
      const Vec3 force = add(vector_at(now.force, dimensions, i), multiply(rho, gravity));
      // The force of a move by h^2 grad C, under the largest pressure of a pair: over the support gravity adds 2 h g
      // rho.
      const double of_move = 2 * (std::max(double{now.pressure[i]}, 0.0) + h * g * rho);
      Vec3 next = add(multiply(kept_of_move, vector_at(way, dimensions, id)),
                      multiply(settling_coefficient * h * h / of_move, force));
      if (const double size = length(next); size > longest) next = multiply(longest / size, next);
      for (int axis = 0; axis < dimensions; ++axis) way[axis][id] = next[axis];
      return length(force) / (rho * g);
    });
  });
  return worst;
}

// Sums of the kernel gradient are exact for linear fields on average. With the factor of the lattice the pressure holds
// layers that are 0.2 % larger.
void LayerSettling::fit_gradient_scale() const {
  ScratchArray<float> divergence_of_position(particles.scratch(), particles.size());
  KernelMoments moments;
  moments.divergence_of_position = divergence_of_position.data();
  kernel_moment_sweep(arrangement.context, arrangement.packed,
                      {.shifting = false, .normals = false, .spacing = resolution.spacing, .fading = {}}, moments);
  const double sum = parallel_sum(particles.size(), [&](std::size_t i) { return double{divergence_of_position[i]}; });
  arrangement.context.gradient_scale *= particles.dimensions * static_cast<double>(particles.size()) / sum;
}

// The datum of a closed tank is free. Below zero pressure pulls particles to the ceiling: where rows of the lattice do
// not end on it, all pressures rise until that of the highest row is the weight of half a row.
void LayerSettling::raise_datum() const {
  double lightest = INFINITY;
  for (const Phase& phase : scene.phases) lightest = std::min(lightest, phase.density);
  const double wanted = lightest * length(gravity) * resolution.spacing / 2;
  const double rise =
      parallel_max(particles.size(), 0.0, [&](std::size_t i) { return wanted - law(i).pressure(excess[i]); });
  parallel_for(particles.size(), [&](std::size_t i) { excess[i] = law(i).excess(law(i).pressure(excess[i]) + rise); });
}

double LayerSettling::settle() const {
  raise_datum();
  VectorScratch way;
  particles.scratch().lease(way, particles.dimensions, particles.size());
  for (int axis = 0; axis < particles.dimensions; ++axis) way[axis].fill(0.0);
  parallel_for(particles.size(), [&](std::size_t i) {
    // Step 1: the jitter of the scene has step 0.
    const auto random = random_uniform(scene.seed, RandomPurpose::initial_jitter,
                                       static_cast<std::uint64_t>((*particles.identifier)[i]), 1, 0);
    Vec3 aside{};
    for (int axis = 0; axis < particles.dimensions; ++axis)
      aside[axis] = off_lattice * resolution.spacing * (2 * random[axis] - 1);
    move(i, aside);
  });
  double left = 0;
  for (int round = 0; round < most_settling_rounds && (left = step(way)) > at_rest; ++round) {
    if (round == even_after) fit_gradient_scale();
    parallel_for(particles.size(), [&](std::size_t i) {
      move(i, vector_at(way, particles.dimensions, static_cast<std::size_t>((*particles.identifier)[i])));
    });
  }
  particles.scratch().release(way);
  return left;
}

}  // namespace spume
