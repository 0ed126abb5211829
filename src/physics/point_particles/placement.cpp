// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/placement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/core/random.hpp"

namespace spume {
namespace {

// A number drawn once more in the digits below 2^-32: 2^32 places along an axis would be too few for millions.
std::array<double, 3> fine_uniform(std::uint64_t seed, std::uint64_t identifier, std::uint32_t draw) {
  const auto r = random_uniform(seed, RandomPurpose::initial_position, identifier, 0, draw);
  const auto q = random_uniform(seed, RandomPurpose::initial_position, identifier, 1, draw);
  return {r[0] + q[0] * 0x1p-32, r[1] + q[1] * 0x1p-32, r[2] + q[2] * 0x1p-32};
}

std::array<double, 3> gaussian(std::uint64_t seed, std::uint64_t identifier) {
  const auto r = random_uniform(seed, RandomPurpose::initial_position, identifier, 2, 0);
  const double a = std::sqrt(-2 * std::log(1 - r[0])), b = std::sqrt(-2 * std::log(1 - r[2]));
  return {a * std::cos(2 * M_PI * r[1]), a * std::sin(2 * M_PI * r[1]), b * std::cos(2 * M_PI * r[3])};
}

double drawn_diameter(const PlacementOptions& options, std::uint64_t identifier) {
  if (options.diameters.size() == 1) return options.diameters[0];
  const double total = options.shares.empty() ? static_cast<double>(options.diameters.size())
                                              : std::accumulate(options.shares.begin(), options.shares.end(), 0.0);
  double left = total * random_uniform(options.seed, RandomPurpose::diameter, identifier, 0, 0)[0];
  for (std::size_t d = 0; d + 1 < options.diameters.size(); ++d) {
    left -= options.shares.empty() ? 1.0 : options.shares[d];
    if (left < 0) return options.diameters[d];
  }
  return options.diameters.back();
}

}  // namespace

std::array<std::size_t, 3> lattice_counts(std::size_t count, const std::array<double, 3>& length) {
  const double spacing = std::cbrt(length[0] * length[1] * length[2] / static_cast<double>(count));
  std::array<std::size_t, 3> counts;
  for (int axis = 0; axis < 3; ++axis)
    counts[axis] = static_cast<std::size_t>(std::max(1.0, std::round(length[axis] / spacing)));
  return counts;
}

void place_particles(const PlacementOptions& options, const std::array<double, 3>& lower,
                     const std::array<double, 3>& length, Particles& particles) {
  const std::size_t n = particles.size();
  std::array<std::size_t, 3> counts{};
  if (options.kind == Placement::lattice && n > 0) {
    counts = lattice_counts(n, length);
    const std::size_t fits = counts[0] * counts[1] * counts[2];
    if (fits != n)
      throw InputError("a lattice of " + std::to_string(n) + " particles does not fill the box evenly; " +
                       std::to_string(fits) + " do (" + std::to_string(counts[0]) + " x " + std::to_string(counts[1]) +
                       " x " + std::to_string(counts[2]) + ")");
  }
  if (options.kind == Placement::file) {
    if (options.given.size() < n)
      throw InputError(std::to_string(options.given.size()) + " positions are given for " + std::to_string(n) +
                       " particles");
    for (std::size_t i = 0; i < n; ++i)
      for (const double x : options.given[i])
        if (!std::isfinite(x)) throw InputError("position " + std::to_string(i + 1) + " is not a finite number");
  }
  const double radius = options.cluster_radius * std::min({length[0], length[1], length[2]});
  const auto place = [&](std::size_t i) -> std::array<double, 3> {
    switch (options.kind) {
      case Placement::lattice: {
        const std::size_t column = i / counts[2];
        const std::array<std::size_t, 3> site{column / counts[1], column % counts[1], i % counts[2]};
        std::array<double, 3> r;
        for (std::size_t a = 0; a < 3; ++a)
          r[a] = lower[a] + length[a] * static_cast<double>(site[a]) / static_cast<double>(counts[a]);
        return r;
      }
      case Placement::file:
        return options.given[i];
      case Placement::clustered: {
        // Clouds are numbered beyond all particles, so that their centres share no draw with these.
        const auto cloud = i % static_cast<std::size_t>(std::max(1, options.clusters));
        const auto centre = fine_uniform(options.seed, ~std::uint64_t{0} - cloud, 0);
        const auto offset = gaussian(options.seed, i);
        return {lower[0] + length[0] * centre[0] + radius * offset[0],
                lower[1] + length[1] * centre[1] + radius * offset[1],
                lower[2] + length[2] * centre[2] + radius * offset[2]};
      }
      case Placement::random:
        break;
    }
    const auto r = fine_uniform(options.seed, i, 0);
    return {lower[0] + length[0] * r[0], lower[1] + length[1] * r[1], lower[2] + length[2] * r[2]};
  };
  parallel_for(n, [&](std::size_t i) {
    const auto x = place(i);
    for (int c = 0; c < 3; ++c) {
      (*particles.position[c])[i] = wrap_periodic(x[c], lower[c], length[c]);
      (*particles.velocity[c])[i] = 0;
    }
    (*particles.identifier)[i] = static_cast<std::int64_t>(i);
    if (particles.diameter != nullptr) (*particles.diameter)[i] = drawn_diameter(options, i);
  });
}

}  // namespace spume
