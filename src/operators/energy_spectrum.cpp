// SPDX-License-Identifier: MIT
#include "spume/operators/energy_spectrum.hpp"

#include <cmath>
#include <string>

#include "spume/core/array.hpp"
#include "spume/core/error.hpp"

namespace spume {

ParticleSpectrum energy_spectrum(const ParticleSpectrumInput& particles) {
  if (!(particles.spacing > 0))
    throw InputError("an energy spectrum was asked for with a particle spacing of " +
                     std::to_string(particles.spacing) + "; expected a positive number");
  if (particles.dimensions != 2 && particles.dimensions != 3)
    throw InputError("an energy spectrum was asked for in " + std::to_string(particles.dimensions) +
                     " dimensions; expected 2 or 3");
  const auto components = static_cast<std::size_t>(particles.dimensions);
  UniformGrid grid{particles.dimensions, particles.lower, particles.upper, {1, 1, 1}};
  for (int axis = 0; axis < particles.dimensions; ++axis) {
    const double natural = std::round(grid.length(axis) / particles.spacing);
    grid.points[axis] = particles.points[axis] > 0 ? particles.points[axis]
                                                   : static_cast<std::size_t>(std::fmin(std::fmax(natural, 1), 1e6));
  }
  require_valid(grid);

  std::array<const double*, 3> fields{};
  std::array<Array<double>, 3> velocity;
  std::array<double*, 3> values{};
  for (std::size_t d = 0; d < components; ++d) {
    if (particles.velocity[d].size() != particles.position[0].size())
      throw InputError("an energy spectrum was asked for with " + std::to_string(particles.position[0].size()) +
                       " particles and " + std::to_string(particles.velocity[d].size()) +
                       " velocities; expected equal numbers");
    fields[d] = particles.velocity[d].data();
    velocity[d].resize(grid.size());
    values[d] = velocity[d].data();
  }
  const GridInterpolationInput input{
      particles.position, {fields.data(), components}, particles.spacing, {true, true, true}};
  ParticleSpectrum result;
  result.interpolation = interpolate_to_grid(grid, input, {values.data(), components});
  const std::array<const double*, 3> grid_velocity{values[0], values[1], values[2]};
  result.spectrum = energy_spectrum(grid, {grid_velocity.data(), components});
  return result;
}

}  // namespace spume
