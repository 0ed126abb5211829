// SPDX-License-Identifier: MIT
#include "spume/solvers/cell_hierarchy.hpp"

#include <algorithm>

#include "spume/core/parallel.hpp"

namespace spume {

namespace {

// A row operation costs about a nanosecond per cell; a parallel dispatch with passive waiting about 10 us.
constexpr std::size_t cells_per_block = 4096;
// Adding up the fine faces between two coarse cells gives twice the stiffness of cells of double width.
constexpr float face_coarsening = 0.5F;
// The distance to a zero-valued surface grows less than the cells do: 9 or 10 iterations on a cell problem with a wavy
// surface instead of 11 to 15 with one half.
constexpr float dirichlet_coarsening = 0.75F;
// Of the coarsest level, which sweeps alone solve. From 1 to 8 cells and from 1 to 16 sweeps a collapsing column at
// 1/200 and a cavity at 1/100 take the same number of iterations; with 64 cells the cavity takes 7 % more.
constexpr int coarsest_cells = 8;
constexpr int coarsest_sweeps = 4;

int wrapped(int i, int n) {
  return i < 0 ? i + n : (i >= n ? i - n : i);
}
int halved(int n) {
  return (n + 1) / 2;
}

// The four rows next to row (j, k), wrapped.
struct RowNeighbours {
  std::size_t row, below, above, behind, before;
};
RowNeighbours neighbours_of(const CellLevel& level, std::size_t row) {
  const int ny = level.cells[1], nz = level.cells[2];
  const int j = static_cast<int>(row) % ny, k = static_cast<int>(row) / ny;
  const auto at = [&](int jj, int kk) {
    return level.row_start(static_cast<std::size_t>(wrapped(kk, nz)) * static_cast<std::size_t>(ny) +
                           static_cast<std::size_t>(wrapped(jj, ny)));
  };
  return {level.row_start(row), at(j - 1, k), at(j + 1, k), at(j, k - 1), at(j, k + 1)};
}

// Calls body(row) for every row that holds active cells.
template <class Body>
void for_rows(const CellLevel& level, Body&& body) {
  parallel_blocks(level.rows(), level.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row)
      if (level.range[row][0] < level.range[row][1]) body(row);
  });
}

void wrap_row(float* row, int n) {
  row[-1] = row[n - 1];
  row[n] = row[0];
}

// sum over faces of c_f u_n for the cells of one row: body(i, sum).
template <bool three_dimensional, class Body>
void neighbour_sums(const CellLevel& level, const float* u, std::size_t row, Body&& body) {
  const RowNeighbours at = neighbours_of(level, row);
  const float* cx = level.face[0].data() + at.row;
  const float* cy0 = level.face[1].data() + at.row;
  const float* cy1 = level.face[1].data() + at.above;
  const float* cz0 = three_dimensional ? level.face[2].data() + at.row : nullptr;
  const float* cz1 = three_dimensional ? level.face[2].data() + at.before : nullptr;
  const float* u0 = u + at.row;
  const float* uy0 = u + at.below;
  const float* uy1 = u + at.above;
  const float* uz0 = u + at.behind;
  const float* uz1 = u + at.before;
  const int first = level.range[row][0], last = level.range[row][1];
#pragma omp simd
  for (int i = first; i < last; ++i) {
    float sum = cx[i] * u0[i - 1] + cx[i + 1] * u0[i + 1] + cy0[i] * uy0[i] + cy1[i] * uy1[i];
    if constexpr (three_dimensional) sum += cz0[i] * uz0[i] + cz1[i] * uz1[i];
    body(i, sum);
  }
}

// One axis of the cell-centred linear interpolation: fine cell i lies in coarse cell i / 2 (weight 3/4) beside
// another (1/4); at a side that does not wrap both are the same cell.
int other_coarse(int i, int coarse_count, bool periodic) {
  const int other = i / 2 + (i % 2 == 0 ? -1 : 1);
  if (other >= 0 && other < coarse_count) return other;
  return periodic ? wrapped(other, coarse_count) : i / 2;
}

