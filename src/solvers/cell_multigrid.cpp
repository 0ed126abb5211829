// SPDX-License-Identifier: MIT
// Application of the preconditioner: from the particles to the cells, a V-cycle, and back.
#include "spume/solvers/cell_multigrid.hpp"

#include <algorithm>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "spume/core/parallel.hpp"
#include "spume/core/simd.hpp"

namespace spume {

// Sums r over the particles of every row of stencil cells into the four rows of cell centres that it touches. The eight
// corners are lanes, with y, z, x as their bits; along each axis a share of 1 - f or f.
void CellMultigrid::spread(const float* r) {
  using simd::f32x8;
  constexpr f32x8 x_low = {1, 1, 1, 1, 0, 0, 0, 0}, x_up = {-1, -1, -1, -1, 1, 1, 1, 1};
  constexpr f32x8 y_low = {1, 0, 1, 0, 1, 0, 1, 0}, y_up = {-1, 1, -1, 1, -1, 1, -1, 1};
  constexpr f32x8 z_low = {1, 1, 0, 0, 1, 1, 0, 0}, z_up = {-1, -1, 1, 1, -1, -1, 1, 1};
  const CellLevel& level = hierarchy_.finest();
  const auto& n = level.cells;
  const std::size_t pitch = level.pitch();
  const int sides = geometry_.dimensions == 3 ? 4 : 2;
  parallel_blocks(level.rows(), std::max<std::size_t>(1, level.rows_per_block() / 4),
                  [&](std::size_t, std::size_t first, std::size_t last) {
                    for (std::size_t row = first; row < last; ++row) {
                      float* to[4];
                      for (int s = 0; s < sides; ++s) {
                        to[s] = partial_.data() + (static_cast<std::size_t>(s) * level.rows() + row) * pitch;
                        std::fill_n(to[s], pitch, 0.0F);
                      }
                      const std::int32_t* start = start_.data() + level.corner_row(row) * level.corner_columns();
                      if (start[0] == start[n[0]]) continue;
                      for (int i = 0; i < n[0]; ++i) {
                        if (start[i] == start[i + 1]) continue;
                        f32x8 sum{};
                        for (std::int32_t o = start[i]; o < start[i + 1]; ++o) {
                          const auto p = static_cast<std::size_t>(order_[static_cast<std::size_t>(o)]);
                          const Stencil& s = stencil_[p];
                          const f32x8 share = (x_low + s.fx * x_up) * (y_low + s.fy * y_up) * (z_low + s.fz * z_up);
                          sum = sum + (s.weight * r[p]) * share;
                        }
                        for (int c = 0; c < sides; ++c) {
                          to[c][i] += sum[c];
                          to[c][i + 1] += sum[4 + c];
                        }
                      }
                      if (axis_[0].periodic)
                        for (int c = 0; c < sides; ++c) to[c][0] += to[c][n[0]];
                    }
                  });
}

// Adds the rows of partial sums up to the right-hand side of the cells.
void CellMultigrid::collect() {
  CellLevel& level = hierarchy_.finest();
  const auto& n = level.cells;
  const std::size_t pitch = level.pitch();
  const bool three_dimensional = geometry_.dimensions == 3;
  parallel_blocks(level.rows(), level.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      if (level.range[row][0] >= level.range[row][1] && shore_.empty()) continue;
      const int j = static_cast<int>(row) % n[1], k = static_cast<int>(row) / n[1];
      const int below = j > 0 ? j - 1 : n[1] - 1, behind = k > 0 ? k - 1 : n[2] - 1;
      const auto part = [&](int side, int jj, int kk) {
        return partial_.data() +
               (static_cast<std::size_t>(side) * level.rows() + static_cast<std::size_t>(kk * n[1] + jj)) * pitch;
      };
      const float* p0 = part(0, j, k);
      const float* p1 = part(1, below, k);
      const float* p2 = three_dimensional ? part(2, j, behind) : nullptr;
      const float* p3 = three_dimensional ? part(3, below, behind) : nullptr;
      float* f = level.right_hand_side.data() + level.row_start(row);
      if (three_dimensional)
        for (int i = 0; i < n[0]; ++i) f[i] = (p0[i] + p1[i]) + (p2[i] + p3[i]);
      else
        for (int i = 0; i < n[0]; ++i) f[i] = p0[i] + p1[i];
    }
  });
}

