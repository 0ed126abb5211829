// SPDX-License-Identifier: MIT
// Setup of the preconditioner: the box of cells, the particles in it, the coefficients of the finest level.
#include <algorithm>
#include <atomic>
#include <climits>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "cell_status.hpp"
#include "spume/core/parallel.hpp"
#include "spume/solvers/cell_multigrid.hpp"

namespace spume {

namespace {

// Box edges are multiples of this, so that the first two levels pair the same cells from step to step. With 1 a
// collapsing column at 1/200 takes as many iterations, with 16 0.6 % fewer.
constexpr int box_alignment = 4;
// Cells per particle beyond which a sparse cloud is covered with wider cells, and a number of cells whose few MB are no
// reason for that. A full domain has 0.3 (3-D) or 0.44 (2-D); a collapsing column has the same bits with 4 and 100.
constexpr double most_cells_per_particle = 8;
constexpr double fewest_cells = 65536;
// Of the mass of a cell of liquid that solids cover: keeps its row positive. A cavity around a solid has the same bits
// with 0.01 (and with 0.9 for the least open volume of cell_multigrid_solids.cpp).
constexpr float least_mass = 0.1F;
// Entries of a cell up to which they are sorted by insertion, as std::sort does; cells hold 2 particles (2-D) or 3
// (3-D).
constexpr int sorted_by_insertion = 16;

// Cells along an axis of fixed length: a small number times a power of two, so that coarsening stays even.
int even_count(double length, double cell_size) {
  const double wanted = length / cell_size;
  if (wanted <= 1.5) return 1;
  int best = 2;
  for (int power = 1; power < (1 << 26); power *= 2)
    for (const int odd : {1, 3, 5, 7}) {
      if (odd > 1 && power == 1) continue;
      if (odd > 3 && power < 4) continue;
      const int count = odd * power;
      if (std::abs(std::log(count / wanted)) < std::abs(std::log(best / wanted))) best = count;
    }
  return best;
}

int floor_to(int i, int step) {
  return (i >= 0 ? i / step : -((-i + step - 1) / step)) * step;
}

}  // namespace

CellMultigrid::CellMultigrid(const CellGeometry& geometry) {
  set_geometry(geometry);
}

void CellMultigrid::set_geometry(const CellGeometry& geometry) {
  if (geometry.dimensions != 2 && geometry.dimensions != 3)
    throw std::invalid_argument("CellMultigrid: dimensions must be 2 or 3");
  if (!(geometry.cell_size > 0)) throw std::invalid_argument("CellMultigrid: the cell size must be positive");
  for (std::size_t a = 0; a < static_cast<std::size_t>(geometry.dimensions); ++a)
    if (!(geometry.upper[a] > geometry.lower[a]))
      throw std::invalid_argument("CellMultigrid: upper must exceed lower on every axis");
  geometry_ = geometry;
}

// The box around the particles of the liquid that are at finite places.
CellMultigrid::Range CellMultigrid::liquid_range(std::span<const double> const (&position)[3],
                                                 std::span<const float> interior) const {
  const auto dimensions = static_cast<std::size_t>(geometry_.dimensions);
  return parallel_reduce(
      particles_, Range{},
      [&](std::size_t first, std::size_t last) {
        Range range{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, false};
        for (std::size_t i = first; i < last; ++i) {
          if (!(interior[i] > 0)) continue;
          bool finite = true;
          for (std::size_t a = 0; a < dimensions; ++a) finite = finite && std::abs(position[a][i]) < HUGE_VAL;
          if (!finite) continue;
          range.any = true;
          for (std::size_t a = 0; a < dimensions; ++a) {
            range.lower[a] = std::min(range.lower[a], position[a][i]);
            range.upper[a] = std::max(range.upper[a], position[a][i]);
          }
        }
        return range;
      },
      [&](Range a, const Range& b) {
        if (!b.any) return a;
        if (!a.any) return b;
        for (std::size_t d = 0; d < dimensions; ++d) {
          a.lower[d] = std::min(a.lower[d], b.lower[d]);
          a.upper[d] = std::max(a.upper[d], b.upper[d]);
        }
        return a;
      });
}

// Cells of about `size` along an axis.
void CellMultigrid::set_axis(std::size_t a, double size) {
  Axis& axis = axis_[a];
  axis.periodic = geometry_.periodic[a];
  axis.lower_wall = !axis.periodic && geometry_.wall[a][0];
  axis.upper_wall = !axis.periodic && geometry_.wall[a][1];
  axis.origin = geometry_.lower[a];
  axis.width = size;
  axis.count = 0;
  if (axis.periodic || (axis.lower_wall && axis.upper_wall)) {
    axis.count = even_count(geometry_.upper[a] - geometry_.lower[a], size);
    axis.width = (geometry_.upper[a] - geometry_.lower[a]) / axis.count;
  } else if (axis.upper_wall) {
    axis.origin = geometry_.upper[a];
  }
}

// First cell of the box along an axis, and how many: one empty cell beyond the liquid, unless there is a wall.
std::array<int, 2> CellMultigrid::box_along(const Axis& axis, double lower, double upper) const {
  if (axis.periodic) return {0, axis.count};
  int first = floor_to(static_cast<int>(std::floor((lower - axis.origin) / axis.width)) - 1, box_alignment);
  int last = -floor_to(-(static_cast<int>(std::floor((upper - axis.origin) / axis.width)) + 2), box_alignment);
  if (axis.lower_wall) first = std::max(first, 0);
  if (axis.upper_wall) last = std::min(last, axis.count);
  if (axis.lower_wall) last = std::max(last, first + 1);
  if (axis.upper_wall) first = std::min(first, last - 1);
  return {first, last - first};
}

void CellMultigrid::choose_box(std::span<const double> const (&position)[3], std::span<const float> interior) {
  const auto dimensions = static_cast<std::size_t>(geometry_.dimensions);
  const Range liquid = liquid_range(position, interior);
  empty_ = !liquid.any;
  std::array<int, 3> cells{1, 1, 1};
  const double most_cells = std::max(fewest_cells, most_cells_per_particle * static_cast<double>(particles_));
  for (double size = geometry_.cell_size; !empty_; size *= 2) {
    double total = 1;
    bool countable = true;
    for (std::size_t a = 0; a < dimensions; ++a) {
      set_axis(a, size);
      const Axis& axis = axis_[a];
      const double lowest = std::floor((liquid.lower[a] - axis.origin) / axis.width);
      const double highest = std::floor((liquid.upper[a] - axis.origin) / axis.width);
      total *= axis.count > 0 && axis.periodic ? axis.count : highest - lowest + 2 + box_alignment;
      countable = countable && std::max(std::abs(lowest), std::abs(highest)) < INT_MAX / 4;
    }
    if (total > most_cells || !countable) continue;
    for (std::size_t a = 0; a < dimensions; ++a) {
      width_[a] = axis_[a].width;
      inverse_width_[a] = 1 / width_[a];
      const auto [first, count] = box_along(axis_[a], liquid.lower[a], liquid.upper[a]);
      first_cell_[a] = first;
      cells[a] = count;
    }
    break;
  }
  hierarchy_.resize(cells, geometry_.periodic);
}

// Particles to cells: what each interpolates between, and the list of particles of every cell.
void CellMultigrid::bin(std::span<const double> const (&position)[3], std::span<const float> interior) {
  clear_cells();
  parallel_blocks(particles_, default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) place(p, position, interior[p]);
    // Apart from the loop above: a locked increment waits for every store before it.
    for (std::size_t p = first; p < last; ++p)
      if (corner_[p] >= 0) start_of(p).fetch_add(1, std::memory_order_relaxed);
  });
  counts_to_ends();
  // Each particle takes the last free place of its cell: where all have theirs, the ends have become starts.
  parallel_blocks(particles_, default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p)
      if (corner_[p] >= 0)
        order_[static_cast<std::size_t>(start_of(p).fetch_sub(1, std::memory_order_relaxed) - 1)] =
            static_cast<std::int32_t>(p);
  });
  sort_cells();
}