// Fine cells that hand a share to coarse cell c along one axis, with weights: the transpose of other_coarse.
struct Share {
  int fine[6];
  float weight[6];
  int count = 0;
};
Share shares_of(int coarse, int fine_count, int coarse_count, bool periodic) {
  Share share;
  if (fine_count == coarse_count) {
    share.fine[0] = coarse;
    share.weight[0] = 1;
    share.count = 1;
    return share;
  }
  int candidates[6];
  int candidate_count = 0;
  for (int i = 2 * coarse - 2; i <= 2 * coarse + 3; ++i) {
    int fine = i;
    if (fine < 0 || fine >= fine_count) {
      if (!periodic) continue;
      fine = ((fine % fine_count) + fine_count) % fine_count;
    }
    bool seen = false;
    for (int c = 0; c < candidate_count; ++c) seen = seen || candidates[c] == fine;
    if (!seen) candidates[candidate_count++] = fine;
  }
  for (int c = 0; c < candidate_count; ++c) {
    const int fine = candidates[c];
    float weight = 0;
    if (fine / 2 == coarse) weight += 0.75F;
    if (other_coarse(fine, coarse_count, periodic) == coarse) weight += 0.25F;
    if (weight > 0) {
      share.fine[share.count] = fine;
      share.weight[share.count++] = weight;
    }
  }
  return share;
}

}  // namespace

std::size_t CellLevel::rows_per_block() const {
  return std::max<std::size_t>(1, cells_per_block / pitch());
}

void CellLevel::resize(const std::array<int, 3>& size, int axes_of_faces) {
  cells = size;
  const std::size_t total = rows() * pitch();
  for (int a = 0; a < axes_of_faces; ++a) face[a].resize(total);
  for (Array<float>* field :
       {&dirichlet, &mass, &inverse_diagonal, &right_hand_side, &solution, &other, &residual, &scratch})
    field->resize(total);
  range.resize(rows());
}

void CellHierarchy::resize(const std::array<int, 3>& cells, const std::array<bool, 3>& periodic) {
  periodic_ = periodic;
  std::array<int, 3> size = cells;
  used_ = 0;
  const int axes = cells[2] > 1 ? 3 : 2;
  while (true) {
    if (levels_.size() <= static_cast<std::size_t>(used_)) levels_.emplace_back();
    levels_[static_cast<std::size_t>(used_++)].resize(size, axes);
    const std::array<int, 3> next{halved(size[0]), halved(size[1]), halved(size[2])};
    if (size[0] * size[1] * size[2] <= coarsest_cells || next == size) break;
    size = next;
  }
}

void CellHierarchy::build() {
  finish(levels_[0]);
  for (int depth = 1; depth < used_; ++depth) {
    coarsen(levels_[static_cast<std::size_t>(depth - 1)], levels_[static_cast<std::size_t>(depth)]);
    finish(levels_[static_cast<std::size_t>(depth)]);
  }
}

