// SPDX-License-Identifier: MIT
#include "spume/operators/sph_diffusion.hpp"

#include "gfd_row.hpp"

namespace spume {
namespace {

using simd::f32n;

// Records hold u, V and mu.
template <int dimensions, class Kernel, bool varies>
void diffusion_row(const SweepContext& context, const float* records, std::size_t i, float scale,
                   const DiffusionProperties& properties, const std::array<float*, 3>& out) {
  constexpr int payload = dimensions + 2;
  const float* own = records + i * record_width(dimensions, payload) + dimensions;
  const float volume = own[dimensions], viscosity = own[dimensions + 1];
  std::array<f32n, dimensions> sum{};
  for_each_batch<dimensions, payload>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
    // Volumes over that of the particle: squares of volumes alone can leave the range of a float.
    const f32n ratio = b.payload[dimensions] * (1 / volume);
    f32n weight = Kernel::f(b.q) * (1.0F + ratio * ratio);
    if constexpr (varies) weight = weight * harmonic_mean(simd::splat<f32n>(viscosity), b.payload[dimensions + 1]);
    for (int a = 0; a < dimensions; ++a) sum[a] = sum[a] + weight * (own[a] - b.payload[a]);
  });
  float factor = scale * volume;
  if constexpr (!varies) factor *= viscosity;
  if (properties.density != nullptr) factor /= properties.density[i];
  for (int a = 0; a < dimensions; ++a) out[a][i] = factor * simd::sum(sum[a]);
}

}  // namespace

void hu_adams_sweep(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
                    const VelocityImageRule& rule, const float* volume, const DiffusionProperties& properties,
                    const std::array<float*, 3>& out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    constexpr int width = record_width(dimensions, dimensions + 2);
    float* records = packed.prepare(context, dimensions + 2);
    pack_velocity(context, records, width, 0, velocity, rule);
    pack_coefficient(context, records, width, dimensions, volume);
    pack_coefficient(context, records, width, dimensions + 1, properties.viscosity.value);
    // sigma / h^(d+2), the factor of F in r . grad W / r^2.
    const double h = context.smoothing_length;
    const auto scale = static_cast<float>(Kernel::normalisation(dimensions) / std::pow(h, dimensions + 2));
    const std::uint8_t* varies = properties.viscosity.varies;
    sweep(context.list->particles(), [&](std::size_t i) {
      if (varies != nullptr && varies[i] != 0)
        diffusion_row<dimensions, Kernel, true>(context, records, i, scale, properties, out);
      else
        diffusion_row<dimensions, Kernel, false>(context, records, i, scale, properties, out);
    });
  });
}

}  // namespace spume
