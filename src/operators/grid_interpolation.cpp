// SPDX-License-Identifier: MIT
#include "spume/operators/grid_interpolation.hpp"

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "consistent_stencil.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/operators/particle_bins.hpp"

namespace spume {

namespace {

using detail::ConsistentStencil;
using detail::StencilOrder;

// Candidates of one cell, copied together so that all grid points of the cell read contiguous memory.
template <int Dimensions>
struct Workspace {
  std::vector<double> fields;  // of the candidates, candidate-major
  std::vector<double> sums;
  ConsistentStencil<Dimensions> stencil;
};

// The grid points whose coordinate lies in cell c along an axis: indices first[c] to first[c + 1].
std::vector<std::size_t> points_by_cell(const UniformGrid& grid, const ParticleBins& bins, int axis) {
  std::vector<std::size_t> first(bins.cells()[axis] + 1, 0);
  for (std::size_t i = 0; i < grid.points[axis]; ++i)
    ++first[1 + (axis < grid.dimensions ? bins.cell_along(axis, grid.coordinate(axis, i)) : 0)];
  std::partial_sum(first.begin(), first.end(), first.begin());
  return first;
}

GridInterpolationReport operator+(const GridInterpolationReport& a, const GridInterpolationReport& b) {
  return {a.cubic + b.cubic, a.linear + b.linear, a.shepard + b.shepard, a.outside + b.outside};
}

template <int Dimensions>
GridInterpolationReport interpolate(const UniformGrid& grid, const GridInterpolationInput& particles,
                                    double support_radius, double largest_amplification,
                                    std::span<double* const> values, std::span<std::uint8_t> mask) {
  const ParticleBins bins(grid, particles.periodic, support_radius, particles.position);
  std::array<std::vector<std::size_t>, 3> first;
  for (int axis = 0; axis < 3; ++axis) first[axis] = points_by_cell(grid, bins, axis);

  const std::size_t fields = particles.fields.size();
  const double covered_distance = std::sqrt(Dimensions) / 2 * particles.spacing / support_radius;
  const double volume = std::pow(particles.spacing / support_radius, Dimensions);

  const auto point = [&](Workspace<Dimensions>& work, const std::array<double, 3>& x, std::size_t index,
                         GridInterpolationReport& report) {
    auto& stencil = work.stencil;
    stencil.select(x, support_radius);
    stencil.evaluate_kernel();
    StencilOrder order = StencilOrder::none;
    if (stencil.nearest() <= covered_distance || stencil.filled(volume) >= 0.5)
      order = stencil.solve(largest_amplification);
    work.sums.assign(fields, 0.0);
    if (!mask.empty()) mask[index] = order == StencilOrder::none ? 0 : 1;
    switch (order) {
      case StencilOrder::cubic:
        ++report.cubic;
        break;
      case StencilOrder::linear:
        ++report.linear;
        break;
      case StencilOrder::shepard:
        ++report.shepard;
        break;
      case StencilOrder::none:
        ++report.outside;
        break;
    }
    const std::size_t used = order == StencilOrder::none ? 0 : stencil.count();
    for (std::size_t n = 0; n < used; ++n) {
      const double* sample = &work.fields[stencil.source(n) * fields];
      for (std::size_t f = 0; f < fields; ++f) work.sums[f] += stencil.weight(n) * sample[f];
    }
    for (std::size_t f = 0; f < fields; ++f) values[f][index] = work.sums[f];
  };

  std::vector<Workspace<Dimensions>> workspaces(static_cast<std::size_t>(thread_count()));
  std::vector<GridInterpolationReport> reports(bins.cell_count());
  const auto [cells_x, cells_y, cells_z] = bins.cells();
  parallel_blocks(
      bins.cell_count(), 1, [&, cells_x = cells_x, cells_y = cells_y](std::size_t cell, std::size_t, std::size_t) {
        const std::array<std::size_t, 3> c{cell % cells_x, cell / cells_x % cells_y, cell / cells_x / cells_y};
        for (int axis = 0; axis < 3; ++axis)
          if (first[axis][c[axis]] == first[axis][c[axis] + 1]) return;
        auto& work = workspaces[static_cast<std::size_t>(omp_get_thread_num())];
        work.stencil.clear_candidates();
        work.fields.clear();
        bins.for_each_around(c[0], c[1], c[2], [&](std::size_t particle, const std::array<double, 3>& x) {
          work.stencil.append_candidate(x);
          for (std::size_t f = 0; f < fields; ++f) work.fields.push_back(particles.fields[f][particle]);
        });
        for (std::size_t k = first[2][c[2]]; k < first[2][c[2] + 1]; ++k)
          for (std::size_t j = first[1][c[1]]; j < first[1][c[1] + 1]; ++j)
            for (std::size_t i = first[0][c[0]]; i < first[0][c[0] + 1]; ++i)
              point(work, {grid.coordinate(0, i), grid.coordinate(1, j), Dimensions == 3 ? grid.coordinate(2, k) : 0.0},
                    grid.index(i, j, k), reports[cell]);
      });
  GridInterpolationReport total;
  for (const GridInterpolationReport& report : reports) total = total + report;
  return total;
}

void require_consistent(const UniformGrid& grid, const GridInterpolationInput& particles, double support_radius,
                        std::span<double* const> values, std::span<std::uint8_t> mask) {
  require_valid(grid);
  if (!(particles.spacing > 0) || !std::isfinite(support_radius) || !(support_radius > 0))
    throw InputError("interpolation to a grid was given a particle spacing of " + std::to_string(particles.spacing) +
                     " and a support of " + std::to_string(support_radius) + "; expected positive numbers");
  for (int axis = 0; axis < grid.dimensions; ++axis) {
    const std::string name(1, "xyz"[axis]);
    if (particles.position[axis].size() != particles.position[0].size())
      throw InputError("interpolation to a grid was given " + std::to_string(particles.position[axis].size()) + " " +
                       name + " coordinates; expected " + std::to_string(particles.position[0].size()));
    if (particles.periodic[axis] && grid.length(axis) < support_radius)
      throw InputError("the box is " + std::to_string(grid.length(axis)) + " long along periodic " + name +
                       "; interpolation to a grid needs at least its support of " + std::to_string(support_radius) +
                       ": use a longer box or a smaller particle spacing");
  }
  if (values.size() != particles.fields.size())
    throw InputError("interpolation to a grid was given " + std::to_string(particles.fields.size()) + " fields and " +
                     std::to_string(values.size()) + " results; expected equal numbers");
  if (!mask.empty() && mask.size() != grid.size())
    throw InputError("interpolation to a grid was given a mask of " + std::to_string(mask.size()) +
                     " points; expected " + std::to_string(grid.size()));
}

}  // namespace

GridInterpolationReport interpolate_to_grid(const UniformGrid& grid, const GridInterpolationInput& particles,
                                            std::span<double* const> values, std::span<std::uint8_t> mask,
                                            const GridInterpolationOptions& options) {
  const double support_radius = options.support * particles.spacing;
  require_consistent(grid, particles, support_radius, values, mask);
  return grid.dimensions == 2
             ? interpolate<2>(grid, particles, support_radius, options.largest_amplification, values, mask)
             : interpolate<3>(grid, particles, support_radius, options.largest_amplification, values, mask);
}

}  // namespace spume
