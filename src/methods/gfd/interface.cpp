// SPDX-License-Identifier: MIT
// The arrangement of a step and its interfaces: colours, filtered properties, potentials.
#include <algorithm>

#include "spume/core/parallel.hpp"
#include "spume/methods/gfd/flow.hpp"
#include "spume/operators/gfd_gradient.hpp"
#include "spume/operators/interface_filters.hpp"
#include "spume/operators/mass_exchange.hpp"
#include "spume/particles/number_density.hpp"
#include "spume/particles/packing.hpp"

namespace spume::gfd {

void Flow::pack() {
  if (packed != 0) return;
  const bool layered = features.interfaces && features.gravity;
  pack_beside_bodies(arrangement, particles, boundary, resolution, particles.position, false, time,
                     layered ? phase_number : nullptr, left_out());
  packed = 1;
}

// At the positions of the start of the step: walls with a normal velocity stand there too, and have the velocity of its
// end, which the new velocities must meet. Bodies have that of the start: what they gain is a pressure behind them.
void Flow::make_images(double dt) {
  boundary.next_walls = boundary.walls;
  const double end = time + dt, before = features.displaced_bodies ? time : end;
  boundary.make_images(arrangement, particles, particles.position, sizes.largest_length_ratio, {time, before, end});
}

void Flow::find_neighbours(double dt) {
  arrangement.find_neighbours(particles, particles.position, sizes);
  displacement = dt > 0 ? displacement_fraction(arrangement, particles, resolution, dt) : 0;
  phase.resize(size());
  parallel_for(size(), [&](std::size_t i) { phase[i] = static_cast<std::uint8_t>((*phase_number)[i]); });
}

void Flow::find_layers(double dt) {
  layers->find(arrangement, particles, phase, boundary.bodies() == nullptr ? nullptr : boundary.bodies()->thin(), dt);
}

void Flow::measure_stencils() {
  GfdMoments out;
  for (std::size_t k = 0; k < 6; ++k) out.correction[k] = correction[k] == nullptr ? nullptr : correction[k]->data();
  out.offset = write(offset);
  out.laplacian_factor = laplacian_factor->data();
  moments.lease(particles);
  out.kernel_sum = moments.kernel_sum.data();
  out.concentration_gradient = write(moments.concentration_gradient);
  out.spacing = spacing();
  gfd_moment_sweep(arrangement.context, arrangement.packed, out);
  const double bulk = resolution.lattice.kernel_sum;
  double total = 0;
  for (std::size_t n = 0; n < phase_volume.size(); ++n) {
    phase_volume[n] = parallel_sum(size(), [&](std::size_t i) {
      return phase[i] == n && moments.kernel_sum[i] > 0 && in_domain(i) ? bulk / moments.kernel_sum[i] : 0.0;
    });
    total += phase_volume[n];
  }
  // The phases fill the domain: what disorder does to the sums of all of them, 0.1 %, says nothing of their volumes.
  std::size_t inside = features.openings ? 0 : size();
  for (std::size_t n = 0; n < phase_volume.size() && features.openings; ++n) inside += particles_of(n);
  for (double& volume : phase_volume) volume *= particles.volume * static_cast<double>(inside) / total;
  if (steps == 0) first_volume = phase_volume;
}

void Flow::find_bands() {
  bands.build(arrangement.context, arrangement.grid, arrangement.table, phase);
}

void Flow::blend_properties() {
  filter_properties();
  if (arrangement.context.image_pressure == nullptr) return;
  const std::span<double> behind = boundary.image_pressure();  // of unit density
  parallel_for(behind.size(), [&](std::size_t k) {
    behind[k] *= (*density)[static_cast<std::size_t>(arrangement.images.source()[k])];
  });
}

void Flow::filter_properties() {
  const std::size_t n = size();
  if (!features.interfaces) {
    parallel_for(n, [&](std::size_t i) {
      (*density)[i] = static_cast<float>(densities[0]);
      if (viscosity != nullptr) (*viscosity)[i] = static_cast<float>(viscosities[0]);
    });
    return;
  }
  std::vector<Array<float>> first(colours.size() < densities.size() ? 1 : 0);
  std::vector<float*> out;
  for (Array<float>& colour : first) {
    particles.scratch().lease(colour, n);
    out.push_back(colour.data());
  }
  for (Colour& colour : colours) {
    colour.value.resize(n);
    out.push_back(colour.value.data());
  }
  filter_colours(arrangement.context, arrangement.packed, bands, phase, out);
  const std::vector<const float*> in(out.begin(), out.end());
  blend_property(bands, phase, in, densities, *density);
  if (viscosity != nullptr) blend_viscosity(in);
  for (Array<float>& colour : first) particles.scratch().release(colour);
}

// Across layers in shear the stress is continuous and resistances add up: the harmonic mean keeps the integral of 1 /
// mu of the sharp interface, where the arithmetic one of (7) makes the thinner fluid narrower by a part of the support.
void Flow::blend_viscosity(std::span<const float* const> colour) {
  const bool harmonic = options.get<MomentumOptions>().viscosity_mean == ViscosityMean::harmonic &&
                        std::none_of(viscosities.begin(), viscosities.end(), [](double mu) { return mu == 0; });
  if (!harmonic) return blend_property(bands, phase, colour, viscosities, *viscosity);
  std::vector<double> fluidity;
  for (const double mu : viscosities) fluidity.push_back(1 / mu);
  blend_property(bands, phase, colour, fluidity, *viscosity);
  parallel_for(size(), [&](std::size_t i) { (*viscosity)[i] = 1 / (*viscosity)[i]; });
}

// At the start from the sharp densities: the velocities that the case gives then have the momentum of the sharp phases.
// Without, a drop 100 times as dense as the wind around it begins with a fifth more than that.
void Flow::exchange_first_mass() {
  if (steps > 0) return;
  exchange_mass();
  keep_exchange();
}

// Mirrors at no-slip walls have the velocity of what they mirror: mass comes from there, not from the wall.
void Flow::exchange_mass() {
  ScratchPool& scratch = particles.scratch();
  ScratchArray<float> gain(scratch, size());
  parallel_for(size(), [&](std::size_t i) { gain[i] = in_domain(i) ? (*density)[i] - (*last_density)[i] : 0.0F; });
  FloatVectorScratch change;
  scratch.lease(change, dimensions, size());
  mass_exchange_sweep(arrangement.context, arrangement.packed, bands,
                      {gain.data(), density->data(), read(particles.velocity)}, boundary.volume_rule(), write(change));
  exchanged.resize(bands.varying().size());
  parallel_for(exchanged.size(), [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(bands.varying()[s]);
    exchanged[s] = {i, vector_at(particles.velocity, dimensions, i)};
    for (int axis = 0; axis < dimensions; ++axis) (*particles.velocity[axis])[i] += change[axis][i];
  });
  scratch.release(change);
}

// What enters has its filtered density and the velocity that is given. With the sharp density until then a jet from a
// slot is held back by the water beside it, and its pressure keeps the neck of the bubble open: 0.28 of a slot of 0.4
// at ten spacings across, where it closes to 0.10 (bubble_departure).
void Flow::keep_exchange() {
  exchanged.clear();
  if (features.density_jump) parallel_for(size(), [&](std::size_t i) { (*last_density)[i] = (*density)[i]; });
}

void Flow::undo_exchange() {
  for (const auto& [i, velocity] : exchanged)
    for (int axis = 0; axis < dimensions; ++axis) (*particles.velocity[axis])[i] = velocity[axis];
  exchanged.clear();
}

void Flow::find_potentials() {
  for (Colour& colour : colours) find_potential(colour);
}

void Flow::find_potential(Colour& colour) {
  InterfaceMeasure measure({.arrangement = arrangement,
                            .bands = bands,
                            .resolution = resolution,
                            .particle_volume = particles.volume,
                            .reflection = boundary.reflection(),
                            .correction = stencils().correction,
                            .scratch = particles.scratch(),
                            .smoothing = options.get<InterfaceOptions>().smoothing,
                            .left_out = left_out()},
                           colour, features.tension);
  if (features.tension) measure.add_tension();
  if (!features.gravity || colour.density_jump == 0) return;
  Vec3 across_sides{};
  for (int axis = 0; axis < dimensions; ++axis)
    if (!scene.domain.periodic(axis)) across_sides[axis] = scene.fluid.gravity[axis];
  measure.add_weight(across_sides, [&](std::size_t i) { return gravity_potential(i); });
}

// (18), of the filtered viscosity itself: the same for two phases, and right for more.
void Flow::find_viscosity_gradient() {
  particles.scratch().lease(viscosity_gradient, dimensions, size());
  gfd_gradient_over_density_subset(arrangement.context, arrangement.packed, viscosity->data(), density->data(),
                                   stencils().correction, bands.varying(), write(viscosity_gradient));
}

}  // namespace spume::gfd
