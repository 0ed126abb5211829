// SPDX-License-Identifier: MIT
#include "spume/neighbours/neighbour_list.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "candidates.hpp"
#include "narrow_lists.hpp"
#include "packed_store.hpp"
#include "spume/core/parallel.hpp"

namespace spume {
namespace {

// Particles handled at a time by one thread; their lists are collected in cache and copied to the shared array.
constexpr std::size_t list_block = 256;

// table[index[l]] of the eight lanes.
[[gnu::always_inline]] inline i32x8 gather_int(const std::int32_t* table, i32x8 index) {
#if defined(__AVX2__)
  return i32x8(_mm256_i32gather_epi32(table, __m256i(index), 4));
#else
  i32x8 v;
  for (int l = 0; l < simd::lanes; ++l) v[l] = table[index[l]];
  return v;
#endif
}

// Entries that a list of `count` neighbours takes.
inline std::int32_t padded(std::int32_t count) {
  return (count + simd::lanes - 1) / simd::lanes * simd::lanes;
}

// Copies whole vectors between aligned arrays past the caches: lists are far larger than these and are written once,
// so fetching the lines that are to be overwritten is a waste of a third of the traffic.
inline void stream(const std::int32_t* from, std::size_t size, std::int32_t* to) {
#if defined(__AVX__)
  for (std::size_t k = 0; k < size; k += simd::lanes)
    _mm256_stream_si256(reinterpret_cast<__m256i*>(to + k),
                        _mm256_load_si256(reinterpret_cast<const __m256i*>(from + k)));
  _mm_sfence();
#else
  std::copy_n(from, size, to);
#endif
}

// Far enough for every kernel to vanish, near enough for finite squares.
float sentinel_coordinate(float support_radius) {
  return 1e6F * support_radius;
}

// Particles that follow each other in the sorted order and lie close together: their candidates are gathered
// once. Fewer repeat the gathering, more lengthen the candidate list: the lists of 100,000 particles take 1.16 to 1.21
// times as long with 8, 1.02 to 1.07 with 32.
constexpr std::size_t group_size = 16;
// The longest box of a group along x and across, in support radii: what sixteen particles fill of a row of cells in two
// dimensions (2.4 in length at a support of 2.6 spacings), and a row's width with room for particles on its sides. They
// end the groups of thin liquid alone: twice these, or half the length, changes the lists of a full cube by less than
// the repeats differ (6 %). Half the width cuts every group short, and takes 2.2 times as long.
constexpr float group_length = 2.5F;
constexpr float group_width = 1.2F;
struct Group {
  std::size_t first = 0, last = 0;
  std::array<float, 3> lower{}, upper{};
};

// Up to eight consecutive sorted points: first .. min(last, first + 8).
struct Block {
  std::int32_t first, last;
};

// Runs of sorted points, one per row.
struct Runs {
  // The most rows that come near a group along y or z, none narrower than CellGrid::row_fraction reaches, in whole
  // vectors; twice for images, and once more as packed stores write whole vectors.
  static constexpr std::size_t rows_near =
      (static_cast<std::size_t>((2 + group_width) / CellGrid::row_fraction) + 3 + simd::lanes - 1) / simd::lanes *
      simd::lanes;
  std::array<std::int32_t, 2 * rows_near * rows_near + simd::lanes> first, last;
  std::size_t size = 0;

