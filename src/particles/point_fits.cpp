// SPDX-License-Identifier: MIT
#include "spume/particles/point_fits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

constexpr int highest_order = 2;
// Of velocities through the surface: the curvature of a boundary layer of four spacings changes by a fifth a spacing.
// Of the flow around a cylinder of 20 spacings the friction on the first row is 14 % too low with parabolas, 3 % with
// cubics.
constexpr int highest_pinned_order = 3;
// Of the sum of all weights, that of the velocity of a no-slip surface in a fit through it.
constexpr double pinned = 10;
// Of a cubic, the sum of |e_j| per spacing of depth: 7 to 14.5 with liquid all around, on jittered lattices in two and
// three dimensions, up to 120 where the liquid ends beside the foot.
constexpr double most_bend = 16;

}  // namespace

template <int dimensions>
double PointFit<dimensions>::fill(const Vec3& behind, std::size_t more) {
  const std::size_t count = taken_.size();
  fit_.resize(count + more);
  for (int axis = 0; axis < dimensions; ++axis) {
    double* const offset = fit_.offset(axis);
    for (std::size_t k = 0; k < count; ++k)
      offset[k] = (near_.offset(axis, static_cast<std::size_t>(taken_[k])) - behind[axis]) / smoothing_length_;
  }
  double* const weight = fit_.weight();
  for (std::size_t k = 0; k < count; ++k) weight[k] = near_.r2(static_cast<std::size_t>(taken_[k]));
  for (std::size_t k = 0; k < count; ++k)
    weight[k] = WendlandC2::w(WendlandC2::support * std::sqrt(weight[k]) / reach_);
  return std::accumulate(weight, weight + count, 0.0);
}

template <int dimensions>
int PointFit<dimensions>::fit(double most_moduli) {
  fill({}, 0);
  order_ = fit_.fit(highest_order);
  if (!std::isfinite(most_moduli)) return order_;
  const auto too_much = [&] {
    fit_.value();
    return fit_.amplification() > most_moduli;
  };
  while (order_ > 0 && too_much()) {
    --order_;
    if (!fit_.factor(order_)) order_ = -1;
  }
  return order_;
}

template <int dimensions>
void PointFit<dimensions>::append(PointFits& fits) {
  const std::size_t count = taken_.size(), begin = fits.source.size();
  const auto coefficient = fit_.value();
  fits.nearest.push_back(nearest_);
  fits.entries.push_back(static_cast<std::int32_t>(count));
  fits.source.resize(begin + count);
  fits.coefficient.resize(begin + count);
  const double sum = std::accumulate(coefficient.begin(), coefficient.end(), 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    fits.source[begin + k] = near_.particle(static_cast<std::size_t>(taken_[k]));
    fits.coefficient[begin + k] = coefficient[k] / sum;
  }
}

template <int dimensions>
void PointFit<dimensions>::append_bend(const Vec3& behind, PointFits& fits) {
  const std::size_t count = taken_.size(), begin = fits.source.size() - count;
  fits.bend.resize(fits.source.size(), 0.0);
  if (order_ < highest_order) return;
  // About the wall point, so that the value of the fit is that of the parabola there.
  const double sum = fill(behind, 1);
  for (int axis = 0; axis < dimensions; ++axis) fit_.offset(axis)[count] = -behind[axis] / 2 / smoothing_length_;
  fit_.weight()[count] = pinned * sum;
  const double most = most_bend * length(behind) / 2 / spacing_;
  for (const int order : {highest_pinned_order, highest_order}) {
    if (!fit_.factor(order)) continue;
    const auto behind_it = fit_.value();
    double moduli = 0;
    for (std::size_t k = 0; k < count; ++k) moduli += std::abs(behind_it[k] + fits.coefficient[begin + k]);
    if (order > highest_order && moduli > most) continue;
    for (std::size_t k = 0; k < count; ++k) fits.bend[begin + k] = behind_it[k] + fits.coefficient[begin + k];
    return;
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
  const bool bends = !stencils.bend.empty() || std::any_of(blocks.begin(), blocks.end(),
                                                           [](const PointFits& fits) { return !fits.bend.empty(); });
  if (bends) {
    // Points without a bend, of openings and of walls that let liquid slip, have zeros.
    const std::size_t before = stencils.bend.size();
    stencils.bend.resize(entry.back());
    std::fill(stencils.bend.begin() + before, stencils.bend.end(), 0.0);
  }
  stencils.first[all] = static_cast<std::int64_t>(entry.back());
  parallel_blocks(blocks.size(), 1, [&](std::size_t b, std::size_t, std::size_t) {
    const PointFits& fits = blocks[b];
    auto next = static_cast<std::int64_t>(entry[b]);
    std::copy(fits.source.begin(), fits.source.end(), stencils.source.data() + next);
    std::copy(fits.coefficient.begin(), fits.coefficient.end(), stencils.coefficient.data() + next);
    if (bends) std::copy(fits.bend.begin(), fits.bend.end(), stencils.bend.data() + next);
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
