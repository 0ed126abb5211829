// SPDX-License-Identifier: MIT
// Fills regions with particles, column by column: what fill.cpp and fill_columns.cpp share.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "fill.hpp"
#include "region_fit.hpp"
#include "spume/core/parallel.hpp"

namespace spume {

// Tells the inside of a body. Within its distance around a place the body has no surface: only places further away
// are asked for, which are few along a column. Of a mesh of 1e5 triangles a question takes 3 to 13 us.
class BodySide {
 public:
  explicit BodySide(const Shape* body) : body_(body) {}
  bool inside(const Vec3& p) {
    const double way = std::hypot(p[0] - place_[0], p[1] - place_[1], p[2] - place_[2]);
    if (!(way < std::abs(distance_))) {
      const double distance = body_->distance(p);
      place_ = p;
      // Interpolated distances are off, and may change by more than the way.
      distance_ = std::copysign(body_->error() > 0 ? 0 : (1 - 1e-6) * std::abs(distance), distance);
    }
    return std::signbit(distance_);
  }

 private:
  const Shape* body_;
  Vec3 place_{};
  double distance_ = 0;
};

// The distance from the walls of bodies, as far as it says whether a cell of the lattice is cut by them: farther away
// only its sign is right. Asked along columns, most questions do not reach the bodies.
class WallDistance {
 public:
  WallDistance(const Combination* walls, double error, double enough) : walls_(walls), error_(error), enough_(enough) {}
  double at(const Vec3& p) {
    const double way = std::hypot(p[0] - place_[0], p[1] - place_[1], p[2] - place_[2]);
    const double left = std::abs(distance_) - way - error_;
    if (left > enough_) return std::copysign(left, distance_);
    place_ = p;
    return distance_ = walls_->distance(p);
  }

 private:
  const Combination* walls_;
  double error_, enough_;
  Vec3 place_{};
  double distance_ = 0;
};

// One thread's own copies of the expressions of all regions, and what it knows of their bodies.
struct ThreadRegions {
  std::vector<std::unique_ptr<Expression>> where;
  std::vector<VectorExpression> velocity;
  std::vector<BodySide> body;
  WallDistance walls;
  ThreadRegions(const std::vector<LiquidRegion>& regions, const WallDistance& distance) : walls(distance) {
    for (const LiquidRegion& region : regions) {
      where.push_back(region.where ? region.where->clone() : nullptr);
      velocity.push_back(region.velocity.clone());
      body.emplace_back(region.body.get());
    }
  }
};

struct Finding {
  std::size_t count = 0;
  Vec3 first{};
  void add(const Vec3& place, std::size_t more = 1) {
    if (count == 0) first = place;
    count += more;
  }
};

// What one block of columns found, merged in block order.
struct Chunk {
  std::vector<double> position[3];
  double volume = 0;                       // of the region, in cells of the lattice
  double cells = 0, open_cells = 0;        // of the region, and their parts outside the walls of bodies
  std::map<std::size_t, Finding> overlap;  // by the other region
  Finding not_finite, beyond_top, in_solid, replaced;
};

// Cells that differ from the lattice: those between two faces in width, or the few layers above a solid in volume.
struct CellMisfit {
  double excess = 0;  // over what still water bears (cell_warnings.cpp)
  std::size_t region = 0, axis = 0;
  double lower = 0, upper = 0;  // the faces, or the ends of the liquid
  double fits = 0, cells = 0;   // cells of the lattice between them, and those that were made
  Vec3 place{};                 // in their middle
};

class Filler {
 public:
  Filler(Scene& scene, const Lattice& lattice, const std::vector<LiquidRegion>& regions, double most,
         Problems& problems)
      : scene_(scene),
        lattice_(lattice),
        regions_(regions),
        most_(most),
        problems_(problems),
        threads_(static_cast<std::size_t>(thread_count())) {
    SolidUnion::Planes sides{};
    for (int axis = 0; axis < scene.domain.dimensions; ++axis)
      sides[axis] = {scene.domain.lower[axis], scene.domain.upper[axis]};
    if (!scene.domain.boxes.empty()) solids_ = std::make_unique<SolidUnion>(scene.domain, sides, scene.spacing);
  }

  // False when there are more than allowed: what was found until then is dropped.
  bool place_particles() {
    std::vector<std::vector<Chunk>> chunks;
    find_columns();
    if (layered() && !scene_.walls.empty()) choose_sites_beside_walls();
    for (std::size_t r = 0; r < regions_.size(); ++r) chunks.push_back(fill_region(r));
    if (too_many()) return false;
    report(chunks);
    gather(chunks);
    // Bodies that move open pools.
    if (!layered() && !scene_.walls.empty() && scene_.motions.empty()) leave_out_small_pools();
    return true;
  }

