// SPDX-License-Identifier: MIT
#include "spume/operators/sph_operators.hpp"

#include <algorithm>
#include <cmath>

#include "change_bounds.hpp"
#include "symmetric_matrix.hpp"

namespace spume {
namespace {

using simd::f32n;

// Volumes of the particles as the last payload of a sweep with a variable h.
template <class Kernel>
void pack_volumes(const SweepContext& context, float* records, int width, int slot) {
  if constexpr (is_variable_h<Kernel>) pack_scalar(context, records, width, slot, context.volume_ratio);
}

// store(i, d u_a / d x_c as [a][c], bounds) for every particle; without `bounded` the bounds are of nothing.
template <int dimensions, class Kernel, bool filter, bool bounded, class Store>
void velocity_gradient(const SweepContext& context, PackedNeighbours& packed,
                       const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                       const std::array<const float*, 6>& correction, const VelocityGradientOut& out, Store&& store) {
  const NeighbourList& list = *context.list;
  constexpr int payload = dimensions + volume_slots<Kernel>;
  float* records = packed.prepare(context, payload);
  constexpr int width = record_width(dimensions, payload);
  pack_velocity(context, records, width, 0, velocity, rule);
  pack_volumes<Kernel>(context, records, width, dimensions);
  const KernelScale<dimensions, Kernel> common(context);
  const auto centre_value = static_cast<float>(Kernel::w(0.0));
  const bool changes = bounded && out.displacement[0] != nullptr;

  sweep(list.particles(), [&](std::size_t i) {
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    const float centre = centre_value * own_volume<Kernel>(context, i);
    std::array<f32n, dimensions> own{}, filtered{};
    for (int a = 0; a < dimensions; ++a) own[a] = simd::splat<f32n>(records[i * width + dimensions + a]);
    std::array<f32n, dimensions * dimensions> m{};
    ChangeBounds<dimensions> bounds;
    if (changes) {
      std::array<float, dimensions> displacement;
      for (int c = 0; c < dimensions; ++c) displacement[c] = out.displacement[c][i];
      bounds = ChangeBounds<dimensions>(displacement);
    }
    f32n kernel_sum{};
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      const f32n g = times_volume<Kernel>(-scale.gradient * Kernel::f(b.q), b);
      std::array<f32n, dimensions> gd;
      for (int c = 0; c < dimensions; ++c) gd[c] = g * b.d[c];
      typename ChangeBounds<dimensions>::Shares shares{};
      if constexpr (bounded) shares = bounds.template shares<Kernel>(b);
      for (int a = 0; a < dimensions; ++a) {
        const f32n difference = b.payload[a] - own[a];
        for (int c = 0; c < dimensions; ++c) m[a * dimensions + c] = m[a * dimensions + c] + difference * gd[c];
        if constexpr (bounded) bounds.add(a, shares, difference);
      }
      if constexpr (filter) {
        const f32n w = times_volume<Kernel>(Kernel::w(b.q), b);
        kernel_sum = kernel_sum + w;
        for (int a = 0; a < dimensions; ++a) filtered[a] = filtered[a] + w * b.payload[a];
      }
    });
    const auto sum = simd::sums_of(m);
    std::array<std::array<float, dimensions>, dimensions> gradient{};
    for (int a = 0; a < dimensions; ++a) {
      for (int c = 0; c < dimensions; ++c) gradient[a][c] = sum[a * dimensions + c];
      gradient[a] = symmetric_product<dimensions>(correction, i, gradient[a]);
    }
    if constexpr (filter) {
      const auto of_filter = simd::sums_of(filtered, std::array{kernel_sum});
      const float weight = 1 / (centre + of_filter[dimensions]);
      for (int a = 0; a < dimensions; ++a) out.filtered[a][i] = (centre * own[a][0] + of_filter[a]) * weight;
    }
    store(i, gradient, bounds);
  });
}

