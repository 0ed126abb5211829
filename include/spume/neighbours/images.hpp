// SPDX-License-Identifier: MIT
// Periodic and mirror images of particles near the sides of the domain and near solid boxes.
//
// An image is a copy of one particle under reflections and shifts along the axes. Axes are treated one after
// the other, each on the particles and all images made before, which fills edges and corners. Precondition: a periodic
// side is at least one support radius long (one copy on either side suffices).
//
// With solid boxes, walls and boxes are one solid (scene/solid_union.hpp). A particle then has an image for every
// combination of wetted faces, one or two along an axis, within the support radius of it. Around an edge of a solid
// these overlap each other and the liquid beyond: which of them a particle sees tells sees(). Those that are the
// reflection of the liquid point nearest to them fill the solid once: `ImagePath::nearest`.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/sight.hpp"
#include "spume/scene/solid_union.hpp"

namespace spume {

enum class ImageKind { none, periodic, mirror };

struct ImageRules {
  int dimensions = 3;
  std::array<double, 3> lower{}, upper{};           // planes of the sides
  std::array<std::array<ImageKind, 2>, 3> sides{};  // [axis][0 lower, 1 upper]
  std::shared_ptr<const SolidUnion> solids;         // null: no boxes
  bool find_nearest = false;                        // in solids: ImagePath::nearest is wanted
  bool only_nearest = false;                        // in solids: images without it are not made
  // Parts of mirror sides that make no images; null: none.
  std::function<bool(int axis, int side, const Vec3& foot)> open_at;
  double support_radius = 0;  // images farther than this from the liquid are not made
};

// How an image came about: which faces it was reflected in, in order. Few distinct values exist.
struct ImagePath {
  // In a scene with solid boxes, per axis: codes of up to two faces (SolidUnion::face_near), walls included; -1 none.
  using Faces = std::array<std::array<std::int16_t, 2>, 3>;
  Faces face{{{-1, -1}, {-1, -1}, {-1, -1}}};
  std::array<std::int8_t, 3> side{-1, -1, -1};         // then, per axis: -1 none, 0 lower, 1 upper
  bool nearest = true;                                 // false is found on demand: ImageRules::find_nearest
  auto operator<=>(const ImagePath&) const = default;  // NOLINT(modernize-use-nullptr): of the comparison with 0 inside
  // In faces.
  int reflections() const {
    int count = 0;
    for (const auto& along : face)
      for (const std::int16_t one : along) count += one >= 0 ? 1 : 0;
    return count;
  }
};

// Points inside bodies that stand for mirrored liquid, beside the images: periodic and mirror sides have images of them
// as of particles.
struct WallPointView {
  std::size_t size = 0;
  std::array<const double*, 3> position{};
  const std::int32_t* source = nullptr;  // the particle that each stands for where one is asked for
};

class Images {
 public:
  // Remakes all images of the n particles at (x, y, z). Sorted by cell of `grid`. `walls`: null without; not beside
  // solid boxes. `scratch`: where there is memory for the sort, 30 bytes an image; null: it is kept here.
  void build(const ImageRules& rules, const CellGrid& grid, const double* x, const double* y, const double* z,
             std::size_t n, const WallPointView* walls = nullptr, ScratchPool* scratch = nullptr);

  // The same images where the particles have gone since, the sides and the wall points. Precondition: no solid boxes.
  void move(const ImageRules& rules, const std::array<const double*, 3>& position,
            const WallPointView* walls = nullptr);

  std::size_t size() const { return source_.size(); }
  const std::int32_t* source() const { return source_.data(); }
  const double* position(int axis) const { return position_[axis].data(); }
  // The wall point that an image is or mirrors, -1 for those of particles; null without wall points.
  const std::int32_t* wall_point() const { return wall_point_.empty() ? nullptr : wall_point_.data(); }
  // Index into paths(), per image.
  const std::int32_t* path() const { return path_.data(); }
  const std::vector<ImagePath>& paths() const { return paths_; }
  // +1 or -1: whether the path reflects along the axis.
  static int sign(const ImagePath& path, const ImageRules& rules, int axis);
  // Solids, null without. Lists of neighbours then hold what a particle sees.
  const SolidUnion* solids() const { return solids_.get(); }
  // What else hides points from particles, null without; it outlives the images or is taken back. Not beside solids.
  void set_sight(const Sight* sight) { sight_ = sight; }
  const Sight* sight() const { return sight_; }
  // Whether a particle at `place` sees image k of the source at `source`.
  bool sees(const Vec3& place, std::size_t k, const Vec3& source) const;
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
  void add_reflections(const ImageRules& rules, std::size_t n);
  void add_axis_images(const ImageRules& rules, int axis, std::size_t n);
  void add_wall_points(const WallPointView& walls);
  std::int32_t find_path(const ImagePath& path);

  struct Reflected {
    Vec3 place;
    std::int32_t source, path;
  };
  std::array<const double*, 3> particle_{};
  std::vector<std::vector<Reflected>> reflected_;  // of blocks of particles, while images at solids are made
  std::array<Array<double>, 3> position_;
  Array<std::int32_t> source_, path_;
  Array<std::int32_t> wall_point_;  // empty without wall points
  std::vector<ImagePath> paths_;
  std::array<double, 3> image_free_lower_{}, image_free_upper_{};
  bool inside_domain_ = false;
  std::shared_ptr<const SolidUnion> solids_;
  const Sight* sight_ = nullptr;
  std::array<double, 3> period_{};  // of periodic axes
  CellOrder table_;
  ScratchPool own_scratch_;  // of those that are given none
};

}  // namespace spume
