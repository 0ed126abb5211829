// SPDX-License-Identifier: MIT
#include "spume/particles/near_distances.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume {

NearDistances::NearDistances(const Combination& walls, int dimensions, const Vec3& lower, const Vec3& upper,
                             double spacing, const std::function<bool(const Vec3&)>& is_far)
    : dimensions_(dimensions), lower_(lower), spacing_(spacing) {
  for (int axis = 0; axis < dimensions; ++axis) {
    // Blocks that begin at the upper side or beyond it have nothing in the box, but for rounding of its width.
    const double blocks = std::ceil((upper[axis] - lower[axis]) / spacing - 1e-6);
    count_[axis] = static_cast<std::size_t>(std::max(1.0, blocks));
    cells_ *= finer;
  }
  // Half a diagonal, and what rounding to float takes.
  off_ = (0.5 * std::sqrt(static_cast<double>(dimensions)) + 1e-3) * spacing / static_cast<double>(finer);
  block_.assign(count_[0] * count_[1] * count_[2], -1);
  const auto place_in = [&](std::size_t block, double share, std::size_t cell, double step) {
    const std::array<std::size_t, 3> at{block % count_[0], block / count_[0] % count_[1],
                                        block / count_[0] / count_[1]};
    Vec3 place{};
    for (int axis = 0; axis < dimensions_; ++axis) {
      place[axis] =
          lower_[axis] + spacing_ * (static_cast<double>(at[axis]) + share + step * static_cast<double>(cell % finer));
      cell /= finer;
    }
    return place;
  };
  std::vector<std::size_t> near;
  for (std::size_t block = 0; block < block_.size(); ++block)
    if (!is_far(place_in(block, 0.5, 0, 0))) {
      block_[block] = static_cast<std::int32_t>(near.size());
      near.push_back(block);
    }
  distance_.resize(near.size() * cells_);
  const double step = 1.0 / static_cast<double>(finer);
  parallel_blocks(near.size(), 16, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k)
      for (std::size_t cell = 0; cell < cells_; ++cell)
        distance_[k * cells_ + cell] = static_cast<float>(walls.distance(place_in(near[k], step / 2, cell, step)));
  });
}

NearDistances::Range NearDistances::at(const Vec3& place) const {
  std::size_t block = 0, cell = 0, blocks = 1, cells = 1;
  for (int axis = 0; axis < dimensions_; ++axis) {
    const double along = (place[axis] - lower_[axis]) / spacing_;
    if (!(along >= 0 && along <= static_cast<double>(count_[axis]))) return {};
    const std::size_t index = std::min(count_[axis] - 1, static_cast<std::size_t>(along));
    block += blocks * index;
    cell += cells * std::min(finer - 1, static_cast<std::size_t>((along - static_cast<double>(index)) * finer));
    blocks *= count_[axis];
    cells *= finer;
  }
  if (block_[block] < 0) return {};
  const double middle = distance_[static_cast<std::size_t>(block_[block]) * cells_ + cell];
  return {middle - off_, middle + off_};
}

}  // namespace spume