// What out asks for of the gradient of one particle.
template <int dimensions>
void store_gradient(const VelocityGradientOut& out, std::size_t i,
                    const std::array<std::array<float, dimensions>, dimensions>& gradient,
                    const ChangeBounds<dimensions>& bounds) {
  double trace = 0, squares = 0;
  for (int a = 0; a < dimensions; ++a)
    for (int c = 0; c < dimensions; ++c) {
      if (out.gradient[0] != nullptr) out.gradient[a * dimensions + c][i] = gradient[a][c];
      trace += double{gradient[a][c]} * gradient[c][a];
      squares += double{gradient[a][c]} * gradient[a][c];
    }
  if (out.trace != nullptr) out.trace[i] = static_cast<float>(trace);
  // S:S = (grad u : grad u + tr(grad u . grad u)) / 2
  if (out.strain != nullptr) out.strain[i] = static_cast<float>(std::sqrt(std::max(squares + trace, 0.0)));
  if (out.change[0] == nullptr) return;
  std::array<float, dimensions> change{};
  for (int a = 0; a < dimensions; ++a)
    for (int c = 0; c < dimensions; ++c) change[a] += gradient[a][c] * out.displacement[c][i];
  bounds.cut(change);
  for (int a = 0; a < dimensions; ++a) out.change[a][i] = change[a];
}

// The velocity gradient G of the nearest particle as wall point g has it: S G R, with R the reflection at the surface
// and S = R, or -1 where the surface holds the liquid. Behind an opening it is G.
template <int dimensions>
void mirror_gradient(const WallStencils& walls, std::size_t g, bool friction,
                     std::array<float, dimensions * dimensions>& gradient) {
  if (!walls.is_wall(g)) return;
  std::array<float, dimensions> n;
  for (int a = 0; a < dimensions; ++a) n[a] = walls.normal[a][g];
  for (int a = 0; a < dimensions; ++a) {
    float along = 0;
    for (int b = 0; b < dimensions; ++b) along += gradient[a * dimensions + b] * n[b];
    for (int b = 0; b < dimensions; ++b) gradient[a * dimensions + b] -= 2 * along * n[b];
  }
  const bool holds = friction && walls.no_slip[g] != 0;
  for (int b = 0; b < dimensions; ++b) {
    float along = 0;
    for (int a = 0; a < dimensions; ++a) along += gradient[a * dimensions + b] * n[a];
    for (int a = 0; a < dimensions; ++a) {
      float& entry = gradient[a * dimensions + b];
      entry = holds ? -entry : entry - 2 * along * n[a];
    }
  }
}

template <int dimensions, class Kernel>
void shift_curvature(const SweepContext& context, PackedNeighbours& packed, const std::array<const float*, 9>& gradient,
                     const VelocityImageRule& rule, const std::vector<std::array<float, 3>>& reflection,
                     const std::array<const float*, 3>& shift, const std::array<const float*, 6>& correction,
                     const std::array<float*, 3>& out) {
  constexpr int entries = dimensions * dimensions;
  constexpr int payload = entries + volume_slots<Kernel>;
  constexpr int width = record_width(dimensions, payload);
  const NeighbourList& list = *context.list;
  const std::size_t n = list.particles();
  float* records = packed.prepare(context, payload);
  pack_volumes<Kernel>(context, records, width, entries);
  parallel_for(n, [&](std::size_t i) {
    for (int k = 0; k < entries; ++k) records[i * width + dimensions + k] = gradient[k][i];
  });
  parallel_for(context.images->size(), [&](std::size_t m) {
    const auto source = static_cast<std::size_t>(context.images->source()[m]);
    const auto path = static_cast<std::size_t>(context.images->path()[m]);
    std::array<float, entries> own;
    for (int k = 0; k < entries; ++k) own[k] = gradient[k][source];
    if (context.walls != nullptr && context.images->wall_point()[m] >= 0)
      mirror_gradient<dimensions>(*context.walls, static_cast<std::size_t>(context.images->wall_point()[m]),
                                  rule.friction, own);
    for (int a = 0; a < dimensions; ++a)
      for (int b = 0; b < dimensions; ++b)
        records[(n + m) * width + dimensions + a * dimensions + b] =
            rule.sign[path][a] * reflection[path][b] * own[a * dimensions + b];
  });
  const KernelScale<dimensions, Kernel> common(context);

  sweep(n, [&](std::size_t i) {
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    std::array<float, dimensions> s;
    for (int a = 0; a < dimensions; ++a) s[a] = shift[a][i];
    // L is symmetric: (L sum g d f) . s = sum g f (d . L s).
    const std::array<float, dimensions> direction = symmetric_product<dimensions>(correction, i, s);
    std::array<f32n, dimensions> sum{};
    std::array<float, entries> own;
    for (int k = 0; k < entries; ++k) own[k] = records[i * width + dimensions + k];
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      f32n along{};
      for (int a = 0; a < dimensions; ++a) along = along + b.d[a] * direction[a];
      const f32n weight = times_volume<Kernel>(-scale.gradient * Kernel::f(b.q), b) * along;
      for (int a = 0; a < dimensions; ++a) {
        f32n difference{};
        for (int c = 0; c < dimensions; ++c)
          difference = difference + s[c] * (b.payload[a * dimensions + c] - own[a * dimensions + c]);
        sum[a] = sum[a] + weight * difference;
      }
    });
    for (int a = 0; a < dimensions; ++a) out[a][i] += 0.5F * simd::sum(sum[a]);
  });
}

