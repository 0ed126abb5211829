// SPDX-License-Identifier: MIT
#include <algorithm>
#include <stdexcept>

#include "scalar_records.hpp"
#include "scalar_sums.hpp"
#include "spume/core/joined_lanes.hpp"
#include "spume/operators/scalar_transport.hpp"
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

// Nothing rides on the sweep.
struct NoPassengers {
  static constexpr int floats = 0;
  static void pack(const SweepContext&, float*, std::size_t, const RidingScalars*) {}
  NoPassengers(const RidingScalars*, std::size_t, const float*) {}
  template <class Batch>
  [[gnu::always_inline]] void add(const Batch&, float, f32n) {}
  void store(const RidingScalars*, std::size_t) const {}
};

// `count` scalars do, in floats behind the velocity and kappa.
template <int dimensions, class Kernel, int count>
class Passengers {
 public:
  static constexpr int floats = count;
  static constexpr int slot = dimensions + 1;

  static void pack(const SweepContext& context, float* records, std::size_t width, const RidingScalars* scalars) {
    float* const out = records + dimensions + slot;
    const auto clear = [=](std::size_t record) { std::fill_n(out + record * width, count, exchanges_nothing); };
    for_each_scalar_record(
        context,
        [=](std::size_t record, std::size_t i) {
          unrolled<count>([&](auto s) {
            out[record * width + s] = static_cast<float>(scalars->values[s][i] - scalars->reference[s]);
          });
        },
        clear);
    clear(context.list->points());  // the sentinel
  }

  [[gnu::always_inline]] Passengers(const RidingScalars* scalars, std::size_t i, const float* own_record)
      : sums_(own_record + dimensions + slot) {
    if (scalars->shift[0] == nullptr) return;
    // L is symmetric: (L sum g d f) . s = sum g f (d . L s).
    std::array<float, dimensions> s;
    for (int a = 0; a < dimensions; ++a) s[a] = scalars->shift[a][i];
    direction_ = symmetric_product<dimensions>(scalars->correction, i, s);
  }
  // With 4 g in the place of g, and kappa in that of nu a. Differences from what exchanges nothing count as none.
  template <class Batch>
  [[gnu::always_inline]] void add(const Batch& b, float gradient_scale, f32n own_kappa) {
    const f32n slope = (-4.0F * gradient_scale) * Kernel::f(b.q);
    f32n pull{};
    for (int a = 0; a < dimensions; ++a) pull = pull + b.d[a] * direction_[a];
    sums_.template add<slot>(b.payload, b.payload[slot] < simd::splat<f32n>(exchanges_nothing),
                             (own_kappa + b.payload[dimensions]) * slope, pull * slope, f32n{});
  }
  [[gnu::always_inline]] void store(const RidingScalars* scalars, std::size_t i) const {
    const auto found = sums_.found(0.25F);
    const auto share = static_cast<float>(1 / (4 * scalars->viscosity));
    for (int s = 0; s < count; ++s) scalars->rate[s][i] = scalars->diffusivity[s] * share * found.rate[s];
    if (scalars->shift[0] == nullptr) return;
    for (int s = 0; s < count; ++s) scalars->change[s][i] = found.change[s];
  }

 private:
  ScalarSums<count, true> sums_;
  std::array<float, dimensions> direction_{};  // L s
};