  // Adds the rows of the mask: points table[from[l]] to table[to[l]], counted from base.
  [[gnu::always_inline]] void add(const std::int32_t* table, i32x8 from, i32x8 to, std::int32_t base, unsigned rows) {
    const Packing packing = packing_of(rows);
    store_packed(gather_int(table, from) + base, packing, first.data() + size);
    store_packed(gather_int(table, to) + base, packing, last.data() + size);
    size += static_cast<std::size_t>(std::popcount(rows));
  }
};

// Cuts runs into blocks. Most runs have at most three: these are written without a branch, as the lengths of runs
// are unpredictable.
[[gnu::noinline]] std::span<const Block> cut(const Runs& runs, Array<Block>& memory) {
  std::size_t most = 3;
  for (std::size_t r = 0; r < runs.size; ++r)
    most += static_cast<std::size_t>((runs.last[r] - runs.first[r] + simd::lanes - 1) / simd::lanes);
  if (most > memory.size()) memory.resize(2 * most);
  Block* out = memory.data();
  for (std::size_t r = 0; r < runs.size; ++r) {
    const std::int32_t first = runs.first[r], last = runs.last[r];
    for (int k = 0; k < 3; ++k) out[k] = {first + k * simd::lanes, last};
    const std::int32_t blocks = (last - first + simd::lanes - 1) / simd::lanes;
    for (std::int32_t k = 3; k < blocks; ++k) out[k] = {first + k * simd::lanes, last};
    out += blocks;
  }
  return {memory.data(), out};
}

// The next group from `first` on: at most group_size particles in a box that is not too long.
template <int dimensions>
Group next_group(const std::array<const float*, 3>& point, std::size_t first, std::size_t end, float support_radius) {
  Group group{first, first, {}, {}};
  for (int axis = 0; axis < dimensions; ++axis) group.lower[axis] = group.upper[axis] = point[axis][first];
  while (++group.last < end && group.last - first < group_size) {
    std::array<float, 3> lower = group.lower, upper = group.upper;
    bool close = true;
    for (int axis = 0; axis < dimensions; ++axis) {
      const float x = point[axis][group.last];
      lower[axis] = std::min(lower[axis], x);
      upper[axis] = std::max(upper[axis], x);
      close = close && upper[axis] - lower[axis] <= (axis == 0 ? group_length : group_width) * support_radius;
    }
    if (!close) break;
    group.lower = lower;
    group.upper = upper;
  }
  return group;
}

// Adds the points of the blocks that lie within the support radius of the group's box. Rounding is monotone, so none is
// dropped that is within that of a particle of the group.
template <int dimensions>
[[gnu::noinline]] void gather(const std::array<const float*, 3>& point, std::span<const Block> blocks,
                              const Group& group, float support_radius2, Candidates& candidates) {
  std::size_t size = 0;
  const Candidates to = candidates;
  const std::array<const float*, 3> from = point;
  const i32x8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
  for (const Block block : blocks) {
    std::array<f32x8, 3> x{};
    f32x8 distance2{};
    for (int axis = 0; axis < dimensions; ++axis) {
      x[axis] = simd::load(from[axis] + block.first);
      const f32x8 nearest =
          simd::min(simd::max(x[axis], simd::splat(group.lower[axis])), simd::splat(group.upper[axis]));
      const f32x8 outside = x[axis] - nearest;
      distance2 = distance2 + outside * outside;
    }
    const i32x8 index = lane + block.first;
    const unsigned mask = mask_of(i32x8(distance2 < support_radius2) & (index < block.last));
    const Packing packing = packing_of(mask);
    for (int axis = 0; axis < dimensions; ++axis) store_packed(x[axis], packing, to.coordinate[axis] + size);
    store_packed(index * entry_scale, packing, to.entry + size);
    size += static_cast<std::size_t>(std::popcount(mask));
  }
  candidates.size = size;
}

// Where point i stands among the candidates; those of a group mostly follow each other.
inline std::size_t slot_of(const Candidates& candidates, std::size_t i, std::size_t guess) {
  const auto wanted = entry_scale * static_cast<std::int32_t>(i);
  if (guess < candidates.size && candidates.entry[guess] == wanted) return guess;
  const std::int32_t *begin = candidates.entry, *end = begin + candidates.size;
  return static_cast<std::size_t>(std::find(begin, end, wanted) - begin);
}

// Writes the candidates within the support radius of a point, as entries or as codes; returns the end of what was
// written.
template <int dimensions, class Number>
[[gnu::noinline]] Number* select(const Candidates& candidates, const std::array<float, 3>& centre,
                                 float support_radius2, Number* out) {
  using Numbers = std::conditional_t<sizeof(Number) == 2, Codes, i32n>;
  const Candidates from = candidates;
  const Number* const number = from.numbers(out);
  const std::array<float, 3> r = centre;
  for (std::size_t j = 0; j < from.size; j += pair_lanes) {
    f32n distance2{};
    for (int axis = 0; axis < dimensions; ++axis) {
      const f32n d = simd::load<f32n>(from.coordinate[axis] + j) - r[axis];
      distance2 = axis == 0 ? d * d : distance2 + d * d;
    }
    const unsigned mask = simd::less_bits(distance2, simd::splat<f32n>(support_radius2));
    Numbers numbers;
    std::memcpy(&numbers, number + j, sizeof numbers);
    store_packed(numbers, mask, out);
    out += std::popcount(mask);
  }
  return out;
}

// Keeps of the entries that particle i has up to `stop` those that it sees; returns their end. What hides or doubles a
// particle, or its reflection in one face, lies within two support radii; the faces of other images may lie farther
// away, and apart from each other.
[[gnu::noinline]] std::int32_t* keep_seen(const std::array<const double*, 3>& position, int dimensions, std::size_t i,
                                          const Images& images, double support_radius, std::size_t particles,
                                          std::int32_t* start, std::int32_t* stop) {
  const auto place_of = [&](std::size_t j) {
    Vec3 place{};
    for (int axis = 0; axis < dimensions; ++axis) place[axis] = position[axis][j];
    return place;
  };
  const Vec3 place = place_of(i);
  const SolidUnion& solids = *images.solids();
  const bool open = solids.open_around(place, 2 * support_radius);
  return std::remove_if(start, stop, [&](std::int32_t entry) {
    const auto j = static_cast<std::size_t>(entry) / entry_scale;
    if (j < particles) {
      if (open) return false;
      const Vec3 other = place_of(j);
      return !solids.sees(place, other, other);
    }
    const std::size_t k = j - particles;
    if (open && images.paths()[static_cast<std::size_t>(images.path()[k])].reflections() < 2) return false;
    return !images.sees(place, k, place_of(static_cast<std::size_t>(images.source()[k])));
  });
}

// The same of what hides points that is no solid box.
[[gnu::noinline]] std::int32_t* keep_seen(const Sight& sight, std::size_t i, std::int32_t* start, std::int32_t* stop) {
  if (sight.open_around(i)) return stop;
  return std::remove_if(
      start, stop, [&](std::int32_t entry) { return !sight.sees(i, static_cast<std::size_t>(entry) / entry_scale); });
}

}  // namespace

template <int dimensions>
bool NeighbourList::search(const CellGrid& grid, const CellOrder& particles,
                           const std::array<const double*, 3>& position, const Images& images,
                           const float* own_support_radius) {
  const std::size_t n = count_.size();
  const auto least_support_radius = static_cast<float>(grid.support_radius());
  const float far = sentinel_coordinate(least_support_radius);
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
  // Cells were assigned from double coordinates: a margin of rounding size keeps the row cull conservative.
  float extent = 0;
  for (int axis = 0; axis < dimensions; ++axis)
    extent = std::max(
        {extent, std::abs(lower[axis]), std::abs(lower[axis] + static_cast<float>(last_cell[axis] + 1) * side[axis])});
  const float margin = 1e-4F * least_support_radius + 4 * std::numeric_limits<float>::epsilon() * extent;

  // Distances from the group to eight rows from c on along an axis; border rows also hold what was clamped into them.
  const auto distance_to = [=](int axis, int c, const Group& group) {
    const i32x8 cell = i32x8{0, 1, 2, 3, 4, 5, 6, 7} + c;
    const f32x8 start = lower[axis] + __builtin_convertvector(cell, f32x8) * side[axis];
    const f32x8 below = cell == 0 ? simd::splat(-INFINITY) : start;
    const f32x8 above = cell == last_cell[axis] ? simd::splat(INFINITY) : start + side[axis];
    return simd::max(simd::max(below - group.upper[axis], group.lower[axis] - above), simd::splat(0));
  };
  const auto column_at = [=](f32x8 x) {
    const f32x8 column = (x - lower[0]) * inverse[0];
    const f32x8 within = simd::min(simd::max(column, simd::splat(0)), simd::splat(static_cast<float>(last_cell[0])));
    return __builtin_convertvector(within, i32x8);
  };
  const std::int32_t columns = grid.columns();
  const bool any_image = images.size() > 0;
  const std::array<float, 3> free_lower = image_free_lower_, free_upper = image_free_upper_;

  // Runs of the points that may lie within the support radius of the group.
  const auto find_runs = [&](const Group& group, float support_radius, Runs& runs) {
    const float cull2 = (support_radius + margin) * (support_radius + margin);
    runs.size = 0;
    bool with_images = false;
    for (int axis = 0; axis < dimensions && any_image; ++axis)
      with_images = with_images || group.lower[axis] < free_lower[axis] || group.upper[axis] > free_upper[axis];
    const int z_first = dimensions == 3 ? cell_at(2, group.lower[2] - support_radius - margin) : 0;
    const int z_last = dimensions == 3 ? cell_at(2, group.upper[2] + support_radius + margin) : 0;
    const int y_first = cell_at(1, group.lower[1] - support_radius - margin);
    const int y_last = cell_at(1, group.upper[1] + support_radius + margin);
    for (int iz = z_first; iz <= z_last; ++iz) {
      const float dz = dimensions == 3 ? distance_to(2, iz, group)[0] : 0;
      for (int iy = y_first; iy <= y_last; iy += simd::lanes) {
        const f32x8 dy = distance_to(1, iy, group);
        const f32x8 left2 = (cull2 - dz * dz) - dy * dy;
        const f32x8 half = simd::sqrt(simd::max(left2, simd::splat(0))) + margin;
        const i32x8 row = load_int(grid.row_ranks(iz) + iy) * columns;
        const i32x8 from = row + column_at(group.lower[0] - half);
        const i32x8 to = row + column_at(group.upper[0] + half) + 1;
        unsigned rows = mask_of(i32x8(left2 > 0.0F));
        if (y_last - iy < simd::lanes - 1) rows &= (2U << (y_last - iy)) - 1U;
        runs.add(first_particle, from, to, 0, rows);
        if (with_images) runs.add(first_image, from, to, image_base, rows);
      }
    }
  };

  std::atomic<std::int64_t> used{0};
  std::atomic<std::int64_t> found{0};
  const auto capacity = static_cast<std::int64_t>(narrow_ ? base_.capacity() : index_.capacity());
  const bool narrow = narrow_;
  std::uint16_t* const codes = code_.data();
  std::int32_t* const bases = base_.data();
  std::int32_t* const counts = count_.data();
  std::uint32_t* const firsts = first_.data();
  std::int32_t* const indices = index_.data();
  const std::int32_t nobody = entry_scale * sentinel();

  parallel_blocks(n, list_block, [=, &used, &found, &images](std::size_t, std::size_t begin, std::size_t end) {
    // One set per thread, kept from build to build.
    thread_local Array<Block> thread_blocks;
    thread_local Array<float> thread_candidates;
    thread_local Array<std::int32_t> thread_collected;
    thread_local NarrowBlock thread_encoded;
    Array<Block>& block_memory = thread_blocks;
    Array<float>& candidate_memory = thread_candidates;
    Array<std::int32_t>& collected = thread_collected;
    NarrowBlock& encoded = thread_encoded;
    encoded.clear();
    Runs runs;
    std::size_t filled = 0;
    std::int64_t pairs = 0;
    for (std::size_t i = begin; i < end;) {
      const Group group = next_group<dimensions>(point, i, end, least_support_radius);
      float support_radius = least_support_radius;
      if (own_support_radius != nullptr)
        support_radius = *std::max_element(own_support_radius + group.first, own_support_radius + group.last);
      float support_radius2 = support_radius * support_radius;
      find_runs(group, support_radius, runs);
      const std::span<const Block> blocks = cut(runs, block_memory);
      Candidates candidates(candidate_memory, simd::lanes * blocks.size());
      gather<dimensions>(point, blocks, group, support_radius2, candidates);
      // Vector loads read candidates past the end: the sentinel is nobody's neighbour.
      for (int axis = 0; axis < dimensions; ++axis)
        std::fill_n(candidates.coordinate[axis] + candidates.size, pair_lanes, far);

      const std::size_t wanted = filled + (group.last - i) * (candidates.size + 2 * pair_lanes);
      if (wanted > collected.size()) collected.resize(2 * wanted);
      std::int32_t low = 0;
      const bool one_base = narrow && images.solids() == nullptr && images.sight() == nullptr &&
                            NarrowBlock::within_reach(candidates.entry, candidates.size, low);
      if (one_base) candidates.find_codes(low);
      std::size_t slot = 0;
      for (; i < group.last; ++i) {
        std::int32_t* const start = collected.data() + filled;
        std::array<float, 3> centre{};
        for (int axis = 0; axis < dimensions; ++axis) centre[axis] = point[axis][i];
        // A particle is not its own neighbour: while it is searched for, its candidate stands far away.
        slot = slot_of(candidates, i, slot + 1);
        float& own = candidates.coordinate[0][slot];
        const float kept = std::exchange(own, far);
        if (own_support_radius != nullptr) support_radius2 = own_support_radius[i] * own_support_radius[i];
        if (one_base) {
          std::uint16_t* const codes_of_list = encoded.begin_list(candidates.size + pair_lanes);
          const auto count = static_cast<std::size_t>(
              select<dimensions>(candidates, centre, support_radius2, codes_of_list) - codes_of_list);
          own = kept;
          counts[i] = encoded.end_list(count, low);
          pairs += static_cast<std::int64_t>(count);
          continue;
        }
        std::int32_t* stop = select<dimensions>(candidates, centre, support_radius2, start);
        own = kept;
        if (images.solids() != nullptr)
          stop = keep_seen(position, dimensions, i, images, support_radius, n, start, stop);
        else if (images.sight() != nullptr)
          stop = keep_seen(*images.sight(), i, start, stop);
        const auto count = static_cast<std::int32_t>(stop - start);
        pairs += count;
        if (narrow) {
          counts[i] = encoded.add(start, stop);
          continue;
        }
        store_int(stop, i32x8{} + nobody);
        counts[i] = count;
        filled += static_cast<std::size_t>(padded(count));
      }
    }
    found += pairs;
    const std::size_t room = narrow ? encoded.size() : filled;
    const std::int64_t target = used.fetch_add(static_cast<std::int64_t>(room));
    if (target + static_cast<std::int64_t>(room) > capacity) return;
    if (narrow)
      encoded.copy_to(codes + target * pair_lanes, bases + target);
    else
      stream(collected.data(), filled, indices + target);
    std::int64_t running = narrow ? target : target / simd::lanes;
    for (std::size_t i = begin; i < end; ++i) {
      firsts[i] = static_cast<std::uint32_t>(running);
      running += narrow ? counts[i] : padded(counts[i]) / simd::lanes;
    }
  });
  pairs_ = found;
  const std::int64_t wanted = used;
  if (wanted / (narrow ? 1 : simd::lanes) > std::numeric_limits<std::uint32_t>::max())
    throw std::length_error("neighbour lists hold at most 3e10 entries, here are " + std::to_string(found.load()));
  const bool found_room = wanted <= capacity;
  // A little more than this step needs, so that a flow that compresses slowly does not search twice again.
  const auto room = static_cast<std::size_t>(found_room ? wanted : wanted + wanted / 32);
  const auto size = [found_room, room](auto& array, std::size_t per_entry) {
    if (!found_room) array.release();
    found_room ? array.resize(room * per_entry) : array.reserve(room * per_entry);
  };
  if (narrow_) {
    index_.release();
    size(code_, pair_lanes);
    size(base_, 1);
  } else {
    size(index_, 1);
  }
  return found_room;
}

void NeighbourList::build(const CellGrid& grid, const CellOrder& particles, const double* x, const double* y,
                          const double* z, std::size_t n, const Images& images, const std::array<double, 3>& origin) {
  build(grid, particles, x, y, z, n, images, origin, nullptr, grid.support_radius());
}

void NeighbourList::build(const CellGrid& grid, const CellOrder& particles, const double* x, const double* y,
                          const double* z, std::size_t n, const Images& images, const std::array<double, 3>& origin,
                          const float* own_support_radius, double largest_support_radius) {
  const int dimensions = grid.dimensions();
  const std::size_t m = images.size();
  points_ = n + m;
  if (points_ >= std::numeric_limits<std::int32_t>::max() / entry_scale)
    throw std::length_error("neighbour lists number at most 5e8 particles and images, here are " +
                            std::to_string(points_));
  origin_ = origin;
  count_.resize(n);
  first_.resize(n);
  for (int axis = 0; axis < dimensions; ++axis) {
    // A vector more: loads may read past the last point.
    coordinate_[axis].fit(points_ + 1 + pair_lanes);
    for (int k = 0; k <= pair_lanes; ++k)
      coordinate_[axis][points_ + k] = sentinel_coordinate(static_cast<float>(grid.support_radius()));
  }
  move({x, y, z}, images, dimensions);

  // The box that no image comes near: outside it lists look at images too.
  for (int axis = 0; axis < 3; ++axis) {
    image_free_lower_[axis] = -INFINITY;
    image_free_upper_[axis] = INFINITY;
  }
  const double support_radius = largest_support_radius;
  if (m > 0) {
    for (int axis = 0; axis < dimensions; ++axis) {
      image_free_lower_[axis] = static_cast<float>(images.image_free_lower(axis) + support_radius - origin[axis]);
      image_free_upper_[axis] = static_cast<float>(images.image_free_upper(axis) - support_radius - origin[axis]);
    }
    if (images.inside_domain()) image_free_upper_[0] = -INFINITY;
  }
  while (!(dimensions == 3 ? search<3>(grid, particles, {x, y, z}, images, own_support_radius)
                           : search<2>(grid, particles, {x, y, z}, images, own_support_radius))) {
  }
}

void NeighbourList::move(const std::array<const double*, 3>& position, const Images& images, int dimensions) {
  const std::size_t n = count_.size();
  for (int axis = 0; axis < dimensions; ++axis) {
    float* out = coordinate_[axis].data();
    const double* in = position[axis];
    const double* image = images.position(axis);
    const double zero = origin_[axis];
    parallel_for(n, [=](std::size_t i) { out[i] = static_cast<float>(in[i] - zero); });
    parallel_for(images.size(), [=](std::size_t i) { out[n + i] = static_cast<float>(image[i] - zero); });
  }
}

double NeighbourList::bytes() const {
  double total = index_.bytes() + count_.bytes() + first_.bytes() + code_.bytes() + base_.bytes();
  for (const auto& axis : coordinate_) total += 4.0 * static_cast<double>(axis.capacity());
  return total;
}

}  // namespace spume