template <int dimensions, class Kernel>
void divergence_of(const SweepContext& context, PackedNeighbours& packed, const std::array<const double*, 3>& velocity,
                   const VelocityImageRule& rule, const std::array<const float*, 6>& correction,
                   const double* potential, double* divergence, float* negative_laplacian) {
  const NeighbourList& list = *context.list;
  constexpr int payload = dimensions + 1 + volume_slots<Kernel>;
  float* records = packed.prepare(context, payload);
  constexpr int width = record_width(dimensions, payload);
  pack_velocity(context, records, width, 0, velocity, rule);
  if (potential != nullptr) pack_scalar(context, records, width, dimensions, potential);
  pack_volumes<Kernel>(context, records, width, dimensions + 1);
  const KernelScale<dimensions, Kernel> common(context);

  sweep(list.particles(), [&](std::size_t i) {
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    std::array<f32n, dimensions> own{};
    for (int a = 0; a < dimensions; ++a) own[a] = simd::splat<f32n>(records[i * width + dimensions + a]);
    const f32n own_potential = simd::splat<f32n>(records[i * width + 2 * dimensions]);
    std::array<f32n, dimensions * dimensions> m{};
    f32n laplacian{};
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      const f32n g = times_volume<Kernel>(-scale.gradient * Kernel::f(b.q), b);
      std::array<f32n, dimensions> gd;
      for (int c = 0; c < dimensions; ++c) gd[c] = g * b.d[c];
      for (int a = 0; a < dimensions; ++a) {
        const f32n difference = b.payload[a] - own[a];
        for (int c = 0; c < dimensions; ++c) m[a * dimensions + c] = m[a * dimensions + c] + difference * gd[c];
      }
      laplacian = laplacian + g * (own_potential - b.payload[dimensions]);
    });
    const auto sum = simd::sums_of(m, std::array{laplacian});
    double result = 0;
    for (int a = 0; a < dimensions; ++a)
      for (int c = 0; c < dimensions; ++c)
        result += double{correction[symmetric_index<dimensions>(a, c)][i]} * sum[a * dimensions + c];
    divergence[i] = result;
    if (potential != nullptr) negative_laplacian[i] = 2 * sum[dimensions * dimensions];
  });
}

