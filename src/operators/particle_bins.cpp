// SPDX-License-Identifier: MIT
#include "spume/operators/particle_bins.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/periodic_grid.hpp"

namespace spume {

ParticleBins::ParticleBins(const UniformGrid& box, std::array<bool, 3> periodic, double support_radius,
                           const std::array<std::span<const double>, 3>& position)
    : dimensions_(box.dimensions), periodic_(periodic) {
  const std::size_t particles = position[0].size();
  for (int axis = 0; axis < dimensions_; ++axis) {
    lower_[axis] = box.lower[axis];
    length_[axis] = box.length(axis);
    cells_[axis] = static_cast<std::size_t>(std::clamp(length_[axis] / support_radius, 1.0, 65536.0));
  }
  // A large, mostly empty box must not cost more cells than the particles and the grid justify.
  const std::size_t most_cells = 64 + 4 * particles + box.size();
  while (cell_count() > most_cells) *std::max_element(cells_.begin(), cells_.end()) /= 2;

  Array<std::uint32_t> cell(particles);
  Array<std::uint32_t> filled(cell_count());
  parallel_for(particles, [&](std::size_t i) {
    std::size_t index = 0;
    for (int axis = dimensions_ - 1; axis >= 0; --axis)
      index = index * cells_[axis] + cell_along(axis, wrapped(axis, position[axis][i]));
    cell[i] = static_cast<std::uint32_t>(index);
    std::atomic_ref(filled[index]).fetch_add(1, std::memory_order_relaxed);
  });
  first_.resize(cell_count() + 1);
  first_[0] = 0;
  for (std::size_t c = 0; c < cell_count(); ++c) {
    first_[c + 1] = first_[c] + filled[c];
    filled[c] = first_[c];
  }
  order_.resize(particles);
  parallel_for(particles, [&](std::size_t i) {
    order_[std::atomic_ref(filled[cell[i]]).fetch_add(1, std::memory_order_relaxed)] = static_cast<std::uint32_t>(i);
  });
  for (int axis = 0; axis < dimensions_; ++axis) sorted_[axis].resize(particles);
  // Threads drop particles into a cell in any order; sorting by index restores a reproducible one.
  parallel_for(cell_count(), [&](std::size_t c) {
    std::sort(order_.begin() + first_[c], order_.begin() + first_[c + 1]);
    for (std::uint32_t n = first_[c]; n < first_[c + 1]; ++n)
      for (int axis = 0; axis < dimensions_; ++axis) sorted_[axis][n] = wrapped(axis, position[axis][order_[n]]);
  });
}

double ParticleBins::wrapped(int axis, double coordinate) const {
  return periodic_[axis] ? wrap_periodic(coordinate, lower_[axis], length_[axis]) : coordinate;
}

std::size_t ParticleBins::cell_along(int axis, double coordinate) const {
  const double cells = static_cast<double>(cells_[axis]);
  const double place = (coordinate - lower_[axis]) / length_[axis] * cells;
  if (!(place > 0)) return 0;
  return static_cast<std::size_t>(std::min(place, cells - 1));
}

}  // namespace spume
