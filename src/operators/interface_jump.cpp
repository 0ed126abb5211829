// SPDX-License-Identifier: MIT
#include "spume/operators/interface_jump.hpp"

#include <algorithm>

#include "gfd_row.hpp"
#include "spume/core/joined_lanes.hpp"
#include "spume/operators/image_values.hpp"

namespace spume {
namespace {

using simd::f32n;

// Records hold C, phi and rho.
template <int dimensions, class Kernel>
void jump_row(const SweepContext& context, const float* records, std::size_t i, const GfdStencils& stencils,
              const InterfaceForce& out) {
  const float* own = records + i * record_width(dimensions, 3) + dimensions;
  const auto o = own_vector<dimensions>(stencils.offset, i);
  std::array<f32n, dimensions> gradient{};
  f32n laplacian{};
  for_each_batch<dimensions, 3>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
    // The means of phi and rho have each a factor 1/2.
    const f32n weight = Kernel::w(b.q) * (b.payload[1] + own[1]) * (b.payload[0] - own[0]) / (b.payload[2] + own[2]);
    for (int a = 0; a < dimensions; ++a) gradient[a] = gradient[a] + weight * b.d[a];
    laplacian = laplacian + weight * offset_factor(b, o);
  });
  const auto total = simd::sums_of(gradient, std::array{laplacian});
  if (out.acceleration[0] != nullptr) {
    std::array<float, dimensions> v;
    std::copy_n(total.begin(), dimensions, v.begin());
    v = symmetric_product<dimensions>(stencils.correction, i, v);
    for (int a = 0; a < dimensions; ++a) out.acceleration[a][i] += v[a];
  }
  if (out.source != nullptr) out.source[i] += double{stencils.laplacian_factor[i]} * total[dimensions];
}

}  // namespace

void interface_jump_sweep(const SweepContext& context, PackedNeighbours& packed, std::span<const std::int32_t> subset,
                          const InterfaceJump& jump, const GfdStencils& stencils, const InterfaceForce& out) {
  if (subset.empty()) return;
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    constexpr int width = record_width(dimensions, 3);
    float* records = packed.prepare(context, 3);
    // At wall points as a pressure is, whose jump it balances.
    pack_scalar(context, records, width, 0, jump.colour);
    pack_coefficient(context, records, width, 1, jump.potential);
    pack_coefficient(context, records, width, 2, jump.density);
    sweep(subset.size(), [&](std::size_t s) {
      jump_row<dimensions, Kernel>(context, records, static_cast<std::size_t>(subset[s]), stencils, out);
    });
  });
}

void interface_average_sweep(const SweepContext& context, PackedNeighbours& packed,
                             std::span<const std::int32_t> subset, const float* weight, const float* value,
                             float* out) {
  if (subset.empty()) return;
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    constexpr int width = record_width(dimensions, 2);
    float* records = packed.prepare(context, 2);
    pack_coefficient(context, records, width, 0, weight);
    pack_coefficient(context, records, width, 1, value);
    const auto centre = static_cast<float>(Kernel::w(0.0));
    sweep(subset.size(), [&](std::size_t s) {
      const auto i = static_cast<std::size_t>(subset[s]);
      f32n sum{}, total{};
      for_each_batch<dimensions, 2>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
        const f32n w = Kernel::w(b.q) * b.payload[0];
        total = total + w;
        sum = sum + w * b.payload[1];
      });
      const float all = centre * weight[i] + simd::sum(total);
      out[i] = all > 0 ? (centre * weight[i] * value[i] + simd::sum(sum)) / all : 0;
    });
  });
}

}  // namespace spume
