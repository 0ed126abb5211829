// SPDX-License-Identifier: MIT
#include "spume/operators/gfd_laplacian.hpp"

#include "gfd_row.hpp"

namespace spume {
namespace {

using simd::f32n;

template <int dimensions, class Kernel, bool with_gradient>
void laplacian(const SweepContext& context, PackedNeighbours& packed, const double* values, double reference,
               const GfdStencils& stencils, const GfdLaplacian& out) {
  constexpr int width = record_width(dimensions, 1);
  float* records = packed.prepare(context, 1);
  pack_from_reference<width>(context, records + dimensions, values, reference);
  const float inverse_h = inverse_width(context);
  sweep(context.list->particles(), [&](std::size_t i) {
    const float own = records[i * width + dimensions];
    const auto o = own_vector<dimensions>(stencils.offset, i);
    f32n sum{};
    std::array<f32n, dimensions> slopes{};
    for_each_batch<dimensions, 1>(*context.list, records, i, inverse_h, [&](const auto& b) {
      const f32n difference = Kernel::w(b.q) * (b.payload[0] - own);
      sum = sum + difference * offset_factor(b, o);
      if constexpr (with_gradient)
        for (int a = 0; a < dimensions; ++a) slopes[a] = slopes[a] + difference * b.d[a];
    });
    out.laplacian[i] = stencils.laplacian_factor[i] * simd::sum(sum);
    if constexpr (with_gradient) {
      std::array<float, dimensions> slope;
      for (int a = 0; a < dimensions; ++a) slope[a] = simd::sum(slopes[a]);
      slope = symmetric_product<dimensions>(stencils.correction, i, slope);
      for (int a = 0; a < dimensions; ++a) out.gradient[a][i] = slope[a];
    }
  });
}

}  // namespace

void gfd_laplacian_sweep(const SweepContext& context, PackedNeighbours& packed, const double* values, double reference,
                         const GfdStencils& stencils, const GfdLaplacian& out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    if (out.gradient[0] != nullptr)
      laplacian<dimensions, Kernel, true>(context, packed, values, reference, stencils, out);
    else
      laplacian<dimensions, Kernel, false>(context, packed, values, reference, stencils, out);
  });
}

}  // namespace spume