void CellHierarchy::coarsen(const CellLevel& fine, CellLevel& coarse) {
  const bool three_dimensional = fine.cells[2] > 1;
  const auto& n = fine.cells;
  float factor[3];
  int step[3];
  for (int a = 0; a < 3; ++a) {
    step[a] = n[static_cast<std::size_t>(a)] > 1 ? 2 : 1;
    factor[a] = step[a] == 2 ? face_coarsening : 1.0F;
  }
  parallel_blocks(coarse.rows(), coarse.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      const int J = static_cast<int>(row) % coarse.cells[1], K = static_cast<int>(row) / coarse.cells[1];
      const std::size_t to = coarse.row_start(row);
      for (Array<float>* field : {&coarse.face[0], &coarse.face[1], &coarse.dirichlet, &coarse.mass})
        std::fill_n(field->data() + to - 1, coarse.pitch(), 0.0F);
      if (three_dimensional) std::fill_n(coarse.face[2].data() + to - 1, coarse.pitch(), 0.0F);
      for (int k = K * step[2]; k < std::min((K + 1) * step[2], n[2]); ++k) {
        for (int j = J * step[1]; j < std::min((J + 1) * step[1], n[1]); ++j) {
          const std::size_t fine_row =
              static_cast<std::size_t>(k) * static_cast<std::size_t>(n[1]) + static_cast<std::size_t>(j);
          if (fine.range[fine_row][0] >= fine.range[fine_row][1]) continue;
          const std::size_t from = fine.row_start(fine_row);
          const bool lowest_y = j == J * step[1], lowest_z = k == K * step[2];
          for (int i = 0; i < n[0]; ++i) {
            const auto f = from + static_cast<std::size_t>(i);
            const auto c = to + static_cast<std::size_t>(i / step[0]);
            if (i % step[0] == 0) coarse.face[0][c] += factor[0] * fine.face[0][f];
            if (lowest_y) coarse.face[1][c] += factor[1] * fine.face[1][f];
            if (three_dimensional && lowest_z) coarse.face[2][c] += factor[2] * fine.face[2][f];
            coarse.dirichlet[c] += dirichlet_coarsening * fine.dirichlet[f];
            coarse.mass[c] += fine.mass[f];
          }
        }
      }
      // A single cell along an axis has no neighbour but itself.
      if (coarse.cells[0] == 1) coarse.face[0][to] = 0;
      if (coarse.cells[1] == 1) coarse.face[1][to] = 0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(coarse.cells[0]); ++i) {
        if (coarse.cells[1] == 1) coarse.face[1][to + i] = 0;
        if (three_dimensional && coarse.cells[2] == 1) coarse.face[2][to + i] = 0;
      }
      coarse.face[0][to + static_cast<std::size_t>(coarse.cells[0])] = coarse.face[0][to];
    }
  });
}

void CellHierarchy::finish(CellLevel& level) {
  const bool three_dimensional = level.cells[2] > 1;
  parallel_blocks(level.rows(), level.rows_per_block(), [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      const RowNeighbours at = neighbours_of(level, row);
      for (Array<float>* field :
           {&level.right_hand_side, &level.solution, &level.other, &level.residual, &level.inverse_diagonal})
        std::fill_n(field->data() + at.row - 1, level.pitch(), 0.0F);
      int begin = level.cells[0], end = 0;
      for (int i = 0; i < level.cells[0]; ++i) {
        const auto o = static_cast<std::size_t>(i);
        float diagonal = level.dirichlet[at.row + o] + level.mass[at.row + o] + level.face[0][at.row + o] +
                         level.face[0][at.row + o + 1] + level.face[1][at.row + o] + level.face[1][at.above + o];
        if (three_dimensional) diagonal += level.face[2][at.row + o] + level.face[2][at.before + o];
        if (!(diagonal > 0)) continue;
        level.inverse_diagonal[at.row + o] = 1.0F / diagonal;
        begin = std::min(begin, i);
        end = i + 1;
      }
      level.range[row] = {begin, end};
    }
  });
}

// The first red half-sweep from a zero guess.
void CellHierarchy::start(CellLevel& level) {
  for_rows(level, [&](std::size_t row) {
    const std::size_t at = level.row_start(row);
    const int parity = static_cast<int>(row % static_cast<std::size_t>(level.cells[1]) +
                                        row / static_cast<std::size_t>(level.cells[1])) &
                       1;
    const float* f = level.right_hand_side.data() + at;
    const float* inverse = level.inverse_diagonal.data() + at;
    float* u = level.solution.data() + at;
#pragma omp simd
    for (int i = level.range[row][0]; i < level.range[row][1]; ++i)
      u[i] = ((i + parity) & 1) == 0 ? inverse[i] * f[i] : 0.0F;
    wrap_row(u, level.cells[0]);
  });
}

