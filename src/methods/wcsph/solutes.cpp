// SPDX-License-Identifier: MIT
// What the liquid carries: seen from where an accepted step has left it, by the lists and images of its end.
#include "spume/core/parallel.hpp"
#include "spume/methods/wcsph/flow.hpp"
#include "spume/particles/surface.hpp"

namespace spume::wcsph {

// What carries values off their particles; the next shift takes its place.
void Flow::keep_shift(double dt) {
  if (!features.scalars || !features.shifting) return;
  particles.scratch().lease(carried_solutes.shift, dimensions, size());
  parallel_for(size(), [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis)
      carried_solutes.shift[axis][i] = static_cast<float>(dt * (*shift[axis])[i]);
  });
}

std::int64_t Flow::transport_scalars(double dt) {
  ScratchPool& scratch = particles.scratch();
  const bool surface = features.oxygen && solutes.oxygen->has_surface() && scene.free_surface;
  ScratchArray<float> divergence_of_position(scratch, size());
  FloatVectorScratch correction[2];
  Array<std::uint8_t> uncorrected;
  KernelMoments moments;
  moments.divergence_of_position = divergence_of_position.data();
  if (features.shifting) {
    scratch.lease(uncorrected, size());
    moments.uncorrected = uncorrected.data();
    for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions * (dimensions + 1) / 2); ++k) {
      scratch.lease(correction[k / 3][k % 3], size());
      moments.correction[k] = correction[k / 3][k % 3].data();
    }
  }
  if (surface) {
    scratch.lease(carried_solutes.normal, dimensions, size());
    scratch.lease(carried_solutes.interior, size());
    moments.normal = write(carried_solutes.normal);
  }
  kernel_moment_sweep(arrangement.context, arrangement.packed,
                      {.shifting = false, .normals = surface, .spacing = scene.spacing, .fading = {}}, moments);
  if (surface) {
    const InteriorWeight interior = interior_weight(dimensions, SurfaceOptions{});
    parallel_for(size(), [&](std::size_t i) { carried_solutes.interior[i] = interior(divergence_of_position[i]); });
  }
  FloatVectorField moved{};
  std::array<const float*, 6> matrix{};
  for (int axis = 0; features.shifting && axis < dimensions; ++axis) moved[axis] = &carried_solutes.shift[axis];
  for (std::size_t k = 0; k < 6; ++k) matrix[k] = moments.correction[k];
  solutes.scalars->add_sources(time - dt, dt, particles.position);
  const std::int64_t sweeps = solutes.scalars->transport(dt, {.arrangement = arrangement,
                                                              .divergence_of_position = moments.divergence_of_position,
                                                              .correction = matrix,
                                                              .places = particles.position,
                                                              .walls = boundary.walls,
                                                              .time = time - dt,
                                                              .shift = moved,
                                                              .interior = [](std::size_t) { return 1.0; }});
  for (auto& part : correction) scratch.release(part);
  scratch.release(uncorrected);
  if (features.shifting) scratch.release(carried_solutes.shift);
  return sweeps + 1;
}

void Flow::transfer_oxygen(double dt) {
  if (solutes.rigid_bubbles != nullptr) solutes.take_from_rigid_bubbles(particles, time, dt);
  if (carried_solutes.interior.empty()) return;
  solutes.oxygen->exchange_with_air(dt, {.interior_weight = carried_solutes.interior.data(),
                                         .normal = read(carried_solutes.normal),
                                         .gradient_scale = arrangement.context.gradient_scale});
  particles.scratch().release(carried_solutes.interior);
  particles.scratch().release(carried_solutes.normal);
}

}  // namespace spume::wcsph