void CellMultigrid::clear_cells() {
  const CellLevel& level = hierarchy_.finest();
  const std::size_t cells = level.rows() * static_cast<std::size_t>(level.cells[0]);
  const std::size_t corners = level.corner_rows() * level.corner_columns();
  stencil_.resize(particles_);
  corner_.resize(particles_);
  order_.resize(particles_);
  start_.resize(corners + 1);
  status_.resize(cells);
  row_total_.resize(level.corner_rows());
  parallel_blocks(corners, 16 * default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    std::fill(start_.data() + first, start_.data() + last, 0);
  });
  parallel_blocks(cells, 16 * default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    std::fill(status_.data() + first, status_.data() + last, std::uint8_t{no_liquid});
  });
}

// Linear between cell centres; constant beyond the last centre before a wall.
bool CellMultigrid::place_along(std::size_t axis, double position, CellPlace& place) const {
  const double s = (position - axis_[axis].origin) * inverse_width_[axis] - 0.5 - first_cell_[axis];
  if (!(std::abs(s) < INT_MAX / 2)) return false;
  const int count = hierarchy_.finest().cells[axis];
  int base = static_cast<int>(s) - (s < 0 ? 1 : 0);
  double f = s - base;
  if (base < 0 || base >= count - 1) {
    if (axis_[axis].periodic) {
      base = ((base % count) + count) % count;
    } else {
      base = base < 0 ? 0 : count - 1;
      f = 0;
    }
  }
  place.lowest[axis] = base;
  place.fraction[axis] = static_cast<float>(f);
  // The nearer of two centres, without a branch that is a coin toss.
  const int own = base + static_cast<int>(f + f);
  place.own[axis] = own == count ? 0 : own;
  return true;
}

