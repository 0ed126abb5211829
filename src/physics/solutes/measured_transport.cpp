// SPDX-License-Identifier: MIT
#include "spume/physics/solutes/measured_transport.hpp"

#include "spume/core/parallel.hpp"
#include "spume/operators/sph_operators.hpp"
#include "spume/particles/surface.hpp"

namespace spume {

bool MeasuredTransport::meets_air() const {
  const Solutes& solutes = liquid_.solutes;
  return liquid_.free_surface && solutes.oxygen != nullptr && solutes.oxygen->has_surface();
}

void MeasuredTransport::keep_shift(const FloatVectorField& velocity, double dt) {
  if (liquid_.solutes.scalars == nullptr || !liquid_.shifting) return;
  ParticleStore& particles = liquid_.particles;
  particles.scratch().lease(shift_, particles.dimensions, particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    for (int axis = 0; axis < particles.dimensions; ++axis)
      shift_[axis][i] = static_cast<float>(dt * (*velocity[axis])[i]);
  });
}

std::int64_t MeasuredTransport::transport(double t, double dt) {
  const std::int64_t sweeps = move(t, dt);
  liquid_.solutes.scalars->add_sources(t - dt, dt);
  return sweeps;
}

std::int64_t MeasuredTransport::move(double t, double dt) {
  ParticleStore& particles = liquid_.particles;
  Scalars& scalars = *liquid_.solutes.scalars;
  const bool surface = meets_air(), moved = liquid_.shifting || scalars.diffuse();
  if (!surface && !moved) return 0;
  ScratchPool& scratch = particles.scratch();
  const int dimensions = particles.dimensions;
  const std::size_t n = particles.size();
  ScratchArray<float> divergence_of_position(scratch, n);
  FloatVectorScratch correction[2];
  Array<std::uint8_t> uncorrected;
  KernelMoments moments;
  moments.divergence_of_position = divergence_of_position.data();
  if (liquid_.shifting) {
    scratch.lease(uncorrected, n);
    moments.uncorrected = uncorrected.data();
    for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions * (dimensions + 1) / 2); ++k) {
      scratch.lease(correction[k / 3][k % 3], n);
      moments.correction[k] = correction[k / 3][k % 3].data();
    }
  }
  if (surface) {
    scratch.lease(normal_, dimensions, n);
    scratch.lease(interior_, n);
    moments.normal = write(normal_);
  }
  kernel_moment_sweep(liquid_.arrangement.context, liquid_.arrangement.packed,
                      {.shifting = false, .normals = surface, .spacing = liquid_.spacing, .fading = {}}, moments);
  if (surface) {
    const InteriorWeight interior = interior_weight(dimensions, SurfaceOptions{});
    parallel_for(n, [&](std::size_t i) { interior_[i] = interior(divergence_of_position[i]); });
  }
  FloatVectorField moves{};
  std::array<const float*, 6> matrix{};
  for (int axis = 0; liquid_.shifting && axis < dimensions; ++axis) moves[axis] = &shift_[axis];
  for (std::size_t k = 0; k < 6; ++k) matrix[k] = moments.correction[k];
  const std::int64_t sweeps = scalars.transport(dt, {.arrangement = liquid_.arrangement,
                                                     .divergence_of_position = moments.divergence_of_position,
                                                     .correction = matrix,
                                                     .places = particles.position,
                                                     .walls = liquid_.boundary.walls,
                                                     .time = t - dt,
                                                     .shift = moves});
  for (auto& part : correction) scratch.release(part);
  scratch.release(uncorrected);
  scratch.release(shift_);
  return sweeps + 1;
}

void MeasuredTransport::transfer_oxygen(double t, double dt) {
  Solutes& solutes = liquid_.solutes;
  if (solutes.rigid_bubbles != nullptr) solutes.take_from_rigid_bubbles(liquid_.particles, t, dt);
  if (interior_.empty()) return;
  solutes.oxygen->exchange_with_air(dt, {.interior_weight = interior_.data(),
                                         .normal = read(normal_),
                                         .gradient_scale = liquid_.arrangement.context.gradient_scale});
  liquid_.particles.scratch().release(interior_);
  liquid_.particles.scratch().release(normal_);
}

}  // namespace spume
