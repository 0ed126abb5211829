// SPDX-License-Identifier: MIT
#include "spume/particles/point_fits.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

constexpr int highest_order = 2;

}  // namespace

template <int dimensions>
int PointFit<dimensions>::fit() {
  fit_.resize(near_.size());
  for (std::size_t k = 0; k < near_.size(); ++k) {
    for (int axis = 0; axis < dimensions; ++axis) fit_.offset(axis)[k] = near_[k].offset[axis] / smoothing_length_;
    fit_.weight()[k] = WendlandC2::w(WendlandC2::support * std::sqrt(near_[k].r2) / reach_);
  }
  return fit_.fit(highest_order);
}

template <int dimensions>
void PointFit<dimensions>::append(PointFits& fits) {
  const auto coefficient = fit_.value();
  fits.nearest.push_back(nearest_);
  fits.entries.push_back(static_cast<std::int32_t>(near_.size()));
  double sum = 0;
  for (const double c : coefficient) sum += c;
  for (std::size_t k = 0; k < near_.size(); ++k) {
    fits.source.push_back(near_[k].particle);
    fits.coefficient.push_back(coefficient[k] / sum);
  }
}

template class PointFit<2>;
template class PointFit<3>;

std::size_t append_points(const std::vector<PointFits>& blocks, int dimensions, WallStencils& stencils) {
  std::vector<std::size_t> point{stencils.size()}, entry{stencils.source.size()};
  for (const PointFits& fits : blocks) {
    point.push_back(point.back() + fits.nearest.size());
    entry.push_back(entry.back() + fits.source.size());
  }
  const std::size_t all = point.back();
  stencils.first.resize(all + 1);
  stencils.nearest.resize(all);
  stencils.no_slip.resize(all);
  for (int axis = 0; axis < dimensions; ++axis) {
    stencils.normal[axis].resize(all);
    stencils.wall_velocity[axis].resize(all);
  }
  stencils.source.resize(entry.back());
  stencils.coefficient.resize(entry.back());
  stencils.first[all] = static_cast<std::int64_t>(entry.back());
  parallel_blocks(blocks.size(), 1, [&](std::size_t b, std::size_t, std::size_t) {
    const PointFits& fits = blocks[b];
    auto next = static_cast<std::int64_t>(entry[b]);
    std::copy(fits.source.begin(), fits.source.end(), stencils.source.data() + next);
    std::copy(fits.coefficient.begin(), fits.coefficient.end(), stencils.coefficient.data() + next);
    for (std::size_t k = 0; k < fits.nearest.size(); ++k) {
      const std::size_t g = point[b] + k;
      stencils.first[g] = next;
      next += fits.entries[k];
      stencils.nearest[g] = fits.nearest[k];
    }
  });
  return point.front();
}

}  // namespace spume
