// SPDX-License-Identifier: MIT
#include "spume/operators/gfd_moments.hpp"

#include "gfd_row.hpp"

namespace spume {
namespace {

using simd::f32n;

// sum |d|^2 W (1 + d . o) over sum |d|^2 W: 1 in the bulk, 0.9 and more when jittered as above; 0.19 and more at
// planes, 0 at corners of a lattice (its edges in 2-D), where the second derivatives of one-sided differences cancel.
constexpr double least_denominator = 0.1;

// Of all particles, or of a subset.
template <int dimensions, class Kernel>
void moments(const SweepContext& context, PackedNeighbours& packed, const std::span<const std::int32_t>* subset,
             const GfdMoments& out) {
  constexpr int entries = symmetric_entries<dimensions>;
  const NeighbourList& list = *context.list;
  const float* records = packed.prepare(context, 0);
  const float inverse_h = inverse_width(context);
  sweep(subset == nullptr ? list.particles() : subset->size(), [&](std::size_t s) {
    const std::size_t i = subset == nullptr ? s : static_cast<std::size_t>((*subset)[s]);
    std::array<f32n, entries> second{};
    std::array<f32n, dimensions> first{}, third{};
    for_each_batch<dimensions, 0>(list, records, i, inverse_h, [&](const auto& b) {
      const f32n w = Kernel::w(b.q);
      f32n r2{};
      for (int a = 0; a < dimensions; ++a) r2 = r2 + b.d[a] * b.d[a];
      int slot = 0;
      for (int a = 0; a < dimensions; ++a) {
        const f32n wd = w * b.d[a];
        first[a] = first[a] + wd;
        third[a] = third[a] + r2 * wd;
        for (int c = a; c < dimensions; ++c) second[slot] = second[slot] + wd * b.d[c], ++slot;
      }
    });
    std::array<double, 6> m{}, b{};
    std::array<double, dimensions> o{};
    for (int k = 0; k < entries; ++k) m[k] = simd::sum(second[k]);
    const auto [trace, scale, isotropic] = normalised_inverse<dimensions>(m, b);
    for (double& entry : b) entry *= scale;
    auto fallback = isotropic ? GfdFallback::isotropic : GfdFallback::none;
    double denominator = trace;
    if (fallback == GfdFallback::none) {
      for (int a = 0; a < dimensions; ++a)
        for (int c = 0; c < dimensions; ++c) o[a] -= b[symmetric_index<dimensions>(a, c)] * simd::sum(first[c]);
      for (int a = 0; a < dimensions; ++a) denominator += o[a] * simd::sum(third[a]);
      if (!(denominator > least_denominator * trace)) {
        fallback = GfdFallback::no_offset;
        denominator = trace;
        o = {};
      }
    }
    if (out.correction[0] != nullptr)
      for (int k = 0; k < entries; ++k) out.correction[k][i] = static_cast<float>(b[k]);
    if (out.offset[0] != nullptr)
      for (int a = 0; a < dimensions; ++a) out.offset[a][i] = static_cast<float>(o[a]);
    if (out.laplacian_factor != nullptr)
      out.laplacian_factor[i] = static_cast<float>(denominator > 0 ? 2 * dimensions / denominator : 0);
    if (out.fallback != nullptr) out.fallback[i] = fallback;
  });
}

}  // namespace

void gfd_moment_sweep(const SweepContext& context, PackedNeighbours& packed, const GfdMoments& out) {
  with_gfd_kernel(context,
                  [&]<int dimensions, class Kernel>() { moments<dimensions, Kernel>(context, packed, nullptr, out); });
}

void gfd_moment_subset(const SweepContext& context, PackedNeighbours& packed, std::span<const std::int32_t> subset,
                       const GfdMoments& out) {
  with_gfd_kernel(context,
                  [&]<int dimensions, class Kernel>() { moments<dimensions, Kernel>(context, packed, &subset, out); });
}

}  // namespace spume
