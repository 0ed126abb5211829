// SPDX-License-Identifier: MIT
#include "spume/particles/thin_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace spume {
namespace {

// Particles by cells at least as wide as `reach`.
class Cells {
 public:
  Cells(const Scene& scene, double reach) : scene_(scene), reach_(reach) {
    const Domain& domain = scene.domain;
    for (int axis = 0; axis < domain.dimensions; ++axis) {
      length_[axis] = domain.upper[axis] - domain.lower[axis];
      count_[axis] = std::max<std::size_t>(1, static_cast<std::size_t>(length_[axis] / reach));
    }
    const std::size_t particles = scene.particles.size();
    first_.assign(count_[0] * count_[1] * count_[2] + 1, 0);
    std::vector<std::size_t> cell(particles);
    for (std::size_t i = 0; i < particles; ++i) {
      cell[i] = number({index(i, 0), index(i, 1), index(i, 2)});
      ++first_[cell[i] + 1];
    }
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    member_.resize(particles);
    for (std::size_t i = 0; i < particles; ++i) member_[next[cell[i]]++] = i;
  }

  // Distance of the nearest particle of another phase, at most the reach.
  double nearest_other(std::size_t i) const {
    std::array<std::vector<std::size_t>, 3> near;
    for (int axis = 0; axis < 3; ++axis) near[axis] = beside(axis, index(i, axis));
    double square = reach_ * reach_;
    for (const std::size_t x : near[0])
      for (const std::size_t y : near[1])
        for (const std::size_t z : near[2]) {
          const std::size_t c = number({x, y, z});
          for (std::size_t m = first_[c]; m < first_[c + 1]; ++m)
            if (scene_.particles.phase[member_[m]] != scene_.particles.phase[i])
              square = std::min(square, squared_distance(i, member_[m]));
        }
    return std::sqrt(square);
  }

 private:
  bool periodic(int axis) const { return scene_.domain.periodic(axis); }
  std::size_t number(const std::array<std::size_t, 3>& at) const {
    return (at[2] * count_[1] + at[1]) * count_[0] + at[0];
  }
  std::size_t index(std::size_t i, int axis) const {
    if (axis >= scene_.domain.dimensions) return 0;
    const double share = (scene_.particles.position[axis][i] - scene_.domain.lower[axis]) / length_[axis];
    return std::min(count_[axis] - 1, static_cast<std::size_t>(std::max(0.0, share * double(count_[axis]))));
  }
  std::vector<std::size_t> beside(int axis, std::size_t at) const {
    const std::size_t count = count_[axis];
    std::vector<std::size_t> list{at};
    if (at > 0 || (periodic(axis) && count > 2)) list.push_back((at + count - 1) % count);
    if (at + 1 < count || (periodic(axis) && count > 1 && count - 1 == at)) list.push_back((at + 1) % count);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    return list;
  }
  double squared_distance(std::size_t i, std::size_t j) const {
    double sum = 0;
    for (int axis = 0; axis < scene_.domain.dimensions; ++axis) {
      double d = scene_.particles.position[axis][i] - scene_.particles.position[axis][j];
      if (periodic(axis)) d -= length_[axis] * std::round(d / length_[axis]);
      sum += d * d;
    }
    return sum;
  }

  const Scene& scene_;
  double reach_;
  std::array<double, 3> length_{1, 1, 1};
  std::array<std::size_t, 3> count_{1, 1, 1};
  std::vector<std::size_t> first_, member_;
};

}  // namespace

std::vector<ThinRegion> thin_regions(const Scene& scene, double width) {
  if (scene.phases.size() < 2) return {};
  // Rounding of the places of a lattice must not tell.
  const double reach = (width + scene.spacing) / 2, enough = reach * (1 - 1e-9);
  const Cells cells(scene, reach);
  const auto& region = scene.particles.region;
  std::vector<double> farthest(1 + static_cast<std::size_t>(*std::max_element(region.begin(), region.end())), 0.0);
  std::vector<bool> filled(farthest.size(), false);
  for (std::size_t i = 0; i < region.size(); ++i) {
    const auto r = static_cast<std::size_t>(region[i]);
    filled[r] = true;
    // The rest of a region that is known to be wide enough is passed over.
    if (farthest[r] < enough) farthest[r] = std::max(farthest[r], cells.nearest_other(i));
  }
  std::vector<ThinRegion> thin;
  for (std::size_t r = 0; r < farthest.size(); ++r)
    if (filled[r] && farthest[r] < enough) thin.push_back({r, 2 * farthest[r] - scene.spacing});
  return thin;
}

}  // namespace spume
