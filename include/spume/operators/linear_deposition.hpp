// SPDX-License-Identifier: MIT
// Particle amounts spread to the points of a periodic grid by linear weights to the eight corners of a cell: the
// smoothed delta function of de Wit et al. (2024), section II A, with the local volume fraction and the clipping (13).
#pragma once

#include <array>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/neighbours/periodic_cells.hpp"

namespace spume {

struct DepositionReport {
  double force = 0;           // integral over the box of |f_x| + |f_y| + |f_z| before clipping
  double clipped_force = 0;   // and of what clipping took away
  double clipped_volume = 0;  // volume of the grid cells where clipping acted
  double most_volume_fraction = 0;
};

// force_c(x) = clip(x) sum_p amount_p,c delta(x - X_p),  clip = min(1, most / alpha(x)),
// alpha(x) = sum_p amount_p,3 delta(x - X_p)
//
// Every plane of grid points sums the particles of the cell plane below it, then those of its own, each in the order
// of the sort, so that the result does not depend on the number of threads. Threads work through planes with two
// planes of sums in cache, and no interleaved array of the size of the grid exists.
class LinearDeposition {
 public:
  LinearDeposition() = default;
  explicit LinearDeposition(const PeriodicGrid& grid) : grid_(grid) {}

  // Cells by which particles must be ordered: those of the grid.
  PeriodicCells cells() const { return {grid_.lower, grid_.length, grid_.points}; }

  // amounts: four numbers per particle, the force integral (per density) and the volume; `order` was built from
  // `position` on cells(). Every point of `force` is written; `volume_fraction` too, unless null.
  template <class Real>
  DepositionReport deposit(const CellOrder& order, const std::array<const double*, 3>& position, const double* amounts,
                           double most_volume_fraction, const std::array<Real*, 3>& force, Real* volume_fraction);

  double bytes() const;

 private:
  PeriodicGrid grid_;
  std::vector<Array<double>> sums_;  // per thread, two planes of records
};

}  // namespace spume
