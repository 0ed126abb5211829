// SPDX-License-Identifier: MIT
#include "spume/neighbours/images.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/borrowed_array.hpp"
#include "spume/core/parallel.hpp"

namespace spume {

int Images::sign(const ImagePath& path, const ImageRules& rules, int axis) {
  int sign = 1;
  for (const std::int16_t face : path.face[axis])
    if (face >= 0) sign = -sign;
  const std::int8_t side = path.side[axis];
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
    const auto counter = [&](const std::array<double, 3>&, std::int32_t, std::int32_t, std::int32_t) { ++count; };
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
  const bool walls = !wall_point_.empty();
  if (walls) wall_point_.resize(after);
  parallel_blocks(scanned, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::size_t slot = before + start[b];
    const auto writer = [&](const std::array<double, 3>& position, std::int32_t source, std::int32_t path,
                            std::int32_t wall_point) {
      for (int axis = 0; axis < 3; ++axis) position_[axis][slot] = position[axis];
      if (walls) wall_point_[slot] = wall_point;
      source_[slot] = source;
      path_[slot] = path;
      ++slot;
    };
    for (std::size_t k = first; k < last; ++k) emit(k, writer);
  });
}

namespace {

// What may happen to a coordinate: nothing, a reflection in one plane, or in two that face each other.
struct AxisReflection {
  double coordinate = 0;
  double distance = 0;  // that a ray travels along the axis at least
  std::array<std::int16_t, 2> face{-1, -1};
};
// A support radius meets few planes: more than these are beyond what particles resolve.
using AxisReflections = std::array<AxisReflection, 48>;

std::size_t axis_reflections(const SolidUnion& solids, const Vec3& r, int axis, double reach, AxisReflections& out) {
  std::size_t size = 0;
  out[size++] = {r[axis], 0, {-1, -1}};
  const std::vector<double>& planes = solids.planes(axis);
  auto plane =
      static_cast<std::size_t>(std::lower_bound(planes.begin(), planes.end(), r[axis] - reach) - planes.begin());
  std::array<double, 16> at{};
  for (; plane < planes.size() && planes[plane] < r[axis] + reach && size <= at.size(); ++plane) {
    const int face = solids.face_near(r, axis, plane, reach);
    if (face < 0) continue;
    at[size - 1] = planes[plane];
    out[size++] = {
        2 * planes[plane] - r[axis], std::abs(planes[plane] - r[axis]), {static_cast<std::int16_t>(face), -1}};
  }
  const std::size_t single = size;
  for (std::size_t p = 1; p < single; ++p)
    for (std::size_t q = 1; q < single && size < out.size(); ++q) {
      const double gap = at[q - 1] - at[p - 1];
      if ((at[p - 1] - r[axis]) * (at[q - 1] - r[axis]) >= 0 || std::abs(gap) >= reach) continue;
      // From the face that the ray meets last before the image.
      const double image = r[axis] + 2 * gap;
      out[size++] = {image, std::abs(image - at[q - 1]), {out[p].face[0], out[q].face[0]}};
    }
  return size;
}

}  // namespace

