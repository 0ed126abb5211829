// SPDX-License-Identifier: MIT
#include "spume/physics/particles/exclusion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "exclusion_search.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"

namespace spume {
namespace {

// A mixing of the pair, equal for both orders of its members (finaliser of MurmurHash3).
std::uint64_t pair_hash(std::int64_t a, std::int64_t b) {
  const auto low = static_cast<std::uint64_t>(std::min(a, b)), high = static_cast<std::uint64_t>(std::max(a, b));
  std::uint64_t v = low * 0x9e3779b97f4a7c15ULL + high;
  v = (v ^ v >> 33) * 0xff51afd7ed558ccdULL;
  v = (v ^ v >> 33) * 0xc4ceb9fe1a85ec53ULL;
  return v ^ v >> 33;
}

// A unit vector for particles that share one point; opposite for the two partners.
std::array<double, 3> parting_direction(std::int64_t own, std::int64_t other) {
  const auto r = random_uniform(0, RandomPurpose::parting, pair_hash(own, other), 0, 0);
  const double cosine = 2 * r[0] - 1, angle = 2 * M_PI * r[1];
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)) * (own < other ? 1 : -1);
  return {sine * std::cos(angle), sine * std::sin(angle), own < other ? cosine : -cosine};
}

}  // namespace

bool stronger_overlap(double q1, std::int64_t a1, std::int64_t b1, double q2, std::int64_t a2, std::int64_t b2) {
  if (q1 != q2) return q1 > q2;
  const std::uint64_t h1 = pair_hash(a1, b1), h2 = pair_hash(a2, b2);
  if (h1 != h2) return h1 > h2;
  const std::int64_t low1 = std::min(a1, b1), low2 = std::min(a2, b2);
  return low1 != low2 ? low1 < low2 : std::max(a1, b1) < std::max(a2, b2);
}

Exclusion::Exclusion(const std::array<double, 3>& lower, const std::array<double, 3>& length, double largest_diameter)
    : lower_(lower), length_(length), largest_diameter_(largest_diameter) {
  const double shortest = std::min({length[0], length[1], length[2]});
  if (!(largest_diameter > 0) || !(2 * largest_diameter < shortest))
    throw std::invalid_argument("the largest diameter, " + std::to_string(largest_diameter) +
                                ", must lie between 0 and half of the shortest side of the box");
  for (int axis = 0; axis < 3; ++axis) inverse_length_[axis] = 1 / length[axis];
}

void Exclusion::prepare(const Spheres& spheres) {
  const std::size_t n = spheres.size;
  // One particle per cell on average, and sides of at least two diameters, so that a sphere reaches two cells along
  // every axis, places in single precision included; where that makes crowds of small spheres, or too few cells, of at
  // least one diameter (the printed radius misses overlaps).
  const double reach = std::sqrt(safe_square(largest_diameter_)), most_cells = std::max<double>(64, double(n));
  const auto fewest = [&] { return std::min({cells_.count[0], cells_.count[1], cells_.count[2]}); };
  cells_ = PeriodicCells::with_side(lower_, length_, 2 * reach, most_cells);
  reaches_half_a_cell_ = fewest() >= 3 && n <= 8 * cells_.size();
  if (!reaches_half_a_cell_) cells_ = PeriodicCells::with_side(lower_, length_, largest_diameter_, most_cells);
  for (int axis = 0; axis < 3; ++axis) {
    inverse_side_[axis] = cells_.count[axis] / length_[axis];
    cells_per_length_[axis] = static_cast<float>(inverse_side_[axis]);
  }
  common_limit_ = spheres.diameter == nullptr ? safe_square(0.5 * (spheres.common_diameter + largest_diameter_)) : 0;
  own_images_ = fewest() < 3;
  order_.build(cells_, spheres.position[0], spheres.position[1], spheres.position[2], n);
  spheres_ = spheres;
  for (int axis = 0; axis < 3; ++axis) {
    place_[axis].resize(n + search_group);
    position_[axis].resize(n);
    float* place = place_[axis].data();
    double* position = position_[axis].data();
    const double* x = spheres.position[axis];
    const double lower = lower_[axis];
    const std::int32_t* order = order_.order().data();
    parallel_for(n, [=](std::size_t k) {
      position[k] = x[order[k]];
      place[k] = static_cast<float>(position[k] - lower);
    });
  }
}

ExclusionReport Exclusion::match(const Spheres& spheres, MatchingMethod method) {
  prepare(spheres);
  partner_.resize(spheres.size);
  taken_.resize(spheres.size);
  parallel_for(spheres.size, [&](std::size_t i) {
    partner_[i] = -1;
    taken_[i] = 0;
  });
  return method == MatchingMethod::rounds ? match_by_rounds() : match_by_sorting();
}

