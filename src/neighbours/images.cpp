// SPDX-License-Identifier: MIT
#include "spume/neighbours/images.hpp"

#include <algorithm>
#include <limits>

#include "spume/core/parallel.hpp"

namespace spume {

int Images::sign(const ImagePath& path, const ImageRules& rules, int axis) {
  int sign = 1;
  if (path.box_face >= 0 && (path.box_face % 6) / 2 == axis) sign = -sign;
  const int side = path.side[axis];
  if (side >= 0 && rules.sides[axis][side] == ImageKind::mirror) sign = -sign;
  return sign;
}

std::int32_t Images::find_path(const ImagePath& path) {
  for (std::size_t p = 0; p < paths_.size(); ++p)
    if (paths_[p] == path) return static_cast<std::int32_t>(p);
  paths_.push_back(path);
  return static_cast<std::int32_t>(paths_.size() - 1);
}

// Appends what emit(k, sink) hands to sink(position, source, path) for every k in [0, scanned), in order of k:
// blocks are counted first, then filled.
template <class Emit>
void Images::append_stage(std::size_t scanned, Emit&& emit) {
  const std::size_t block = std::max<std::size_t>(1024, (scanned + max_reduction_blocks - 1) / max_reduction_blocks);
  std::array<std::size_t, max_reduction_blocks + 1> start{};
  parallel_blocks(scanned, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::size_t count = 0;
    const auto counter = [&](const std::array<double, 3>&, std::int32_t, std::int32_t) { ++count; };
    for (std::size_t k = first; k < last; ++k) emit(k, counter);
    start[b + 1] = count;
  });
  for (std::size_t b = 0; b < block_count(scanned, block); ++b) start[b + 1] += start[b];
  const std::size_t before = source_.size();
  const std::size_t after = before + start[block_count(scanned, block)];
  if (after == before) return;
  for (auto& axis : position_) axis.resize(after);
  source_.resize(after);
  path_.resize(after);
  parallel_blocks(scanned, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::size_t slot = before + start[b];
    const auto writer = [&](const std::array<double, 3>& position, std::int32_t source, std::int32_t path) {
      for (int axis = 0; axis < 3; ++axis) position_[axis][slot] = position[axis];
      source_[slot] = source;
      path_[slot] = path;
      ++slot;
    };
    for (std::size_t k = first; k < last; ++k) emit(k, writer);
  });
}

void Images::add_box_images(const ImageRules& rules, std::size_t n) {
  const int dimensions = rules.dimensions;
  for (std::size_t b = 0; b < rules.boxes.size(); ++b) {
    const ImageRules::Box& box = rules.boxes[b];
    std::array<std::array<std::int32_t, 2>, 3> path{};
    for (int axis = 0; axis < dimensions; ++axis)
      for (int side = 0; side < 2; ++side) {
        ImagePath p;
        p.box_face = static_cast<std::int16_t>(6 * b + 2 * axis + side);
        path[axis][side] = find_path(p);
      }
    // Of two faces equally near up to rounding the earlier one owns an image: a lattice beside a box has many such
    // points, and each must be filled once.
    const double tie = 1e-6 * rules.support_radius;
    // Depth of a point below a face of the box; faces that bound no liquid never are the nearest.
    const auto depth = [&](const std::array<double, 3>& r, int axis, int side) {
      if (!box.face[axis][side]) return std::numeric_limits<double>::infinity();
      return side == 0 ? r[axis] - box.lower[axis] : box.upper[axis] - r[axis];
    };
    append_stage(n, [&](std::size_t k, auto& sink) {
      std::array<double, 3> r{};
      for (int axis = 0; axis < dimensions; ++axis) {
        r[axis] = particle_[axis][k];
        if (r[axis] < box.lower[axis] - rules.support_radius || r[axis] > box.upper[axis] + rules.support_radius)
          return;
      }
      for (int axis = 0; axis < dimensions; ++axis)
        for (int side = 0; side < 2; ++side) {
          if (!box.face[axis][side]) continue;
          const double plane = side == 0 ? box.lower[axis] : box.upper[axis];
          const double distance = side == 0 ? plane - r[axis] : r[axis] - plane;
          if (distance < 0 || distance >= rules.support_radius) continue;
          std::array<double, 3> image = r;
          image[axis] = 2 * plane - r[axis];
          bool nearest = true;
          for (int a = 0; a < dimensions && nearest; ++a)
            for (int s = 0; s < 2; ++s) {
              const double other = depth(image, a, s);
              const bool earlier = 2 * a + s < 2 * axis + side;
              const bool same = a == axis && s == side;
              if (other < 0 || (!same && other < distance + (earlier ? tie : -tie))) nearest = false;
            }
          if (nearest) sink(image, static_cast<std::int32_t>(k), path[axis][side]);
        }
    });
  }
}

