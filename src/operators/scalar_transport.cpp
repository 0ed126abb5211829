// SPDX-License-Identifier: MIT
#include "spume/operators/scalar_transport.hpp"

#include <algorithm>

#include "scalar_records.hpp"
#include "scalar_sums.hpp"
#include "symmetric_matrix.hpp"

namespace spume {
namespace {

using simd::f32n;

template <int count>
void pack_scalars(const SweepContext& context, float* records, std::size_t width, const ScalarSweepInput& in,
                  std::size_t first) {
  const auto dimensions = static_cast<std::size_t>(context.dimensions);
  const std::size_t last = std::min(first + count, in.values.size());
  for_each_scalar_record(
      context,
      [=, &in](std::size_t record, std::size_t i) {
        float* out = records + record * width + dimensions;
        for (std::size_t s = first; s < last; ++s)
          out[s - first] = static_cast<float>(in.values[s][i] - in.reference[s]);
        for (std::size_t s = last; s < first + count; ++s) out[s - first] = 0;
      },
      [=](std::size_t record) { std::fill_n(records + record * width + dimensions, count, exchanges_nothing); });
}

template <int dimensions, class Kernel, int count, bool shifted, bool varies>
struct ScalarRow {
  static constexpr int payload =
      count + 1 + (varies ? 2 : 0);  // behind the scalars a, the eddy viscosity and the volume
  static constexpr int width = record_width(dimensions, payload);
  const SweepContext& context;
  const float* records;
  const ScalarSweepInput& in;
  const ScalarSweepOutput& out;
  const std::size_t first;
  const KernelScale<dimensions, Kernel> scale{context};

  // Of particle i: the factor of its own smoothing length, and the vector along which differences count.
  struct Shift {
    float gradient = 0;
    std::array<float, dimensions> direction{};
  };

  void operator()(std::size_t i) const {
    const std::size_t scalars = std::min<std::size_t>(count, in.values.size() - first);
    const float* own_record = records + i * width + dimensions;
    const float ratio = varies && context.length_ratio != nullptr ? context.length_ratio[i] : 1;
    const float own_eddy = varies ? own_record[count + 1] : 0, own_volume = varies ? own_record[count + 2] : 1;
    const float own_normalisation = own_record[count];
    std::array<float, count> diffusivity{}, share{};
    for (std::size_t s = 0; s < scalars; ++s) {
      diffusivity[s] = in.diffusivity[first + s];
      if (varies && in.eddy_viscosity != nullptr) share[s] = in.inverse_schmidt[first + s];
    }
    const Shift shift = shift_of(i, ratio);
    ScalarSums<count, shifted, varies> sums(own_record);
    f32n exchange{}, eddy_exchange{};
    for_each_batch<dimensions, payload>(
        *context.list, records, i, scale.inverse_h / ratio, [&](const auto& b) __attribute__((always_inline)) {
          // Differences from what exchanges nothing, and from the sentinel, count as none.
          const auto counts = (b.payload[0] < simd::splat<f32n>(exchanges_nothing)) &
                              (b.q < simd::splat<f32n>(static_cast<float>(Kernel::support)));
          f32n weight = (-own_volume * scale.gradient) * (own_normalisation + b.payload[count]) *
                        Kernel::f(varies ? b.q * ratio : b.q);
          if constexpr (varies) weight = weight * b.payload[count + 2];
          weight = counts ? weight : f32n{};
          exchange = exchange + weight;
          [[maybe_unused]] f32n by_eddies{}, pull{};
          if constexpr (varies) {
            by_eddies = weight * (0.5F * (b.payload[count + 1] + own_eddy));
            eddy_exchange = eddy_exchange + by_eddies;
          }
          if constexpr (shifted) {
            for (int a = 0; a < dimensions; ++a) pull = pull + b.d[a] * shift.direction[a];
            pull = pull * Kernel::f(b.q);
            if constexpr (varies) pull = pull * b.payload[count + 2];
          }
          sums.template add<0>(b.payload, counts, weight, pull, by_eddies);
        });
    const auto found = sums.found(-shift.gradient);
    for (std::size_t s = 0; s < scalars; ++s) {
      out.rate[first + s][i] = diffusivity[s] * found.rate[s] + share[s] * found.eddy_rate[s];
      if constexpr (shifted) out.change[first + s][i] = found.change[s];
    }
    if (out.exchange == nullptr) return;
    const float all = simd::sum(exchange), all_by_eddies = simd::sum(eddy_exchange);
    float most = first == 0 ? 0 : out.exchange[i];
    for (std::size_t s = 0; s < scalars; ++s) most = std::max(most, diffusivity[s] * all + share[s] * all_by_eddies);
    out.exchange[i] = most;
  }

