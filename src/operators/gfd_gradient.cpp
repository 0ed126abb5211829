// SPDX-License-Identifier: MIT
#include "spume/operators/gfd_gradient.hpp"

#include "change_bounds.hpp"
#include "gfd_row.hpp"
#include "spume/core/joined_lanes.hpp"

namespace spume {
namespace {

using simd::f32n;

// B sum_j c_ij (f_j - f_i) W d of particle i, whose records hold f and, with `over_density`, rho; c = 1 without.
template <int dimensions, class Kernel, int payload, bool over_density>
void gradient_row(const SweepContext& context, const float* records, std::size_t i,
                  const std::array<const float*, 6>& correction, float factor, const std::array<float*, 3>& out) {
  const float* own = records + i * record_width(dimensions, payload) + dimensions;
  std::array<f32n, dimensions> sum{};
  for_each_batch<dimensions, payload>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
    f32n weight = Kernel::w(b.q) * (b.payload[0] - own[0]);
    if constexpr (over_density) weight = weight * (2.0F / (b.payload[1] + own[1]));
    for (int a = 0; a < dimensions; ++a) sum[a] = sum[a] + weight * b.d[a];
  });
  std::array<float, dimensions> v = simd::sums_of(sum);
  for (float& component : v) component *= factor;
  v = symmetric_product<dimensions>(correction, i, v);
  for (int a = 0; a < dimensions; ++a) out[a][i] = v[a];
}

template <int dimensions, class Kernel>
void gradient(const SweepContext& context, PackedNeighbours& packed, const double* values, double reference,
              const float* density, const std::array<const float*, 6>& correction, const std::array<float*, 3>& out) {
  constexpr int width = record_width(dimensions, 1);
  float* records = packed.prepare(context, 1);
  pack_from_reference<width>(context, records + dimensions, values, reference, density != nullptr);
  sweep(context.list->particles(), [&](std::size_t i) {
    const float factor = density != nullptr ? 1 / density[i] : 1;
    gradient_row<dimensions, Kernel, 1, false>(context, records, i, correction, factor, out);
  });
}

template <int dimensions, class Kernel>
void gradient_over_density(const SweepContext& context, PackedNeighbours& packed, const double* values,
                           double reference, const PhaseProperty& density,
                           const std::array<const float*, 6>& correction, const std::array<float*, 3>& out) {
  constexpr int width = record_width(dimensions, 2);
  float* records = packed.prepare(context, 2);
  pack_from_reference<width>(context, records + dimensions, values, reference, true);
  pack_coefficient(context, records, width, 1, density.value);
  sweep(context.list->particles(), [&](std::size_t i) {
    if (density.varies[i] != 0)
      gradient_row<dimensions, Kernel, 2, true>(context, records, i, correction, 1, out);
    else
      gradient_row<dimensions, Kernel, 2, false>(context, records, i, correction, 1 / density.value[i], out);
  });
}

// row(i, u_i, each): each(use) calls use(batch) for the neighbours of particle i, whose payload is their velocity.
template <int dimensions, class Row>
void sweep_velocities(const SweepContext& context, PackedNeighbours& packed,
                      const std::array<const double*, 3>& velocity, const VelocityImageRule& rule, const Row& row) {
  constexpr int width = record_width(dimensions, dimensions);
  float* records = packed.prepare(context, dimensions);
  pack_velocity(context, records, width, 0, velocity, rule);
  const float inverse_h = inverse_width(context);
  sweep(context.list->particles(), [&](std::size_t i) {
    row(
        i, records + i * width + dimensions, [&](const auto& use) __attribute__((always_inline)) {
          for_each_batch<dimensions, dimensions>(*context.list, records, i, inverse_h, use);
        });
  });
}