// Solves the cells of one colour exactly. Written from one array into the other, so that rows may run in any order
// and an odd periodic count, where equal colours meet, is a Jacobi update there.
void CellHierarchy::sweep(CellLevel& level, int colour) {
  const auto run = [&]<bool three_dimensional>() {
    for_rows(level, [&](std::size_t row) {
      const std::size_t at = level.row_start(row);
      const int parity = static_cast<int>(row % static_cast<std::size_t>(level.cells[1]) +
                                          row / static_cast<std::size_t>(level.cells[1])) &
                         1;
      const float* f = level.right_hand_side.data() + at;
      const float* inverse = level.inverse_diagonal.data() + at;
      const float* u = level.solution.data() + at;
      float* out = level.other.data() + at;
      const int shift = parity + colour;
      neighbour_sums<three_dimensional>(level, level.solution.data(), row, [=](int i, float sum) {
        const float solved = inverse[i] * (f[i] + sum);
        out[i] = ((i + shift) & 1) == 0 ? solved : u[i];
      });
      wrap_row(out, level.cells[0]);
    });
  };
  if (level.cells[2] > 1)
    run.template operator()<true>();
  else
    run.template operator()<false>();
  level.solution.swap(level.other);
}

void CellHierarchy::compute_residual(CellLevel& level) {
  const auto run = [&]<bool three_dimensional>() {
    for_rows(level, [&](std::size_t row) {
      const std::size_t at = level.row_start(row);
      const float* f = level.right_hand_side.data() + at;
      const float* inverse = level.inverse_diagonal.data() + at;
      const float* u = level.solution.data() + at;
      float* out = level.residual.data() + at;
      neighbour_sums<three_dimensional>(level, level.solution.data(), row, [=](int i, float sum) {
        out[i] = inverse[i] > 0 ? f[i] + sum - u[i] / inverse[i] : 0.0F;
      });
    });
  };
  if (level.cells[2] > 1)
    run.template operator()<true>();
  else
    run.template operator()<false>();
}

void CellHierarchy::restrict_residual(CellLevel& fine, CellLevel& coarse) {
  const int nx = fine.cells[0], NX = coarse.cells[0];
  for_rows(coarse, [&](std::size_t row) {
    const int J = static_cast<int>(row) % coarse.cells[1], K = static_cast<int>(row) / coarse.cells[1];
    const Share sy = shares_of(J, fine.cells[1], coarse.cells[1], periodic_[1]);
    const Share sz = shares_of(K, fine.cells[2], coarse.cells[2], periodic_[2]);
    // Rows of the coarse level are at most half of the fine ones, so each finds its own scratch row there.
    float* sum = fine.scratch.data() + fine.row_start(row);
    std::fill_n(sum, nx, 0.0F);
    for (int a = 0; a < sz.count; ++a) {
      for (int b = 0; b < sy.count; ++b) {
        const std::size_t fine_row = static_cast<std::size_t>(sz.fine[a]) * static_cast<std::size_t>(fine.cells[1]) +
                                     static_cast<std::size_t>(sy.fine[b]);
        const float weight = sz.weight[a] * sy.weight[b];
        const float* r = fine.residual.data() + fine.row_start(fine_row);
        const int begin = fine.range[fine_row][0], end = fine.range[fine_row][1];
#pragma omp simd
        for (int i = begin; i < end; ++i) sum[i] += weight * r[i];
      }
    }
    float* f = coarse.right_hand_side.data() + coarse.row_start(row);
    if (NX == nx) {
      std::copy_n(sum, nx, f);
      return;
    }
    for (int I = 1; I < NX - 1 && 2 * I + 2 < nx; ++I)
      f[I] = 0.75F * (sum[2 * I] + sum[2 * I + 1]) + 0.25F * (sum[2 * I - 1] + sum[2 * I + 2]);
    const auto edge = [&](int I) {
      const Share sx = shares_of(I, nx, NX, periodic_[0]);
      f[I] = 0;
      for (int a = 0; a < sx.count; ++a) f[I] += sx.weight[a] * sum[sx.fine[a]];
    };
    edge(0);
    for (int I = std::max(1, std::min(NX - 1, (nx - 2) / 2)); I < NX; ++I) edge(I);
  });
}

