// SPDX-License-Identifier: MIT
#include "spume/operators/gfd_stress.hpp"

#include "gfd_row.hpp"
#include "spume/core/joined_lanes.hpp"

namespace spume {
namespace {

using simd::f32n;

// What a row computes where the viscosity varies.
template <MomentumDiffusion form>
inline constexpr bool pairwise_gradient = form == MomentumDiffusion::rotation_free;
template <MomentumDiffusion form>
inline constexpr bool takes_means =
    form == MomentumDiffusion::split || form == MomentumDiffusion::mu_laplacian || pairwise_gradient<form>;
template <MomentumDiffusion form>
inline constexpr bool takes_gradient =
    form == MomentumDiffusion::split || form == MomentumDiffusion::printed || pairwise_gradient<form>;

// The inverse of sum mu_ij W d (x) d is the result times `inverse`.
template <int dimensions>
float weighted_correction(const std::array<f32n, symmetric_entries<dimensions>>& sums, std::array<double, 6>& inverse) {
  std::array<double, 6> moment{};
  for (std::size_t k = 0; k < sums.size(); ++k) moment[k] = simd::sum(sums[k]);
  return static_cast<float>(normalised_inverse<dimensions>(moment, inverse).scale);
}

template <int dimensions>
std::array<float, dimensions> weighted_product(const std::array<double, 6>& inverse, float scale,
                                               const std::array<float, dimensions>& v) {
  std::array<float, dimensions> result{};
  for (int a = 0; a < dimensions; ++a)
    for (int c = 0; c < dimensions; ++c)
      result[a] += scale * static_cast<float>(inverse[symmetric_index<dimensions>(a, c)]) * v[c];
  return result;
}

// Particle i, whose records hold u and, where a form takes means, mu after it.
template <int dimensions, class Kernel, int payload, MomentumDiffusion form>
void stress_row(const SweepContext& context, const float* records, std::size_t i, const GfdStencils& stencils,
                const DiffusionProperties& properties, const std::array<float*, 3>& out) {
  const float* own = records + i * record_width(dimensions, payload) + dimensions;
  const auto o = own_vector<dimensions>(stencils.offset, i);
  [[maybe_unused]] const f32n own_viscosity = simd::splat<f32n>(properties.viscosity.value[i]);
  std::array<f32n, dimensions> sum{};
  [[maybe_unused]] std::array<f32n, dimensions> means{};  // sum mu_ij d W (1 + d . o)
  std::array<std::array<f32n, dimensions>, dimensions> m{};
  [[maybe_unused]] std::array<f32n, symmetric_entries<dimensions>> moment{};  // sum mu_ij W d (x) d
  for_each_batch<dimensions, payload>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
    f32n w = Kernel::w(b.q);
    f32n weight = w * offset_factor(b, o);
    if constexpr (takes_means<form>) {
      const f32n mean = harmonic_mean(own_viscosity, b.payload[dimensions]);
      weight = weight * mean;
      if constexpr (pairwise_gradient<form>) w = w * mean;
    }
    std::array<f32n, dimensions> wd;
    if constexpr (takes_gradient<form>)
      for (int c = 0; c < dimensions; ++c) wd[c] = w * b.d[c];
    if constexpr (pairwise_gradient<form>)
      for (int c = 0; c < dimensions; ++c)
        for (int e = c; e < dimensions; ++e)
          moment[symmetric_index<dimensions>(c, e)] = moment[symmetric_index<dimensions>(c, e)] + wd[c] * b.d[e];
    if constexpr (pairwise_gradient<form>)
      for (int c = 0; c < dimensions; ++c) means[c] = means[c] + weight * b.d[c];
    for (int a = 0; a < dimensions; ++a) {
      const f32n difference = b.payload[a] - own[a];
      sum[a] = sum[a] + weight * difference;
      if constexpr (takes_gradient<form>)
        for (int c = 0; c < dimensions; ++c) m[a][c] = m[a][c] + difference * wd[c];
    }
  });
  float factor = stencils.laplacian_factor[i];
  if constexpr (!takes_means<form>) factor *= properties.viscosity.value[i];
  if (properties.density != nullptr) factor /= properties.density[i];
  std::array<float, dimensions> result = simd::sums_of(sum);
  for (float& component : result) component *= factor;
  if constexpr (takes_gradient<form>) {
    [[maybe_unused]] std::array<double, 6> b_weighted{};  // of the gradient, over its scale
    [[maybe_unused]] float scale = 1;
    if constexpr (pairwise_gradient<form>) scale = weighted_correction<dimensions>(moment, b_weighted);
    std::array<float, dimensions> slope;
    if constexpr (pairwise_gradient<form>)
      for (int b = 0; b < dimensions; ++b) slope[b] = factor * simd::sum(means[b]);
    else
      slope = own_vector<dimensions>(properties.viscosity_gradient, i);
    for (int b = 0; b < dimensions; ++b) {
      std::array<float, dimensions> gradient;  // of u_b
      for (int c = 0; c < dimensions; ++c) gradient[c] = simd::sum(m[b][c]);
      if constexpr (pairwise_gradient<form>)
        gradient = weighted_product<dimensions>(b_weighted, scale, gradient);
      else
        gradient = symmetric_product<dimensions>(stencils.correction, i, gradient);
      for (int a = 0; a < dimensions; ++a) {
        result[a] += gradient[a] * slope[b];
        if constexpr (form == MomentumDiffusion::printed) result[b] += gradient[a] * slope[a];
      }
    }
  }
  for (int a = 0; a < dimensions; ++a) out[a][i] = result[a];
}