template <int dimensions, class Kernel>
void divergence_of(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
                   const VelocityImageRule& rule, const std::array<const float*, 6>& correction, double* out) {
  sweep_velocities<dimensions>(context, packed, velocity, rule, [&](std::size_t i, const float* own, const auto& each) {
    std::array<float, symmetric_entries<dimensions>> b_of;
    for (std::size_t k = 0; k < b_of.size(); ++k) b_of[k] = correction[k][i];
    f32n sum{};
    each([&](const auto& b) {
      f32n product{};
      for (int a = 0; a < dimensions; ++a) {
        f32n along{};
        for (int c = 0; c < dimensions; ++c) along = along + b_of[symmetric_index<dimensions>(a, c)] * b.d[c];
        product = product + (b.payload[a] - own[a]) * along;
      }
      sum = sum + Kernel::w(b.q) * product;
    });
    out[i] = simd::sum(sum);
  });
}

template <int dimensions, class Kernel>
void change_of(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
               const VelocityImageRule& rule, const std::array<const float*, 6>& correction,
               const std::array<const float*, 3>& displacement, const std::array<float*, 3>& out) {
  sweep_velocities<dimensions>(context, packed, velocity, rule, [&](std::size_t i, const float* own, const auto& each) {
    const auto direction = symmetric_product<dimensions>(correction, i, own_vector<dimensions>(displacement, i));
    std::array<f32n, dimensions> sum{};
    ChangeBounds<dimensions> bounds(own_vector<dimensions>(displacement, i));
    each([&](const auto& b) {
      f32n along{};
      for (int c = 0; c < dimensions; ++c) along = along + direction[c] * b.d[c];
      along = Kernel::w(b.q) * along;
      const auto shares = bounds.template shares<Kernel>(b);
      for (int a = 0; a < dimensions; ++a) {
        const f32n difference = b.payload[a] - own[a];
        sum[a] = sum[a] + along * difference;
        bounds.add(a, shares, difference);
      }
    });
    std::array<float, dimensions> change = simd::sums_of(sum);
    bounds.cut(change);
    for (int a = 0; a < dimensions; ++a) out[a][i] = change[a];
  });
}

}  // namespace

void gfd_gradient_sweep(const SweepContext& context, PackedNeighbours& packed, const double* values, double reference,
                        const std::array<const float*, 6>& correction, const std::array<float*, 3>& out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    gradient<dimensions, Kernel>(context, packed, values, reference, nullptr, correction, out);
  });
}

void gfd_gradient_over_density_sweep(const SweepContext& context, PackedNeighbours& packed, const double* values,
                                     double reference, const PhaseProperty& density,
                                     const std::array<const float*, 6>& correction, const std::array<float*, 3>& out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    if (density.varies == nullptr)
      gradient<dimensions, Kernel>(context, packed, values, reference, density.value, correction, out);
    else
      gradient_over_density<dimensions, Kernel>(context, packed, values, reference, density, correction, out);
  });
}

void gfd_gradient_over_density_subset(const SweepContext& context, PackedNeighbours& packed, const float* values,
                                      const float* density, const std::array<const float*, 6>& correction,
                                      std::span<const std::int32_t> subset, const std::array<float*, 3>& out) {
  if (subset.empty()) return;
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    constexpr int width = record_width(dimensions, 2);
    float* records = packed.prepare(context, 2);
    pack_scalar(context, records, width, 0, values);
    pack_coefficient(context, records, width, 1, density);
    sweep(subset.size(), [&](std::size_t s) {
      gradient_row<dimensions, Kernel, 2, true>(context, records, static_cast<std::size_t>(subset[s]), correction, 1,
                                                out);
    });
  });
}

void gfd_divergence_sweep(const SweepContext& context, PackedNeighbours& packed,
                          const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                          const std::array<const float*, 6>& correction, double* out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    divergence_of<dimensions, Kernel>(context, packed, velocity, rule, correction, out);
  });
}

void gfd_change_sweep(const SweepContext& context, PackedNeighbours& packed,
                      const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                      const std::array<const float*, 6>& correction, const std::array<const float*, 3>& displacement,
                      const std::array<float*, 3>& out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    change_of<dimensions, Kernel>(context, packed, velocity, rule, correction, displacement, out);
  });
}

}  // namespace spume
