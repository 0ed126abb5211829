// SPDX-License-Identifier: MIT
// Layers at rest, at the start.
//
// A lattice is no place to rest on. Under Wendland's kernel of 1.3 spacings rows of a square one that slide by half a
// spacing lower its kernel sums, from 1.0105 to 1.0088 where they are hexagonal: it breaks up within 6 sqrt(H/g), and
// the pressure times that is kinetic energy, 0.05 sqrt(gH), which nothing dissipates without viscosity. Where phases
// meet the slope of the pressure has a kink, which the sums of a lattice miss. So the particles move until the pressure
// of the layers holds each of them, beginning off the lattice: on it they would stay.
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"
#include "spume/core/vectors.hpp"
#include "spume/methods/wcsph/flow.hpp"
#include "spume/operators/sph_operators.hpp"

namespace spume::wcsph {
namespace {

constexpr double off_lattice = 0.2;   // spacings along each axis at most; 0.1 and 0.3 end in the same speeds
constexpr double longest_move = 0.1;  // spacings a round
// Of h^2 grad C, and of the last round's move (the heavy ball of Polyak 1964), which stands eigenvalues of the moves up
// to 2 (1 + kept): with 1 particles below the ceiling never came to rest.
constexpr double coefficient = 0.5, kept = 0.9;
constexpr int even_after = 100;  // rounds: neighbours are evenly spaced, no layer has stretched
constexpr int most_rounds = 4000;

}  // namespace

// Its pressure stays that of the layer at its height.
void Flow::move_at_rest(std::size_t i, const Vec3& way) {
  const Vec3 before = vector_at(particles.position, dimensions, i), free = add(before, way);
  Vec3 r = free;
  boundary.apply_walls(boundary.walls, r, nullptr);
  double head = 0;
  for (int axis = 0; axis < dimensions; ++axis) {
    // Particles go round periodic sides when lists are made.
    if (scene.domain.periodic(axis)) r[axis] = free[axis];
    head += wall_gravity[axis] * (r[axis] - before[axis]);
    (*particles.position[axis])[i] = r[axis];
  }
  (*excess)[i] = law(i).excess(law(i).pressure((*excess)[i]) + law(i).density * head);
}

// `way` is that of the last round, by identifier, as the order of the particles changes. Returns the largest
// acceleration over that of gravity.
double Flow::step_towards_rest(VectorScratch& way) {
  keep_lists(0);
  drift(0);
  lease_properties();
  particles.scratch().lease(pressure, size());
  parallel_for(size(), [&](std::size_t i) { pressure[i] = law(i).pressure((*excess)[i]) + background; });
  find_pressure_force();
  const double g = length(wall_gravity), h = resolution.smoothing_length, longest = longest_move * scene.spacing;
  const double worst = parallel_max(size(), 0.0, [&](std::size_t i) {
    const auto id = static_cast<std::size_t>((*particles.identifier)[i]);
    const double rho = law(i).density;
    const Vec3 force = add(vector_at(pressure_force, dimensions, i), multiply(rho, wall_gravity));
    // The force of a move by h^2 grad C, under the largest pressure of a pair: over the support gravity adds 2 h g rho.
    const double of_move = 2 * (std::max(pressure[i], 0.0) + h * g * rho);
    Vec3 move = add(multiply(kept, vector_at(way, dimensions, id)), multiply(coefficient * h * h / of_move, force));
    if (const double size = length(move); size > longest) move = multiply(longest / size, move);
    for (int axis = 0; axis < dimensions; ++axis) way[axis][id] = move[axis];
    return length(force) / (rho * g);
  });
  release_leased();
  return worst;
}

// Sums of the kernel gradient are exact for linear fields on average. With the factor of the lattice the pressure holds
// layers that are 0.2 % larger.
void Flow::fit_gradient_scale() {
  ScratchArray<float> divergence_of_position(particles.scratch(), size());
  KernelMoments moments;
  moments.divergence_of_position = divergence_of_position.data();
  kernel_moment_sweep(arrangement.context, arrangement.packed,
                      {.shifting = false, .normals = false, .spacing = scene.spacing, .fading = {}}, moments);
  const double sum = parallel_sum(size(), [&](std::size_t i) { return double{divergence_of_position[i]}; });
  arrangement.context.gradient_scale *= dimensions * static_cast<double>(size()) / sum;
}

// The datum of a closed tank is free. Below zero pressure pulls particles to the ceiling: where rows of the lattice do
// not end on it, all pressures rise until that of the highest row is the weight of half a row.
void Flow::raise_datum() {
  double lightest = INFINITY;
  for (const PhaseLaw& one : laws) lightest = std::min(lightest, one.density);
  const double wanted = lightest * length(wall_gravity) * scene.spacing / 2;
  const double rise = parallel_max(size(), 0.0, [&](std::size_t i) { return wanted - law(i).pressure((*excess)[i]); });
  parallel_for(size(), [&](std::size_t i) { (*excess)[i] = law(i).excess(law(i).pressure((*excess)[i]) + rise); });
}

void Flow::settle() {
  if (settled != 0) return;
  settled = 1;
  raise_datum();
  VectorScratch way;
  particles.scratch().lease(way, dimensions, size());
  for (int axis = 0; axis < dimensions; ++axis) way[axis].fill(0.0);
  parallel_for(size(), [&](std::size_t i) {
    // Step 1: the jitter of the scene has step 0.
    const auto random = random_uniform(scene.seed, RandomPurpose::initial_jitter,
                                       static_cast<std::uint64_t>((*particles.identifier)[i]), 1, 0);
    Vec3 aside{};
    for (int axis = 0; axis < dimensions; ++axis) aside[axis] = off_lattice * scene.spacing * (2 * random[axis] - 1);
    move_at_rest(i, aside);
  });
  for (int round = 0; round < most_rounds && (unsettled = step_towards_rest(way)) > layers_at_rest; ++round) {
    if (round == even_after) fit_gradient_scale();
    parallel_for(size(), [&](std::size_t i) {
      move_at_rest(i, vector_at(way, dimensions, static_cast<std::size_t>((*particles.identifier)[i])));
    });
  }
  particles.scratch().release(way);
}

}  // namespace spume::wcsph
