// SPDX-License-Identifier: MIT
#include "spume/neighbours/cross_search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "packed_store.hpp"

namespace spume {
namespace {

// Blocks of a run that are written without asking whether it has as many: lengths of runs are unpredictable.
constexpr int blocks_at_once = 4;

}  // namespace

CrossSearch::CrossSearch(const CellGrid& grid, const std::array<double, 3>& origin,
                         const std::array<const float*, 3>& point, std::span<const Points> sets)
    : grid_(grid), point_(point), last_cell_{grid.columns() - 1, grid.rows_y() - 1, grid.rows_z() - 1} {
  if (sets.size() > most_sets) throw std::logic_error("CrossSearch: too many sets of points");
  std::int32_t base = 0;
  for (const Points& set : sets) {
    if (set.size > 0) {
      Set& own = set_[sets_++];
      own = {set.table->first(), base, {}};
      for (std::size_t a = 0; a < 3; ++a) {
        own.free.lower[a] = static_cast<float>(set.free_lower[a] - origin[a]);
        own.free.upper[a] = static_cast<float>(set.free_upper[a] - origin[a]);
      }
    }
    base += static_cast<std::int32_t>(set.size);
  }
  float extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    lower_[a] = static_cast<float>(grid.lower(axis) - origin[a]);
    side_[a] = static_cast<float>(grid.side(axis));
    inverse_[a] = 1 / side_[a];
    extent =
        std::max({extent, std::abs(lower_[a]), std::abs(lower_[a] + static_cast<float>(last_cell_[a] + 1) * side_[a])});
  }
  margin_ = 1e-4F * static_cast<float>(grid.support_radius()) + 4 * std::numeric_limits<float>::epsilon() * extent;
}

// Blocks that together have all points within the support radius of the box.
std::span<const CrossSearch::Block> CrossSearch::blocks_near(const Box& box, float support_radius, Found& found) const {
  std::size_t size = 0;
  std::array<Set, most_sets> near;
  std::size_t sets = 0;
  const float far = support_radius + margin_;
  for (std::size_t s = 0; s < sets_; ++s) {
    bool free = true;
    for (std::size_t a = 0; a < 3; ++a)
      free = free && box.lower[a] - far > set_[s].free.lower[a] && box.upper[a] + far < set_[s].free.upper[a];
    if (!free) near[sets++] = set_[s];
  }
  const auto cell_at = [&](std::size_t a, float x) {
    const float cell = (x - lower_[a]) * inverse_[a];
    return cell > 0 ? static_cast<int>(std::min(cell, static_cast<float>(last_cell_[a]))) : 0;
  };
  // Square of the distance to row c; border rows also hold what lies beyond the grid.
  const auto distance2_to = [&](std::size_t a, int c) {
    const float start = lower_[a] + static_cast<float>(c) * side_[a];
    const float below = c == 0 ? 0 : start - box.upper[a];
    const float above = c == last_cell_[a] ? 0 : box.lower[a] - (start + side_[a]);
    const float distance = std::max({below, above, 0.0F});
    return distance * distance;
  };
  // Every row is cut to the same columns: what a chord of its own would spare costs as much to find.
  const std::int32_t columns = grid_.columns();
  const std::int32_t from = cell_at(0, box.lower[0] - far), to = cell_at(0, box.upper[0] + far) + 1;
  const int y_first = cell_at(1, box.lower[1] - far), y_last = cell_at(1, box.upper[1] + far);
  const int z_first = cell_at(2, box.lower[2] - far), z_last = cell_at(2, box.upper[2] + far);
  for (int iz = z_first; iz <= z_last; ++iz) {
    const float left2 = far * far - distance2_to(2, iz);
    const std::int32_t* ranks = grid_.row_ranks(iz);
    for (int iy = y_first; iy <= y_last; ++iy) {
      if (distance2_to(1, iy) >= left2) continue;
      const std::int64_t row = std::int64_t{ranks[iy]} * columns;
      for (std::size_t s = 0; s < sets; ++s) {
        const std::int32_t first = near[s].base + near[s].first[row + from];
        const std::int32_t last = near[s].base + near[s].first[row + to];
        const std::int32_t blocks = (last - first + pair_lanes - 1) / pair_lanes;
        const std::size_t wanted = size + static_cast<std::size_t>(std::max(blocks, blocks_at_once));
        if (wanted > found.blocks.size()) found.blocks.resize(2 * wanted);
        Block* const out = found.blocks.data() + size;
        for (int k = 0; k < blocks_at_once; ++k) out[k] = {first + k * pair_lanes, last};
        for (std::int32_t k = blocks_at_once; k < blocks; ++k) out[k] = {first + k * pair_lanes, last};
        size += static_cast<std::size_t>(blocks);
      }
    }
  }
  // Packed stores write whole vectors.
  const std::size_t wanted = pair_lanes * (size + 1);
  if (wanted > found.index.size()) {
    found.index.resize(2 * wanted);
    found.share2.resize(2 * wanted);
  }
  return {found.blocks.data(), size};
}

