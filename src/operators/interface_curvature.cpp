// SPDX-License-Identifier: MIT
#include "spume/operators/interface_curvature.hpp"

#include "gfd_row.hpp"
#include "spume/core/joined_lanes.hpp"

namespace spume {
namespace {

using simd::f32n;

void set_zero(const SweepContext& context, const std::array<float*, 3>& out) {
  parallel_for(context.list->particles(), [&](std::size_t i) {
    for (int a = 0; a < context.dimensions; ++a) out[a][i] = 0;
  });
}

template <int dimensions>
float squared_length(const std::array<float, dimensions>& v) {
  float sum = 0;
  for (const float component : v) sum += component * component;
  return sum;
}

// div n of a particle on the band from sum W (n_j - n_i)_a d_c and sum W d_a d_c over the band.
template <int dimensions>
float divergence(const std::array<f32n, dimensions * dimensions>& slopes,
                 const std::array<f32n, symmetric_entries<dimensions>>& second) {
  constexpr int entries = symmetric_entries<dimensions>;
  const auto total = simd::sums_of(second, slopes);
  std::array<double, 6> m{}, b{};
  for (int k = 0; k < entries; ++k) m[k] = total[k];
  const double scale = normalised_inverse<dimensions>(m, b).scale;
  double sum = 0;
  for (int a = 0; a < dimensions; ++a)
    for (int c = 0; c < dimensions; ++c)
      sum += scale * b[symmetric_index<dimensions>(a, c)] * total[entries + a * dimensions + c];
  return static_cast<float>(sum);
}

// Normals at wall points of bodies are fits to those of the band and to the zeros beyond it: they become as long as
// that of the particle nearest to the place that they mirror.
template <int dimensions>
void restore_length(const SweepContext& context, float* records, const std::array<const float*, 3>& normal) {
  constexpr int width = record_width(dimensions, dimensions);
  if (context.walls == nullptr) return;
  const std::int32_t* point = context.images->wall_point();
  const std::int32_t* source = context.images->source();
  parallel_for(context.images->size(), [&](std::size_t k) {
    if (point[k] < 0) return;
    float* v = records + (context.list->particles() + k) * width + dimensions;
    float square = 0;
    for (int a = 0; a < dimensions; ++a) square += v[a] * v[a];
    const float nearest =
        squared_length<dimensions>(own_vector<dimensions>(normal, static_cast<std::size_t>(source[k])));
    const float factor = square > 0 ? std::sqrt(nearest / square) : 0;
    for (int a = 0; a < dimensions; ++a) v[a] *= factor;
  });
}

template <int dimensions, class Kernel>
void curvature_of(const SweepContext& context, PackedNeighbours& packed, std::span<const std::int32_t> subset,
                  const std::array<const float*, 3>& normal, const std::vector<std::array<float, 3>>& reflection,
                  float* curvature) {
  constexpr int width = record_width(dimensions, dimensions);
  float* records = packed.prepare(context, dimensions);
  pack_vector(context, records, width, 0, normal, reflection);
  restore_length<dimensions>(context, records, normal);
  const float inverse_h = inverse_width(context);
  sweep(subset.size(), [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(subset[s]);
    const auto own = own_vector<dimensions>(normal, i);
    if (!(squared_length<dimensions>(own) > 0)) return;
    std::array<f32n, dimensions * dimensions> slopes{};
    std::array<f32n, symmetric_entries<dimensions>> second{};
    for_each_batch<dimensions, dimensions>(*context.list, records, i, inverse_h, [&](const auto& b) {
      f32n square{};
      for (int a = 0; a < dimensions; ++a) square = square + b.payload[a] * b.payload[a];
      const f32n w = square > 0.0F ? Kernel::w(b.q) : f32n{};
      int slot = 0;
      for (int c = 0; c < dimensions; ++c) {
        const f32n wd = w * b.d[c];
        for (int a = 0; a < dimensions; ++a)
          slopes[a * dimensions + c] = slopes[a * dimensions + c] + (b.payload[a] - own[a]) * wd;
        for (int e = c; e < dimensions; ++e) second[slot] = second[slot] + wd * b.d[e], ++slot;
      }
    });
    curvature[i] = -divergence<dimensions>(slopes, second);
  });
}

}  // namespace

void interface_normal_sweep(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                            const float* colour, const float* density, const std::array<const float*, 6>& correction,
                            double threshold, const InterfaceNormals& out) {
  set_zero(context, out.gradient);
  set_zero(context, out.normal);
  gfd_gradient_over_density_subset(context, packed, colour, density, correction, bands.varying(), out.gradient);
  const auto least = static_cast<float>(threshold / context.smoothing_length);
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    parallel_for(bands.varying().size(), [&](std::size_t s) {
      const auto i = static_cast<std::size_t>(bands.varying()[s]);
      std::array<float, dimensions> v;
      for (int a = 0; a < dimensions; ++a) v[a] = out.gradient[a][i];
      const float length = std::sqrt(squared_length<dimensions>(v));
      const bool on_band = density[i] * length > least;
      for (int a = 0; a < dimensions; ++a) {
        if (on_band) out.normal[a][i] = v[a] / length;
        if (!on_band) out.gradient[a][i] = 0;
      }
    });
  });
}

void curvature_sweep(const SweepContext& context, PackedNeighbours& packed, std::span<const std::int32_t> subset,
                     const std::array<const float*, 3>& normal, const std::vector<std::array<float, 3>>& reflection,
                     float* curvature) {
  parallel_for(context.list->particles(), [&](std::size_t i) { curvature[i] = 0; });
  if (subset.empty()) return;
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    curvature_of<dimensions, Kernel>(context, packed, subset, normal, reflection, curvature);
  });
}

void tension_acceleration(const SweepContext& context, const InterfaceBands& bands, double tension,
                          const float* curvature, const std::array<const float*, 3>& gradient,
                          const std::array<float*, 3>& out) {
  set_zero(context, out);
  parallel_for(bands.varying().size(), [&](std::size_t s) {
    const auto i = static_cast<std::size_t>(bands.varying()[s]);
    const float factor = static_cast<float>(tension) * curvature[i];
    for (int a = 0; a < context.dimensions; ++a) out[a][i] = factor * gradient[a][i];
  });
}

}  // namespace spume