void CellMultigrid::place(std::size_t p, std::span<const double> const (&position)[3], float interior) {
  corner_[p] = -1;
  stencil_[p] = {0, 0, 0, 0};
  if (!(interior > 0)) return;
  CellPlace at;
  for (std::size_t a = 0; a < static_cast<std::size_t>(geometry_.dimensions); ++a)
    if (!place_along(a, position[a][p], at)) return;
  stencil_[p] = {at.fraction[0], at.fraction[1], at.fraction[2], interior};
  const auto& n = hierarchy_.finest().cells;
  const auto index = [](const int(&cell)[3], int columns, int rows) {
    return (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(cell[1])) *
               static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(cell[0]);
  };
  corner_[p] = static_cast<std::int32_t>(index(at.lowest, n[0] + 1, n[1] + 1));
  const std::atomic_ref<std::uint8_t> status(status_[index(at.own, n[0], n[1])]);
  if (status.load(std::memory_order_relaxed) != interior_cell) status.store(interior_cell, std::memory_order_relaxed);
}

std::atomic_ref<std::int32_t> CellMultigrid::start_of(std::size_t particle) {
  return std::atomic_ref<std::int32_t>(start_[static_cast<std::size_t>(corner_[particle])]);
}

// From how many particles a cell holds to where its list ends.
void CellMultigrid::counts_to_ends() {
  const CellLevel& level = hierarchy_.finest();
  const std::size_t columns = level.corner_columns(), rows = level.corner_rows();
  const auto row_cells = [&](std::size_t row) { return start_.data() + row * columns; };
  parallel_blocks(rows, level.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row)
      row_total_[row] = std::accumulate(row_cells(row), row_cells(row) + columns, std::int32_t{0});
  });
  std::int32_t running = 0;
  for (std::size_t row = 0; row < rows; ++row) running += std::exchange(row_total_[row], running);
  start_[rows * columns] = running;
  parallel_blocks(rows, level.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row)
      std::inclusive_scan(row_cells(row), row_cells(row) + columns, row_cells(row), std::plus<>(), row_total_[row]);
  });
}

// Arrival order depends on the threads; index order does not.
void CellMultigrid::sort_cells() {
  parallel_blocks(start_.size() - 1, 4 * default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c) {
      std::int32_t* here = order_.data() + start_[c];
      const std::int32_t count = start_[c + 1] - start_[c];
      if (count > sorted_by_insertion) {
        std::sort(here, here + count);
        continue;
      }
      for (std::int32_t i = 1; i < count; ++i) {
        const std::int32_t p = here[i];
        std::int32_t at = i;
        for (; at > 0 && here[at - 1] > p; --at) here[at] = here[at - 1];
        here[at] = p;
      }
    }
  });
}

