// SPDX-License-Identifier: MIT
#include "spume/neighbours/list_skin.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "spume/core/joined_lanes.hpp"
#include "spume/core/parallel.hpp"

namespace spume {
namespace {

using simd::f32n, simd::f32x4, simd::pair_lanes;

// Blocks handled at a time by one thread.
constexpr std::size_t blocks_at_a_time = 64;
// Of the mean squares of a full block, beside which a gradient that few points leave open is nought.
constexpr float regularisation = 1e-4F;

float squared(f32x4 v) {
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

f32x4 absolute(f32x4 v) {
  return v < 0 ? -v : v;
}

f32x4 splat4(float value) {
  return f32x4{value, value, value, value};
}

// The least singular value of I + G, G by columns: the root of the least eigenvalue of (I + G)^T (I + G).
float least_stretch(const std::array<f32x4, 3>& gradient) {
  std::array<f32x4, 3> map = gradient;
  for (int a = 0; a < 3; ++a) map[static_cast<std::size_t>(a)][a] += 1;
  const auto product = [](f32x4 a, f32x4 b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const float xx = product(map[0], map[0]), yy = product(map[1], map[1]), zz = product(map[2], map[2]);
  const float xy = product(map[0], map[1]), xz = product(map[0], map[2]), yz = product(map[1], map[2]);
  // Smith (1961), of a symmetric matrix of three rows.
  const float mean = (xx + yy + zz) / 3, off = xy * xy + xz * xz + yz * yz;
  const float dx = xx - mean, dy = yy - mean, dz = zz - mean;
  const float size = std::sqrt((dx * dx + dy * dy + dz * dz + 2 * off) / 6);
  if (size < 1e-7F) return std::sqrt(std::max(mean, 0.0F));
  const float determinant = (dx * (dy * dz - yz * yz) - xy * (xy * dz - yz * xz) + xz * (xy * yz - dy * xz)) / 2;
  const float angle = std::acos(std::clamp(determinant / (size * size * size), -1.0F, 1.0F)) / 3;
  constexpr float third_of_a_turn = 2.0943951F;
  return std::sqrt(std::max(0.0F, mean + 2 * size * std::cos(angle + third_of_a_turn)));
}

}  // namespace

// Places and ways of the points of a block, those of an axis one after the other.
class ListSkin::Gathered {
 public:
  void make_room(std::size_t count) {
    stride_ = (count + pair_lanes) / pair_lanes * pair_lanes;
    if (memory_.size() < 6 * stride_) memory_.resize(12 * stride_);
    count_ = count;
  }
  float* place(int axis) { return memory_.data() + axis * stride_; }
  float* way(int axis) { return memory_.data() + (3 + axis) * stride_; }
  // Whole vectors, the last of which ends in points of nought.
  void finish(int dimensions) {
    for (int axis = 0; axis < dimensions; ++axis) {
      std::fill(place(axis) + count_, place(axis) + whole(), 0.0F);
      std::fill(way(axis) + count_, way(axis) + whole(), 0.0F);
    }
  }
  std::size_t count() const { return count_; }
  std::size_t whole() const { return (count_ + pair_lanes - 1) / pair_lanes * pair_lanes; }

 private:
  Array<float> memory_;
  std::size_t stride_ = 0, count_ = 0;
};

void ListSkin::find_blocks(const Points& points) {
  const CellGrid& grid = points.grid;
  // As wide along x as rows are: at least the reach of the lists.
  columns_ = std::max(1, static_cast<int>(std::ceil(CellGrid::row_fraction / CellGrid::column_fraction)));
  count_ = {(grid.columns() + columns_ - 1) / columns_, grid.rows_y(), grid.rows_z()};
  const std::size_t all = static_cast<std::size_t>(count_[0]) * count_[1] * count_[2];
  slot_.resize(all);
  const bool any_image = points.images.size() > 0;
  parallel_for(all, [&](std::size_t b) {
    const auto [first, last] = cells_of(points, b);
    const auto filled = [first = first, last = last](const CellOrder& order) {
      return order.first()[first] < order.first()[last];
    };
    slot_[b] = filled(points.particles) || (any_image && filled(points.images.table())) ? 0 : -1;
  });
  block_.clear();
  for (std::size_t b = 0; b < all; ++b) {
    if (slot_[b] < 0) continue;
    slot_[b] = static_cast<std::int32_t>(block_.size());
    block_.push_back(static_cast<std::int32_t>(b));
  }
  fit_.resize(block_.size());
  const auto& paths = points.images.paths();
  path_.resize(paths.size());
  for (std::size_t p = 0; p < paths.size(); ++p)
    for (int axis = 0; axis < grid.dimensions(); ++axis) {
      const std::int8_t side = paths[p].side[axis];
      const double lower = points.rules.lower[axis], upper = points.rules.upper[axis];
      path_[p].sign[axis] = static_cast<float>(Images::sign(paths[p], points.rules, axis));
      if (side < 0) continue;
      const bool mirror = points.rules.sides[axis][side] == ImageKind::mirror;
      double shift = side == 0 ? lower - upper : upper - lower;
      if (mirror) shift = 2 * ((side == 0 ? lower : upper) - points.origin[axis]);
      path_[p].shift[axis] = static_cast<float>(shift);
    }
  indexed_ = true;
}

std::array<int, 3> ListSkin::place_of(std::size_t block) const {
  const auto x = static_cast<std::size_t>(count_[0]), y = static_cast<std::size_t>(count_[1]);
  return {static_cast<int>(block % x), static_cast<int>(block / x % y), static_cast<int>(block / x / y)};
}

std::array<std::int64_t, 2> ListSkin::cells_of(const Points& points, std::size_t block) const {
  const auto [x, y, z] = place_of(block);
  const std::int64_t row = std::int64_t{points.grid.row(y, z)} * points.grid.columns();
  return {row + std::int64_t{x} * columns_, row + std::min((x + 1) * columns_, points.grid.columns())};
}

const ListSkin::Fit* ListSkin::fit_at(std::array<int, 3> place, const std::array<int, 3>& step) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place[axis] += step[axis];
    if (place[axis] < 0 || place[axis] >= count_[axis]) return nullptr;
  }
  const std::size_t block = (static_cast<std::size_t>(place[2]) * count_[1] + place[1]) * count_[0] + place[0];
  return slot_[block] < 0 ? nullptr : &fit_[static_cast<std::size_t>(slot_[block])];
}

template <int dimensions>
void ListSkin::fit_block(const Points& points, std::size_t slot, Gathered& gathered) {
  constexpr int moments = dimensions * (dimensions + 1) / 2;
  const auto [first, last] = cells_of(points, static_cast<std::size_t>(block_[slot]));
  const std::int32_t begin = points.particles.first()[first], end = points.particles.first()[last];
  std::int32_t image = 0, image_end = 0;
  if (points.images.size() > 0) {
    image = points.images.table().first()[first];
    image_end = points.images.table().first()[last];
  }
  gathered.make_room(static_cast<std::size_t>(end - begin + image_end - image));
  for (int axis = 0; axis < dimensions; ++axis) {
    float* place = std::copy(points.place[axis] + begin, points.place[axis] + end, gathered.place(axis));
    float* way = std::copy(points.way[axis] + begin, points.way[axis] + end, gathered.way(axis));
    for (std::int32_t k = image; k < image_end; ++k) {
      const std::int32_t source = points.images.source()[k];
      const Path& path = path_[static_cast<std::size_t>(points.images.path()[k])];
      *place++ = path.sign[axis] * points.place[axis][source] + path.shift[axis];
      *way++ = path.sign[axis] * points.way[axis][source];
    }
  }
  gathered.finish(dimensions);
  const auto count = static_cast<float>(gathered.count());

  std::array<float, dimensions> middle{}, mean_way{};
  for (int axis = 0; axis < dimensions; ++axis) {
    f32n place{}, way{};
    for (std::size_t k = 0; k < gathered.whole(); k += pair_lanes) {
      place = place + simd::load<f32n>(gathered.place(axis) + k);
      way = way + simd::load<f32n>(gathered.way(axis) + k);
    }
    middle[axis] = simd::sum(place) / count;
    mean_way[axis] = simd::sum(way) / count;
  }
  // The points that fill the last vector stand in the middle, with the mean way.
  for (int axis = 0; axis < dimensions; ++axis) {
    std::fill(gathered.place(axis) + gathered.count(), gathered.place(axis) + gathered.whole(), middle[axis]);
    std::fill(gathered.way(axis) + gathered.count(), gathered.way(axis) + gathered.whole(), mean_way[axis]);
  }
  std::array<f32n, moments + dimensions * dimensions> sum{};
  std::array<f32n, dimensions> farthest{};
  for (std::size_t k = 0; k < gathered.whole(); k += pair_lanes) {
    std::array<f32n, dimensions> x, d;
    for (int a = 0; a < dimensions; ++a) {
      x[a] = simd::load<f32n>(gathered.place(a) + k) - middle[a];
      d[a] = simd::load<f32n>(gathered.way(a) + k) - mean_way[a];
      farthest[a] = simd::max(farthest[a], simd::max(x[a], -x[a]));
    }
    int at = 0;
    for (int a = 0; a < dimensions; ++a)
      for (int b = a; b < dimensions; ++b, ++at) sum[at] = sum[at] + x[a] * x[b];
    for (int c = 0; c < dimensions; ++c)
      for (int a = 0; a < dimensions; ++a, ++at) sum[at] = sum[at] + d[c] * x[a];
  }
  const auto total = simd::sums_of(sum);

  Eigen::Matrix<float, dimensions, dimensions> squares, products;
  int at = 0;
  for (int a = 0; a < dimensions; ++a)
    for (int b = a; b < dimensions; ++b, ++at) squares(a, b) = squares(b, a) = total[at];
  for (int c = 0; c < dimensions; ++c)
    for (int a = 0; a < dimensions; ++a, ++at) products(c, a) = total[at];
  const auto side = static_cast<float>(points.grid.support_radius());
  squares.diagonal().array() += regularisation * count * side * side / 12;
  const Eigen::Matrix<float, dimensions, dimensions> gradient = products * squares.inverse();

  Fit& fit = fit_[slot];
  fit = {};
  for (int a = 0; a < dimensions; ++a) {
    fit.place[a] = middle[a];
    fit.way[a] = mean_way[a];
    fit.extent[a] = simd::largest(farthest[a]);
    for (int c = 0; c < dimensions; ++c) fit.gradient[a][c] = gradient(c, a);
  }
  f32n longest2{};
  for (std::size_t k = 0; k < gathered.whole(); k += pair_lanes) {
    f32n length2{};
    for (int c = 0; c < dimensions; ++c) {
      f32n rest = simd::load<f32n>(gathered.way(c) + k) - mean_way[c];
      for (int a = 0; a < dimensions; ++a)
        rest = rest - gradient(c, a) * (simd::load<f32n>(gathered.place(a) + k) - middle[a]);
      length2 = length2 + rest * rest;
    }
    longest2 = simd::max(longest2, length2);
  }
  fit.place[3] = count;
  fit.extent[3] = std::sqrt(simd::largest(longest2));
}

// How near a pair of points of these blocks may be now that was farther apart than `reach`.
float ListSkin::nearest_of(const Fit* const* fits, std::size_t count, float reach) {
  Fit mean;
  for (std::size_t k = 0; k < count; ++k) {
    const f32x4 weight = splat4(fits[k]->count());
    mean.place += weight * fits[k]->place;
    mean.way += weight * fits[k]->way;
    for (std::size_t a = 0; a < 3; ++a) mean.gradient[a] += weight * fits[k]->gradient[a];
    mean.extent[3] += fits[k]->count();
  }
  const f32x4 share = splat4(1 / mean.extent[3]);
  mean.place *= share;
  mean.way *= share;
  for (f32x4& column : mean.gradient) column *= share;
  float longest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Fit& fit = *fits[k];
    f32x4 aside = fit.way - mean.way, turned{};
    const f32x4 x = fit.place - mean.place;
    for (int a = 0; a < 3; ++a) {
      aside -= splat4(x[a]) * mean.gradient[static_cast<std::size_t>(a)];
      turned += splat4(fit.extent[a]) *
                absolute(fit.gradient[static_cast<std::size_t>(a)] - mean.gradient[static_cast<std::size_t>(a)]);
    }
    longest = std::max(longest, std::sqrt(squared(aside)) + std::sqrt(squared(turned)) + fit.remainder());
  }
  return reach * least_stretch(mean.gradient) - 2 * longest;
}

