// SPDX-License-Identifier: MIT
#include "spume/neighbours/neighbour_list.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/core/simd.hpp"

namespace spume {
namespace {

using simd::f32x8;
using simd::i32x8;

// Particles handled at a time by one thread; their lists are collected in cache and copied to the shared array.
constexpr std::size_t list_block = 256;

// For each 8-bit mask the lanes that are set, in order, one byte each.
constexpr std::array<std::uint64_t, 256> make_lane_table() {
  std::array<std::uint64_t, 256> table{};
  for (unsigned mask = 0; mask < 256; ++mask) {
    std::uint64_t packed = 0;
    int slot = 0;
    for (unsigned lane = 0; lane < 8; ++lane)
      if (mask >> lane & 1U) packed |= std::uint64_t{lane} << (8 * slot++);
    table[mask] = packed;
  }
  return table;
}
constexpr auto lane_table = make_lane_table();

// Packs the lanes of v that are set in the mask to the front.
#if defined(__AVX2__)
using Packing = __m256i;
[[gnu::always_inline]] inline Packing packing_of(unsigned mask) {
  return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(lane_table[mask])));
}
[[gnu::always_inline]] inline void store_packed(i32x8 v, Packing packing, std::int32_t* out) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_permutevar8x32_epi32(__m256i(v), packing));
}
[[gnu::always_inline]] inline void store_packed(f32x8 v, Packing packing, float* out) {
  _mm256_storeu_ps(out, _mm256_permutevar8x32_ps(__m256(v), packing));
}
#else
using Packing = std::uint64_t;
[[gnu::always_inline]] inline Packing packing_of(unsigned mask) {
  return lane_table[mask];
}
template <class V, class T>
[[gnu::always_inline]] inline void store_packed(V v, Packing packing, T* out) {
  for (int k = 0; k < 8; ++k, packing >>= 8) out[k] = v[packing & 7U];
}
#endif

[[gnu::always_inline]] inline unsigned mask_of(i32x8 lanes) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(__m256i(lanes))));
#else
  unsigned mask = 0;
  for (int l = 0; l < 8; ++l) mask |= static_cast<unsigned>(lanes[l] != 0) << l;
  return mask;
#endif
}

[[gnu::always_inline]] inline i32x8 load_int(const std::int32_t* p) {
  i32x8 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

// Particles that follow each other in the sorted order and lie close together: their candidates are gathered
// once. Eight in a row measured best: fewer repeat the gathering, more lengthen the candidate list.
constexpr std::size_t group_size = 8;

struct Group {
  std::size_t first = 0, last = 0;
  std::array<float, 3> lower{}, upper{};
};

// Candidates of a group, packed; arrays grow and are reused. One set per thread.
struct Candidates {
  std::array<Array<float>, 3> coordinate;
  Array<std::int32_t> index;
  std::size_t size = 0;

  void reserve(std::size_t wanted) {
    if (wanted <= index.size()) return;
    for (auto& axis : coordinate) axis.resize(wanted + wanted / 2);
    index.resize(wanted + wanted / 2);
  }
};

// The next group from `first` on: at most group_size particles whose box is no longer than `length` along x and
// one and a half rows across.
template <int dimensions>
Group next_group(const std::array<const float*, 3>& point, std::size_t first, std::size_t end, float reach) {
  Group group{first, first, {}, {}};
  for (int axis = 0; axis < dimensions; ++axis) group.lower[axis] = group.upper[axis] = point[axis][first];
  while (++group.last < end && group.last - first < group_size) {
    std::array<float, 3> lower = group.lower, upper = group.upper;
    bool close = true;
    for (int axis = 0; axis < dimensions; ++axis) {
      const float x = point[axis][group.last];
      lower[axis] = std::min(lower[axis], x);
      upper[axis] = std::max(upper[axis], x);
      close = close && upper[axis] - lower[axis] <= (axis == 0 ? 2.5F : 0.75F) * reach;
    }
    if (!close) break;
    group.lower = lower;
    group.upper = upper;
  }
  return group;
}

// Adds points [first, last) that lie within the reach of the group's box.
template <int dimensions>
[[gnu::always_inline]] inline void gather(const std::array<const float*, 3>& point, std::int32_t first,
                                          std::int32_t last, const Group& group, float reach2, Candidates& candidates) {
  candidates.reserve(candidates.size + static_cast<std::size_t>(last - first) + 16);
  std::size_t size = candidates.size;
  const i32x8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
  for (std::int32_t j = first; j < last; j += simd::lanes) {
    std::array<f32x8, 3> x{};
    f32x8 distance2{};
    for (int axis = 0; axis < dimensions; ++axis) {
      x[axis] = simd::load(point[axis] + j);
      const f32x8 outside =
          simd::max(simd::max(group.lower[axis] - x[axis], x[axis] - group.upper[axis]), simd::splat(0));
      distance2 = distance2 + outside * outside;
    }
    unsigned mask = mask_of(i32x8(distance2 < reach2));
    if (last - j < simd::lanes) mask &= (1U << (last - j)) - 1U;
    const Packing packing = packing_of(mask);
    for (int axis = 0; axis < dimensions; ++axis)
      store_packed(x[axis], packing, candidates.coordinate[axis].data() + size);
    store_packed(lane + j, packing, candidates.index.data() + size);
    size += static_cast<std::size_t>(std::popcount(mask));
  }
  candidates.size = size;
}

// Writes the candidates within the reach of point i, itself excluded; returns how many.
template <int dimensions>
[[gnu::always_inline]] inline std::int32_t select(const Candidates& candidates,
                                                  const std::array<const float*, 3>& point, std::size_t i, float reach2,
                                                  std::int32_t* out) {
  std::int32_t* const start = out;
  std::array<f32x8, 3> centre{};
  for (int axis = 0; axis < dimensions; ++axis) centre[axis] = simd::splat(point[axis][i]);
  const i32x8 self = i32x8{} + static_cast<std::int32_t>(i);
  for (std::size_t j = 0; j < candidates.size; j += simd::lanes) {
    f32x8 distance2{};
    for (int axis = 0; axis < dimensions; ++axis) {
      const f32x8 d = simd::load(candidates.coordinate[axis].data() + j) - centre[axis];
      distance2 = distance2 + d * d;
    }
    const i32x8 index = load_int(candidates.index.data() + j);
    const unsigned mask = mask_of(i32x8(distance2 < reach2) & (index != self));
    store_packed(index, packing_of(mask), out);
    out += std::popcount(mask);
  }
  return static_cast<std::int32_t>(out - start);
}

}  // namespace

