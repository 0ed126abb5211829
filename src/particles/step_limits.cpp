// SPDX-License-Identifier: MIT
#include "spume/particles/step_limits.hpp"

#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/size_bits.hpp"
#include "spume/particles/blocks.hpp"

namespace spume {

namespace {

// |u|^2 of those that bound a step, of all particles and without spray.
struct Squares {
  double largest = 0, limiting = 0;
};

Squares largest_of_both(const Squares& a, const Squares& b) {
  return {larger_or_nan(a.largest, b.largest), larger_or_nan(a.limiting, b.limiting)};
}

}  // namespace

Speeds find_speeds(const Arrangement& arrangement, const ParticleStore& particles) {
  const int d = particles.dimensions, spray = spray_neighbours(d);
  const bool listed = arrangement.list.particles() == particles.size();
  const auto u = read(particles.velocity);
  const Squares squares = parallel_reduce(
      particles.size(), Squares{},
      [&](std::size_t first, std::size_t last) {
        Squares so_far;
        ParticleBlock speed2;
        each_block(first, last, [&](std::size_t from, std::size_t to) {
          Squares block;
          block.limiting = block.largest = largest_square(
              d, from, to, speed2, [&](int axis) { return [u = u[axis]](std::size_t i) { return u[i]; }; });
          if (listed) {
            const std::int32_t* const counts = arrangement.list.counts() + from;
            for (std::size_t k = 0; k < to - from; ++k) speed2[k] = counts[k] < spray ? 0 : speed2[k];
            block.limiting = largest_size(speed2.data(), 0, to - from);
          }
          so_far = largest_of_both(so_far, block);
        });
        return so_far;
      },
      largest_of_both);
  return {.largest = std::sqrt(squares.largest), .limiting = std::sqrt(squares.limiting)};
}

void refuse_long_strides(const ParticleStore& particles, const VectorField& at, const VectorScratch& velocity,
                         double support_radius, double dt) {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  const auto u = read(velocity);
  const double fastest = std::sqrt(parallel_reduce(
      n, 0.0,
      [&](std::size_t first, std::size_t last) {
        double so_far = 0;
        ParticleBlock speed2;
        each_block(first, last, [&](std::size_t from, std::size_t to) {
          so_far = larger_or_nan(so_far, largest_square(d, from, to, speed2, [&](int axis) {
                                   return [u = u[axis]](std::size_t i) { return u[i]; };
                                 }));
        });
        return so_far;
      },
      larger_or_nan));
  const double limit = 0.5 * support_radius / dt;
  if (fastest <= limit) return;
  StepFailure::Details details;
  blame_first(details, particles, at, [&](std::size_t i) {
    details.value = std::sqrt(squared_norm(velocity, d, i));
    return !(details.value <= limit);
  });
  details.cause = std::isfinite(fastest) ? "a particle would cross half its support in one step"
                                         : "a velocity is not a finite number";
  details.option = "time.courant";
  throw StepFailure(details);
}

void refuse_burst(const ParticleStore& particles, const CompressedState& state, const char* option) {
  constexpr double largest_excess_of_a_flow = 0.5;
  const double largest = parallel_reduce(
      particles.size(), 0.0,
      [&](std::size_t first, std::size_t last) {
        double strongest = 0;
        for (int axis = 0; axis < particles.dimensions; ++axis)
          strongest = larger_or_nan(strongest, double{largest_size(state.force[axis].data(), first, last)});
        return std::isfinite(strongest) ? double{largest_size(state.excess, first, last)} : NAN;
      },
      larger_or_nan);
  if (largest <= largest_excess_of_a_flow) return;
  StepFailure::Details details;
  details.cause =
      std::isfinite(largest) ? "the density has changed by more than half" : "a force is not a finite number";
  details.option = option;
  details.value = largest;
  blame_first(details, particles, state.at, [&](std::size_t i) {
    bool finite = true;
    for (int axis = 0; axis < particles.dimensions; ++axis) finite = finite && std::isfinite(state.force[axis][i]);
    return !(std::abs(state.excess[i]) <= largest_excess_of_a_flow && finite);
  });
  throw StepFailure(details);
}

}  // namespace spume