template <int dimensions, class Kernel>
void gradient_of(const SweepContext& context, PackedNeighbours& packed, const double* values, double reference,
                 const std::array<const float*, 6>& correction, const std::array<float*, 3>& out) {
  const NeighbourList& list = *context.list;
  const std::size_t n = list.particles();
  constexpr int payload = 1 + volume_slots<Kernel>;
  float* records = packed.prepare(context, payload);
  constexpr int width = record_width(dimensions, payload);
  pack_volumes<Kernel>(context, records, width, 1);
  parallel_for(n, [=](std::size_t i) { records[i * width + dimensions] = static_cast<float>(values[i] - reference); });
  for_each_image_pressure(context, values, true, [=](std::size_t k, double value) {
    records[(n + k) * width + dimensions] = static_cast<float>(value - reference);
  });
  const KernelScale<dimensions, Kernel> common(context);

  sweep(n, [&](std::size_t i) {
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    const f32n own = simd::splat<f32n>(records[i * width + dimensions]);
    std::array<f32n, dimensions> sum{};
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      const f32n weight = times_volume<Kernel>(-scale.gradient * Kernel::f(b.q) * (b.payload[0] - own), b);
      for (int a = 0; a < dimensions; ++a) sum[a] = sum[a] + weight * b.d[a];
    });
    const auto v = symmetric_product<dimensions>(correction, i, simd::sums_of(sum));
    for (int a = 0; a < dimensions; ++a) out[a][i] = v[a];
  });
}

// Of the `count` particles that a list names, or of the first where it is null.
template <int dimensions, class Kernel>
void filter_listed(const SweepContext& context, PackedNeighbours& packed, const std::array<const float*, 3>& values,
                   const std::vector<std::array<float, 3>>& reflection, std::size_t count, const std::int32_t* listed,
                   const std::array<float*, 3>& out) {
  const NeighbourList& list = *context.list;
  constexpr int payload = dimensions + volume_slots<Kernel>;
  float* records = packed.prepare(context, payload);
  constexpr int width = record_width(dimensions, payload);
  pack_vector(context, records, width, 0, values, reflection);
  pack_volumes<Kernel>(context, records, width, dimensions);
  const KernelScale<dimensions, Kernel> common(context);
  const auto centre_value = static_cast<float>(Kernel::w(0.0));

  sweep(count, [&](std::size_t s) {
    const std::size_t i = listed == nullptr ? s : static_cast<std::size_t>(listed[s]);
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    const float centre = centre_value * own_volume<Kernel>(context, i);
    std::array<f32n, dimensions> filtered{};
    f32n kernel_sum{};
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      const f32n w = times_volume<Kernel>(Kernel::w(b.q), b);
      kernel_sum = kernel_sum + w;
      for (int a = 0; a < dimensions; ++a) filtered[a] = filtered[a] + w * b.payload[a];
    });
    const auto sum = simd::sums_of(filtered, std::array{kernel_sum});
    const float weight = 1 / (centre + sum[dimensions]);
    for (int a = 0; a < dimensions; ++a) out[a][i] = (centre * values[a][i] + sum[a]) * weight;
  });
}

// The scalars from `first_scalar` on, of which image_value counts all.
template <int dimensions, class Kernel, int count>
void filter_some(const SweepContext& context, PackedNeighbours& packed, std::span<const float* const> all_values,
                 std::span<float* const> all_out, std::size_t first_scalar, const ImageValue& image_value) {
  const auto values = all_values.subspan(first_scalar, count);
  const auto out = all_out.subspan(first_scalar, count);
  const NeighbourList& list = *context.list;
  constexpr int payload = count + volume_slots<Kernel>;
  float* records = packed.prepare(context, payload);
  constexpr int width = record_width(dimensions, payload);
  for (int k = 0; k < count; ++k) pack_scalar(context, records, width, k, values[k]);
  if (image_value)
    parallel_for(context.images->size(), [&](std::size_t m) {
      for (int k = 0; k < count; ++k)
        records[(list.particles() + m) * width + dimensions + k] = image_value(first_scalar + k, m);
    });
  pack_volumes<Kernel>(context, records, width, count);
  const KernelScale<dimensions, Kernel> common(context);
  const auto centre_value = static_cast<float>(Kernel::w(0.0));

  sweep(list.particles(), [&](std::size_t i) {
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    const float centre = centre_value * own_volume<Kernel>(context, i);
    std::array<f32n, count> filtered{};
    f32n kernel_sum{};
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& b) {
      const f32n w = times_volume<Kernel>(Kernel::w(b.q), b);
      kernel_sum = kernel_sum + w;
      for (int k = 0; k < count; ++k) filtered[k] = filtered[k] + w * b.payload[k];
    });
    const float weight = 1 / (centre + simd::sum(kernel_sum));
    for (int k = 0; k < count; ++k)
      out[k][i] = (centre * records[i * width + dimensions + k] + simd::sum(filtered[k])) * weight;
  });
}

}  // namespace

