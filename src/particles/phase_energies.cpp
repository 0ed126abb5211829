// SPDX-License-Identifier: MIT
#include "spume/particles/phase_energies.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/size_bits.hpp"
#include "spume/core/unrolled.hpp"

namespace spume {
namespace {

template <int dimensions>
PhaseEnergies energies_of(const PhaseEnergies::State& state, std::size_t first, std::size_t last) {
  const auto x = read(state.particles.position), u = read(state.particles.velocity);
  const double* const excess = state.excess;
  const std::int64_t* const left_out = state.left_out;
  const Vec3 gravity = state.gravity, gradient = state.reference_gradient, from_there = state.reference_place;
  const double background = state.background;
  const bool referred = background != 0 || gradient != Vec3{};
  const double volume = state.particles.volume;
  double kinetic = 0, potential = 0, compression = 0, reference = 0, speed2 = 0;
  state.law.each_run(first, last, [&](const PhaseLaw& own, std::size_t from, std::size_t to) {
    const double mass = volume * own.density, stiffness = volume * own.stiffness();
    for (std::size_t i = from; i < to; ++i) {
      if (left_out != nullptr && left_out[i] >= 0) continue;
      double square = 0, head = 0;
      unrolled<dimensions>([&](auto axis) {
        square += u[axis][i] * u[axis][i];
        head -= gravity[axis] * x[axis][i];
      });
      kinetic += mass * square / 2;
      potential += mass * head;
      compression += stiffness * own.energy_over_stiffness(excess[i]);
      if (referred) {
        double pressure = -background;
        unrolled<dimensions>([&](auto axis) { pressure += gradient[axis] * (x[axis][i] - from_there[axis]); });
        reference += volume / (1 + excess[i]) * pressure;
      }
      speed2 = larger_or_nan(speed2, square);
    }
  });
  return {kinetic, potential, compression, reference, speed2};
}

}  // namespace

PhaseEnergies phase_energies(const PhaseEnergies::State& state) {
  PhaseEnergies sums = parallel_reduce(
      state.particles.size(), PhaseEnergies{},
      [&](std::size_t first, std::size_t last) {
        return state.particles.dimensions == 2 ? energies_of<2>(state, first, last)
                                               : energies_of<3>(state, first, last);
      },
      [](const PhaseEnergies& a, const PhaseEnergies& b) {
        return PhaseEnergies{a.kinetic + b.kinetic, a.potential + b.potential, a.compression + b.compression,
                             a.reference + b.reference, larger_or_nan(a.largest_speed, b.largest_speed)};
      });
  sums.largest_speed = std::sqrt(sums.largest_speed);
  return sums;
}

double largest_excess(std::size_t phase, const Array<std::int64_t>& phases, const Array<double>& excess,
                      const std::int64_t* left_out) {
  const double* const s = excess.data();
  const std::int64_t* const of = phases.data();
  const auto wanted = static_cast<std::int64_t>(phase);
  const bool all = phases.empty();
  return parallel_reduce(
      excess.size(), 0.0,
      [=](std::size_t first, std::size_t last) {
        std::int64_t most = 0;
        if (left_out == nullptr) {
          for (std::size_t i = first; i < last; ++i)
            most = std::max(most, all || of[i] == wanted ? size_bits(s[i]) : 0);
        } else {
          for (std::size_t i = first; i < last; ++i)
            most = std::max(most, (all || of[i] == wanted) && left_out[i] < 0 ? size_bits(s[i]) : 0);
        }
        return of_size_bits(most);
      },
      larger_or_nan);
}

}  // namespace spume
