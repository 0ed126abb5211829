// SPDX-License-Identifier: MIT
#include "spume/operators/mass_exchange.hpp"

#include <algorithm>

#include "gfd_row.hpp"

namespace spume {

using simd::f32n;

void mass_exchange_sweep(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                         const MassExchange& exchange, const VelocityImageRule& rule,
                         const std::array<float*, 3>& change) {
  for (int axis = 0; axis < context.dimensions; ++axis)
    parallel_for(context.list->particles(), [&, out = change[axis]](std::size_t i) { out[i] = 0; });
  if (bands.varying().empty()) return;
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    constexpr int payload = dimensions + 1;
    constexpr int width = record_width(dimensions, payload);
    float* records = packed.prepare(context, payload);
    pack_velocity(context, records, width, 0, exchange.velocity, rule);
    pack_scalar(context, records, width, dimensions, exchange.gain);
    clear_wall_points(context, records, width, dimensions);
    sweep(bands.varying().size(), [&](std::size_t s) {
      const auto i = static_cast<std::size_t>(bands.varying()[s]);
      if (!(exchange.gain[i] > 0)) return;
      const float* own = records + i * width + dimensions;
      std::array<f32n, dimensions> sum{};
      f32n total{};
      for_each_batch<dimensions, payload>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
        const f32n lost = simd::max(-b.payload[dimensions], f32n{}) * Kernel::w(b.q);
        total = total + lost;
        for (int a = 0; a < dimensions; ++a) sum[a] = sum[a] + lost * (b.payload[a] - own[a]);
      });
      const float whole = simd::sum(total);
      if (!(whole > 0)) return;
      const float share = std::min(1.0F, exchange.gain[i] / exchange.density[i]) / whole;
      for (int a = 0; a < dimensions; ++a) change[a][i] = share * simd::sum(sum[a]);
    });
  });
}

}  // namespace spume
