// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/exclusion.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "exclusion_search.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/core/random.hpp"

namespace spume {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

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
  for (int axis = 0; axis < 3; ++axis) {
    inverse_length_[axis] = 1 / length[axis];
    unit_[axis] = static_cast<float>(length[axis] * 0x1p-32);
  }
  least_overlap_ = static_cast<float>(std::max({length[0], length[1], length[2]}) * 0x1p-28);
}

void Exclusion::prepare(const Spheres& spheres) {
  const std::size_t n = spheres.size;
  // Two cells for a particle on average where that many fit (in clusters of bubbles 1.1 times faster than one, the same
  // elsewhere; four gain nothing more), and sides of at least two diameters, so that a sphere reaches two cells along
  // every axis, whichever way its place was rounded; where that makes crowds of small spheres, of at least one diameter
  // (the printed radius misses overlaps).
  const double support_radius = largest_diameter_ * (1 + overlap_rounding) + least_overlap_,
               most_cells = std::max<double>(64, 2.0 * double(n));
  cells_ = PeriodicCells::with_side(lower_, length_, 2 * support_radius, most_cells);
  cells_reached_ = 2;
  if (n > 8 * cells_.size()) {
    cells_ = PeriodicCells::with_side(lower_, length_, support_radius, most_cells);
    cells_reached_ = 3;
  }
  rows_of_two_ = cells_reached_ == 2 && std::min({cells_.count[0], cells_.count[1], cells_.count[2]}) >= 2;
  const bool alike = spheres.diameter == nullptr;
  const double limit = spheres.common_diameter * (1 - double{overlap_rounding}) - least_overlap_;
  common_limit_ = static_cast<float>(std::pow(std::max(limit, 0.0), 2));
  out_of_reach_ = std::bit_cast<std::int32_t>(alike ? infinite : -infinite);
  order_.build(cells_, spheres.position[0], spheres.position[1], spheres.position[2], n);
  spheres_ = spheres;
  constexpr std::size_t read_beyond = 4;
  records_.resize(4 * (n + read_beyond));
  parallel_for(n, [&](std::size_t k) {
    const std::size_t i = index_of(k);
    const double x = spheres.position[0][i], y = spheres.position[1][i], z = spheres.position[2][i];
    std::int32_t* record = records_.data() + 4 * k;
    if (!std::isfinite(x + y + z)) {
      std::fill_n(record, 3, 0);
      record[3] = out_of_reach_;
      return;
    }
    const auto place = place_of(x, y, z);
    std::copy_n(place.data(), 3, record);
    record[3] = alike ? 0 : std::bit_cast<std::int32_t>(static_cast<float>(0.5 * spheres.diameter[i]));
  });
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

// Leaves the strongest overlaps in front, in order, and no others.
void Exclusion::keep_strongest(std::size_t k, Found& found) const {
  const auto identifier = [&](int f) { return spheres_.identifier[index_of(static_cast<std::size_t>(found.rank[f]))]; };
  const std::int64_t own = spheres_.identifier[index_of(k)];
  std::array<int, remembered + 1> order;
  int kept = 0;
  for (int f = 0; f < found.count; ++f) {
    int place = std::min(kept, remembered);
    for (; place > 0; --place) {
      const int other = order[place - 1];
      if (!stronger_overlap(-double(found.weakness[f]), own, identifier(f), -double(found.weakness[other]), own,
                            identifier(other)))
        break;
      order[place] = other;
    }
    order[place] = f;
    kept = std::min(kept + 1, remembered);
  }
  const Found all = found;
  for (int s = 0; s < kept; ++s) {
    found.weakness[s] = all.weakness[order[s]];
    found.rank[s] = all.rank[order[s]];
  }
  found.count = kept;
}

template <bool alike>
Exclusion::Strongest Exclusion::strongest_listed(std::size_t k) const {
  Found found;
  Strongest strongest;
  const auto keep = [&] {
    strongest.has_more |= found.count > remembered;
    keep_strongest(k, found);
  };
  list_overlaps<alike>(centre_of(k), found, keep);
  keep();
  std::copy_n(found.rank, found.count, strongest.rank.data());
  return strongest;
}

// The same without a list, a loop over what was found or a branch on how much it was: the strongest two of every lane,
// and how strong the third was, then the strongest three of these. Ties are left to the list.
template <bool alike>
[[gnu::always_inline]] inline Exclusion::Strongest Exclusion::strongest_overlaps(std::size_t k) const {
  using simd::f32x16, simd::i32x16;
  const Centre here = centre_of(k);
  FourRows rows;
  if (!lies_in_four_rows(here, rows)) return strongest_listed<alike>(k);
  constexpr float none = infinite;
  f32x16 first = simd::splat16(none), second = first, third = first;
  i32x16 first_rank = simd::splat16(-1), second_rank = first_rank;
  compare<alike>(here, rows, [&](f32x16 weakness, i32x16 rank, simd::bits16 near) {
    const f32x16 here_too = simd::chosen(near, weakness, simd::splat16(none));
    const simd::bits16 before_first = simd::bits_less(here_too, first);
    const f32x16 later = simd::larger(first, here_too);
    const i32x16 later_rank = simd::chosen(before_first, first_rank, rank);
    first = simd::smaller(first, here_too);
    first_rank = simd::chosen(before_first, rank, first_rank);
    const simd::bits16 before_second = simd::bits_less(later, second);
    third = simd::smaller(third, simd::larger(second, later));
    second = simd::smaller(second, later);
    second_rank = simd::chosen(before_second, later_rank, second_rank);
  });

  Strongest strongest;
  if (simd::bits_less(first, simd::splat16(none)) == 0) return strongest;
  float last = -none;
  bool undecided = false;
  for (std::int32_t& chosen : strongest.rank) {
    const float weakness = simd::least(first);
    const simd::bits16 lane = simd::bits_equal(first, simd::splat16(weakness));
    const bool any = weakness < none;
    chosen = any ? simd::lane_of(first_rank, lane) : -1;
    undecided |= any & (!std::has_single_bit(lane) | (weakness == last));
    strongest.has_more |= any & (chosen < 0);
    last = weakness;
    first = simd::chosen(lane, second, first);
    first_rank = simd::chosen(lane, second_rank, first_rank);
    second = simd::chosen(lane, third, second);
    second_rank = simd::chosen(lane, simd::splat16(-1), second_rank);
    third = simd::chosen(lane, simd::splat16(none), third);
  }
  const float next = simd::least(first);
  strongest.has_more |= next < none;
  undecided |= (next < none) & (next == last);
  if (undecided) [[unlikely]]
    return strongest_listed<alike>(k);
  return strongest;
}

void Exclusion::remember(std::size_t k, const Strongest& strongest) {
  best_[k] = strongest.rank;
  has_more_[k] = strongest.has_more ? 1 : 0;
}

// Leaves the strongest overlap with a particle that is still free in front.
void Exclusion::drop_taken(std::size_t k) {
  auto& best = best_[k];
  while (best[0] >= 0 && taken_[static_cast<std::size_t>(best[0])] != 0) {
    std::copy(best.begin() + 1, best.end(), best.begin());
    best.back() = -1;
  }
  if (best[0] < 0 && has_more_[k] != 0)
    remember(k, spheres_.diameter == nullptr ? strongest_overlaps<true>(k) : strongest_overlaps<false>(k));
}

ExclusionReport Exclusion::match_by_rounds() {
  const std::size_t n = spheres_.size;
  best_.resize(n);
  has_more_.resize(n);
  ExclusionReport report;
  const bool alike = spheres_.diameter == nullptr;

  // Blocks of ranks that never change; each keeps those of its own with a free partner at its beginning, in order.
  const std::size_t block = std::max(default_block, block_count(n, max_reduction_blocks));
  std::array<std::size_t, max_reduction_blocks> left{}, pairs{};
  std::int32_t* active = order_.scratch().data();
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::size_t kept = first;
    for (std::size_t k = first; k < last; ++k) {
      remember(k, alike ? strongest_overlaps<true>(k) : strongest_overlaps<false>(k));
      active[kept] = static_cast<std::int32_t>(k);
      kept += best_[k][0] >= 0 ? 1 : 0;
    }
    left[b] = kept - first;
  });
  const auto total = [](const auto& of_blocks) { return std::accumulate(of_blocks.begin(), of_blocks.end(), 0UL); };
  report.overlapping = total(left);
  while (total(left) > 0) {
    // The globally strongest free pair is always the strongest for both, so that every round takes at least one.
    // Chance decides who is taken: conditional writes would be guessed wrong as often as right.
    ++report.rounds;
    const std::size_t paired = total(pairs);
    parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t) {
      std::size_t kept = first;
      for (std::size_t a = first; a < first + left[b]; ++a) {
        const auto k = static_cast<std::size_t>(active[a]);
        const auto m = static_cast<std::size_t>(best_[k][0]);
        const bool mutual = best_[m][0] == active[a];
        taken_[k] = mutual ? 1 : 0;
        records_[4 * k + 3] = mutual ? out_of_reach_ : records_[4 * k + 3];
        partner_[index_of(k)] = mutual ? static_cast<std::int32_t>(index_of(m)) : -1;
        active[kept] = active[a];
        kept += mutual ? 0 : 1;
      }
      pairs[b] += first + left[b] - kept;
      left[b] = kept - first;
    });
    if (total(pairs) == paired)
      throw std::logic_error("of two particles that overlap only one finds the other: a position lies outside the box");
    parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t) {
      std::size_t kept = first;
      for (std::size_t a = first; a < first + left[b]; ++a) {
        const auto k = static_cast<std::size_t>(active[a]);
        drop_taken(k);
        active[kept] = active[a];
        kept += best_[k][0] >= 0 ? 1 : 0;
      }
      left[b] = kept - first;
    });
  }
  report.pairs = total(pairs) / 2;
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
  ExclusionReport report;
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
      ++report.pairs;
    }
  for (const std::size_t count : overlapping) report.overlapping += count;
  report.rounds = 1;
  return report;
}