void CrossSearch::near_box(const Box& box, float support_radius, Found& found) const {
  const std::span<const Block> blocks = blocks_near(box, support_radius, found);
  const Box within = box;
  const std::array<const float*, 3> point = point_;
  std::int32_t* const out = found.index.data();
  const float support_radius2 = support_radius * support_radius;
  std::size_t size = 0;
  for (const Block block : blocks) {
    f32n distance2{};
    for (std::size_t a = 0; a < 3; ++a) {
      const f32n x = simd::load<f32n>(point[a] + block.first);
      const f32n outside =
          x - simd::min(simd::max(x, simd::splat<f32n>(within.lower[a])), simd::splat<f32n>(within.upper[a]));
      distance2 = distance2 + outside * outside;
    }
    const unsigned mask =
        simd::less_bits(distance2, simd::splat<f32n>(support_radius2)) & first_lanes(block.last - block.first);
    store_packed(numbers_from(block.first), packing_of(mask), out + size);
    size += static_cast<std::size_t>(std::popcount(mask));
  }
  found.size = size;
}

void CrossSearch::near_place(const std::array<float, 3>& place, float largest_support_radius,
                             const float* inverse_support_radius, Found& found) const {
  const std::span<const Block> blocks = blocks_near({place, place}, largest_support_radius, found);
  const std::array<float, 3> centre = place;
  const std::array<const float*, 3> point = point_;
  std::int32_t* const index_out = found.index.data();
  float* const share2_out = found.share2.data();
  std::size_t size = 0;
  for (const Block block : blocks) {
    f32n distance2{};
    for (std::size_t a = 0; a < 3; ++a) {
      const f32n d = simd::load<f32n>(point[a] + block.first) - centre[a];
      distance2 = distance2 + d * d;
    }
    const f32n inverse = simd::load<f32n>(inverse_support_radius + block.first);
    const f32n share2 = distance2 * (inverse * inverse);
    const unsigned mask = simd::less_bits(share2, simd::splat<f32n>(1)) & first_lanes(block.last - block.first);
    const Packing packing = packing_of(mask);
    store_packed(numbers_from(block.first), packing, index_out + size);
    store_packed(share2, packing, share2_out + size);
    size += static_cast<std::size_t>(std::popcount(mask));
  }
  std::fill_n(share2_out + size, pair_lanes, 1.0F);
  found.size = size;
}

CrossSearch::Points images_as_points(const Images& images) {
  CrossSearch::Points points{&images.table(), images.size()};
  if (images.inside_domain()) return points;
  for (int axis = 0; axis < 3; ++axis) {
    points.free_lower[static_cast<std::size_t>(axis)] = images.image_free_lower(axis);
    points.free_upper[static_cast<std::size_t>(axis)] = images.image_free_upper(axis);
  }
  return points;
}

}  // namespace spume
