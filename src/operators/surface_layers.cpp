// SPDX-License-Identifier: MIT
#include "spume/operators/surface_layers.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "free_box_sweep.hpp"
#include "spume/operators/image_values.hpp"

namespace spume {
namespace {

using simd::f32n;

// Depths in spacings. A drop or a sheet of one layer holds less than the column of a lattice; at the second layer the
// surface is 1.5 away.
constexpr float shallowest = 0.25F, deepest = 2;

// In kernel widths: beyond every neighbour, nearer than the sentinel.
constexpr float beyond_neighbours = 1e3F;

// A near-surface particle one spacing above adds (1 - 1 / 1.8^2)^2 = 0.48: one is enough for the whole normal.
constexpr float full_weight = 0.4F;

f32n zero() {
  return f32n{};
}

// A, of integral 1 over a line or a disc: on a lattice of unit spacing it sums to nearly 1.
template <int dimensions>
[[gnu::always_inline]] inline f32n across(f32n x) {
  constexpr float scale = dimensions == 2 ? 1.0F / 6 : static_cast<float>(15 / (7 * std::numbers::pi) / 6);
  const f32n a = simd::max(2.0F - x, zero()), b = simd::max(1.0F - x, zero());
  return scale * (a * a * a - 4.0F * (b * b * b));
}

// B: 1 at s = z - 1.2 = -1, 1/2 at 0, 0 at 1; slope 0 at both ends.
[[gnu::always_inline]] inline f32n down_column(f32n z) {
  const f32n s = simd::min(simd::max(z - 1.2F, simd::splat<f32n>(-1)), simd::splat<f32n>(1));
  return 0.5F - s + 0.5F * s * simd::max(s, -s);
}

template <int dimensions>
[[gnu::always_inline]] inline f32n column(f32n x, f32n z) {
  return across<dimensions>(x) * down_column(z);
}
template <int dimensions>
float column_at(float x, float z) {
  return column<dimensions>(simd::splat<f32n>(x), simd::splat<f32n>(z))[0];
}

// What the column holds below a flat lattice surface, in spacings.
template <int dimensions>
float lattice_column() {
  double sum = 0;
  for (int layer = 0; layer <= 2; ++layer)
    for (int j = dimensions == 3 ? -1 : 0; j <= (dimensions == 3 ? 1 : 0); ++j)
      for (int i = -1; i <= 1; ++i)
        sum += double{column_at<dimensions>(static_cast<float>(std::hypot(i, j)), static_cast<float>(layer))};
  return static_cast<float>(sum);
}

template <int dimensions>
using Vector = std::array<float, dimensions>;

template <int dimensions>
float length(const Vector<dimensions>& v) {
  float sum = 0;
  for (const float component : v) sum += component * component;
  return std::sqrt(sum);
}

// False where the vector vanishes.
template <int dimensions>
bool make_unit(Vector<dimensions>& v) {
  const float size = length<dimensions>(v);
  if (!(size > 0)) return false;
  for (float& component : v) component /= size;
  return true;
}

template <int dimensions>
Vector<dimensions> vector_of(const std::array<const float*, 3>& field, std::size_t i) {
  Vector<dimensions> v;
  for (int axis = 0; axis < dimensions; ++axis) v[axis] = field[axis][i];
  return v;
}

template <class Batch, std::size_t dimensions>
[[gnu::always_inline]] inline f32n dot(const Batch& d, const std::array<float, dimensions>& n) {
  f32n sum{};
  for (std::size_t axis = 0; axis < dimensions; ++axis) sum = sum + n[axis] * d[axis];
  return sum;
}

template <int dimensions, class Kernel>
void find_own_depths(const SweepContext& context, PackedNeighbours& packed, const NearSurface& near_surface,
                     std::span<float> of_particle) {
  constexpr int payload = volume_slots<Kernel>;
  float* records = packed.prepare(context, payload);
  if constexpr (is_variable_h<Kernel>)
    pack_scalar(context, records, record_width(dimensions, payload), 0, context.volume_ratio);
  const KernelScale<dimensions, Kernel> common(context);
  const float of_lattice = lattice_column<dimensions>(), own_column = column_at<dimensions>(0, 0);
  const auto spacing = static_cast<float>(near_surface.spacing),
             per_spacing = static_cast<float>(1 / near_surface.spacing);

  sweep(near_surface.particles.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(near_surface.particles[k]);
    auto normal = vector_of<dimensions>(near_surface.normal, i);
    if (!make_unit<dimensions>(normal)) {
      of_particle[i] = spacing;
      return;
    }
    for (float& component : normal) component *= per_spacing;
    f32n content{};
    for_each_batch<dimensions, payload>(*context.list, records, i, common.at(context, i).inverse_h, [&](const auto& b) {
      f32n r2{};
      for (int axis = 0; axis < dimensions; ++axis) r2 = r2 + b.d[axis] * b.d[axis];
      const f32n below = -dot(b.d, normal);
      const f32n aside = simd::sqrt(simd::max(r2 * (per_spacing * per_spacing) - below * below, zero()));
      const f32n part = times_volume<Kernel>(column<dimensions>(aside, below), b);
      content = content + (b.q < beyond_neighbours ? part : zero());
    });
    const float sum = own_volume<Kernel>(context, i) * own_column + simd::sum(content);
    of_particle[i] = spacing * std::clamp(0.5F + sum - of_lattice, shallowest, deepest);
  });
}

// The same where the column is counted in a box.
template <int dimensions, class Kernel>
void find_box_depths(const SweepContext& context, const NearSurface& near_surface, std::span<float> of_particle) {
  const KernelScale<dimensions, Kernel> common(context);
  const float of_lattice = lattice_column<dimensions>();
  const auto spacing = static_cast<float>(near_surface.spacing);
  sweep(near_surface.boxes.size(), [&](std::size_t k) {
    const FreeBox& box = near_surface.boxes[k];
    const auto i = static_cast<std::size_t>(box.particle);
    auto normal = vector_of<dimensions>(near_surface.normal, i);
    if (!(of_particle[i] > 0) || !make_unit<dimensions>(normal)) return;
    double content = 0;
    visit_box<dimensions>(context, *near_surface.solids, box, near_surface.spacing,
                          Kernel::support / common.at(context, i).inverse_h,
                          [&](const std::array<double, dimensions>& d, double share, std::size_t source) {
                            double r2 = 0, along = 0;
                            for (int axis = 0; axis < dimensions; ++axis) {
                              r2 += d[axis] * d[axis];
                              along += normal[axis] * d[axis];
                            }
                            const double aside = std::sqrt(std::max(0.0, r2 - along * along));
                            content += share * own_volume<Kernel>(context, source) *
                                       column_at<dimensions>(static_cast<float>(aside / near_surface.spacing),
                                                             static_cast<float>(-along / near_surface.spacing));
                          });
    of_particle[i] = spacing * std::clamp(0.5F + static_cast<float>(content) - of_lattice, shallowest, deepest);
  });
}

template <int dimensions, class Kernel>
void share_depths(const SweepContext& context, PackedNeighbours& packed, const NearSurface& near_surface,
                  std::span<const float> of_particle, std::span<float> depth) {
  float* records = packed.prepare(context, 1);
  pack_scalar(context, records, record_width(dimensions, 1), 0, of_particle.data());
  clear_wall_points(context, records, record_width(dimensions, 1), 0);
  const KernelScale<dimensions, Kernel> common(context);
  const auto centre = static_cast<float>(Kernel::w(0.0));
  const auto per_half_spacing = static_cast<float>(2 / near_surface.spacing);

  sweep(near_surface.particles.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(near_surface.particles[k]);
    auto normal = vector_of<dimensions>(near_surface.normal, i);
    if (!make_unit<dimensions>(normal)) {
      depth[k] = of_particle[i];
      return;
    }
    for (float& component : normal) component *= per_half_spacing;
    f32n weights{}, sum{};
    for_each_batch<dimensions, 1>(*context.list, records, i, common.at(context, i).inverse_h, [&](const auto& b) {
      const f32n along = dot(b.d, normal);
      const f32n weight = Kernel::w(b.q) * simd::max(1.0F - simd::max(along, -along), zero());
      // Depths are positive; other particles have none.
      weights = weights + (b.payload[0] > 0.0F ? weight : zero());
      sum = sum + weight * b.payload[0];
    });
    depth[k] = (centre * of_particle[i] + simd::sum(sum)) / (centre + simd::sum(weights));
  });
}

