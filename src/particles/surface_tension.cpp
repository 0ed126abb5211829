// SPDX-License-Identifier: MIT
#include "spume/particles/surface_tension.hpp"

#include "spume/core/parallel.hpp"
#include "spume/operators/gfd_moments.hpp"
#include "spume/operators/interface_filters.hpp"
#include "spume/operators/wcsph_sums.hpp"

namespace spume {

SurfaceTension::SurfaceTension(const Scene& scene, int smoothing)
    : colours_(scene.surface_tension > 0 ? colours_of(scene) : std::vector<Colour>()),
      phases_(scene.phases.size()),
      smoothing_(smoothing) {}

void SurfaceTension::find_bands(const Arrangement& arrangement, const Array<std::int64_t>& phase) {
  phase_.resize(phase.size());
  parallel_for(phase.size(), [&](std::size_t i) { phase_[i] = static_cast<std::uint8_t>(phase[i]); });
  bands_.build(arrangement.context, arrangement.grid, arrangement.table, phase_);
}

void SurfaceTension::find_potentials(const Now& now) {
  const SweepContext& context = now.arrangement.context;
  ScratchPool& scratch = now.particles.scratch();
  const std::size_t n = now.particles.size();
  std::vector<float*> values(phases_, nullptr);
  for (Colour& colour : colours_) {
    colour.value.resize(n);
    values[colour.phase] = colour.value.data();
  }
  filter_colours(context, now.arrangement.packed, bands_, phase_, values);
  std::array<Array<float>, 6> correction;
  scratch.lease(correction, context.dimensions * (context.dimensions + 1) / 2, n);
  gfd_moment_subset(context, now.arrangement.packed, bands_.varying(), {.correction = write(correction)});
  for (Colour& colour : colours_) {
    InterfaceMeasure measure({.arrangement = now.arrangement,
                              .bands = bands_,
                              .resolution = now.resolution,
                              .particle_volume = now.particles.volume,
                              .reflection = now.reflection,
                              .correction = read(correction),
                              .scratch = scratch,
                              .smoothing = smoothing_},
                             colour, true);
    measure.add_tension();
    const auto mean = static_cast<float>(colour.mean_potential);
    parallel_for(n, [&](std::size_t i) { colour.potential[i] += mean; });
  }
  scratch.release(correction);
}

void SurfaceTension::add_force(const Now& now, const std::array<float*, 3>& force) const {
  const std::size_t n = now.particles.size();
  ScratchArray<float> sharp(now.particles.scratch(), n);
  for (const Colour& colour : colours_) {
    parallel_for(n, [&](std::size_t i) { sharp[i] = phase_[i] == colour.phase ? 1.0F : 0.0F; });
    tension_force_sweep(now.arrangement.context, now.arrangement.packed, bands_,
                        {.volume = now.volume, .colour = sharp.data(), .potential = colour.potential.data()}, force);
  }
}

double SurfaceTension::mean_jump(std::size_t phase) const {
  double sum = 0;
  for (const Colour& colour : colours_)
    if (colour.phase == phase) sum += colour.mean_potential;
  return sum;
}

double SurfaceTension::bytes() const {
  double sum = phase_.bytes() + bands_.bytes();
  for (const Colour& colour : colours_) sum += colour.value.bytes() + colour.potential.bytes();
  return sum;
}

}  // namespace spume