template <int dimensions, class Kernel, MomentumDiffusion form, bool varies>
void stress(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
            const VelocityImageRule& rule, const GfdStencils& stencils, const DiffusionProperties& properties,
            const std::array<float*, 3>& out) {
  constexpr int payload = dimensions + (varies && takes_means<form> ? 1 : 0);
  constexpr int width = record_width(dimensions, payload);
  float* records = packed.prepare(context, payload);
  pack_velocity(context, records, width, 0, velocity, rule);
  if constexpr (payload > dimensions) pack_coefficient(context, records, width, dimensions, properties.viscosity.value);
  sweep(context.list->particles(), [&](std::size_t i) {
    if constexpr (varies)
      if (properties.viscosity.varies[i] != 0)
        return stress_row<dimensions, Kernel, payload, form>(context, records, i, stencils, properties, out);
    stress_row<dimensions, Kernel, payload, MomentumDiffusion::laplacian>(context, records, i, stencils, properties,
                                                                          out);
  });
}

// sum W (1 + d . o) of particle i, of pairs times their mean viscosity where records hold it.
template <int dimensions, class Kernel, int payload, bool means>
float weight_sum(const SweepContext& context, const float* records, std::size_t i, const GfdStencils& stencils,
                 const float* viscosity) {
  const auto o = own_vector<dimensions>(stencils.offset, i);
  [[maybe_unused]] const f32n own = simd::splat<f32n>(viscosity[i]);
  f32n sum{};
  for_each_batch<dimensions, payload>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
    f32n weight = Kernel::w(b.q) * offset_factor(b, o);
    if constexpr (means) weight = weight * harmonic_mean(own, b.payload[0]);
    sum = sum + weight;
  });
  return means ? simd::sum(sum) : viscosity[i] * simd::sum(sum);
}

template <int dimensions, class Kernel, bool varies>
void diagonal(const SweepContext& context, PackedNeighbours& packed, const GfdStencils& stencils,
              const DiffusionProperties& properties, float* out) {
  constexpr int payload = varies ? 1 : 0;
  float* records = packed.prepare(context, payload);
  const float* viscosity = properties.viscosity.value;
  if constexpr (varies) pack_coefficient(context, records, record_width(dimensions, payload), 0, viscosity);
  sweep(context.list->particles(), [&](std::size_t i) {
    float sum = 0;
    if (varies && properties.viscosity.varies[i] != 0)
      sum = weight_sum<dimensions, Kernel, payload, varies>(context, records, i, stencils, viscosity);
    else
      sum = weight_sum<dimensions, Kernel, payload, false>(context, records, i, stencils, viscosity);
    const float factor = stencils.laplacian_factor[i] * sum;
    out[i] = properties.density == nullptr ? factor : factor / properties.density[i];
  });
}

}  // namespace

void gfd_diffusion_diagonal(const SweepContext& context, PackedNeighbours& packed, const GfdStencils& stencils,
                            const DiffusionProperties& properties, float* out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    if (properties.viscosity.varies != nullptr)
      diagonal<dimensions, Kernel, true>(context, packed, stencils, properties, out);
    else
      diagonal<dimensions, Kernel, false>(context, packed, stencils, properties, out);
  });
}

void gfd_stress_sweep(const SweepContext& context, PackedNeighbours& packed,
                      const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                      const GfdStencils& stencils, MomentumDiffusion form, const DiffusionProperties& properties,
                      const std::array<float*, 3>& out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    const auto run = [&]<MomentumDiffusion chosen, bool varies>() {
      stress<dimensions, Kernel, chosen, varies>(context, packed, velocity, rule, stencils, properties, out);
    };
    using enum MomentumDiffusion;
    if (properties.viscosity.varies == nullptr || form == laplacian)
      run.template operator()<laplacian, false>();
    else if (form == split)
      run.template operator()<split, true>();
    else if (form == rotation_free)
      run.template operator()<rotation_free, true>();
    else if (form == printed)
      run.template operator()<printed, true>();
    else
      run.template operator()<mu_laplacian, true>();
  });
}

}  // namespace spume
