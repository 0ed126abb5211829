// SPDX-License-Identifier: MIT
// Setup of the preconditioner: what solid boxes and bodies leave of the cells, and the solid cells beside liquid.
#include <algorithm>
#include <cmath>

#include "cell_status.hpp"
#include "spume/core/parallel.hpp"
#include "spume/solvers/cell_multigrid.hpp"

namespace spume {
namespace {

// A cell without particles and with less open volume than this is taken for a part of the solid.
constexpr float least_open_volume = 0.6F;
// In cell widths, of the faces of a solid.
constexpr double rounding = 1e-6;

}  // namespace

// The open part of a cell or of a face of it is that of a surface that is flat and lies across the axis.
void CellMultigrid::mark_bodies() {
  const CellLevel& level = hierarchy_.finest();
  const auto& n = level.cells;
  const auto dimensions = static_cast<std::size_t>(geometry_.dimensions);
  parallel_blocks(level.rows(), 1, [&](std::size_t row, std::size_t, std::size_t) {
    const int start[3] = {0, static_cast<int>(row) % n[1], static_cast<int>(row) / n[1]};
    for (int i = 0; i < n[0]; ++i) {
      const std::size_t c = row * static_cast<std::size_t>(n[0]) + static_cast<std::size_t>(i);
      std::array<double, 3> middle{};
      for (std::size_t a = 0; a < dimensions; ++a)
        middle[a] = axis_[a].origin + (first_cell_[a] + (a == 0 ? i : start[a]) + 0.5) * width_[a];
      // Faces are cut within half a width of a cell.
      if (geometry_.farther && geometry_.farther(middle, 2 * width_[0])) continue;
      const double distance = geometry_.distance(middle);
      const auto open = [&](double away, std::size_t a) {
        return static_cast<float>(std::clamp(0.5 + away / width_[a], 0.0, 1.0));
      };
      open_volume_[c] = std::min(open_volume_[c], open(distance, 0));
      if (std::abs(distance) > 2 * width_[0]) {
        for (std::size_t a = 0; a < dimensions; ++a) open_face_[a][c] = std::min(open_face_[a][c], open(distance, 0));
        continue;
      }
      for (std::size_t a = 0; a < dimensions; ++a) {
        std::array<double, 3> face = middle;
        face[a] -= 0.5 * width_[a];
        open_face_[a][c] = std::min(open_face_[a][c], open(geometry_.distance(face), (a + 1) % dimensions));
      }
    }
  });
}

void CellMultigrid::mark_solids() {
  const CellLevel& level = hierarchy_.finest();
  const auto& n = level.cells;
  const std::size_t total = level.rows() * static_cast<std::size_t>(n[0]);
  for (Array<float>* field : {&open_volume_, &open_face_[0], &open_face_[1], &open_face_[2]}) {
    field->resize(total);
    field->fill(1.0F);
  }
  const auto dimensions = static_cast<std::size_t>(geometry_.dimensions);
  for (const CellGeometry::Box& box : geometry_.solids) {
    double lower[3] = {0, 0, 0}, upper[3] = {1, 1, 1};  // in cell widths of the box of cells
    int first[3] = {0, 0, 0}, last[3] = {1, 1, 1};
    for (std::size_t a = 0; a < dimensions; ++a) {
      lower[a] = (box.lower[a] - axis_[a].origin) / width_[a] - first_cell_[a];
      upper[a] = (box.upper[a] - axis_[a].origin) / width_[a] - first_cell_[a];
      first[a] = static_cast<int>(std::floor(std::clamp<double>(lower[a], 0, n[a])));
      last[a] = static_cast<int>(std::ceil(std::clamp<double>(upper[a] + rounding, 0, n[a])));
    }
    const auto overlap = [&](std::size_t a, int i) {
      return std::max(0.0, std::min(upper[a], i + 1.0) - std::max(lower[a], double(i)));
    };
    for (int k = first[2]; k < last[2]; ++k) {
      for (int j = first[1]; j < last[1]; ++j) {
        for (int i = first[0]; i < last[0]; ++i) {
          const int at[3] = {i, j, k};
          const std::size_t c =
              static_cast<std::size_t>(k * n[1] + j) * static_cast<std::size_t>(n[0]) + static_cast<std::size_t>(i);
          const double part[3] = {overlap(0, i), overlap(1, j), dimensions == 3 ? overlap(2, k) : 1.0};
          open_volume_[c] -= static_cast<float>(part[0] * part[1] * part[2]);
          for (std::size_t a = 0; a < dimensions; ++a) {
            if (at[a] < lower[a] - rounding || at[a] > upper[a] + rounding) continue;
            const double covered = part[(a + 1) % 3] * part[(a + 2) % 3];
            open_face_[a][c] = std::max(0.0F, open_face_[a][c] - static_cast<float>(covered));
          }
        }
      }
    }
  }
  if (geometry_.distance) mark_bodies();
  parallel_for(total, [&](std::size_t c) {
    if (status_[c] == no_liquid && open_volume_[c] < least_open_volume) status_[c] = solid_cell;
  });
}

void CellMultigrid::find_shore() {
  shore_.clear();
  shore_first_.assign(1, 0);
  shore_next_.clear();
  if (geometry_.solids.empty() && !geometry_.distance) return;
  const CellLevel& level = hierarchy_.finest();
  const auto& n = level.cells;
  const auto cell = [&](const std::array<int, 3>& at) {
    return static_cast<std::size_t>(at[2] * n[1] + at[1]) * static_cast<std::size_t>(n[0]) +
           static_cast<std::size_t>(at[0]);
  };
  const auto slot = [&](const std::array<int, 3>& at) {
    return level.row_start(static_cast<std::size_t>(at[2] * n[1] + at[1])) + static_cast<std::size_t>(at[0]);
  };
  // visit(slot) of the neighbours that hold liquid, across faces (steps 1), edges or corners.
  const auto each_neighbour = [&](const std::array<int, 3>& at, int steps, auto&& visit) {
    for (int way = 0; way < 27; ++way) {
      const std::array<int, 3> step{way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1};
      if (std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]) != steps) continue;
      std::array<int, 3> there = at;
      bool exists = true;
      for (std::size_t a = 0; a < 3; ++a) {
        there[a] += step[a];
        if (there[a] >= 0 && there[a] < n[a]) continue;
        exists = exists && axis_[a].periodic && n[a] > 1;
        there[a] = (there[a] + n[a]) % n[a];
      }
      if (exists && holds_liquid(status_[cell(there)])) visit(slot(there));
    }
  };
  const auto place = [&](std::size_t c) {
    const auto columns = static_cast<std::size_t>(n[0]), rows = static_cast<std::size_t>(n[1]);
    return std::array<int, 3>{static_cast<int>(c % columns), static_cast<int>(c / columns % rows),
                              static_cast<int>(c / (columns * rows))};
  };
  parallel_select(level.rows() * static_cast<std::size_t>(n[0]), shore_cells_, [&](std::size_t c) {
    if (status_[c] != solid_cell) return false;
    bool beside_liquid = false;
    for (const int steps : {1, 2, 3}) each_neighbour(place(c), steps, [&](std::size_t) { beside_liquid = true; });
    return beside_liquid;
  });
  for (const std::int32_t c : shore_cells_) {
    const std::array<int, 3> at = place(static_cast<std::size_t>(c));
    for (int steps = 1; shore_next_.size() == shore_first_.back(); ++steps)
      each_neighbour(at, steps, [&](std::size_t there) { shore_next_.push_back(there); });
    shore_.push_back(slot(at));
    shore_first_.push_back(shore_next_.size());
  }
}

}  // namespace spume