void Images::add_reflections(const ImageRules& rules, std::size_t n) {
  const SolidUnion& solids = *rules.solids;
  const double reach = rules.support_radius;
  const bool find_nearest = rules.find_nearest || rules.only_nearest;
  // Of two faces equally near up to rounding one owns an image: a lattice beside a box has many such points.
  const double tie = 1e-6 * reach;
  const auto each = [&](std::size_t k, auto&& sink) {
    Vec3 r{};
    for (int axis = 0; axis < rules.dimensions; ++axis) r[axis] = particle_[axis][k];
    if (solids.clear_around(r, reach)) return;
    std::array<AxisReflections, 3> along;
    std::array<std::size_t, 3> size{1, 1, 1};
    for (int axis = 0; axis < rules.dimensions; ++axis)
      size[axis] = axis_reflections(solids, r, axis, reach, along[axis]);
    for (std::size_t combination = 1; combination < size[0] * size[1] * size[2]; ++combination) {
      const std::array<std::size_t, 3> pick{combination % size[0], combination / size[0] % size[1],
                                            combination / size[0] / size[1]};
      ImagePath path;
      Vec3 image{}, foot{};
      double distance2 = 0;
      for (int axis = 0; axis < rules.dimensions; ++axis) {
        const AxisReflection& one = along[axis][pick[axis]];
        image[axis] = one.coordinate;
        foot[axis] = 0.5 * (one.coordinate + r[axis]);
        distance2 += one.distance * one.distance;
        path.face[axis] = one.face;
        path.nearest = path.nearest && one.face[1] < 0;
      }
      if (distance2 >= reach * reach) continue;
      if (path.nearest && find_nearest) {
        const Vec3 nearest = solids.nearest_free(image, tie);
        for (int axis = 0; axis < rules.dimensions; ++axis)
          path.nearest = path.nearest && std::abs(nearest[axis] - foot[axis]) <= tie;
        path.nearest = path.nearest && solids.inside(image);
      }
      if (path.nearest || !rules.only_nearest) sink(image, static_cast<std::int32_t>(k), path);
    }
  };
  // Blocks of particles, each with the paths that it found: which of all they are is known at the end.
  std::vector<std::vector<ImagePath>> of_block(max_reduction_blocks);
  reflected_.resize(max_reduction_blocks);
  const std::size_t block = std::max<std::size_t>(1024, (n + max_reduction_blocks - 1) / max_reduction_blocks);
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::vector<ImagePath>& own = of_block[b];
    reflected_[b].clear();
    for (std::size_t k = first; k < last; ++k)
      each(k, [&](const Vec3& place, std::int32_t source, const ImagePath& path) {
        const auto known = std::find(own.begin(), own.end(), path);
        reflected_[b].push_back({place, source, static_cast<std::int32_t>(known - own.begin())});
        if (known == own.end()) own.push_back(path);
      });
  });
  for (const auto& own : of_block) paths_.insert(paths_.end(), own.begin(), own.end());
  std::sort(paths_.begin(), paths_.end());
  paths_.erase(std::unique(paths_.begin(), paths_.end()), paths_.end());
  std::array<std::size_t, max_reduction_blocks + 1> start{};
  const std::size_t blocks = block_count(n, block);
  for (std::size_t b = 0; b < blocks; ++b) start[b + 1] = start[b] + reflected_[b].size();
  for (auto& axis : position_) axis.resize(start[blocks]);
  source_.resize(start[blocks]);
  path_.resize(start[blocks]);
  parallel_blocks(n, block, [&](std::size_t b, std::size_t, std::size_t) {
    std::vector<std::int32_t> number;  // of the paths of the block among all
    for (const ImagePath& path : of_block[b])
      number.push_back(
          static_cast<std::int32_t>(std::lower_bound(paths_.begin(), paths_.end(), path) - paths_.begin()));
    std::size_t slot = start[b];
    for (const Reflected& one : reflected_[b]) {
      for (std::size_t axis = 0; axis < 3; ++axis) position_[axis][slot] = one.place[axis];
      source_[slot] = one.source;
      path_[slot++] = number[static_cast<std::size_t>(one.path)];
    }
  });
}

bool Images::sees(const Vec3& place, std::size_t k, const Vec3& source) const {
  const ImagePath& path = paths_[static_cast<std::size_t>(path_[k])];
  Vec3 image{}, at = source;
  for (int axis = 0; axis < 3; ++axis) {
    image[axis] = position_[axis][k];
    if (path.side[axis] >= 0) at[axis] += path.side[axis] == 0 ? -period_[axis] : period_[axis];
  }
  return solids_->sees(place, image, at);
}

void Images::add_axis_images(const ImageRules& rules, int axis, std::size_t n) {
  const double length = rules.upper[axis] - rules.lower[axis];
  std::array<ImageKind, 2> made_here = rules.sides[axis];
  if (rules.solids != nullptr)
    for (ImageKind& one : made_here)
      if (one == ImageKind::mirror) one = ImageKind::none;  // made with the solids
  const std::array<ImageKind, 2> kind = made_here;
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
  const std::array<double, 2> planes{rules.lower[axis], rules.upper[axis]};
  const double reach = rules.support_radius;
  // Without openings no call of `open_at` is in the loop, across which the compiler would keep nothing in registers.
  const auto stage = [&](auto openings) {
    append_stage(n + made, [&, axis, length, kind, planes, reach, n](std::size_t k, auto& sink) {
      const bool particle = k < n;
      const double x = particle ? particle_[axis][k] : position_[axis][k - n];
      for (int side = 0; side < 2; ++side) {
        if (kind[side] == ImageKind::none) continue;
        const double plane = planes[side];
        const double depth = side == 0 ? x - plane : plane - x;
        double image = 0;
        if (kind[side] == ImageKind::mirror) {
          // A particle a little outside a wall still gets its image: the pair then pushes it back.
          if (depth >= reach) continue;
          image = 2 * plane - x;
        } else {
          // A copy beyond `side` comes from particles near the opposite side.
          const double to_opposite = length - depth;
          if (to_opposite >= reach) continue;
          image = side == 0 ? x - length : x + length;
        }
        std::array<double, 3> r{};
        for (int a = 0; a < rules.dimensions; ++a) r[a] = particle ? particle_[a][k] : position_[a][k - n];
        if constexpr (openings) {
          if (kind[side] == ImageKind::mirror) {
            std::array<double, 3> foot = r;
            foot[axis] = plane;
            if (rules.open_at(axis, side, foot)) continue;
          }
        }
        r[axis] = image;
        const std::int32_t source = particle ? static_cast<std::int32_t>(k) : source_[k - n];
        const std::size_t row = particle ? 0 : static_cast<std::size_t>(path_[k - n]) + 1;
        sink(r, source, next[row][side], particle || wall_point_.empty() ? -1 : wall_point_[k - n]);
      }
    });
  };
  if (rules.open_at)
    stage(std::true_type{});
  else
    stage(std::false_type{});
}