// c n of shared_along_normal, 0 where no near-surface particle is around.
template <int dimensions, class Kernel>
void find_layer_normals(const SweepContext& context, PackedNeighbours& packed, double spacing,
                        const std::array<const float*, 3>& unit_normal,
                        const std::vector<std::array<float, 3>>& reflection, std::span<const std::int32_t> upper,
                        std::span<std::array<float, 3>> out) {
  float* records = packed.prepare(context, dimensions);
  pack_vector(context, records, record_width(dimensions, dimensions), 0, unit_normal, reflection);
  const KernelScale<dimensions, Kernel> common(context);
  const auto per_distance2 = static_cast<float>(1 / (layer_distance * layer_distance * spacing * spacing));

  sweep(upper.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(upper[k]);
    std::array<f32n, dimensions> sums{};
    f32n weights{};
    for_each_batch<dimensions, dimensions>(*context.list, records, i, common.at(context, i).inverse_h,
                                           [&](const auto& b) {
                                             f32n r2{}, near{};  // 1 for near-surface particles
                                             for (int axis = 0; axis < dimensions; ++axis) {
                                               r2 = r2 + b.d[axis] * b.d[axis];
                                               near = near + b.payload[axis] * b.payload[axis];
                                             }
                                             const f32n x = simd::max(1.0F - per_distance2 * r2, zero());
                                             const f32n weight = x * x;
                                             for (int axis = 0; axis < dimensions; ++axis)
                                               sums[axis] = sums[axis] + weight * b.payload[axis];
                                             weights = weights + weight * near;
                                           });
    auto normal = vector_of<dimensions>(unit_normal, i);
    const bool is_near = length<dimensions>(normal) > 0;
    for (int axis = 0; axis < dimensions; ++axis) normal[axis] += simd::sum(sums[axis]);
    const bool any = make_unit<dimensions>(normal);
    const float share = is_near ? 1 : std::min(1.0F, simd::sum(weights) / full_weight);
    for (int axis = 0; axis < dimensions; ++axis) out[k][axis] = any ? share * normal[axis] : 0;
  });
}