// What particles give to solid cells goes to the liquid around these: the transpose of extend_to_shore().
void CellMultigrid::spread_from_shore() {
  float* f = hierarchy_.finest().right_hand_side.data();
  for (std::size_t s = 0; s < shore_.size(); ++s) {
    const float share = std::exchange(f[shore_[s]], 0.0F) / static_cast<float>(shore_first_[s + 1] - shore_first_[s]);
    for (std::size_t k = shore_first_[s]; k < shore_first_[s + 1]; ++k) f[shore_next_[k]] += share;
  }
}

void CellMultigrid::extend_to_shore() {
  float* u = hierarchy_.finest().solution.data();
  for (std::size_t s = 0; s < shore_.size(); ++s) {
    float sum = 0;
    for (std::size_t k = shore_first_[s]; k < shore_first_[s + 1]; ++k) sum += u[shore_next_[k]];
    u[shore_[s]] = sum / static_cast<float>(shore_first_[s + 1] - shore_first_[s]);
  }
}

template <class Real>
void CellMultigrid::apply_any(std::span<const Real> r, std::span<Real> z) {
  if (r.size() != particles_ || z.size() != particles_)
    throw std::invalid_argument("CellMultigrid::apply: the vectors differ in length from the last setup");
  const auto by_diagonal = [&](std::size_t i, Real value) {
    return diagonal_[i] > 0 ? value / static_cast<Real>(diagonal_[i]) : Real{0};
  };
  if (empty_) {
    parallel_for(particles_, [&](std::size_t i) { z[i] = by_diagonal(i, r[i]); });
    return;
  }
  if constexpr (std::is_same_v<Real, double>) {
    residual_.resize(particles_);
    parallel_for(particles_, [&](std::size_t i) { residual_[i] = static_cast<float>(r[i]); });
    spread(residual_.data());
  } else {
    spread(r.data());
  }
  collect();
  spread_from_shore();
  hierarchy_.v_cycle();
  extend_to_shore();
  const CellLevel& level = hierarchy_.finest();
  const auto& n = level.cells;
  const std::size_t row_pitch = static_cast<std::size_t>(n[0]) + 1;
  const std::size_t rows_per_plane = static_cast<std::size_t>(n[1]) + 1;
  parallel_blocks(rows_per_plane * (static_cast<std::size_t>(n[2]) + 1), level.rows_per_block(),
                  [&](std::size_t, std::size_t first, std::size_t last) {
                    for (std::size_t row = first; row < last; ++row) {
                      const std::size_t j = row % rows_per_plane % static_cast<std::size_t>(n[1]);
                      const std::size_t k = row / rows_per_plane % static_cast<std::size_t>(n[2]);
                      const float* from =
                          level.solution.data() + level.row_start(k * static_cast<std::size_t>(n[1]) + j);
                      std::copy_n(from, row_pitch, corner_value_.data() + row * row_pitch);
                    }
                  });
  const std::size_t up_y = row_pitch, up_z = row_pitch * rows_per_plane;
  const bool three_dimensional = geometry_.dimensions == 3;
  const float* value = corner_value_.data();
  parallel_blocks(particles_, 4 * default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      const Stencil s = stencil_[p];
      const float* c = value + std::max(corner_[p], 0);
      const auto line = [&](const float* v) { return v[0] + s.fx * (v[1] - v[0]); };
      const float y0 = line(c), y1 = line(c + up_y);
      float cell = y0 + s.fy * (y1 - y0);
      if (three_dimensional) {
        const float y2 = line(c + up_z), y3 = line(c + up_z + up_y);
        const float upper = y2 + s.fy * (y3 - y2);
        cell += s.fz * (upper - cell);
      }
      z[p] = by_diagonal(p, r[p]) + static_cast<Real>(s.weight * cell);
    }
  });
}

double CellMultigrid::bytes() const {
  double total = stencil_.bytes() + status_.bytes() + hierarchy_.bytes();
  for (const auto* array : {&corner_, &start_, &order_, &row_total_}) total += array->bytes();
  for (const auto* array : {&open_volume_, &open_face_[0], &open_face_[1], &open_face_[2], &cell_coefficient_,
                            &partial_, &corner_value_, &residual_, &correction_})
    total += array->bytes();
  return total;
}

void CellMultigrid::apply(std::span<const float> r, std::span<float> z) {
  apply_any(r, z);
}
void CellMultigrid::apply(std::span<const double> r, std::span<double> z) {
  apply_any(r, z);
}

}  // namespace spume
