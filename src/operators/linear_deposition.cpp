// SPDX-License-Identifier: MIT
#include "spume/operators/linear_deposition.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "spume/core/parallel.hpp"
#include "spume/core/simd.hpp"

namespace spume {
namespace {

using simd::f64x4;

// A tile repeats the particles of one plane of cells and one row of each plane of its neighbours: 1/16 and 1/32 of half
// the work. 33 rows of 128 points in two planes take 280 KB.
constexpr int tile_planes = 16, tile_rows = 32;

[[gnu::always_inline]] inline void add(double* target, double weight, f64x4 amount) {
  f64x4 sum;
  std::memcpy(&sum, target, sizeof sum);
  sum += weight * amount;
  std::memcpy(target, &sum, sizeof sum);
}

f64x4 absolute(f64x4 v) {
  return v < 0 ? -v : v;
}

bool any_above(f64x4 v, double bound) {
  return v[0] > bound || v[1] > bound || v[2] > bound || v[3] > bound;
}

// Component c of four records to component[c]; the records become zero.
[[gnu::always_inline]] inline void take_points(double* records, f64x4 (&component)[4]) {
  f64x4 r[4];
  std::memcpy(r, records, sizeof r);
  const f64x4 zero[4] = {};
  std::memcpy(records, zero, sizeof zero);
  const f64x4 a = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), b = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
  const f64x4 c = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6), d = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
  component[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  component[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  component[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  component[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

template <class Real>
[[gnu::always_inline]] inline void put_points(Real* target, f64x4 values, std::size_t points) {
  using Target = std::conditional_t<std::is_same_v<Real, float>, simd::f32x4, f64x4>;
  const Target converted = __builtin_convertvector(values, Target);
  if (points == 4)
    std::memcpy(target, &converted, sizeof converted);
  else
    std::memcpy(target, &converted, points * sizeof(Real));
}

struct Spreading {
  DepositedParticles particles;
  const std::int32_t* index;
  double lower[3], scale[3], inverse_volume;
  int points_z;
};

// Adds the particles index[from .. to) of the cell column (cx, cy) to rows of the grid planes at its lower and upper
// side in x; null: not wanted, but with all_wanted. What the loop reads is copied first: sums are numbers like these,
// and the compiler would read them again after every addition (a third of the time).
template <bool all_wanted>
void spread_range(const Spreading& given, std::int32_t from, std::int32_t to, int cx, int cy, double* lower_0,
                  double* lower_1, double* upper_0, double* upper_1) {
  const double* const x = given.particles.position[0];
  const double* const y = given.particles.position[1];
  const double* const z = given.particles.position[2];
  const double* const force = given.particles.force;
  const double* const diameter = given.particles.diameter;
  const std::int32_t* const index = given.index;
  const double origin_x = given.lower[0], origin_y = given.lower[1], origin_z = given.lower[2];
  const double scale_x = given.scale[0], scale_y = given.scale[1], scale_z = given.scale[2];
  const double inverse_volume = given.inverse_volume;
  const auto fraction_of = [=](double d) { return M_PI / 6 * d * d * d * inverse_volume; };
  const double common_fraction = fraction_of(given.particles.common_diameter);
  const int nz = given.points_z;
  for (std::int32_t k = from; k < to; ++k) {
    const auto p = static_cast<std::size_t>(index[k]);
    const double pz = (z[p] - origin_z) * scale_z;
    const int cz = std::clamp(static_cast<int>(pz), 0, nz - 1);
    const double tx = (x[p] - origin_x) * scale_x - cx, ty = (y[p] - origin_y) * scale_y - cy, tz = pz - cz;
    f64x4 amount;
    std::memcpy(&amount, force + 3 * p, sizeof amount);
    amount *= inverse_volume;
    amount[3] = diameter == nullptr ? common_fraction : fraction_of(diameter[p]);
    const f64x4 near_z = (1 - tz) * amount, far_z = tz * amount;
    const std::size_t z_0 = 4 * static_cast<std::size_t>(cz),
                      z_1 = 4 * static_cast<std::size_t>(cz + 1 < nz ? cz + 1 : 0);
    const auto corners = [&](double* target, double weight) {
      add(target + z_0, weight, near_z);
      add(target + z_1, weight, far_z);
    };
    if (all_wanted || lower_0 != nullptr) corners(lower_0, (1 - tx) * (1 - ty));
    if (all_wanted || lower_1 != nullptr) corners(lower_1, (1 - tx) * ty);
    if (all_wanted || upper_0 != nullptr) corners(upper_0, tx * (1 - ty));
    if (all_wanted || upper_1 != nullptr) corners(upper_1, tx * ty);
  }
}

DepositionReport combined(DepositionReport a, const DepositionReport& b) {
  a.force += b.force;
  a.clipped_force += b.clipped_force;
  a.clipped_volume += b.clipped_volume;
  a.most_volume_fraction = std::max(a.most_volume_fraction, b.most_volume_fraction);
  return a;
}

}  // namespace

template <class Real>
DepositionReport LinearDeposition::deposit(const CellOrder& order, const DepositedParticles& particles,
                                           double most_volume_fraction, const std::array<Real*, 3>& force,
                                           Real* volume_fraction) {
  const int nx = grid_.points[0], ny = grid_.points[1], nz = grid_.points[2];
  const std::size_t row = 4 * (static_cast<std::size_t>(nz) + 4);  // off powers of two, and room for four points
  const std::size_t plane = row * static_cast<std::size_t>(std::min(ny, tile_rows));
  const std::int32_t* index = order.order().data();
  const std::int32_t* first = order.first();
  const double cell_volume = grid_.cell_volume();

  if (sums_.size() < static_cast<std::size_t>(thread_count())) sums_.resize(static_cast<std::size_t>(thread_count()));
  for (auto& sums : sums_) sums.resize(2 * plane);

  const Spreading spreading{particles,
                            index,
                            {grid_.lower[0], grid_.lower[1], grid_.lower[2]},
                            {grid_.inverse_spacing(0), grid_.inverse_spacing(1), grid_.inverse_spacing(2)},
                            1 / cell_volume,
                            nz};
  const auto spread_column = [&](int cx, int cy, double* lower_0, double* lower_1, double* upper_0, double* upper_1) {
    const std::size_t column = static_cast<std::size_t>(cx) * static_cast<std::size_t>(ny) + std::size_t(cy);
    const std::int32_t from = first[column], to = first[column + 1];
    if (lower_0 != nullptr && lower_1 != nullptr && upper_0 != nullptr && upper_1 != nullptr)
      spread_range<true>(spreading, from, to, cx, cy, lower_0, lower_1, upper_0, upper_1);
    else
      spread_range<false>(spreading, from, to, cx, cy, lower_0, lower_1, upper_0, upper_1);
  };
  // Adds cell plane cx to the rows [y_from, y_to) of its two grid planes.
  const auto spread = [&](int cx, int y_from, int y_to, double* lower_plane, double* upper_plane) {
    const auto row_of = [&](double* sums, int y) {
      return sums == nullptr || y < y_from || y >= y_to ? nullptr : sums + static_cast<std::size_t>(y - y_from) * row;
    };
    for (int y = y_from - 1; y < y_to; ++y) {
      const int cy = y < 0 ? ny - 1 : y, above = cy + 1 < ny ? cy + 1 : 0;
      // The column before the tile gives its upper row alone; the last one of a whole box was its column before.
      const bool below_tile = y < y_from;
      if (!below_tile && y_to - y_from == ny && cy == ny - 1) {
        spread_column(cx, cy, row_of(lower_plane, cy), nullptr, row_of(upper_plane, cy), nullptr);
        continue;
      }
      spread_column(cx, cy, below_tile ? nullptr : row_of(lower_plane, cy), row_of(lower_plane, above),
                    below_tile ? nullptr : row_of(upper_plane, cy), row_of(upper_plane, above));
    }
  };

  // Clips the rows of a finished plane, writes them out and empties them, four points at a time: rows are padded, so
  // that a remainder reads sums that are zero.
  const auto finish = [&](int ix, int y_from, int y_to, double* sums, DepositionReport& report) {
    f64x4 size{}, clipped{}, crowded_points{}, most{};
    for (int iy = y_from; iy < y_to; ++iy) {
      double* from = sums + static_cast<std::size_t>(iy - y_from) * row;
      const std::size_t to = grid_.row(ix, iy);
      for (int iz = 0; iz < nz; iz += 4) {
        double* s = from + 4 * static_cast<std::size_t>(iz);
        f64x4 component[4];
        take_points(s, component);
        f64x4 magnitude = absolute(component[0]) + absolute(component[1]) + absolute(component[2]);
        const f64x4 alpha = component[3];
        most = alpha > most ? alpha : most;
        size += magnitude;
        if (any_above(alpha, most_volume_fraction)) {
          const f64x4 one = f64x4{} + 1.0;
          const f64x4 clip = alpha > most_volume_fraction ? most_volume_fraction / alpha : one;
          clipped += (one - clip) * magnitude;
          crowded_points += alpha > most_volume_fraction ? one : f64x4{};
          for (int c = 0; c < 3; ++c) component[c] *= clip;
        }
        const auto points = static_cast<std::size_t>(std::min(4, nz - iz));
        for (int c = 0; c < 3; ++c) put_points(force[c] + to + iz, component[c], points);
        if (volume_fraction != nullptr) put_points(volume_fraction + to + iz, alpha, points);
      }
    }
    report.force += simd::sum(size);
    report.clipped_force += simd::sum(clipped);
    report.clipped_volume += simd::sum(crowded_points);
    for (int l = 0; l < 4; ++l) report.most_volume_fraction = std::max(report.most_volume_fraction, most[l]);
  };

  const std::size_t x_tiles = block_count(static_cast<std::size_t>(nx), tile_planes);
  const std::size_t y_tiles = block_count(static_cast<std::size_t>(ny), tile_rows);
  std::array<DepositionReport, max_reduction_blocks> partial{};
  const std::size_t stride = block_count(x_tiles * y_tiles, max_reduction_blocks);  // tiles per partial result
  parallel_blocks(x_tiles * y_tiles, stride, [&](std::size_t group, std::size_t tile_first, std::size_t tile_last) {
    double* const sums = sums_[static_cast<std::size_t>(omp_get_thread_num())].data();
    DepositionReport report;
    for (std::size_t t = tile_first; t < tile_last; ++t) {
      const int x_from = static_cast<int>(t / y_tiles) * tile_planes, x_to = std::min(nx, x_from + tile_planes);
      const int y_from = static_cast<int>(t % y_tiles) * tile_rows, y_to = std::min(ny, y_from + tile_rows);
      double *below = sums, *above = sums + plane;
      std::fill_n(sums, 2 * plane, 0.0);
      spread(x_from > 0 ? x_from - 1 : nx - 1, y_from, y_to, nullptr, below);
      for (int ix = x_from; ix < x_to; ++ix) {
        spread(ix, y_from, y_to, below, ix + 1 < x_to ? above : nullptr);
        finish(ix, y_from, y_to, below, report);
        std::swap(below, above);
      }
    }
    partial[group] = report;
  });
  DepositionReport report;
  for (const auto& p : partial) report = combined(report, p);
  report.force *= cell_volume;
  report.clipped_force *= cell_volume;
  report.clipped_volume *= cell_volume;
  return report;
}

double LinearDeposition::bytes() const {
  double total = 0;
  for (const auto& sums : sums_) total += 8.0 * static_cast<double>(sums.capacity());
  return total;
}

template DepositionReport LinearDeposition::deposit(const CellOrder&, const DepositedParticles&, double,
                                                    const std::array<double*, 3>&, double*);
template DepositionReport LinearDeposition::deposit(const CellOrder&, const DepositedParticles&, double,
                                                    const std::array<float*, 3>&, float*);

}  // namespace spume