// Pairs of the blocks around one that touch it, those on its two sides among them; and with blocks two apart that have
// no points between them.
float ListSkin::nearest_around(std::size_t slot, float reach) const {
  const int depth = count_[2] > 1 ? 1 : 0;
  const std::array<int, 3> here = place_of(static_cast<std::size_t>(block_[slot]));
  std::array<const Fit*, 27> around{};
  std::size_t size = 0;
  for (int z = -depth; z <= depth; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if (const Fit* fit = fit_at(here, {x, y, z}); fit != nullptr) around[size++] = fit;
  float nearest = nearest_of(around.data(), size, reach);
  if (size == (depth == 0 ? 9 : 27)) return nearest;
  for (int z = -2 * depth; z <= 2 * depth; ++z)
    for (int y = -2; y <= 2; ++y)
      for (int x = -2; x <= 2; ++x) {
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) < 2) continue;
        const Fit* const other = fit_at(here, {x, y, z});
        if (other == nullptr || fit_at(here, {x / 2, y / 2, z / 2}) != nullptr) continue;
        const std::array<const Fit*, 2> both{&fit_[slot], other};
        nearest = std::min(nearest, nearest_of(both.data(), 2, reach));
      }
  return nearest;
}

double ListSkin::nearest(const Points& points, double longest) {
  const double reach = points.grid.support_radius(), of_far_blocks = 2 * reach - 2 * longest;
  if (!indexed_) find_blocks(points);
  parallel_blocks(block_.size(), blocks_at_a_time, [&](std::size_t, std::size_t first, std::size_t last) {
    thread_local Gathered gathered;  // kept from call to call
    for (std::size_t slot = first; slot < last; ++slot)
      points.grid.dimensions() == 3 ? fit_block<3>(points, slot, gathered) : fit_block<2>(points, slot, gathered);
  });
  const double of_near_blocks = -parallel_max(block_.size(), -of_far_blocks, [&](std::size_t slot) {
    return -double{nearest_around(slot, static_cast<float>(reach))};
  });
  return std::max(of_near_blocks, reach - 2 * longest);
}

double ListSkin::bytes() const {
  return slot_.bytes() + static_cast<double>(block_.capacity() * sizeof(block_[0]) + fit_.capacity() * sizeof(Fit));
}

}  // namespace spume
