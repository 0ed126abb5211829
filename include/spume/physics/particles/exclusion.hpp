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
  double strongest = 0;  // largest Q / ((D_i + D_j) / 2)
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
  const CellOrder& order() const { return order_; }
  double bytes() const;

  // A particle in the order of the cells.
  struct Record {
    double x, y, z;
    float diameter;
    std::int32_t index;
  };

  // Calls visit(rank, overlap) for every particle that overlaps the one of rank k, in an order that depends on the
  // positions alone. Valid after prepare().
  void prepare(const Spheres& spheres);
  template <class Visit>
  void for_each_overlap(std::size_t k, Visit&& visit) const;
  // The same for every particle that covers the point; the overlap is then its depth below the surface.
  template <class Visit>
  void for_each_covering(const std::array<double, 3>& point, Visit&& visit) const;
  const Array<Record>& records() const { return records_; }

 private:
  struct Best {
    double overlap;
    std::int32_t rank;  // of the partner; -1: none
  };
  ExclusionReport match_by_rounds(const Spheres& spheres);
  ExclusionReport match_by_sorting(const Spheres& spheres);
  template <class Visit>
  void visit_around(const Record& here, std::int32_t rank, Visit&& visit) const;
  template <bool own_images, class Visit>
  void visit_cells(const Record& here, std::int32_t rank, Visit&& visit) const;
  Best strongest_free(const Spheres& spheres, std::size_t k) const;
  ExclusionReport summarise(std::size_t overlapping, int rounds) const;

  std::array<double, 3> lower_{}, length_{}, inverse_side_{};
  double largest_diameter_ = 0;
  bool own_images_ = false;  // some axis has fewer than three cells: nearest images by rounding
  PeriodicCells cells_;
  CellOrder order_;
  Array<Record> records_;
  Array<std::int32_t> partner_, best_, active_, next_active_;
  Array<std::uint8_t> taken_;
  Array<double> strength_;
};

// Whether spheres that touch at distance `touching` overlap at the square root of distance_2. Pairs that were moved
// apart touch to rounding (of the diameters in single precision, 6e-8): they do not count.
inline bool overlapping(double distance_2, double touching) {
  return distance_2 < (1 - 1e-6) * touching * touching;
}

// True when the overlap (q1, a1-b1) is taken before (q2, a2-b2); the arguments a, b are identifiers in either order.
bool stronger_overlap(double q1, std::int64_t a1, std::int64_t b1, double q2, std::int64_t a2, std::int64_t b2);

}  // namespace spume