// A cell inside the liquid may by chance hold no particle; taken for air it would pin the pressure to zero there.
void CellMultigrid::fill_holes() {
  const CellLevel& level = hierarchy_.finest();
  const auto& n = level.cells;
  const auto status = [&](std::size_t c) { return std::atomic_ref<std::uint8_t>(status_[c]); };
  const std::size_t row_cells = static_cast<std::size_t>(n[0]);
  parallel_blocks(level.rows(), level.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      for (int i = 0; i < n[0]; ++i) {
        const std::size_t c = row * row_cells + static_cast<std::size_t>(i);
        if (status(c).load(std::memory_order_relaxed) != no_liquid) continue;
        const int here[3] = {i, static_cast<int>(row) % n[1], static_cast<int>(row) / n[1]};
        bool enclosed = true, liquid = false;
        for (std::size_t a = 0; a < 3 && enclosed; ++a) {
          if (n[a] == 1) continue;
          for (const int step : {-1, 1}) {
            int there[3] = {here[0], here[1], here[2]};
            there[a] += step;
            if ((there[a] < 0 || there[a] >= n[a]) && !axis_[a].periodic) continue;
            there[a] = (there[a] + n[a]) % n[a];
            const std::uint8_t next = status(static_cast<std::size_t>(there[2] * n[1] + there[1]) * row_cells +
                                             static_cast<std::size_t>(there[0]))
                                          .load(std::memory_order_relaxed);
            liquid = liquid || next == interior_cell;
            enclosed = enclosed && (next == interior_cell || next == solid_cell);
          }
        }
        if (enclosed && liquid) status(c).store(hole, std::memory_order_relaxed);
      }
    }
  });
}

void CellMultigrid::set_coefficients(double helmholtz) {
  CellLevel& level = hierarchy_.finest();
  const auto& n = level.cells;
  const int dimensions = geometry_.dimensions;
  const double volume = width_[0] * width_[1] * (dimensions == 3 ? width_[2] : 1.0);
  float face[3] = {0, 0, 0};
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a)
    face[a] = static_cast<float>(volume / (width_[a] * width_[a]));
  const float mass = static_cast<float>(helmholtz * volume);
  const bool solids = !geometry_.solids.empty() || geometry_.distance;
  const auto index = [&](int i, int j, int k) {
    return static_cast<std::size_t>(k * n[1] + j) * static_cast<std::size_t>(n[0]) + static_cast<std::size_t>(i);
  };
  parallel_blocks(level.rows(), level.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      const int j = static_cast<int>(row) % n[1], k = static_cast<int>(row) / n[1];
      const std::size_t at = level.row_start(row);
      for (int i = 0; i < n[0]; ++i) {
        const auto o = at + static_cast<std::size_t>(i);
        const std::size_t c = index(i, j, k);
        const bool inside = holds_liquid(status_[c]);
        float dirichlet = 0;
        for (int a = 0; a < dimensions; ++a) {
          const auto axis = static_cast<std::size_t>(a);
          float lower_face = 0;
          if (n[axis] > 1) {
            for (const int side : {0, 1}) {
              int there[3] = {i, j, k};
              there[a] += side == 0 ? -1 : 1;
              const bool outside = there[a] < 0 || there[a] >= n[axis];
              if (outside && !axis_[axis].periodic) continue;
              there[a] = (there[a] + n[axis]) % n[axis];
              const std::size_t t = index(there[0], there[1], there[2]);
              const float open = face[a] * (solids ? open_face_[a][side == 0 ? c : t] : 1.0F);
              if (!inside) continue;
              if (status_[t] == no_liquid) dirichlet += open;
              if (side == 0 && holds_liquid(status_[t])) lower_face = open;
            }
          }
          level.face[a][o] = lower_face;
        }
        level.dirichlet[o] = dirichlet;
        level.mass[o] = inside ? mass * (solids ? std::max(open_volume_[c], least_mass) : 1.0F) : 0.0F;
      }
      level.face[0][at + static_cast<std::size_t>(n[0])] = level.face[0][at];
    }
  });
  if (n[1] == 1) level.face[1].fill(0.0F);
}