  // Without any particle: the cells beside solid boxes that differ most, in volume or also in width; and the columns
  // that there are.
  CellMisfit largest_misfit(bool widths) {
    compares_widths_ = widths;
    find_columns();
    return misfit_;
  }
  std::size_t columns() const {
    std::size_t sum = 0;
    for (const auto& of_region : columns_) sum += of_region.size();
    return sum;
  }

  void jitter(double fraction);
  void set_velocities();
  bool fills_domain() const;

 private:
  bool behind_walls(std::size_t axis, int side) const;
  double open_volume() const;
  WallDistance wall_distance() const {
    double error = 0;
    for (const Body& body : scene_.bodies)
      if (body.solid) error = std::max(error, body.solid->error());
    return {&scene_.walls, error, scene_.spacing};
  }

  // Regions of phases lie on each other, the later above.
  bool layered() const { return regions_.front().phase >= 0; }

  bool too_many() const { return static_cast<double>(found_.load()) > most_; }

  ThreadRegions& own() {
    auto& regions = threads_[static_cast<std::size_t>(omp_get_thread_num())];
    if (!regions) regions = std::make_unique<ThreadRegions>(regions_, wall_distance());
    return *regions;
  }

  double centre(std::size_t axis, double k) const { return lattice_.origin[axis] + (k + 0.5) * lattice_.spacing[axis]; }

  bool in_shapes(ThreadRegions& own, std::size_t r, const Vec3& p) const {
    const LiquidRegion& region = regions_[r];
    double distance = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
      // Half-open, so that regions that share a face share no particle; the slack keeps a face that falls on
      // cell centres from splitting a layer by rounding.
      const double slack = 1e-9 * lattice_.spacing[a];
      if (p[a] < region.lower[a] - slack || p[a] >= region.upper[a] - slack) return false;
      distance += (p[a] - region.centre[a]) * (p[a] - region.centre[a]);
    }
    if (region.ball && !(distance < region.radius * region.radius)) return false;
    return !region.body || own.body[r].inside(p);
  }

  bool contains(ThreadRegions& own, std::size_t r, const Vec3& p, Chunk& chunk) const {
    if (!in_shapes(own, r, p)) return false;
    if (!own.where[r]) return true;
    const double value = (*own.where[r])(p[0], p[1], p[2], 0);
    if (!std::isfinite(value)) chunk.not_finite.add(p);
    return std::isfinite(value) && value > 0;
  }

  // The same of another region, which reports its own faults.
  bool covers(ThreadRegions& own, std::size_t r, const Vec3& p) const {
    if (!in_shapes(own, r, p)) return false;
    if (!own.where[r]) return true;
    const double value = (*own.where[r])(p[0], p[1], p[2], 0);
    return std::isfinite(value) && value > 0;
  }

  // Whether a later region of a phase lies there.
  bool is_replaced(ThreadRegions& own, std::size_t r, const Vec3& p) const {
    for (std::size_t q = r + 1; q < regions_.size() && layered(); ++q)
      if (covers(own, q, p)) return true;
    return false;
  }