  // L is symmetric: (L sum g d f) . s = sum g f (d . L s).
  Shift shift_of([[maybe_unused]] std::size_t i, [[maybe_unused]] float ratio) const {
    Shift shift;
    if constexpr (shifted) {
      std::array<float, dimensions> s;
      for (int a = 0; a < dimensions; ++a) s[a] = in.shift[a][i];
      shift.direction = symmetric_product<dimensions>(in.correction, i, s);
      shift.gradient =
          scale.gradient / (dimensions == 3 ? ratio * ratio * ratio * ratio * ratio : ratio * ratio * ratio * ratio);
    }
    return shift;
  }
};

template <int dimensions, class Kernel, int count, bool shifted, bool varies>
void transport_some(const SweepContext& context, PackedNeighbours& packed, const ScalarSweepInput& in,
                    const ScalarSweepOutput& out, std::size_t first) {
  using Row = ScalarRow<dimensions, Kernel, count, shifted, varies>;
  float* records = packed.prepare(context, Row::payload);
  pack_scalars<count>(context, records, Row::width, in, first);
  const std::size_t n = context.list->particles();
  const auto w = static_cast<std::size_t>(Row::width);
  const auto write = [&, w](std::size_t record, std::size_t i) {
    float* behind = records + record * w + dimensions + count;
    behind[0] = in.normalisation[i];
    if constexpr (varies) {
      behind[1] = in.eddy_viscosity == nullptr ? 0 : std::max(in.eddy_viscosity[i], 0.0F);
      behind[2] = context.volume_ratio == nullptr ? 1 : context.volume_ratio[i];
    }
  };
  parallel_for(n, [&](std::size_t i) { write(i, i); });
  const std::int32_t* source = context.images->source();
  parallel_for(context.images->size(), [&](std::size_t k) { write(n + k, static_cast<std::size_t>(source[k])); });
  const Row row{context, records, in, out, first};
  sweep(context.list->particles(), [&](std::size_t i) { row(i); });
}

template <int dimensions, class Kernel, int count>
void transport(const SweepContext& context, PackedNeighbours& packed, const ScalarSweepInput& in,
               const ScalarSweepOutput& out, std::size_t first) {
  const bool shifted = in.shift[0] != nullptr;
  if (in.eddy_viscosity != nullptr || context.volume_ratio != nullptr) {
    if (shifted)
      transport_some<dimensions, Kernel, count, true, true>(context, packed, in, out, first);
    else
      transport_some<dimensions, Kernel, count, false, true>(context, packed, in, out, first);
  } else if (shifted) {
    transport_some<dimensions, Kernel, count, true, false>(context, packed, in, out, first);
  } else {
    transport_some<dimensions, Kernel, count, false, false>(context, packed, in, out, first);
  }
}

}  // namespace

std::int64_t scalar_transport_sweep(const SweepContext& context, PackedNeighbours& packed, const ScalarSweepInput& in,
                                    const ScalarSweepOutput& out) {
  std::int64_t sweeps = 0;
  with_plain_kernel(context.dimensions, context.kernel, [&]<int dimensions, class Kernel>() {
    const auto run = [&]<int count>(std::size_t first) {
      transport<dimensions, Kernel, count>(context, packed, in, out, first);
      return first + count;
    };
    const std::size_t all = in.values.size();
    for (std::size_t first = 0; first < all; ++sweeps) {
      const std::size_t left = all - first;
      first = left > 4   ? run.template operator()<8>(first)
              : left > 1 ? run.template operator()<4>(first)
                         : run.template operator()<1>(first);
    }
  });
  return sweeps;
}

}  // namespace spume
