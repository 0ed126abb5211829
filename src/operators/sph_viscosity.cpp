// SPDX-License-Identifier: MIT
#include "spume/operators/sph_operators.hpp"
#include "symmetric_matrix.hpp"

namespace spume {
namespace {

using simd::f32n;

// Volumes of the particles as the last payload of a sweep with a variable h.
template <class Kernel>
void pack_own_volumes(const SweepContext& context, float* records, int width, int slot) {
  if constexpr (is_variable_h<Kernel>) pack_scalar(context, records, width, slot, context.volume_ratio);
}

// Squared distance over h^2 below which two particles coincide and have no direction: 1e-4 h is far below the distance
// of any two particles.
constexpr double coincident = 1e-8;
// Least divisor of the harmonic mean, a float far below any diffusivity: 0 / 0 becomes 0.
constexpr float no_diffusivity = 1e-30F;

// The weight of a pair, of the viscosity's own sum and of what is taken off it.
template <int dimensions, class Kernel, class Batch>
[[gnu::always_inline]] inline f32n pair_weight(const Batch& b, float gradient_scale, f32n own_kappa) {
  // Harmonic mean 2 k_i k_j / (k_i + k_j), zero when both vanish (also at the sentinel).
  const f32n kappa_j = b.payload[dimensions];
  const f32n mean = own_kappa * kappa_j / simd::max(own_kappa + kappa_j, simd::splat<f32n>(no_diffusivity));
  return times_volume<Kernel>((-4.0F * gradient_scale) * Kernel::f(b.q) * mean, b);
}

// Adds what a pair of the given weight and difference of velocities gives.
template <int dimensions, bool stress, class Batch>
[[gnu::always_inline]] inline void add_pair(const Batch& b, f32n weight, const std::array<f32n, dimensions>& difference,
                                            float tiny, std::array<f32n, dimensions>& sum) {
  if constexpr (stress) {
    f32n along{}, r2{};
    for (int a = 0; a < dimensions; ++a) {
      along = along + difference[a] * b.d[a];
      r2 = r2 + b.d[a] * b.d[a];
    }
    weight = weight * static_cast<float>(dimensions + 2) * along / simd::max(r2, simd::splat<f32n>(tiny));
    for (int a = 0; a < dimensions; ++a) sum[a] = sum[a] + weight * b.d[a];
  } else {
    for (int a = 0; a < dimensions; ++a) sum[a] = sum[a] + weight * difference[a];
  }
}

template <int dimensions, class Kernel, bool stress>
void viscous(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
             const VelocityImageRule& rule, const float* kappa, const std::array<float*, 3>& out,
             const LinearPart& taken_off) {
  const NeighbourList& list = *context.list;
  constexpr int payload = dimensions + 1 + volume_slots<Kernel>;
  float* records = packed.prepare(context, payload);
  constexpr int width = record_width(dimensions, payload);
  pack_velocity(context, records, width, 0, velocity, rule);
  pack_coefficient(context, records, width, dimensions, kappa);
  pack_own_volumes<Kernel>(context, records, width, dimensions + 1);
  const KernelScale<dimensions, Kernel> common(context);
  const auto tiny = static_cast<float>(coincident * context.smoothing_length * context.smoothing_length);

  sweep(list.particles(), [&](std::size_t i) {
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    std::array<f32n, dimensions> own{}, sum{};
    for (int a = 0; a < dimensions; ++a) own[a] = simd::splat<f32n>(records[i * width + dimensions + a]);
    const f32n own_kappa = simd::splat<f32n>(kappa[i]);
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      std::array<f32n, dimensions> difference;
      for (int a = 0; a < dimensions; ++a) difference[a] = b.payload[a] - own[a];
      add_pair<dimensions, stress>(b, pair_weight<dimensions, Kernel>(b, scale.gradient, own_kappa), difference, tiny,
                                   sum);
    });
    for (int a = 0; a < dimensions; ++a) out[a][i] = simd::sum(sum[a]);
  });
  if (taken_off.share == nullptr) return;

  sweep(list.particles(), [&](std::size_t i) {
    if (taken_off.share[i] == 0) return;
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    std::array<f32n, dimensions> own{}, sum{};
    for (int a = 0; a < dimensions; ++a) own[a] = simd::splat<f32n>(records[i * width + dimensions + a]);
    std::array<std::array<f32n, dimensions>, dimensions> m{};
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      const f32n g = times_volume<Kernel>(-scale.gradient * Kernel::f(b.q), b);
      for (int a = 0; a < dimensions; ++a)
        for (int c = 0; c < dimensions; ++c) m[a][c] = m[a][c] + g * (b.payload[a] - own[a]) * b.d[c];
    });
    std::array<std::array<float, dimensions>, dimensions> gradient{};
    for (int a = 0; a < dimensions; ++a) {
      for (int c = 0; c < dimensions; ++c) gradient[a][c] = taken_off.share[i] * simd::sum(m[a][c]);
      gradient[a] = symmetric_product<dimensions>(taken_off.correction, i, gradient[a]);
    }
    const f32n own_kappa = simd::splat<f32n>(kappa[i]);
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      std::array<f32n, dimensions> linear{};
      for (int a = 0; a < dimensions; ++a)
        for (int c = 0; c < dimensions; ++c) linear[a] = linear[a] + gradient[a][c] * b.d[c];
      add_pair<dimensions, stress>(b, pair_weight<dimensions, Kernel>(b, scale.gradient, own_kappa), linear, tiny, sum);
    });
    for (int a = 0; a < dimensions; ++a) out[a][i] -= simd::sum(sum[a]);
  });
}

}  // namespace

void viscous_sweep(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
                   const VelocityImageRule& rule, const float* kappa, const std::array<float*, 3>& out, bool stress,
                   const LinearPart& taken_off) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    if (stress)
      viscous<dimensions, Kernel, true>(context, packed, velocity, rule, kappa, out, taken_off);
    else
      viscous<dimensions, Kernel, false>(context, packed, velocity, rule, kappa, out, taken_off);
  });
}

}  // namespace spume