Exclusion::Strongest Exclusion::strongest_free(std::size_t k) const {
  Strongest best;
  const auto identifier = [&](std::int32_t rank) {
    return spheres_.identifier[index_of(static_cast<std::size_t>(rank))];
  };
  search_around(k, [&](const std::int32_t* rank, const double* overlap, int count) {
    for (int f = 0; f < count; ++f) {
      const std::int32_t m = rank[f];
      const double q = taken_[static_cast<std::size_t>(m)] == 0 ? overlap[f] : 0.0;
      best.found += q > 0 ? 1 : 0;
      // Which of the remembered ones it comes before.
      bool before[remembered];
      for (int b = 0; b < remembered; ++b) before[b] = q > best.overlap[b];
      if (q > 0 && (q == best.overlap[0] || q == best.overlap[1] || q == best.overlap[2])) [[unlikely]] {
        const std::int64_t own = identifier(static_cast<std::int32_t>(k));
        for (int b = 0; b < remembered; ++b)
          if (q == best.overlap[b])
            before[b] = stronger_overlap(q, own, identifier(m), best.overlap[b], own, identifier(best.rank[b]));
      }
      for (int b = remembered - 1; b > 0; --b) {
        best.overlap[b] = before[b - 1] ? best.overlap[b - 1] : (before[b] ? q : best.overlap[b]);
        best.rank[b] = before[b - 1] ? best.rank[b - 1] : (before[b] ? m : best.rank[b]);
      }
      best.overlap[0] = before[0] ? q : best.overlap[0];
      best.rank[0] = before[0] ? m : best.rank[0];
    }
  });
  return best;
}

void Exclusion::remember(std::size_t k, const Strongest& strongest) {
  std::copy_n(strongest.rank, remembered, best_[k].data());
  has_more_[k] = strongest.found > remembered ? 1 : 0;
}

// Leaves the strongest overlap with a particle that is still free in front.
void Exclusion::drop_taken(std::size_t k) {
  auto& best = best_[k];
  while (best[0] >= 0 && taken_[static_cast<std::size_t>(best[0])] != 0) {
    std::copy(best.begin() + 1, best.end(), best.begin());
    best.back() = -1;
  }
  if (best[0] < 0 && has_more_[k] != 0) remember(k, strongest_free(k));
}

ExclusionReport Exclusion::match_by_rounds() {
  const std::size_t n = spheres_.size;
  best_.resize(n);
  has_more_.resize(n);
  Array<std::int32_t>&active = order_.scratch(), &next_active = order_.more_scratch();
  ExclusionReport report;
  parallel_for(n, [&](std::size_t k) { remember(k, strongest_free(k)); });

  // Keeps the ranks with a free partner, in ascending order, by fixed blocks.
  std::array<std::size_t, max_reduction_blocks + 1> start{};
  const auto keep = [&](const std::int32_t* from, std::size_t count, Array<std::int32_t>& to) {
    const std::size_t block = std::max(default_block, block_count(count, max_reduction_blocks));
    const auto wanted = [&](std::size_t a) {
      const std::size_t k = from == nullptr ? a : static_cast<std::size_t>(from[a]);
      return best_[k][0] >= 0 && taken_[k] == 0;
    };
    parallel_blocks(count, block, [&](std::size_t b, std::size_t first, std::size_t last) {
      std::size_t kept = 0;
      for (std::size_t a = first; a < last; ++a) kept += wanted(a) ? 1 : 0;
      start[b + 1] = kept;
    });
    const std::size_t blocks = block_count(count, block);
    start[0] = 0;
    for (std::size_t b = 0; b < blocks; ++b) start[b + 1] += start[b];
    parallel_blocks(count, block, [&](std::size_t b, std::size_t first, std::size_t last) {
      std::size_t place = start[b];
      for (std::size_t a = first; a < last; ++a)
        if (wanted(a)) to[place++] = from == nullptr ? static_cast<std::int32_t>(a) : from[a];
    });
    return count == 0 ? std::size_t{0} : start[blocks];
  };
  std::size_t left = keep(nullptr, n, active);
  report.overlapping = left;
  while (left > 0) {
    // The globally strongest free pair is always the strongest for both, so that every round takes at least one.
    ++report.rounds;
    parallel_for(left, [&](std::size_t a) {
      const auto k = static_cast<std::size_t>(active[a]);
      const std::int32_t m = best_[k][0];
      if (best_[static_cast<std::size_t>(m)][0] != active[a]) return;
      taken_[k] = 1;
      partner_[index_of(k)] = static_cast<std::int32_t>(index_of(static_cast<std::size_t>(m)));
    });
    parallel_for(left, [&](std::size_t a) {
      const auto k = static_cast<std::size_t>(active[a]);
      if (taken_[k] == 0) drop_taken(k);
    });
    left = keep(active.data(), left, next_active);
    active.swap(next_active);
  }
  report.pairs = matched_pairs();
  return report;
}

