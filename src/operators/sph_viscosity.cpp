// SPDX-License-Identifier: MIT
#include <algorithm>
#include <stdexcept>

#include "scalar_records.hpp"
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
struct NoPassenger {
  static constexpr int floats = 0;
  static void pack(const SweepContext&, float*, std::size_t, const RidingScalar*) {}
  NoPassenger(const RidingScalar*, std::size_t, const float*) {}
  template <class Batch>
  [[gnu::always_inline]] void add(const Batch&, float, f32n) {}
  void store(const RidingScalar*, std::size_t) const {}
};

// A scalar does, in a float that fills the records up to eight.
template <int dimensions, class Kernel>
class Passenger {
 public:
  static constexpr int floats = 1;
  static constexpr int slot = dimensions + 1;  // behind the velocity and kappa

  static void pack(const SweepContext& context, float* records, std::size_t width, const RidingScalar* scalar) {
    float* out = records + dimensions + slot;
    const double* const values = scalar->values;
    const double reference = scalar->reference;
    for_each_scalar_record(
        context,
        [=](std::size_t record, std::size_t i) { out[record * width] = static_cast<float>(values[i] - reference); },
        [=](std::size_t record) { out[record * width] = exchanges_nothing; });
    out[context.list->points() * width] = exchanges_nothing;  // the sentinel
  }

  [[gnu::always_inline]] Passenger(const RidingScalar* scalar, std::size_t i, const float* own_record)
      : own_(simd::splat<f32n>(own_record[dimensions + slot])) {
    if (scalar->shift[0] == nullptr) return;
    // L is symmetric: (L sum g d f) . s = sum g f (d . L s).
    std::array<float, dimensions> s;
    for (int a = 0; a < dimensions; ++a) s[a] = scalar->shift[a][i];
    direction_ = symmetric_product<dimensions>(scalar->correction, i, s);
  }
  // With 4 g in the place of g, and kappa in that of nu a. Differences from what exchanges nothing count as none.
  template <class Batch>
  [[gnu::always_inline]] void add(const Batch& b, float gradient_scale, f32n own_kappa) {
    const f32n slope = (-4.0F * gradient_scale) * Kernel::f(b.q);
    f32n pull{};
    for (int a = 0; a < dimensions; ++a) pull = pull + b.d[a] * direction_[a];
    const f32n value = b.payload[slot];
    const f32n difference = value < simd::splat<f32n>(exchanges_nothing) ? value - own_ : f32n{};
    const f32n slant = slope * difference;
    rate_ = rate_ + (own_kappa + b.payload[dimensions]) * slant;
    along_ = along_ + pull * slant;
    low_ = simd::min(low_, difference);
    high_ = simd::max(high_, difference);
  }
  [[gnu::always_inline]] void store(const RidingScalar* scalar, std::size_t i) const {
    scalar->rate[i] = static_cast<float>(scalar->diffusivity / (4 * scalar->viscosity)) * simd::sum(rate_);
    if (scalar->shift[0] != nullptr)
      scalar->change[i] = std::clamp(0.25F * simd::sum(along_), 0.5F * simd::least(low_), 0.5F * simd::largest(high_));
  }

 private:
  f32n own_;
  std::array<float, dimensions> direction_{};  // L s
  f32n rate_{}, along_{}, low_{}, high_{};     // no arrays: GCC 12 keeps such sums in memory
};

// `records` as the viscous sweep has packed them.
template <int dimensions, class Kernel, bool stress>
void take_off_linear_part(const SweepContext& context, const float* records, const float* kappa,
                          const std::array<float*, 3>& out, const LinearPart& taken_off) {
  const NeighbourList& list = *context.list;
  constexpr int payload = dimensions + 1 + volume_slots<Kernel>;
  constexpr int width = record_width(dimensions, payload);
  const KernelScale<dimensions, Kernel> common(context);
  const auto tiny = static_cast<float>(coincident * context.smoothing_length * context.smoothing_length);
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

template <int dimensions, class Kernel, bool stress, class Beside>
void viscous(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
             const VelocityImageRule& rule, const float* kappa, const std::array<float*, 3>& out,
             const LinearPart& taken_off, const RidingScalar* scalar) {
  const NeighbourList& list = *context.list;
  constexpr int alone = dimensions + 1 + volume_slots<Kernel>, payload = alone + Beside::floats;
  constexpr int width = record_width(dimensions, payload);
  static_assert(width == record_width(dimensions, alone));
  float* records = packed.prepare(context, payload);
  pack_velocity(context, records, width, 0, velocity, rule);
  pack_coefficient(context, records, width, dimensions, kappa);
  pack_own_volumes<Kernel>(context, records, width, dimensions + 1);
  Beside::pack(context, records, width, scalar);
  const KernelScale<dimensions, Kernel> common(context);
  const auto tiny = static_cast<float>(coincident * context.smoothing_length * context.smoothing_length);

  sweep(list.particles(), [&](std::size_t i) {
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    std::array<f32n, dimensions> own{}, sum{};
    for (int a = 0; a < dimensions; ++a) own[a] = simd::splat<f32n>(records[i * width + dimensions + a]);
    const f32n own_kappa = simd::splat<f32n>(kappa[i]);
    Beside beside(scalar, i, records + i * width);
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      std::array<f32n, dimensions> difference;
      for (int a = 0; a < dimensions; ++a) difference[a] = b.payload[a] - own[a];
      add_pair<dimensions, stress>(b, pair_weight<dimensions, Kernel>(b, scale.gradient, own_kappa), difference, tiny,
                                   sum);
      beside.add(b, scale.gradient, own_kappa);
    });
    for (int a = 0; a < dimensions; ++a) out[a][i] = simd::sum(sum[a]);
    beside.store(scalar, i);
  });
  if (taken_off.share != nullptr)
    take_off_linear_part<dimensions, Kernel, stress>(context, records, kappa, out, taken_off);
}

}  // namespace

void viscous_sweep(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
                   const VelocityImageRule& rule, const float* kappa, const std::array<float*, 3>& out, bool stress,
                   const LinearPart& taken_off, const RidingScalar* scalar) {
  const bool rides = scalar != nullptr && scalar->values != nullptr;
  if (rides && context.length_ratio != nullptr)
    throw std::logic_error("no scalar rides on a viscous sweep of particles that differ in size");
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    const auto run = [&]<bool stress_form, class Beside>() {
      viscous<dimensions, Kernel, stress_form, Beside>(context, packed, velocity, rule, kappa, out, taken_off, scalar);
    };
    const auto with = [&]<class Beside>() {
      if (stress)
        run.template operator()<true, Beside>();
      else
        run.template operator()<false, Beside>();
    };
    if constexpr (!is_variable_h<Kernel>)
      if (rides) return with.template operator()<Passenger<dimensions, Kernel>>();
    with.template operator()<NoPassenger>();
  });
}

}  // namespace spume
