// SPDX-License-Identifier: MIT
#include "spume/operators/interface_filters.hpp"

#include "gfd_row.hpp"
#include "spume/operators/image_values.hpp"

namespace spume {
namespace {

using simd::f32n;

// The colours of up to `count` phases from `first` on.
template <int dimensions, class Kernel, int count>
void sum_colours(const SweepContext& context, const float* records, std::span<const std::int32_t> mixed,
                 std::size_t first, std::span<float* const> colour) {
  constexpr int width = record_width(dimensions, 1);
  const auto centre = static_cast<float>(Kernel::w(0.0));
  sweep(mixed.size(), [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(mixed[s]);
    const float own = records[i * width + dimensions];
    std::array<f32n, count> sum{};
    f32n total{};
    for_each_batch<dimensions, 1>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
      const f32n w = Kernel::w(b.q);
      total = total + w;
      for (int n = 0; n < count; ++n) sum[n] = sum[n] + (b.payload[0] == static_cast<float>(first + n) ? w : f32n{});
    });
    const float weight = 1 / (centre + simd::sum(total));
    for (int n = 0; n < count; ++n)
      if (float* out = colour[first + n]; out != nullptr)
        out[i] = weight * (simd::sum(sum[n]) + (own == static_cast<float>(first + n) ? centre : 0));
  });
}

}  // namespace

void filter_colours(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                    std::span<const std::uint8_t> phase, std::span<float* const> colour) {
  const std::size_t particles = context.list->particles();
  for (std::size_t n = 0; n < colour.size(); ++n)
    if (colour[n] != nullptr)
      parallel_for(particles, [&, out = colour[n]](std::size_t i) { out[i] = phase[i] == n ? 1 : 0; });
  if (bands.mixed().empty()) return;
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    constexpr int width = record_width(dimensions, 1);
    float* records = packed.prepare(context, 1);
    const std::int32_t* source = context.images->source();
    parallel_for(particles, [&](std::size_t i) { records[i * width + dimensions] = phase[i]; });
    parallel_for(context.images->size(), [&](std::size_t k) {
      records[(particles + k) * width + dimensions] = phase[static_cast<std::size_t>(source[k])];
    });
    std::size_t n = 0;
    for (; n + 1 < colour.size(); n += 2)
      sum_colours<dimensions, Kernel, 2>(context, records, bands.mixed(), n, colour);
    if (n < colour.size()) sum_colours<dimensions, Kernel, 1>(context, records, bands.mixed(), n, colour);
  });
}

void blend_property(const InterfaceBands& bands, std::span<const std::uint8_t> phase,
                    std::span<const float* const> colour, std::span<const double> of_phase, std::span<float> out) {
  parallel_for(out.size(), [&](std::size_t i) { out[i] = static_cast<float>(of_phase[phase[i]]); });
  parallel_for(bands.mixed().size(), [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(bands.mixed()[s]);
    double sum = 0;
    for (std::size_t n = 0; n < of_phase.size(); ++n) sum += of_phase[n] * double{colour[n][i]};
    out[i] = static_cast<float>(sum);
  });
}

void filter_property(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                     const float* values, std::span<float> out) {
  parallel_for(out.size(), [&](std::size_t i) { out[i] = values[i]; });
  if (bands.mixed().empty()) return;
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    constexpr int width = record_width(dimensions, 1);
    float* records = packed.prepare(context, 1);
    pack_scalar(context, records, width, 0, values);
    const auto centre = static_cast<float>(Kernel::w(0.0));
    sweep(bands.mixed().size(), [&](std::size_t s) {
      const auto i = static_cast<std::size_t>(bands.mixed()[s]);
      f32n sum{}, total{};
      for_each_batch<dimensions, 1>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
        const f32n w = Kernel::w(b.q);
        total = total + w;
        sum = sum + w * b.payload[0];
      });
      out[i] = (simd::sum(sum) + centre * values[i]) / (centre + simd::sum(total));
    });
  });
}

}  // namespace spume
