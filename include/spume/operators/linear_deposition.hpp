// SPDX-License-Identifier: MIT
// Particle amounts spread to the points of a periodic grid by linear weights to the eight corners of a cell: the
// smoothed delta function of de Wit et al. (2024), section II A, with the local volume fraction and the clipping (13).
#pragma once

#include <array>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/periodic_cells.hpp"

namespace spume {

struct DepositionReport {
  double force = 0;           // integral over the box of |f_x| + |f_y| + |f_z| before clipping
  double clipped_force = 0;   // and of what clipping took away
  double clipped_volume = 0;  // volume of the grid cells where clipping acted
  double most_volume_fraction = 0;
};

// What is spread: per particle three numbers of force (integral, per density of the fluid) and a volume.
struct DepositedParticles {
  std::array<const double*, 3> position{};  // in the box
  const double* force = nullptr;            // x, y, z side by side; room for one number behind the last
  const double* diameter = nullptr;         // null: all have the common one
  double common_diameter = 0;
};

// force_c(x) = clip(x) sum_p force_p,c delta(x - X_p),  clip = min(1, most / alpha(x)),
// alpha(x) = sum_p volume_p delta(x - X_p)
//
// Tiles of rows, of a few planes each, are summed on their own: every grid plane takes the particles of the cell plane
// below it, then those of its own, each in the order of the sort, so that the result does not depend on the number of
// threads. The two planes of sums of a tile stay in the second-level cache (with whole planes of 128^2 points they did
// not: 22 ns a particle), and no interleaved array of the size of the grid exists.
class LinearDeposition {
 public:
  LinearDeposition() = default;
  explicit LinearDeposition(const PeriodicGrid& grid) : grid_(grid) {}

  // Cells by which particles must be ordered: columns of the grid along z.
  PeriodicCells cells() const { return {grid_.lower, grid_.length, {grid_.points[0], grid_.points[1], 1}}; }

  // `order` was built from the positions on cells(). Every point of `force` is written; `volume_fraction` too, unless
  // null.
  template <class Real>
  DepositionReport deposit(const CellOrder& order, const DepositedParticles& particles, double most_volume_fraction,
                           const std::array<Real*, 3>& force, Real* volume_fraction);

  double bytes() const;

 private:
  PeriodicGrid grid_;
  std::vector<Array<double>> sums_;  // per thread, two planes of a tile
};

}  // namespace spume