void velocity_gradient_sweep(const SweepContext& context, PackedNeighbours& packed,
                             const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                             const std::array<const float*, 6>& correction, const VelocityGradientOut& out) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    const auto store = [&](std::size_t i, const auto& gradient, const auto& bounds) {
      store_gradient<dimensions>(out, i, gradient, bounds);
    };
    const auto run = [&]<bool filter, bool bounded>() {
      velocity_gradient<dimensions, Kernel, filter, bounded>(context, packed, velocity, rule, correction, out, store);
    };
    // Beside a filter the bounds come along where nobody asks for the change: one variant less to compile.
    const bool filter = out.filtered[0] != nullptr, bounded = out.change[0] != nullptr;
    if (filter)
      run.template operator()<true, true>();
    else if (bounded)
      run.template operator()<false, true>();
    else
      run.template operator()<false, false>();
  });
}

void gradient_trace_sweep(const SweepContext& context, PackedNeighbours& packed,
                          const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                          const std::array<const float*, 6>& correction, float* trace) {
  VelocityGradientOut out;
  out.trace = trace;
  velocity_gradient_sweep(context, packed, velocity, rule, correction, out);
}

void shift_curvature_sweep(const SweepContext& context, PackedNeighbours& packed,
                           const std::array<const float*, 9>& gradient, const VelocityImageRule& rule,
                           const std::vector<std::array<float, 3>>& reflection,
                           const std::array<const float*, 3>& shift, const std::array<const float*, 6>& correction,
                           const std::array<float*, 3>& out) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    shift_curvature<dimensions, Kernel>(context, packed, gradient, rule, reflection, shift, correction, out);
  });
}

void divergence_sweep(const SweepContext& context, PackedNeighbours& packed,
                      const std::array<const double*, 3>& velocity, const VelocityImageRule& rule,
                      const std::array<const float*, 6>& correction, const double* potential, double* divergence,
                      float* negative_laplacian) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    divergence_of<dimensions, Kernel>(context, packed, velocity, rule, correction, potential, divergence,
                                      negative_laplacian);
  });
}

void gradient_sweep(const SweepContext& context, PackedNeighbours& packed, const double* values, double reference,
                    const std::array<const float*, 6>& correction, const std::array<float*, 3>& out) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    gradient_of<dimensions, Kernel>(context, packed, values, reference, correction, out);
  });
}

void filter_vector_subset(const SweepContext& context, PackedNeighbours& packed,
                          const std::array<const float*, 3>& values,
                          const std::vector<std::array<float, 3>>& reflection, std::span<const std::int32_t> subset,
                          const std::array<float*, 3>& out) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    filter_listed<dimensions, Kernel>(context, packed, values, reflection, subset.size(), subset.data(), out);
  });
}

void filter_vector(const SweepContext& context, PackedNeighbours& packed, const std::array<const float*, 3>& values,
                   const std::vector<std::array<float, 3>>& reflection, const std::array<float*, 3>& out) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    filter_listed<dimensions, Kernel>(context, packed, values, reflection, context.list->particles(), nullptr, out);
  });
}

void filter_scalars(const SweepContext& context, PackedNeighbours& packed, std::span<const float* const> values,
                    std::span<float* const> out, const ImageValue& image_value) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    std::size_t k = 0;
    for (; k + 1 < values.size(); k += 2)
      filter_some<dimensions, Kernel, 2>(context, packed, values, out, k, image_value);
    if (k < values.size()) filter_some<dimensions, Kernel, 1>(context, packed, values, out, k, image_value);
  });
}

}  // namespace spume