void Images::add_wall_points(const WallPointView& walls) {
  const std::int32_t path = find_path({});
  for (auto& axis : position_) axis.resize(walls.size);
  source_.resize(walls.size);
  path_.resize(walls.size);
  wall_point_.resize(walls.size);
  parallel_for(walls.size, [&](std::size_t g) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      position_[axis][g] = walls.position[axis] == nullptr ? 0 : walls.position[axis][g];
    source_[g] = walls.source[g];
    path_[g] = path;
    wall_point_[g] = static_cast<std::int32_t>(g);
  });
}

void Images::build(const ImageRules& rules, const CellGrid& grid, const double* x, const double* y, const double* z,
                   std::size_t n, const WallPointView* walls, ScratchPool* scratch) {
  particle_ = {x, y, z};
  solids_ = rules.solids;
  inside_domain_ = solids_ != nullptr || walls != nullptr;
  for (int axis = 0; axis < 3; ++axis) period_[axis] = rules.upper[axis] - rules.lower[axis];
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double everywhere = std::numeric_limits<double>::infinity();
    image_free_lower_[axis] = rules.sides[axis][0] == ImageKind::none ? -everywhere : rules.lower[axis];
    image_free_upper_[axis] = rules.sides[axis][1] == ImageKind::none ? everywhere : rules.upper[axis];
  }
  for (auto& axis : position_) axis.resize(0);
  source_.resize(0);
  path_.resize(0);
  if (solids_ != nullptr) paths_.clear();  // remade, as their numbers are their order
  if (solids_ != nullptr) add_reflections(rules, n);
  wall_point_.resize(0);
  if (walls != nullptr) add_wall_points(*walls);
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
  // Numbers of 8 bytes take two floats: fields of particles, which trade their memory with the pool, keep their size.
  ScratchPool& pool = scratch == nullptr || 2 * m > n ? own_scratch_ : *scratch;
  const BorrowedArray<std::int32_t> sorted(pool, m);
  table_.build(grid, position_[0].data(), position_[1].data(), rules.dimensions == 3 ? position_[2].data() : nullptr, m,
               pool, sorted.data());
  const std::int32_t* order = sorted.data();
  const auto reorder = [&]<class T>(Array<T>& values) {
    const BorrowedArray<T> moved(pool, m);
    T *const from = values.data(), *const to = moved.data();
    parallel_for(m, [=](std::size_t k) { to[k] = from[order[k]]; });
    parallel_for(m, [=](std::size_t k) { from[k] = to[k]; });
  };
  for (int axis = 0; axis < 3; ++axis) reorder(position_[axis]);
  reorder(source_);
  reorder(path_);
  if (!wall_point_.empty()) reorder(wall_point_);
}

void Images::move(const ImageRules& rules, const std::array<const double*, 3>& position, const WallPointView* walls) {
  // Along every axis a path is x -> sign x + shift: a table of both, since sides, which differ from image to image, are
  // no branches that a processor foresees.
  struct Change {
    double sign, shift;
  };
  std::vector<Change> changes(paths_.size());
  for (int axis = 0; axis < rules.dimensions; ++axis) {
    const double lower = rules.lower[axis], upper = rules.upper[axis];
    for (std::size_t p = 0; p < paths_.size(); ++p) {
      const std::int8_t side = paths_[p].side[axis];
      if (side < 0)
        changes[p] = {1, 0};
      else if (rules.sides[axis][side] == ImageKind::mirror)
        changes[p] = {-1, 2 * (side == 0 ? lower : upper)};
      else
        changes[p] = {1, side == 0 ? lower - upper : upper - lower};
    }
    const double* const from = position[axis];
    double* const to = position_[axis].data();
    const Change* const change = changes.data();
    const auto* const source = source_.data();
    const auto* const path = path_.data();
    if (walls == nullptr) {
      parallel_for(source_.size(), [=](std::size_t k) {
        const Change& along = change[path[k]];
        to[k] = along.sign * from[source[k]] + along.shift;
      });
      continue;
    }
    const auto* const point = wall_point_.data();
    const auto* const wall = walls->position[axis];
    parallel_for(source_.size(), [=](std::size_t k) {
      const Change& along = change[path[k]];
      to[k] = along.sign * (point[k] >= 0 ? wall[point[k]] : from[source[k]]) + along.shift;
    });
  }
}

double Images::bytes() const {
  double total = table_.bytes() + own_scratch_.idle_bytes() + source_.bytes() + path_.bytes() + wall_point_.bytes();
  for (const auto& axis : position_) total += axis.bytes();
  for (const auto& block : reflected_) total += static_cast<double>(sizeof(Reflected) * block.capacity());
  return total;
}

}  // namespace spume