// From c n to the shared part of the vector.
template <int dimensions, class Kernel>
void share_along(const SweepContext& context, PackedNeighbours& packed, double spacing,
                 const std::array<const float*, 3>& vector, const std::vector<std::array<float, 3>>& reflection,
                 std::span<const std::int32_t> upper, std::span<std::array<float, 3>> out) {
  float* records = packed.prepare(context, dimensions);
  pack_vector(context, records, record_width(dimensions, dimensions), 0, vector, reflection);
  const KernelScale<dimensions, Kernel> common(context);
  const auto centre = static_cast<float>(Kernel::w(0.0));
  const auto per_spacing = static_cast<float>(1 / spacing);

  sweep(upper.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(upper[k]);
    Vector<dimensions> normal;
    for (int axis = 0; axis < dimensions; ++axis) normal[axis] = out[k][axis];
    if (!make_unit<dimensions>(normal)) return;
    f32n weights{}, sum{};
    for_each_batch<dimensions, dimensions>(
        *context.list, records, i, common.at(context, i).inverse_h, [&](const auto& b) {
          const f32n along = per_spacing * dot(b.d, normal);
          const f32n weight = Kernel::w(b.q) * simd::max(1.0F - simd::max(along, -along), zero());
          weights = weights + weight;
          sum = sum + weight * dot(b.payload, normal);
        });
    float own = 0;
    for (int axis = 0; axis < dimensions; ++axis) own += vector[axis][i] * normal[axis];
    const float shared = (centre * own + simd::sum(sum)) / (centre + simd::sum(weights));
    for (int axis = 0; axis < dimensions; ++axis) out[k][axis] *= shared;
  });
}

}  // namespace

void surface_depths(const SweepContext& context, PackedNeighbours& packed, const NearSurface& near_surface,
                    std::span<float> of_particle, std::span<float> depth) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    parallel_for(of_particle.size(), [&](std::size_t i) { of_particle[i] = 0; });
    find_own_depths<dimensions, Kernel>(context, packed, near_surface, of_particle);
    find_box_depths<dimensions, Kernel>(context, near_surface, of_particle);
    for (const KnownDepth& known : near_surface.known)
      if (of_particle[static_cast<std::size_t>(known.particle)] > 0)
        of_particle[static_cast<std::size_t>(known.particle)] = known.depth;
    share_depths<dimensions, Kernel>(context, packed, near_surface, of_particle, depth);
  });
}

double column_weight(int dimensions, double aside, double below) {
  const auto x = static_cast<float>(aside), z = static_cast<float>(below);
  return double{dimensions == 3 ? column_at<3>(x, z) : column_at<2>(x, z)};
}

double depth_of_column(int dimensions, double content) {
  const double of_lattice = dimensions == 3 ? lattice_column<3>() : lattice_column<2>();
  return std::clamp(0.5 + content - of_lattice, double{shallowest}, double{deepest});
}

void mark_upper_layers(const SweepContext& context, double spacing, std::span<const std::int32_t> near_surface,
                       std::span<std::uint8_t> beside) {
  const NeighbourList& list = *context.list;
  const auto particles = static_cast<std::int32_t>(list.particles());
  const auto distance2_limit = static_cast<float>(layer_distance * layer_distance * spacing * spacing);
  parallel_for(beside.size(), [&](std::size_t i) { beside[i] = 0; });
  parallel_for(near_surface.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(near_surface[k]);
    std::atomic_ref<std::uint8_t>(beside[i]).store(1, std::memory_order_relaxed);
    for (const std::int32_t j : list.of(i)) {
      std::atomic_ref<std::uint8_t> mark(
          beside[static_cast<std::size_t>(j < particles ? j : context.images->source()[j - particles])]);
      if (mark.load(std::memory_order_relaxed) != 0) continue;
      float r2 = 0;
      for (int axis = 0; axis < context.dimensions; ++axis) {
        const float d = list.coordinate(axis)[j] - list.coordinate(axis)[i];
        r2 += d * d;
      }
      if (r2 < distance2_limit) mark.store(1, std::memory_order_relaxed);
    }
  });
}

void shared_along_normal(const SweepContext& context, PackedNeighbours& packed, double spacing,
                         const std::array<const float*, 3>& unit_normal, const std::array<const float*, 3>& vector,
                         const std::vector<std::array<float, 3>>& reflection, std::span<const std::int32_t> upper,
                         std::span<std::array<float, 3>> out) {
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    find_layer_normals<dimensions, Kernel>(context, packed, spacing, unit_normal, reflection, upper, out);
    share_along<dimensions, Kernel>(context, packed, spacing, vector, reflection, upper, out);
  });
}

}  // namespace spume
