// SPDX-License-Identifier: MIT
// The liquid of the start in the cells of the lattice that fills a scene (scene/lattice.hpp), and its parts: liquid
// whose cells touch, by a corner too, is one, unless a body stands between their centres. Kept are the cells around the
// liquid, by one at least, and along periodic axes all.
#pragma once

#include <cstdint>
#include <vector>

#include "spume/scene/lattice.hpp"

namespace spume {

class LiquidCells {
 public:
  using Cell = std::array<std::int64_t, 3>;  // numbers along the axes, 0 along one that does not exist

  // With the phases of the particles of the scene; of two in one cell that of the last.
  explicit LiquidCells(const Scene& scene);

  int up() const { return lattice_.dimensions - 1; }  // rows are numbered along this axis
  double height() const { return lattice_.spacing[up()]; }
  std::int64_t rows() const { return count_[static_cast<std::size_t>(up())]; }
  double bottom(std::int64_t row) const {
    return lattice_.origin[up()] + static_cast<double>(row) * lattice_.spacing[up()];
  }
  std::int64_t columns() const { return count_[0] * (up() == 2 ? count_[1] : 1); }
  Cell cell(std::int64_t column, std::int64_t row) const;
  std::int64_t column_of(const Cell& cell) const { return up() == 2 ? cell[0] * count_[1] + cell[1] : cell[0]; }
  Cell cell_of(const Vec3& place) const;  // the nearest one, of places outside

  std::int32_t phase(const Cell& cell) const { return phase_[index(cell)]; }  // -1 without liquid
  std::int32_t part(const Cell& cell) const { return part_[index(cell)]; }    // -1 without liquid
  std::size_t parts() const { return first_row_.size(); }
  std::int64_t first_row(std::size_t part) const { return first_row_[part]; }
  std::int64_t last_row(std::size_t part) const { return last_row_[part]; }

  // Whether the wall of a body lies nearer to its centre than half a spacing, or beyond it.
  bool is_covered(const Cell& cell) const;

  // Goes one cell on along an axis, from one with liquid; where the domain ends there, what it ends with.
  enum class Beyond { cell, wall, open };
  Beyond step(Cell& cell, int axis, int by) const;

 private:
  std::size_t index(const Cell& cell) const {
    return static_cast<std::size_t>((cell[0] * count_[1] + cell[1]) * count_[2] + cell[2]);
  }
  void keep_around(const InitialParticles& particles);
  Vec3 centre(const Cell& cell) const;
  bool meet(const Cell& one, const Cell& other, double clear, int axes) const;
  void find_parts();

  const Scene& scene_;
  Lattice lattice_;
  Cell count_{1, 1, 1};
  std::vector<std::int32_t> phase_, part_;
  std::vector<std::int64_t> first_row_, last_row_;  // of parts
};

}  // namespace spume