void CellHierarchy::prolong(const CellLevel& coarse, CellLevel& fine) {
  const int nx = fine.cells[0], NX = coarse.cells[0];
  for_rows(fine, [&](std::size_t row) {
    const int j = static_cast<int>(row) % fine.cells[1], k = static_cast<int>(row) / fine.cells[1];
    const bool halve_y = fine.cells[1] != coarse.cells[1], halve_z = fine.cells[2] != coarse.cells[2];
    const int J[2] = {halve_y ? j / 2 : j, halve_y ? other_coarse(j, coarse.cells[1], periodic_[1]) : j};
    const int K[2] = {halve_z ? k / 2 : k, halve_z ? other_coarse(k, coarse.cells[2], periodic_[2]) : k};
    const auto coarse_row = [&](int a, int b) {
      return coarse.solution.data() +
             coarse.row_start(static_cast<std::size_t>(K[a]) * static_cast<std::size_t>(coarse.cells[1]) +
                              static_cast<std::size_t>(J[b]));
    };
    const float *c00 = coarse_row(0, 0), *c01 = coarse_row(0, 1), *c10 = coarse_row(1, 0), *c11 = coarse_row(1, 1);
    float* mixed = fine.scratch.data() + fine.row_start(row);
#pragma omp simd
    for (int I = 0; I < NX; ++I) mixed[I] = 0.5625F * c00[I] + 0.1875F * (c01[I] + c10[I]) + 0.0625F * c11[I];
    float* u = fine.solution.data() + fine.row_start(row);
    const float* inverse = fine.inverse_diagonal.data() + fine.row_start(row);
    if (NX == nx) {
      for (int i = 0; i < nx; ++i) u[i] += inverse[i] > 0 ? mixed[i] : 0.0F;
    } else {
      const auto add = [&](int i, int other) {
        u[i] += inverse[i] > 0 ? 0.75F * mixed[i / 2] + 0.25F * mixed[other] : 0.0F;
      };
      add(0, other_coarse(0, NX, periodic_[0]));
      for (int I = 0; I + 1 < NX; ++I) {
        add(2 * I + 1, I + 1);
        add(2 * I + 2, I);
      }
      if (nx == 2 * NX) add(nx - 1, other_coarse(nx - 1, NX, periodic_[0]));
    }
    wrap_row(u, nx);
  });
}

void CellHierarchy::cycle(int depth) {
  CellLevel& level = levels_[static_cast<std::size_t>(depth)];
  start(level);
  sweep(level, 1);
  if (depth + 1 == used_) {
    // Red, black, ..., black, red: the same read from either end, which makes the result symmetric.
    for (int s = 0; s < coarsest_sweeps; ++s) {
      sweep(level, 0);
      sweep(level, 1);
    }
    sweep(level, 0);
    return;
  }
  CellLevel& coarse = levels_[static_cast<std::size_t>(depth + 1)];
  compute_residual(level);
  restrict_residual(level, coarse);
  cycle(depth + 1);
  prolong(coarse, level);
  sweep(level, 1);
  sweep(level, 0);
}

double CellHierarchy::bytes() const {
  double total = 0;
  for (const CellLevel& level : levels_) {
    for (const auto* array :
         {&level.face[0], &level.face[1], &level.face[2], &level.dirichlet, &level.mass, &level.inverse_diagonal,
          &level.right_hand_side, &level.solution, &level.other, &level.residual, &level.scratch})
      total += array->bytes();
    total += level.range.bytes();
  }
  return total;
}

void CellHierarchy::v_cycle() {
  cycle(0);
}

}  // namespace spume