void Images::add_axis_images(const ImageRules& rules, int axis, std::size_t n) {
  const double length = rules.upper[axis] - rules.lower[axis];
  const std::array<ImageKind, 2> kind = rules.sides[axis];
  if (kind[0] == ImageKind::none && kind[1] == ImageKind::none) return;

  // Paths of this stage for every path made so far: [old path + 1][side]; row 0 is the particle itself.
  const std::size_t known = paths_.size();
  std::vector<std::array<std::int32_t, 2>> next(known + 1);
  for (std::size_t p = 0; p <= known; ++p)
    for (int side = 0; side < 2; ++side) {
      ImagePath path = p == 0 ? ImagePath{} : paths_[p - 1];
      path.side[axis] = static_cast<std::int8_t>(side);
      next[p][side] = find_path(path);
    }

  const std::size_t made = source_.size();
  append_stage(n + made, [&](std::size_t k, auto& sink) {
    const bool particle = k < n;
    const double x = particle ? particle_[axis][k] : position_[axis][k - n];
    for (int side = 0; side < 2; ++side) {
      if (kind[side] == ImageKind::none) continue;
      const double plane = side == 0 ? rules.lower[axis] : rules.upper[axis];
      const double depth = side == 0 ? x - plane : plane - x;
      // A particle a little outside a wall still gets its image: the pair then pushes it back.
      if (kind[side] == ImageKind::mirror ? depth >= rules.support_radius : false) continue;
      double image = 0;
      if (kind[side] == ImageKind::mirror) {
        image = 2 * plane - x;
      } else {
        // A copy beyond `side` comes from particles near the opposite side.
        const double to_opposite = length - depth;
        if (to_opposite >= rules.support_radius) continue;
        image = side == 0 ? x - length : x + length;
      }
      std::array<double, 3> r{};
      for (int a = 0; a < rules.dimensions; ++a) r[a] = particle ? particle_[a][k] : position_[a][k - n];
      r[axis] = image;
      const std::int32_t source = particle ? static_cast<std::int32_t>(k) : source_[k - n];
      const std::size_t row = particle ? 0 : static_cast<std::size_t>(path_[k - n]) + 1;
      sink(r, source, next[row][side]);
    }
  });
}

void Images::build(const ImageRules& rules, const CellGrid& grid, const double* x, const double* y, const double* z,
                   std::size_t n) {
  particle_ = {x, y, z};
  inside_domain_ = !rules.boxes.empty();
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double everywhere = std::numeric_limits<double>::infinity();
    image_free_lower_[axis] = rules.sides[axis][0] == ImageKind::none ? -everywhere : rules.lower[axis];
    image_free_upper_[axis] = rules.sides[axis][1] == ImageKind::none ? everywhere : rules.upper[axis];
  }
  for (auto& axis : position_) axis.resize(0);
  source_.resize(0);
  path_.resize(0);
  add_box_images(rules, n);
  for (int axis = 0; axis < rules.dimensions; ++axis) add_axis_images(rules, axis, n);

  const std::size_t m = source_.size();
  // A particle outside a mirror side has its image inside.
  for (int axis = 0; axis < rules.dimensions; ++axis)
    for (int side = 0; side < 2; ++side) {
      if (rules.sides[axis][side] != ImageKind::mirror) continue;
      const double plane = side == 0 ? rules.lower[axis] : rules.upper[axis];
      const double depth = parallel_max(m, 0.0, [&](std::size_t k) {
        if (paths_[static_cast<std::size_t>(path_[k])].side[axis] != side) return 0.0;
        return side == 0 ? position_[axis][k] - plane : plane - position_[axis][k];
      });
      (side == 0 ? image_free_lower_ : image_free_upper_)[axis] = side == 0 ? plane + depth : plane - depth;
    }
  table_.build(grid, position_[0].data(), position_[1].data(), rules.dimensions == 3 ? position_[2].data() : nullptr,
               m);
  const std::int32_t* order = table_.order().data();
  const auto reorder = [&](auto& values, auto& scratch) {
    scratch.resize(m);
    const auto* from = values.data();
    auto* to = scratch.data();
    parallel_for(m, [=](std::size_t k) { to[k] = from[order[k]]; });
    values.swap(scratch);
  };
  for (int axis = 0; axis < 3; ++axis) reorder(position_[axis], scratch_position_[axis]);
  reorder(source_, scratch_);
  reorder(path_, scratch_);
}

double Images::bytes() const {
  double total =
      table_.bytes() + 4.0 * static_cast<double>(source_.capacity() + path_.capacity() + scratch_.capacity());
  for (int axis = 0; axis < 3; ++axis)
    total += 8.0 * static_cast<double>(position_[axis].capacity() + scratch_position_[axis].capacity());
  return total;
}

}  // namespace spume