// `records` as the viscous sweep has packed them.
template <int dimensions, class Kernel, bool stress, int payload>
void take_off_linear_part(const SweepContext& context, const float* records, const float* kappa,
                          const std::array<float*, 3>& out, const LinearPart& taken_off) {
  const NeighbourList& list = *context.list;
  constexpr int width = record_width(dimensions, payload);
  const KernelScale<dimensions, Kernel> common(context);
  const auto tiny = static_cast<float>(coincident * context.smoothing_length * context.smoothing_length);
  sweep(list.particles(), [&](std::size_t i) {
    if (taken_off.share[i] == 0) return;
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    std::array<f32n, dimensions> own{}, sum{};
    for (int a = 0; a < dimensions; ++a) own[a] = simd::splat<f32n>(records[i * width + dimensions + a]);
    std::array<std::array<f32n, dimensions>, dimensions> m{};
    for_each_batch<dimensions, payload>(
        list, records, i, scale.inverse_h, [&](const auto& b) __attribute__((always_inline)) {
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
    for_each_batch<dimensions, payload>(
        list, records, i, scale.inverse_h, [&](const auto& b) __attribute__((always_inline)) {
          std::array<f32n, dimensions> linear{};
          for (int a = 0; a < dimensions; ++a)
            for (int c = 0; c < dimensions; ++c) linear[a] = linear[a] + gradient[a][c] * b.d[c];
          add_pair<dimensions, stress>(b, pair_weight<dimensions, Kernel>(b, scale.gradient, own_kappa), linear, tiny,
                                       sum);
        });
    for (int a = 0; a < dimensions; ++a) out[a][i] -= simd::sum(sum[a]);
  });
}

template <int dimensions, class Kernel, bool stress, class Beside>
void viscous(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
             const VelocityImageRule& rule, const float* kappa, const std::array<float*, 3>& out,
             const LinearPart& taken_off, const RidingScalars* scalars) {
  const NeighbourList& list = *context.list;
  constexpr int alone = dimensions + 1 + volume_slots<Kernel>, payload = alone + Beside::floats;
  constexpr int width = record_width(dimensions, payload);
  float* records = packed.prepare(context, payload);
  pack_velocity(context, records, width, 0, velocity, rule);
  pack_coefficient(context, records, width, dimensions, kappa);
  pack_own_volumes<Kernel>(context, records, width, dimensions + 1);
  Beside::pack(context, records, width, scalars);
  const KernelScale<dimensions, Kernel> common(context);
  const auto tiny = static_cast<float>(coincident * context.smoothing_length * context.smoothing_length);

  sweep(list.particles(), [&](std::size_t i) {
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    std::array<f32n, dimensions> own{}, sum{};
    for (int a = 0; a < dimensions; ++a) own[a] = simd::splat<f32n>(records[i * width + dimensions + a]);
    const f32n own_kappa = simd::splat<f32n>(kappa[i]);
    Beside beside(scalars, i, records + i * width);
    for_each_batch<dimensions, payload>(
        list, records, i, scale.inverse_h, [&](const auto& b) __attribute__((always_inline)) {
          std::array<f32n, dimensions> difference;
          for (int a = 0; a < dimensions; ++a) difference[a] = b.payload[a] - own[a];
          add_pair<dimensions, stress>(b, pair_weight<dimensions, Kernel>(b, scale.gradient, own_kappa), difference,
                                       tiny, sum);
          beside.add(b, scale.gradient, own_kappa);
        });
    const auto total = simd::sums_of(sum);
    for (int a = 0; a < dimensions; ++a) out[a][i] = total[a];
    beside.store(scalars, i);
  });
  if (taken_off.share != nullptr)
    take_off_linear_part<dimensions, Kernel, stress, payload>(context, records, kappa, out, taken_off);
}

}  // namespace

void viscous_sweep(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
                   const VelocityImageRule& rule, const float* kappa, const std::array<float*, 3>& out, bool stress,
                   const LinearPart& taken_off, const RidingScalars* scalars) {
  const std::size_t riding = scalars == nullptr ? 0 : scalars->values.size();
  if (riding > most_riding_scalars || (riding > 0 && context.length_ratio != nullptr))
    throw std::logic_error("at most five scalars ride on a viscous sweep, of particles of one size");
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    const auto with = [&]<class Beside>() {
      if (stress)
        viscous<dimensions, Kernel, true, Beside>(context, packed, velocity, rule, kappa, out, taken_off, scalars);
      else
        viscous<dimensions, Kernel, false, Beside>(context, packed, velocity, rule, kappa, out, taken_off, scalars);
    };
    if constexpr (!is_variable_h<Kernel>) {
      if (riding == 1) return with.template operator()<Passengers<dimensions, Kernel, 1>>();
      if (riding == 2) return with.template operator()<Passengers<dimensions, Kernel, 2>>();
      if (riding == 3) return with.template operator()<Passengers<dimensions, Kernel, 3>>();
      if (riding == 4) return with.template operator()<Passengers<dimensions, Kernel, 4>>();
      if (riding == 5) return with.template operator()<Passengers<dimensions, Kernel, 5>>();
    }
    with.template operator()<NoPassengers>();
  });
}

}  // namespace spume
