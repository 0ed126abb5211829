// SPDX-License-Identifier: MIT
// Which sites of the lattice phases take beside the walls of bodies. Their particles have the volume of a cell, so a
// tank holds the liquid that it has room for only if the number of its sites is its volume. In circles about a corner
// of the lattice lie 3.5 % more centres of cells than that with a radius of 8 spacings, and 7 % less with one of 5.5.
// So of the cells that walls cut those are taken whose centres are farthest before them, as many as the volume; centres
// behind a wall, or close to it, are moved before it.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "filler.hpp"
#include "slots.hpp"
#include "spume/core/golden_ratio.hpp"

namespace spume {
namespace {

// Of a spacing: what the layer of a cell counts between cells whose centres are as far from the walls. Those that stay
// empty are spread over the height of a column.
constexpr double weight_of_layer = 1e-3;
// Closer to each other than this are cells that mirror each other.
constexpr double same_rank = 1e-9;

}  // namespace

// Mirrored by the middle of the domain.
double Filler::rank_of_site(ThreadRegions& own, const Vec3& p) const {
  const auto up = static_cast<std::size_t>(lattice_.dimensions) - 1;
  const double middle = lattice_.origin[up] + 0.5 * lattice_.count[up] * lattice_.spacing[up];
  const double layer = std::abs(p[up] - middle) / lattice_.spacing[up];
  return own.walls.at(p) / scene_.spacing - weight_of_layer * golden_part(layer);
}

bool Filler::is_cut(ThreadRegions& own, const Vec3& p) const {
  return std::abs(own.walls.at(p)) < 0.5 * std::sqrt(lattice_.dimensions) * scene_.spacing;
}

// Of a cell whose centre is behind a wall the place before it.
bool Filler::is_in_slot(const Vec3& p) const {
  const double width = too_narrow * scene_.spacing;
  const NearestPoint face = scene_.walls.nearest(p);
  if (face.distance > 0) return slot_at(scene_.walls, scene_.domain, p, width).has_value();
  const Vec3 before = add(p, multiply(0.01 * scene_.spacing - face.distance, face.normal));
  return slot_at(scene_.walls, scene_.domain, before, width).has_value();
}

void Filler::choose_sites_beside_walls() {
  const auto columns = static_cast<std::size_t>(lattice_.count[0]), rows = static_cast<std::size_t>(lattice_.count[1]);
  struct Found {
    std::vector<double> ranks;
    double volume = 0;  // of all cells that are cut
  };
  std::vector<Found> found(columns);
  parallel_blocks(columns, 1, [&](std::size_t i, std::size_t, std::size_t) {
    ThreadRegions& own = this->own();
    for (std::size_t j = 0; j < rows; ++j)
      for (double k = 0; k < (lattice_.dimensions == 3 ? lattice_.count[2] : 1); ++k) {
        const Vec3 p{centre(0, static_cast<double>(i)), centre(1, static_cast<double>(j)),
                     lattice_.dimensions == 3 ? centre(2, k) : 0};
        if (in_solid(p) || !is_cut(own, p) || is_in_slot(p)) continue;
        found[i].volume += open_part(own, p);
        if (own.walls.at(p) > 0) found[i].ranks.push_back(rank_of_site(own, p));
      }
  });
  std::vector<double> ranks;
  double volume = 0;
  for (const Found& some : found) {
    ranks.insert(ranks.end(), some.ranks.begin(), some.ranks.end());
    volume += some.volume;
  }
  std::sort(ranks.begin(), ranks.end(), std::greater<>());
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t count = 0; count <= ranks.size(); ++count) {
    const double last = count == 0 ? 2 : ranks[count - 1], next = count == ranks.size() ? -2 : ranks[count];
    const double miss = std::abs(static_cast<double>(count) - volume);
    if (last - next < same_rank || !(miss < best)) continue;
    best = miss;
    least_rank_ = 0.5 * (last + next);
  }
}

bool Filler::is_open_site(ThreadRegions& own, const Vec3& p) const {
  if (scene_.walls.empty()) return true;
  const double distance = own.walls.at(p), width = too_narrow * scene_.spacing;
  if (!(distance > 0) || (distance < width && slot_at(scene_.walls, scene_.domain, p, width))) return false;
  return !layered() || !is_cut(own, p) || rank_of_site(own, p) > least_rank_;
}

}  // namespace spume