  bool in_solid(const Vec3& p) const {
    for (const SolidBox& box : scene_.domain.boxes) {
      bool inside = true;
      for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) {
        inside = inside && p[a] >= box.lower[a] && p[a] <= box.upper[a];
      }
      if (inside) return true;
    }
    return false;
  }

  void accept(ThreadRegions& own, std::size_t r, const Vec3& p, Chunk& chunk) const {
    if (in_solid(p)) {
      chunk.in_solid.add(p);
      return;
    }
    if (!scene_.walls.empty()) {
      // Regions on sites of the lattice have taken the walls into their volume.
      if (is_box(regions_[r]) || regions_[r].conform) {
        chunk.cells += 1;
        chunk.open_cells += open_part(own, p);
      }
    }
    if (!is_open_site(own, p)) {
      chunk.in_solid.add(p);
      return;
    }
    if (is_replaced(own, r, p)) {
      chunk.replaced.add(p);
      return;
    }
    for (std::size_t q = 0; q < regions_.size() && !layered(); ++q) {
      // Lattice regions share sites, so one direction suffices; a conforming one has its own places.
      if (q == r || (q > r && regions_[q].conform == regions_[r].conform)) continue;
      if (covers(own, q, p)) chunk.overlap[q].add(p);
    }
    for (std::size_t a = 0; a < static_cast<std::size_t>(lattice_.dimensions); ++a) chunk.position[a].push_back(p[a]);
  }

  // Indices of cells whose centres may lie in the region's box.
  std::pair<double, double> index_range(const LiquidRegion& region, std::size_t axis) const {
    double low = region.lower[axis], high = region.upper[axis];
    if (region.ball) {
      low = std::max(low, region.centre[axis] - region.radius);
      high = std::min(high, region.centre[axis] + region.radius);
    }
    const double first = std::floor((low - lattice_.origin[axis]) / lattice_.spacing[axis] - 0.5);
    const double last = std::ceil((high - lattice_.origin[axis]) / lattice_.spacing[axis] + 0.5);
    return {std::clamp(first, 0.0, lattice_.count[axis]), std::clamp(last, 0.0, lattice_.count[axis])};
  }

  // A box filled with columns of its own; regions cut by a ball, a body or an expression take sites of the lattice.
  bool is_box(const LiquidRegion& region) const { return !region.ball && !region.body && !region.where && !layered(); }
  bool lies_in_solids(const LiquidRegion& region) const {
    return is_box(region) && solids_ != nullptr && solids_->free_volume(region.lower, region.upper) == 0;
  }
  // Ends of the columns of a box, in the domain.
  double lower_of(std::size_t r) const {
    const auto up = static_cast<std::size_t>(lattice_.dimensions) - 1;
    return std::max(regions_[r].lower[up], scene_.domain.lower[up]);
  }
  double upper_of(std::size_t r) const {
    const auto up = static_cast<std::size_t>(lattice_.dimensions) - 1;
    return std::min(regions_[r].upper[up], scene_.domain.upper[up]);
  }
  // Cells that the columns of a region stand on, those of the lattice's order.
  void add_columns(std::size_t r, double bottom, double top, std::vector<ColumnCell>& columns);
  void compare_width(std::size_t r, const CellRun& run, std::size_t axis, const Vec3& middle);
  void compare_depths(std::size_t r, const CellRun& run, double row_lower, double row_upper, double area, double bottom,
                      double top);
  void compare_depth(std::size_t r, const ColumnCell& cell);
  std::vector<CellRun> runs_of(std::size_t r, std::size_t axis, const Vec3& lower, const Vec3& upper,
                               const Vec3& row_lower, const Vec3& row_upper) const;
  void find_columns();
  std::vector<Chunk> fill_region(std::size_t r);
  std::vector<ColumnPart> parts_of(const ColumnCell& cell, std::size_t r) const;
  void box_column(ThreadRegions& own, std::size_t r, const ColumnCell& cell, Chunk& chunk) const;
  void conform_column(ThreadRegions& own, std::size_t r, Vec3 p, double area, Chunk& chunk) const;
  void site_column(ThreadRegions& own, std::size_t r, Vec3 p, double area, Chunk& chunk) const;
  double part_of_cell(ThreadRegions& own, std::size_t r, const Vec3& p, Chunk& chunk) const;
  double open_part(ThreadRegions& own, const Vec3& p) const;
  template <class Inside>
  double share_of_cell(const Vec3& p, Inside&& inside) const;
  // fill_beside_bodies.cpp
  bool is_cut(ThreadRegions& own, const Vec3& p) const;
  bool is_in_slot(const Vec3& p) const;
  double rank_of_site(ThreadRegions& own, const Vec3& p) const;
  void choose_sites_beside_walls();
  bool is_open_site(ThreadRegions& own, const Vec3& p) const;
  // fill_pools.cpp
  bool is_open_way(const Vec3& from, const Vec3& to) const;
  bool is_bare(const Vec3& from, const Vec3& to, const std::vector<Vec3>& pool) const;
  bool is_closed(const std::vector<Vec3>& pool) const;
  void leave_out_small_pools();
  void take_out(const std::vector<std::uint8_t>& out);
  void report(const std::vector<std::vector<Chunk>>& chunks);
  void set_volume(const std::vector<std::vector<Chunk>>& chunks);
  bool stands_alone(std::size_t r, const std::vector<std::vector<Chunk>>& chunks) const;
  void fit_lattice(const std::vector<std::vector<Chunk>>& chunks);
  void gather(const std::vector<std::vector<Chunk>>& chunks);

  Scene& scene_;
  const Lattice& lattice_;
  const std::vector<LiquidRegion>& regions_;
  double most_;
  std::atomic<std::size_t> found_ = 0;
  Problems& problems_;
  std::vector<std::unique_ptr<ThreadRegions>> threads_;
  std::unique_ptr<const SolidUnion> solids_;      // null without boxes
  std::vector<std::vector<ColumnCell>> columns_;  // of each region
  bool compares_widths_ = false;
  CellMisfit misfit_;
  double least_rank_ = 0;             // of the sites beside walls of bodies that phases take
  std::vector<double> layer_volume_;  // below the surface of each, in cells of the lattice
};

}  // namespace spume