template <int dimensions>
bool NeighbourList::search(const CellGrid& grid, const CellTable& particles, const Images& images) {
  const std::size_t n = count_.size();
  const auto reach = static_cast<float>(grid.reach());
  const float reach2 = reach * reach;
  const std::array<const float*, 3> point{coordinate_[0].data(), coordinate_[1].data(), coordinate_[2].data()};
  const std::int32_t* first_particle = particles.first();
  const std::int32_t* first_image = images.table().first();
  const auto image_base = static_cast<std::int32_t>(n);

  // Grid geometry in the float coordinates of the list.
  std::array<float, 3> lower{}, inverse{}, side{};
  const std::array<int, 3> last_cell{grid.columns() - 1, grid.rows_y() - 1, grid.rows_z() - 1};
  for (int axis = 0; axis < dimensions; ++axis) {
    lower[axis] = static_cast<float>(grid.lower(axis) - origin_[axis]);
    side[axis] = static_cast<float>(grid.side(axis));
    inverse[axis] = 1 / side[axis];
  }
  const auto cell_at = [&](int axis, float x) {
    const float cell = (x - lower[axis]) * inverse[axis];
    return cell > 0 ? static_cast<int>(std::min(cell, static_cast<float>(last_cell[axis]))) : 0;
  };
  // Distance from the group to row c along an axis; border rows also hold what was clamped into them.
  const auto distance_to = [&](int axis, int c, const Group& group) {
    const float below = c == 0 ? -INFINITY : lower[axis] + static_cast<float>(c) * side[axis];
    const float above = c == last_cell[axis] ? INFINITY : lower[axis] + static_cast<float>(c + 1) * side[axis];
    return std::max({0.0F, below - group.upper[axis], group.lower[axis] - above});
  };
  // Cells were assigned from double coordinates: a margin of rounding size keeps the row cull conservative.
  const float margin = 1e-4F * reach;
  const float cull2 = (reach + margin) * (reach + margin);

  const auto gather_group = [&](const Group& group, Candidates& candidates) {
    candidates.size = 0;
    bool with_images = false;
    for (int axis = 0; axis < dimensions && images.size() > 0; ++axis)
      with_images =
          with_images || group.lower[axis] < image_free_lower_[axis] || group.upper[axis] > image_free_upper_[axis];
    const int z_first = dimensions == 3 ? cell_at(2, group.lower[2] - reach - margin) : 0;
    const int z_last = dimensions == 3 ? cell_at(2, group.upper[2] + reach + margin) : 0;
    const int y_first = cell_at(1, group.lower[1] - reach - margin);
    const int y_last = cell_at(1, group.upper[1] + reach + margin);
    for (int iz = z_first; iz <= z_last; ++iz) {
      const float dz = dimensions == 3 ? distance_to(2, iz, group) : 0;
      for (int iy = y_first; iy <= y_last; ++iy) {
        const float dy = distance_to(1, iy, group);
        const float left2 = cull2 - dy * dy - dz * dz;
        if (left2 <= 0) continue;
        const float half = std::sqrt(left2) + margin;
        const std::int64_t row = std::int64_t{grid.row(iy, iz)} * grid.columns();
        const std::int64_t c0 = row + cell_at(0, group.lower[0] - half);
        const std::int64_t c1 = row + cell_at(0, group.upper[0] + half) + 1;
        gather<dimensions>(point, first_particle[c0], first_particle[c1], group, reach2, candidates);
        if (with_images && first_image[c1] > first_image[c0])
          gather<dimensions>(point, image_base + first_image[c0], image_base + first_image[c1], group, reach2,
                             candidates);
      }
    }
    // Vector loads read up to seven candidates past the end: the sentinel is nobody's neighbour.
    candidates.reserve(candidates.size + 16);
    for (std::size_t k = candidates.size; k < candidates.size + simd::lanes; ++k) {
      for (int axis = 0; axis < dimensions; ++axis) candidates.coordinate[axis][k] = point[axis][points_];
      candidates.index[k] = sentinel();
    }
  };

  std::atomic<std::int64_t> used{0};
  std::atomic<std::int64_t> found{0};
  const auto capacity = static_cast<std::int64_t>(index_.capacity());

  parallel_blocks_dynamic(n, list_block, [&](std::size_t, std::size_t begin, std::size_t end) {
    thread_local Candidates candidates;
    thread_local Array<std::int32_t> collected;
    std::size_t filled = 0;
    std::int64_t pairs = 0;
    for (std::size_t i = begin; i < end;) {
      const Group group = next_group<dimensions>(point, i, end, reach);
      gather_group(group, candidates);
      collected.resize(std::max(collected.size(), filled + group_size * (candidates.size + 16)));
      for (; i < group.last; ++i) {
        count_[i] = select<dimensions>(candidates, point, i, reach2, collected.data() + filled);
        filled += static_cast<std::size_t>(count_[i]);
        pairs += count_[i];
        while (filled % 8 != 0) collected[filled++] = sentinel();
      }
    }
    found += pairs;
    const std::int64_t target = used.fetch_add(static_cast<std::int64_t>(filled));
    if (target + static_cast<std::int64_t>(filled) > capacity) return;
    std::memcpy(index_.data() + target, collected.data(), filled * sizeof(std::int32_t));
    std::int64_t running = target;
    for (std::size_t i = begin; i < end; ++i) {
      first_[i] = running;
      running += (count_[i] + 7) / 8 * 8;
    }
  });
  pairs_ = found;
  const std::int64_t wanted = used;
  if (wanted <= capacity) {
    index_.resize(static_cast<std::size_t>(wanted));
    return true;
  }
  // A tenth more than this step needs, so that a flow that compresses slowly does not search twice again.
  index_.release();
  index_.reserve(static_cast<std::size_t>(wanted + wanted / 10));
  return false;
}

