// SPDX-License-Identifier: MIT
// Excluded volume of spheres by "you only collide once" (de Wit et al. 2024, section III A): of all overlaps
// Q = (D_i + D_j)/2 - |X_i - X_j| the strongest are taken first, no particle twice, and each pair taken is moved
// apart along its line of centres until it touches.
//
// Taking the strongest first is a greedy matching. The same matching comes from rounds in which every pair that is the
// strongest for both of its particles is taken at once; that needs no list of overlaps, no sort and no order of
// threads. Overlaps of equal strength are ordered by a hash of the two identifiers (and then by these): in order of the
// identifiers themselves, n particles of one size at one point would need n / 2 rounds.
#pragma once

#include <array>
#include <cstdint>

#include "spume/core/array.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/periodic_cells.hpp"
#include "spume/physics/point_particles/kinds.hpp"

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

class Exclusion {
 public:
  Exclusion() = default;
  // The box, and the largest diameter, below half of the shortest side (std::invalid_argument otherwise).
  Exclusion(const std::array<double, 3>& lower, const std::array<double, 3>& length, double largest_diameter);

  // Finds the matching: partner()[i] is the index of the partner of particle i, or -1. Positions lie in the box. Pairs
  // that were moved apart touch to rounding, of single precision and of places to 2^-32 of the box: what overlaps by
  // less than 5e-7 of a diameter and 2^-28 of the box does not count, nor does a position that is not finite. Throws
  // std::logic_error where only one of two sees the other: a position lies outside the box.
  ExclusionReport match(const Spheres& spheres, MatchingMethod method = MatchingMethod::rounds);

  // Moves the pairs of the last match apart, shares of the way in inverse proportion to the volumes, so that the centre
  // of volume of the pair stays. Particles at one point part along a direction drawn from their identifiers.
  void separate(const Spheres& spheres) const;

  const Array<std::int32_t>& partner() const { return partner_; }
  const PeriodicCells& cells() const { return cells_; }
  // May be borrowed for another order; every search starts with its own.
  CellOrder& order() { return order_; }
  double bytes() const;

  // Sorts the spheres into cells, for the two searches below; they look at the spheres as they are then, and a match by
  // rounds hides those that it found a partner for.
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
    std::array<std::int32_t, remembered> rank{-1, -1, -1};  // of the partners; -1: none, or not known
    bool has_more = false;                                  // than these
  };
  // Where a search starts and what counts: spheres of one diameter whose distance squared is below `limit`, else those
  // that overlap by more than `share` of the sum of the radii and `least`.
  struct Centre {
    std::array<std::int32_t, 3> place;
    std::int32_t rank;  // of the sphere there; -1: a point
    float radius = 0, limit = 0, share = 0, least = 0;
  };
  // Ranks begin[r] .. end[r] of neighbouring cells.
  struct FourRows {
    std::int32_t begin[4], end[4];
  };
  struct Found;
  ExclusionReport match_by_rounds();
  ExclusionReport match_by_sorting();
  // Pieces of a search; `alike`: all spheres have one diameter.
  template <bool alike, class Use>
  void compare(const Centre& here, const FourRows& rows, Use&& use) const;
  std::array<int, 3> first_reached(const Centre& here) const;
  bool lies_in_four_rows(const Centre& here, FourRows& rows) const;
  template <class Use>
  void for_each_four_cells(const Centre& here, Use&& use) const;
  template <bool alike, class Full>
  void list_overlaps(const Centre& here, Found& found, Full&& full) const;
  template <class Visit>
  void for_each_found(const Centre& here, Visit&& visit) const;
  std::size_t cell_number(int i, int j, int l) const {
    return (static_cast<std::size_t>(i) * cells_.count[1] + j) * static_cast<std::size_t>(cells_.count[2]) + l;
  }
  // In 2^-32 of the box, wrapped around.
  std::array<std::int32_t, 3> place_of(double x, double y, double z) const {
    const double from_lower[3] = {x - lower_[0], y - lower_[1], z - lower_[2]};
    std::array<std::int32_t, 3> place;
    for (int axis = 0; axis < 3; ++axis)
      place[axis] = static_cast<std::int32_t>(
          static_cast<std::uint32_t>(static_cast<std::int64_t>(from_lower[axis] * (0x1p32 * inverse_length_[axis]))));
    return place;
  }
  Centre centre_of(std::size_t k) const;
  template <bool alike>
  Strongest strongest_overlaps(std::size_t k) const;
  template <bool alike>
  Strongest strongest_listed(std::size_t k) const;
  void remember(std::size_t k, const Strongest& strongest);
  void keep_strongest(std::size_t k, Found& found) const;
  void drop_taken(std::size_t k);

  std::array<double, 3> lower_{}, length_{}, inverse_length_{};
  std::array<float, 3> unit_{};  // of a place
  double largest_diameter_ = 0;
  float least_overlap_ = 0;
  float common_limit_ = 0;  // the square of the distance of spheres of one diameter that overlap
  std::int32_t out_of_reach_ = 0;
  int cells_reached_ = 3;  // along an axis
  bool rows_of_two_ = false;
  PeriodicCells cells_;
  CellOrder order_;
  Spheres spheres_;
  // In the order of the cells: place along x, y and z, and the bits of a float: of spheres of one diameter 0, else the
  // radius; of those that have a partner what puts them out of reach, so that searches of later rounds pass by, and the
  // same where a position is not finite.
  Array<std::int32_t> records_;
  Array<std::int32_t> partner_;
  // By rank: the partners of the strongest overlaps, and whether it has a partner now or more overlaps than are
  // remembered. Without a memory of several, every second particle of a crowd had to be searched around again.
  Array<std::array<std::int32_t, remembered>> best_;
  Array<std::uint8_t> taken_, has_more_;
};

// True when the overlap (q1, a1-b1) is taken before (q2, a2-b2); the arguments a, b are identifiers in either order.
bool stronger_overlap(double q1, std::int64_t a1, std::int64_t b1, double q2, std::int64_t a2, std::int64_t b2);

}  // namespace spume