void Exclusion::separate(const Spheres& spheres) const {
  parallel_for(spheres.size, [&](std::size_t i) {
    // The partner with the smaller index moves both: no one else touches either.
    if (partner_[i] < 0 || static_cast<std::size_t>(partner_[i]) < i) return;
    const auto j = static_cast<std::size_t>(partner_[i]);
    std::array<double, 3> d;
    double distance_2 = 0;
    for (int c = 0; c < 3; ++c) {
      d[c] = spheres.position[c][i] - spheres.position[c][j];
      d[c] -= length_[c] * std::nearbyint(d[c] * inverse_length_[c]);
      distance_2 += d[c] * d[c];
    }
    const double own = spheres.diameter == nullptr ? spheres.common_diameter : spheres.diameter[i];
    const double other = spheres.diameter == nullptr ? spheres.common_diameter : spheres.diameter[j];
    const double distance = std::sqrt(distance_2);
    const double touching = 0.5 * (own + other);
    double stretch = (touching - distance) / distance;
    if (!(distance > 1e-12 * touching)) {
      d = parting_direction(spheres.identifier[i], spheres.identifier[j]);
      stretch = touching - distance;
    }
    const double share = other * other * other / (own * own * own + other * other * other);
    for (int c = 0; c < 3; ++c) {
      double* x = spheres.position[c];
      x[i] = wrap_periodic(x[i] + share * stretch * d[c], lower_[c], length_[c]);
      x[j] = wrap_periodic(x[j] - (1 - share) * stretch * d[c], lower_[c], length_[c]);
    }
  });
}

double Exclusion::bytes() const {
  return order_.bytes() +
         static_cast<double>(4 * (records_.capacity() + partner_.capacity() + remembered * best_.capacity()) +
                             taken_.capacity() + has_more_.capacity());
}

}  // namespace spume