ExclusionReport Exclusion::match_by_sorting() {
  struct Overlap {
    double overlap;
    std::int64_t own, other;
    std::int32_t rank, other_rank;
  };
  const std::size_t n = spheres_.size;
  const std::size_t block = std::max(default_block, block_count(n, max_reduction_blocks));
  std::vector<std::vector<Overlap>> lists(block_count(n, block));
  std::vector<std::size_t> overlapping(lists.size(), 0);
  const auto before = [](const Overlap& a, const Overlap& b) {
    return stronger_overlap(a.overlap, a.own, a.other, b.overlap, b.own, b.other);
  };
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const std::int64_t own = spheres_.identifier[index_of(k)];
      bool overlaps = false;
      for_each_overlap(k, [&](std::int32_t m, double overlap) {
        overlaps = true;
        const std::int64_t other = spheres_.identifier[index_of(static_cast<std::size_t>(m))];
        if (own > other) lists[b].push_back({overlap, own, other, static_cast<std::int32_t>(k), m});
      });
      overlapping[b] += overlaps ? 1 : 0;
    }
    std::sort(lists[b].begin(), lists[b].end(), before);
  });
  for (std::size_t width = 1; width < lists.size(); width *= 2)
    parallel_blocks(block_count(lists.size(), 2 * width), 1, [&](std::size_t pair, std::size_t, std::size_t) {
      const std::size_t a = 2 * width * pair, b = a + width;
      if (b >= lists.size()) return;
      std::vector<Overlap> merged(lists[a].size() + lists[b].size());
      std::merge(lists[a].begin(), lists[a].end(), lists[b].begin(), lists[b].end(), merged.begin(), before);
      lists[a].swap(merged);
      lists[b] = {};
    });
  if (!lists.empty())
    for (const Overlap& o : lists[0]) {
      auto& own = taken_[static_cast<std::size_t>(o.rank)];
      auto& other = taken_[static_cast<std::size_t>(o.other_rank)];
      if (own != 0 || other != 0) continue;
      own = other = 1;
      const std::size_t i = index_of(static_cast<std::size_t>(o.rank));
      const std::size_t j = index_of(static_cast<std::size_t>(o.other_rank));
      partner_[i] = static_cast<std::int32_t>(j);
      partner_[j] = static_cast<std::int32_t>(i);
    }
  ExclusionReport report;
  for (const std::size_t count : overlapping) report.overlapping += count;
  report.rounds = 1;
  report.pairs = matched_pairs();
  return report;
}

std::size_t Exclusion::matched_pairs() const {
  return static_cast<std::size_t>(
      parallel_sum(partner_.size(), [&](std::size_t i) { return partner_[i] >= 0 ? 0.5 : 0.0; }));
}

void Exclusion::separate(const Spheres& spheres) const {
  // Written only after every pair was read: both partners need both old places.
  const auto shift_of = [&](std::size_t i) {
    const auto j = static_cast<std::size_t>(partner_[i]);
    std::array<double, 3> d;
    double distance_2 = 0;
    for (int c = 0; c < 3; ++c) {
      d[c] = nearest_image(spheres.position[c][i] - spheres.position[c][j], length_[c]);
      distance_2 += d[c] * d[c];
    }
    const double own = spheres.diameter == nullptr ? spheres.common_diameter : spheres.diameter[i];
    const double other = spheres.diameter == nullptr ? spheres.common_diameter : spheres.diameter[j];
    const double distance = std::sqrt(distance_2);
    const double touching = 0.5 * (own + other);
    if (distance > 1e-12 * touching)
      for (double& component : d) component /= distance;
    else
      d = parting_direction(spheres.identifier[i], spheres.identifier[j]);
    const double share = other * other * other / (own * own * own + other * other * other);
    for (double& component : d) component *= share * (touching - distance);
    return d;
  };
  parallel_for(spheres.size, [&](std::size_t i) {
    const std::int32_t j = partner_[i];
    // The partner with the smaller index moves both: no one else touches either.
    if (j < 0 || static_cast<std::size_t>(j) < i) return;
    const auto mine = shift_of(i), theirs = shift_of(static_cast<std::size_t>(j));
    for (int c = 0; c < 3; ++c) {
      double* x = spheres.position[c];
      x[i] = wrap_periodic(x[i] + mine[c], lower_[c], length_[c]);
      x[j] = wrap_periodic(x[j] + theirs[c], lower_[c], length_[c]);
    }
  });
}

double Exclusion::bytes() const {
  return order_.bytes() +
         static_cast<double>(24 * position_[0].capacity() +
                             4 * (3 * place_[0].capacity() + partner_.capacity() + remembered * best_.capacity()) +
                             taken_.capacity() + has_more_.capacity());
}

}  // namespace spume
