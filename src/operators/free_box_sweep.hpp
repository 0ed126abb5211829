// SPDX-License-Identifier: MIT
// The liquid of a free box, particle by particle (operators/free_box.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "spume/operators/free_box.hpp"

namespace spume {

// visit(offset, share, source) for the listed particles in the box and their mirror images, the particle itself and its
// own included, up to `reach`.
template <int dimensions, class Visit>
void visit_box(const SweepContext& context, const SolidUnion& solids, const FreeBox& box, double spacing, double reach,
               Visit&& visit) {
  const NeighbourList& list = *context.list;
  const auto particles = static_cast<std::int32_t>(list.particles());
  const auto i = static_cast<std::size_t>(box.particle);
  const auto share_of = [&](const std::array<double, dimensions>& d) {
    double share = 1;
    for (int axis = 0; axis < dimensions; ++axis)
      for (int side = 0; side < 2; ++side) {
        const double plane = side == 0 ? box.lower[axis] - box.place[axis] : box.upper[axis] - box.place[axis];
        const double inside = side == 0 ? d[axis] - plane : plane - d[axis];
        if (inside >= 0.5 * spacing) continue;
        Vec3 behind = box.place;
        for (int a = 0; a < dimensions; ++a) behind[a] += d[a];
        behind[axis] = box.place[axis] + plane + (side == 0 ? -1 : 1) * 1e-3 * spacing;
        if (solids.inside(behind))
          share = inside < 0 ? 0 : share;
        else
          share *= std::max(0.0, 0.5 + inside / spacing);
      }
    return share;
  };
  const auto mirrored = [&](const std::array<double, dimensions>& d, std::size_t source) {
    const double share = share_of(d);
    if (!(share > 0)) return;
    constexpr std::size_t most = 16;
    std::array<std::array<double, most>, 3> at{};
    std::array<std::size_t, 3> count{1, 1, 1};
    for (int axis = 0; axis < dimensions; ++axis) {
      count[axis] = 0;
      const double lower = box.lower[axis] - box.place[axis], upper = box.upper[axis] - box.place[axis];
      const double period = 2 * (upper - lower);
      const auto add = [&](double x) {
        if (std::abs(x) < reach && count[axis] < most) at[axis][count[axis]++] = x;
      };
      const int rounds = period < 4 * reach ? std::min(3, static_cast<int>(2 * reach / period) + 1) : 0;
      for (int round = -rounds; round <= rounds; ++round) {
        const double shift = rounds == 0 ? 0.0 : round * period;
        add(d[axis] + shift);
        add(2 * lower - d[axis] + shift);
        if (rounds == 0) add(2 * upper - d[axis]);
      }
    }
    std::array<double, dimensions> offset;
    for (std::size_t c = 0; c < count[0] * count[1] * count[2]; ++c) {
      const std::array<std::size_t, 3> pick{c % count[0], c / count[0] % count[1], c / count[0] / count[1]};
      double r2 = 0;
      for (int axis = 0; axis < dimensions; ++axis) {
        offset[axis] = at[axis][pick[axis]];
        r2 += offset[axis] * offset[axis];
      }
      if (r2 < reach * reach) visit(offset, share, source);
    }
  };
  mirrored({}, i);
  for (const std::int32_t j : list.of(i)) {
    std::size_t source = static_cast<std::size_t>(j);
    if (j >= particles) {
      const auto k = static_cast<std::size_t>(j - particles);
      const ImagePath& path = context.images->paths()[static_cast<std::size_t>(context.images->path()[k])];
      if (path.face != ImagePath{}.face) continue;
      source = static_cast<std::size_t>(context.images->source()[k]);
    }
    std::array<double, dimensions> d;
    for (int axis = 0; axis < dimensions; ++axis)
      d[axis] = double{list.coordinate(axis)[j]} - double{list.coordinate(axis)[i]};
    mirrored(d, source);
  }
}

}  // namespace spume