// Means over the particles by the weights that residuals are spread with; cells without particles have 1. The rows of
// active cells must be known.
void CellMultigrid::find_cell_coefficients(std::span<const float> coefficient) {
  CellLevel& level = hierarchy_.finest();
  const std::size_t total = level.rows() * level.pitch();
  cell_coefficient_.resize(total);
  spread(coefficient.data());
  collect();
  std::copy_n(level.right_hand_side.data(), total, cell_coefficient_.data());
  residual_.resize(particles_);
  residual_.fill(1.0F);
  spread(residual_.data());
  collect();
  const float* weight = level.right_hand_side.data();
  parallel_blocks(level.rows(), level.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row)
      for (std::size_t o = level.row_start(row); o < level.row_start(row) + static_cast<std::size_t>(level.cells[0]);
           ++o)
        cell_coefficient_[o] = weight[o] > 0 && cell_coefficient_[o] > 0 ? cell_coefficient_[o] / weight[o] : 1.0F;
  });
}

void CellMultigrid::multiply_faces() {
  CellLevel& level = hierarchy_.finest();
  const auto& n = level.cells;
  const auto cell = [&](int i, int j, int k) {
    return cell_coefficient_[level.row_start(static_cast<std::size_t>(k * n[1] + j)) + static_cast<std::size_t>(i)];
  };
  parallel_blocks(level.rows(), level.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      const int j = static_cast<int>(row) % n[1], k = static_cast<int>(row) / n[1];
      const std::size_t at = level.row_start(row);
      for (int i = 0; i < n[0]; ++i) {
        const auto o = at + static_cast<std::size_t>(i);
        const float own = cell(i, j, k);
        const int below[3] = {(i + n[0] - 1) % n[0], (j + n[1] - 1) % n[1], (k + n[2] - 1) % n[2]};
        for (int a = 0; a < geometry_.dimensions; ++a) {
          const float other = a == 0 ? cell(below[0], j, k) : a == 1 ? cell(i, below[1], k) : cell(i, j, below[2]);
          level.face[a][o] *= 2 * own * other / (own + other);
        }
        level.dirichlet[o] *= own;
      }
      level.face[0][at + static_cast<std::size_t>(n[0])] = level.face[0][at];
    }
  });
}

void CellMultigrid::setup(std::span<const double> x, std::span<const double> y, std::span<const double> z,
                          std::span<const float> interior, double helmholtz, std::span<const float> diagonal,
                          std::span<const float> coefficient) {
  particles_ = x.size();
  if (y.size() != particles_ || interior.size() != particles_ || diagonal.size() != particles_ ||
      (geometry_.dimensions == 3 && z.size() != particles_) ||
      (!coefficient.empty() && coefficient.size() != particles_))
    throw std::invalid_argument("CellMultigrid::setup: all spans must have one entry per particle");
  if (!(helmholtz >= 0))
    throw std::invalid_argument("CellMultigrid::setup: the Helmholtz coefficient must not be negative");
  diagonal_ = diagonal;
  const std::span<const double> position[3] = {x, y, z};
  choose_box(position, interior);
  if (empty_) return;
  bin(position, interior);
  if (!geometry_.solids.empty() || geometry_.distance) mark_solids();
  fill_holes();
  find_shore();
  set_coefficients(helmholtz);
  const auto& n = hierarchy_.finest().cells;
  partial_.resize(4 * hierarchy_.finest().rows() * hierarchy_.finest().pitch());
  corner_value_.resize((static_cast<std::size_t>(n[0]) + 1) * (static_cast<std::size_t>(n[1]) + 1) *
                       (static_cast<std::size_t>(n[2]) + 1));
  hierarchy_.build();
  if (coefficient.empty()) return;
  find_cell_coefficients(coefficient);
  multiply_faces();
  hierarchy_.build();
}

}  // namespace spume
