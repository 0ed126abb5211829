// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/clustering.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "spume/core/parallel.hpp"
#include "spume/core/periodic_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/periodic_cells.hpp"

namespace spume {
namespace {

// Slope of log y against log x by least squares; points without a y are left out.
struct LogSlope {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  void add(double at, double value) {
    if (!(value > 0)) return;
    const double u = std::log(at), v = std::log(value);
    n += 1;
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  double value() const {
    return n < 2 ? std::numeric_limits<double>::quiet_NaN() : (n * xy - x * y) / (n * xx - x * x);
  }
};

}  // namespace

PairStatistics pair_statistics(const std::array<double, 3>& lower, const std::array<double, 3>& length,
                               const std::array<const double*, 3>& position, std::size_t size, double smallest,
                               double largest, int bins, std::size_t centres) {
  if (!(smallest > 0) || !(largest > smallest) || !(2 * largest < std::min({length[0], length[1], length[2]})) ||
      bins < 1)
    throw std::invalid_argument("pair statistics need 0 < smallest < largest < half of the box, and bins");
  PairStatistics out;
  for (int b = 0; b <= bins; ++b) out.radius.push_back(smallest * std::pow(largest / smallest, double(b) / bins));
  out.radial_distribution.assign(static_cast<std::size_t>(bins), 0);
  out.correlation.assign(static_cast<std::size_t>(bins) + 1, 0);
  if (size < 2) return out;

  const PeriodicCells cells =
      PeriodicCells::with_side(lower, length, largest, std::max<double>(64, static_cast<double>(size)));
  CellOrder order;
  order.build(cells, position[0], position[1], position[2], size);
  const std::size_t stride = block_count(size, std::max<std::size_t>(centres, 1));
  const std::size_t looked_at = block_count(size, stride);

  // Counts per block of centres, added in order. count[0]: closer than the smallest radius.
  const std::size_t block = std::max<std::size_t>(16, block_count(looked_at, 64));
  std::vector<std::vector<double>> counts(block_count(looked_at, block),
                                          std::vector<double>(static_cast<std::size_t>(bins) + 1, 0.0));
  const double per_bin = bins / std::log(largest / smallest);
  parallel_blocks(looked_at, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    for (std::size_t centre = first; centre < last; ++centre) {
      const std::size_t i = centre * stride;
      int from[3], to[3];
      for (int axis = 0; axis < 3; ++axis) {
        const int n = cells.count[axis];
        const int own = std::clamp(static_cast<int>((position[axis][i] - lower[axis]) / cells.side(axis)), 0, n - 1);
        from[axis] = n < 3 ? 0 : own - 1;
        to[axis] = n < 3 ? n - 1 : own + 1;
      }
      const auto wrapped = [&](int c, int axis) { return (c + cells.count[axis]) % cells.count[axis]; };
      for (int cx = from[0]; cx <= to[0]; ++cx)
        for (int cy = from[1]; cy <= to[1]; ++cy)
          for (int cz = from[2]; cz <= to[2]; ++cz) {
            const auto cell = static_cast<std::size_t>(
                (wrapped(cx, 0) * cells.count[1] + wrapped(cy, 1)) * cells.count[2] + wrapped(cz, 2));
            for (std::int32_t k = order.first()[cell]; k < order.first()[cell + 1]; ++k) {
              const auto j = static_cast<std::size_t>(order.order()[static_cast<std::size_t>(k)]);
              if (j == i) continue;
              double distance_2 = 0;
              for (int axis = 0; axis < 3; ++axis) {
                const double d = nearest_image(position[axis][j] - position[axis][i], length[axis]);
                distance_2 += d * d;
              }
              if (distance_2 >= largest * largest) continue;
              const double bin =
                  distance_2 < smallest * smallest ? -1 : 0.5 * std::log(distance_2 / (smallest * smallest)) * per_bin;
              counts[b][static_cast<std::size_t>(std::clamp(static_cast<int>(std::floor(bin)), -1, bins - 1) + 1)] += 1;
            }
          }
    }
  });
  std::vector<double> total(static_cast<std::size_t>(bins) + 1, 0.0);
  for (const auto& part : counts)
    for (std::size_t b = 0; b < total.size(); ++b) total[b] += part[b];

  const double density = static_cast<double>(size - 1) / (length[0] * length[1] * length[2]);
  double within = 0;
  for (std::size_t b = 0; b < total.size(); ++b) {
    within += total[b] / static_cast<double>(looked_at);
    out.correlation[b] = within;
    if (b == 0) continue;
    const double shell = 4 * M_PI / 3 * (std::pow(out.radius[b], 3) - std::pow(out.radius[b - 1], 3));
    out.radial_distribution[b - 1] = total[b] / static_cast<double>(looked_at) / (density * shell);
  }
  return out;
}

double correlation_dimension(const PairStatistics& pairs, double from, double to) {
  LogSlope slope;
  for (std::size_t b = 0; b < pairs.radius.size(); ++b)
    if (pairs.radius[b] >= from && pairs.radius[b] <= to) slope.add(pairs.radius[b], pairs.correlation[b]);
  return slope.value();
}

double dimension_beyond_contact(const PairStatistics& pairs, double from, double to) {
  LogSlope slope;
  for (std::size_t b = 0; b + 1 < pairs.radius.size(); ++b)
    if (pairs.radius[b] >= from * (1 - 1e-12) && pairs.radius[b + 1] <= to * (1 + 1e-12))
      slope.add(std::sqrt(pairs.radius[b] * pairs.radius[b + 1]), pairs.radial_distribution[b]);
  return 3 + slope.value();
}

double box_count_variance(const PeriodicCells& boxes, const std::array<const double*, 3>& position, std::size_t size) {
  if (size == 0 || boxes.size() < 2) return 0;
  CellOrder order;
  order.build(boxes, position[0], position[1], position[2], size);
  const double mean = static_cast<double>(size) / static_cast<double>(boxes.size());
  const double squares = parallel_sum(boxes.size(), [&](std::size_t c) {
    const double off = order.first()[c + 1] - order.first()[c] - mean;
    return off * off;
  });
  return squares / static_cast<double>(boxes.size() - 1) / mean;
}

std::vector<BoxCount> box_counts(const std::array<double, 3>& lower, const std::array<double, 3>& length,
                                 const std::array<const double*, 3>& position, std::size_t size, double smallest) {
  std::vector<BoxCount> out;
  const double shortest = std::min({length[0], length[1], length[2]});
  // Sides that divide the box but for rounding must not lose a box.
  for (double side = smallest * (1 - 1e-12); 2 * side <= shortest; side *= 2) {
    const PeriodicCells boxes = PeriodicCells::with_side(lower, length, side, 1e18);
    out.push_back({std::cbrt(boxes.side(0) * boxes.side(1) * boxes.side(2)),
                   static_cast<double>(size) / static_cast<double>(boxes.size()),
                   box_count_variance(boxes, position, size)});
  }
  return out;
}

}  // namespace spume
