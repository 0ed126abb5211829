// SPDX-License-Identifier: MIT
// Excluded volume of spheres by "you only collide once" (de Wit et al. 2024, section III A): of all overlaps
// Q = (D_i + D_j)/2 - |X_i - X_j| the strongest are taken first, no particle twice, and each pair taken is moved
// apart along its line of centres until it touches.
//
// Taking the strongest first is a greedy matching. The same matching comes from rounds in which every pair that is the
// strongest for both of its particles is taken at once; that needs no list of overlaps, no sort and no order of
// threads. Overlaps of equal strength are ordered by a hash of the two identifiers (and then by these): in order of the
// identifiers themselves, n particles at one point would need n / 2 rounds.
#pragma once

#include <array>
#include <cstdint>

#include "spume/core/array.hpp"
#include "spume/neighbours/periodic_cells.hpp"

namespace spume {

struct ExclusionReport {
  std::size_t overlapping = 0;  // particles with an overlap
  std::size_t pairs = 0;        // pairs moved apart
  int rounds = 0;
};

// The particles to be separated. `diameter` may be null: then all have `common_diameter`.
struct Spheres {
  std::array<double*, 3> position{};
  const double* diameter = nullptr;
  const std::int64_t* identifier = nullptr;
  double common_diameter = 0;
  std::size_t size = 0;
};

enum class MatchingMethod {
  rounds,   // locally strongest pairs, in parallel
  sorting,  // the paper's: all overlaps listed, sorted, purged
};

class Exclusion {
 public:
  Exclusion() = default;
  // The box, and the largest diameter, below half of the shortest side (std::invalid_argument otherwise).
  Exclusion(const std::array<double, 3>& lower, const std::array<double, 3>& length, double largest_diameter);

  // Finds the matching: partner()[i] is the index of the partner of particle i, or -1. Positions lie in the box.
  ExclusionReport match(const Spheres& spheres, MatchingMethod method = MatchingMethod::rounds);

  // Moves the pairs of the last match apart, shares of the way in inverse proportion to the volumes, so that the centre
  // of volume of the pair stays. Particles at one point part along a direction drawn from their identifiers.
  void separate(const Spheres& spheres) const;

  const Array<std::int32_t>& partner() const { return partner_; }
  const PeriodicCells& cells() const { return cells_; }
  // May be borrowed for another order; every search starts with its own.
  CellOrder& order() { return order_; }
  double bytes() const;

  // Sorts the spheres into cells, for the two searches below; they look at the spheres as they are then.
  void prepare(const Spheres& spheres);
  // Calls visit(rank, overlap) for every particle that overlaps the one of rank k in order(), in an order that depends
  // on the positions alone.
  template <class Visit>
  void for_each_overlap(std::size_t k, Visit&& visit) const;
  // The same for every particle that covers the point; the overlap is then its depth below the surface.
  template <class Visit>
  void for_each_covering(const std::array<double, 3>& point, Visit&& visit) const;
  std::size_t index_of(std::size_t rank) const { return static_cast<std::size_t>(order_.order()[rank]); }
  double diameter_of(std::size_t rank) const {
    return spheres_.diameter == nullptr ? spheres_.common_diameter : spheres_.diameter[index_of(rank)];
  }

 private:
  // The strongest overlaps of a particle with free ones, in order.
  static constexpr int remembered = 3;
  struct Strongest {
    double overlap[remembered] = {};
    std::int32_t rank[remembered] = {-1, -1, -1};  // of the partner; -1: none
    int found = 0;                                 // overlaps, also those not remembered
  };
  ExclusionReport match_by_rounds();
  ExclusionReport match_by_sorting();
  // Where a search starts and how far it goes.
  struct Centre {
    std::array<double, 3> place;
    double radius;
    std::int32_t rank;  // of the sphere there; -1: a point
  };
  // Calls use(ranks, overlaps, count) for groups of neighbours of particle k; an overlap of 0 is none.
  template <class Use>
  void search_around(std::size_t k, Use&& use) const;
  // The same for any centre, anywhere.
  template <bool own_images, class Use>
  void search_cells(const Centre& here, Use&& use) const;
  // The same inside the box and outside crowds, elsewhere false; a sphere must reach no further than half a cell.
  // `place` is from the lower corner, `limit` the square of what may be near; centre() gives the centre, where
  // something is.
  template <class CentreOf, class Use>
  bool search_near(const std::array<float, 3>& place, std::int32_t rank, float limit, CentreOf&& centre,
                   Use&& use) const;
  std::size_t cell_number(int i, int j, int l) const {
    return (static_cast<std::size_t>(i) * cells_.count[1] + j) * static_cast<std::size_t>(cells_.count[2]) + l;
  }
  // The square of a reach that misses nothing although places are compared in single precision: from the lower corner
  // they are off by 2^-24 of the box, distances by less than eight times that along every axis, the image included.
  float safe_square(double reach) const;
  Centre centre_of(std::size_t k) const;
  double overlap_with(const Centre& here, std::int32_t rank) const;
  Strongest strongest_free(std::size_t k) const;
  void remember(std::size_t k, const Strongest& strongest);
  void drop_taken(std::size_t k);
  std::size_t matched_pairs() const;

  std::array<double, 3> lower_{}, length_{}, inverse_length_{}, inverse_side_{};
  std::array<float, 3> cells_per_length_{};
  float common_limit_ = 0;  // of spheres of one diameter
  double largest_diameter_ = 0;
  bool reaches_half_a_cell_ = false;
  bool own_images_ = false;  // some axis has fewer than three cells: nearest images by rounding
  PeriodicCells cells_;
  CellOrder order_;
  Spheres spheres_;
  // In the order of the cells: positions, and places from the lower corner, which tell in vectors what cannot overlap.
  std::array<Array<double>, 3> position_;
  std::array<Array<float>, 3> place_;
  Array<std::int32_t> partner_;
  // By rank: the partners of the strongest overlaps, and whether it has a partner now or more overlaps than are
  // remembered. Without a memory of several, every second particle of a crowd had to be searched around again.
  Array<std::array<std::int32_t, remembered>> best_;
  Array<std::uint8_t> taken_, has_more_;
};

// Whether spheres that touch at distance `touching` overlap at the square root of distance_2. Pairs that were moved
// apart touch to rounding: they do not count.
inline bool overlapping(double distance_2, double touching) {
  return distance_2 < (1 - 1e-6) * touching * touching;
}

// True when the overlap (q1, a1-b1) is taken before (q2, a2-b2); the arguments a, b are identifiers in either order.
bool stronger_overlap(double q1, std::int64_t a1, std::int64_t b1, double q2, std::int64_t a2, std::int64_t b2);

}  // namespace spume