void NeighbourList::build(const CellGrid& grid, const CellTable& particles, const double* x, const double* y,
                          const double* z, std::size_t n, const Images& images, const std::array<double, 3>& origin) {
  const int dimensions = grid.dimensions();
  const std::size_t m = images.size();
  points_ = n + m;
  origin_ = origin;
  count_.resize(n);
  first_.resize(n);
  const double* particle[3] = {x, y, z};
  for (int axis = 0; axis < dimensions; ++axis) {
    // Eight more: vector loads may read past the last point.
    coordinate_[axis].resize(points_ + 1 + simd::lanes);
    float* out = coordinate_[axis].data();
    const double* in = particle[axis];
    const double* image = images.position(axis);
    const double zero = origin[axis];
    parallel_for(n, [=](std::size_t i) { out[i] = static_cast<float>(in[i] - zero); });
    parallel_for(m, [=](std::size_t i) { out[n + i] = static_cast<float>(image[i] - zero); });
    // Far enough for every kernel to vanish, near enough for finite squares.
    for (int k = 0; k <= simd::lanes; ++k) out[points_ + k] = 1e6F * static_cast<float>(grid.reach());
  }

  // The box that no image comes near: outside it lists look at images too.
  for (int axis = 0; axis < 3; ++axis) {
    image_free_lower_[axis] = -INFINITY;
    image_free_upper_[axis] = INFINITY;
  }
  const double reach = grid.reach();
  if (m > 0) {
    for (int axis = 0; axis < dimensions; ++axis) {
      image_free_lower_[axis] = static_cast<float>(images.image_free_lower(axis) + reach - origin[axis]);
      image_free_upper_[axis] = static_cast<float>(images.image_free_upper(axis) - reach - origin[axis]);
    }
    if (images.inside_domain()) image_free_upper_[0] = -INFINITY;
  }
  while (!(dimensions == 3 ? search<3>(grid, particles, images) : search<2>(grid, particles, images))) {
  }
}

double NeighbourList::bytes() const {
  double total =
      4.0 * static_cast<double>(index_.capacity() + count_.capacity()) + 8.0 * static_cast<double>(first_.capacity());
  for (const auto& axis : coordinate_) total += 4.0 * static_cast<double>(axis.capacity());
  return total;
}

}  // namespace spume
