// SPDX-License-Identifier: MIT
// Periodic and mirror images of particles near the sides of the domain and near solid boxes.
//
// An image is a copy of one particle under reflections and shifts along the axes. Axes are treated one after
// the other, each on the particles and all images made before, which fills edges and corners. Solid boxes
// come first: a particle is mirrored in a face when the image lies inside the box and that face is the
// nearest one to the image, so that the box is filled once, also at its edges. Precondition: a periodic side is at
// least one support radius long (one copy on either side suffices).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"

namespace spume {

enum class ImageKind { none, periodic, mirror };

struct ImageRules {
  int dimensions = 3;
  std::array<double, 3> lower{}, upper{};           // planes of the sides
  std::array<std::array<ImageKind, 2>, 3> sides{};  // [axis][0 lower, 1 upper]
  struct Box {
    std::array<double, 3> lower{}, upper{};
    std::array<std::array<bool, 2>, 3> face{};  // faces that bound liquid
  };
  std::vector<Box> boxes;
  double support_radius = 0;  // images farther than this from the liquid are not made
};

// How an image came about: which faces it was reflected in, in order. Few distinct values exist.
struct ImagePath {
  std::int16_t box_face = -1;                   // 6 box + 2 axis + side, or -1
  std::array<std::int8_t, 3> side{-1, -1, -1};  // per axis: -1 none, 0 lower, 1 upper
  bool operator==(const ImagePath&) const = default;
};

class Images {
 public:
  // Remakes all images of the n particles at (x, y, z). Sorted by cell of `grid`.
  void build(const ImageRules& rules, const CellGrid& grid, const double* x, const double* y, const double* z,
             std::size_t n);

  std::size_t size() const { return source_.size(); }
  const std::int32_t* source() const { return source_.data(); }
  const double* position(int axis) const { return position_[axis].data(); }
  // Index into paths(), per image.
  const std::int32_t* path() const { return path_.data(); }
  const std::vector<ImagePath>& paths() const { return paths_; }
  // +1 or -1: whether the path reflects along the axis.
  static int sign(const ImagePath& path, const ImageRules& rules, int axis);
  // Every image lies outside the box [image_free_lower, image_free_upper], unless inside_domain(): solid boxes
  // have images anywhere.
  double image_free_lower(int axis) const { return image_free_lower_[axis]; }
  double image_free_upper(int axis) const { return image_free_upper_[axis]; }
  bool inside_domain() const { return inside_domain_; }
  const CellOrder& table() const { return table_; }
  double bytes() const;

 private:
  template <class Emit>
  void append_stage(std::size_t scanned, Emit&& emit);
  void add_box_images(const ImageRules& rules, std::size_t n);
  void add_axis_images(const ImageRules& rules, int axis, std::size_t n);
  std::int32_t find_path(const ImagePath& path);

  std::array<const double*, 3> particle_{};
  std::array<Array<double>, 3> position_, scratch_position_;
  Array<std::int32_t> source_, path_, scratch_;
  std::vector<ImagePath> paths_;
  std::array<double, 3> image_free_lower_{}, image_free_upper_{};
  bool inside_domain_ = false;
  CellOrder table_;
};

}  // namespace spume
