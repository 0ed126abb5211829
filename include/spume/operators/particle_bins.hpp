// SPDX-License-Identifier: MIT
// Particles sorted into the cells of a box, for sweeps over points that are not particles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "spume/core/array.hpp"
#include "spume/core/uniform_grid.hpp"

namespace spume {

// Cells with edges of at least `support_radius`, so that all particles within that distance of a point lie in the
// 3^dimensions cells around the point's own. Particles beyond a side that is not periodic belong to the cells at that
// side.
class ParticleBins {
 public:
  // Needs length >= support_radius along periodic axes. Not-a-number coordinates land in a cell; distances to them are
  // not numbers either.
  ParticleBins(const UniformGrid& box, std::array<bool, 3> periodic, double support_radius,
               const std::array<std::span<const double>, 3>& position);

  std::array<std::size_t, 3> cells() const { return cells_; }
  std::size_t cell_count() const { return cells_[0] * cells_[1] * cells_[2]; }
  std::size_t cell_along(int axis, double coordinate) const;

  // Calls use(particle, wrapped_position) for all particles of the cells around (a, b, c), periodic images included
  // as separate entries, in an order that depends on the particles alone.
  template <class Use>
  void for_each_around(std::size_t a, std::size_t b, std::size_t c, Use&& use) const;

 private:
  double wrapped(int axis, double coordinate) const;

  int dimensions_;
  std::array<double, 3> lower_{}, length_{};
  std::array<bool, 3> periodic_{};
  std::array<std::size_t, 3> cells_{1, 1, 1};
  Array<std::uint32_t> first_;  // cell -> first entry of order_
  Array<std::uint32_t> order_;  // particles by cell, ascending within a cell
  Array<double> sorted_[3];     // wrapped positions in that order
};

template <class Use>
void ParticleBins::for_each_around(std::size_t a, std::size_t b, std::size_t c, Use&& use) const {
  struct Neighbour {
    std::size_t cell;
    double shift;
  };
  const std::array<std::size_t, 3> centre{a, b, c};
  std::array<std::array<Neighbour, 3>, 3> around{};
  std::array<int, 3> count{1, 1, 1};
  for (int axis = 0; axis < dimensions_; ++axis) {
    count[axis] = 0;
    const auto n = static_cast<std::ptrdiff_t>(cells_[axis]);
    for (std::ptrdiff_t offset = -1; offset <= 1; ++offset) {
      std::ptrdiff_t cell = static_cast<std::ptrdiff_t>(centre[axis]) + offset;
      double shift = 0;
      if (cell < 0 || cell >= n) {
        if (!periodic_[axis]) continue;
        shift = cell < 0 ? -length_[axis] : length_[axis];
        cell += cell < 0 ? n : -n;
      }
      around[axis][count[axis]++] = {static_cast<std::size_t>(cell), shift};
    }
  }
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        const std::size_t cell = around[0][i].cell + cells_[0] * (around[1][j].cell + cells_[1] * around[2][k].cell);
        for (std::uint32_t n = first_[cell]; n < first_[cell + 1]; ++n)
          use(order_[n], std::array<double, 3>{sorted_[0][n] + around[0][i].shift, sorted_[1][n] + around[1][j].shift,
                                               dimensions_ == 3 ? sorted_[2][n] + around[2][k].shift : 0.0});
      }
}

}  // namespace spume
