// SPDX-License-Identifier: MIT
#include "spume/geometry/distance_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "facet_sweep.hpp"
#include "mesh_tree.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/geometry/isosurface.hpp"
#include "spume/geometry/mesh.hpp"
#include "triangles.hpp"

namespace spume {
namespace {

// 32 MB of distances.
constexpr std::size_t most_nodes = 4'000'000;
// Spacings between the nodes of a level set. At one spacing, a disc with a radius of 4 spacings had distances that
// differed by 0.033 spacings from one side to the other: still water sloshed around it with 0.03 sqrt(gH), here with
// 2e-4 as around the closed form.
constexpr double level_set_nodes = 0.5;

class NodeValues {
 public:
  NodeValues(const NodeGrid& grid, int dimensions, std::vector<double> values)
      : grid_(grid), values_(std::move(values)), dimensions_(static_cast<std::size_t>(dimensions)) {}

  bool covers(const Vec3& p) const {
    for (std::size_t a = 0; a < dimensions_; ++a)
      if (!(p[a] >= grid_.lower[a] && p[a] <= upper(a))) return false;
    return true;
  }
  Vec3 clamped(Vec3 p) const {
    for (std::size_t a = 0; a < dimensions_; ++a) p[a] = std::clamp(p[a], grid_.lower[a], upper(a));
    return p;
  }
  double upper(std::size_t a) const { return grid_.lower[a] + grid_.spacing * static_cast<double>(grid_.count[a] - 1); }

  // At a point that it covers; `gradient` of the interpolant, when wanted.
  double at(const Vec3& p, Vec3* gradient = nullptr) const {
    std::size_t first = 0, step = 1;
    std::array<std::size_t, 3> stride{};
    Vec3 part{};
    for (std::size_t a = 0; a < dimensions_; ++a) {
      const double x = (p[a] - grid_.lower[a]) / grid_.spacing;
      const std::size_t cell = std::min(static_cast<std::size_t>(std::max(x, 0.0)), grid_.count[a] - 2);
      part[a] = x - static_cast<double>(cell);
      first += cell * step;
      stride[a] = step;
      step *= grid_.count[a];
    }
    const double* v = values_.data() + first;
    const std::size_t sx = stride[0], sy = stride[1], sz = stride[2];
    const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
    const auto plane = [&](const double* w, double& dx, double& dy) {
      const double low = mix(w[0], w[sx], part[0]), high = mix(w[sy], w[sy + sx], part[0]);
      dx = mix(w[sx] - w[0], w[sy + sx] - w[sy], part[1]);
      dy = high - low;
      return mix(low, high, part[1]);
    };
    double dx0 = 0, dy0 = 0, dx1 = 0, dy1 = 0;
    const double lower = plane(v, dx0, dy0);
    if (dimensions_ == 2) {
      if (gradient) *gradient = {dx0 / grid_.spacing, dy0 / grid_.spacing, 0};
      return lower;
    }
    const double higher = plane(v + sz, dx1, dy1);
    if (gradient)
      *gradient = multiply(1 / grid_.spacing, {mix(dx0, dx1, part[2]), mix(dy0, dy1, part[2]), higher - lower});
    return mix(lower, higher, part[2]);
  }

  NearestPoint nearest(const Vec3& p) const {
    NearestPoint found;
    Vec3 gradient{};
    found.distance = at(p, &gradient);
    found.normal = unit(gradient, static_cast<int>(dimensions_));
    found.point = subtract(p, multiply(found.distance, found.normal));
    return found;
  }

  // The largest difference to a distance at the middle of the cells that the surface passes.
  template <class Distance>
  double difference(Distance&& distance) const {
    std::array<std::size_t, 3> cells{1, 1, 1};
    for (std::size_t a = 0; a < dimensions_; ++a) cells[a] = grid_.count[a] - 1;
    return parallel_max(cells[0] * cells[1] * cells[2], 0, [&](std::size_t n) {
      const std::size_t i = n % cells[0], j = n / cells[0] % cells[1], k = n / cells[0] / cells[1];
      Vec3 middle = grid_.node(grid_.number(i, j, k));
      for (std::size_t a = 0; a < dimensions_; ++a) middle[a] += 0.5 * grid_.spacing;
      const double own = at(middle);
      return std::abs(own) > grid_.spacing ? 0.0 : std::abs(own - distance(middle, own));
    });
  }

 private:
  NodeGrid grid_;
  std::vector<double> values_;
  std::size_t dimensions_;
};

std::vector<double> sampled(const Shape& shape, const NodeGrid& grid) {
  std::vector<double> values(grid.size());
  parallel_for(values.size(), [&](std::size_t n) { values[n] = shape.distance(grid.node(n)); });
  return values;
}

class DistanceField final : public Shape {
 public:
  DistanceField(ShapePointer exact, const Bounds& box, double spacing, int dimensions)
      : exact_(std::move(exact)),
        grid_(cover(box, spacing, dimensions, most_nodes)),
        values_(grid_, dimensions, sampled(*exact_, grid_)) {
    error_ = values_.difference([&](const Vec3& p, double) { return exact_->distance(p); });
  }
  NearestPoint nearest(const Vec3& p) const override {
    return values_.covers(p) ? values_.nearest(p) : exact_->nearest(p);
  }
  double distance(const Vec3& p) const override { return values_.covers(p) ? values_.at(p) : exact_->distance(p); }
  Bounds bounds() const override { return exact_->bounds(); }
  Bounds extent() const override { return exact_->extent(); }
  double volume() const override { return exact_->volume(); }
  double error() const override { return exact_->error() + error_; }
  TriangleSurface surface(const Bounds& window, double step) const override { return exact_->surface(window, step); }

 private:
  ShapePointer exact_;
  NodeGrid grid_;
  NodeValues values_;
  double error_ = 0;
};

std::string words(const Vec3& p, int dimensions) {
  char text[96];
  if (dimensions == 3)
    std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g)", p[0], p[1], p[2]);
  else
    std::snprintf(text, sizeof text, "(%.6g, %.6g)", p[0], p[1]);
  return text;
}

class LevelSet final : public Shape {
 public:
  LevelSet(const std::function<double(const Vec3&)>& value, const NodeGrid& grid, const std::vector<double>& nodes,
           Isosurface surface, int dimensions)
      : LevelSet(value, grid, nodes, surface.boundary, std::move(surface.body), MeshTree(surface.boundary),
                 dimensions) {}

  NearestPoint nearest(const Vec3& p) const override {
    if (values_.covers(p)) return values_.nearest(p);
    const Vec3 edge = values_.clamped(p), away = subtract(p, edge);
    NearestPoint found = values_.nearest(edge);
    const double way = length(away);
    if (found.distance > 0) found.normal = unit(subtract(p, found.point), dimensions_);
    found.distance += found.distance > 0 ? way : -way;
    return found;
  }
  double distance(const Vec3& p) const override { return values_.covers(p) ? values_.at(p) : nearest(p).distance; }
  Bounds bounds() const override { return bounds_; }
  // Where it ends on the window it goes on beyond.
  Bounds extent() const override { return {{-infinite, -infinite, -infinite}, {infinite, infinite, infinite}}; }
  double volume() const override { return volume_; }
  double error() const override { return error_; }
  TriangleSurface surface(const Bounds&, double) const override { return body_; }

 private:
  LevelSet(const std::function<double(const Vec3&)>& value, const NodeGrid& grid, const std::vector<double>& nodes,
           const TriangleSurface& boundary, TriangleSurface body, const MeshTree& tree, int dimensions)
      : dimensions_(dimensions), body_(std::move(body)), values_(grid, dimensions, from_facets(boundary, grid, nodes)) {
    const double interpolation = values_.difference([&](const Vec3& p, double own) {
      // Of the sign that it has anyway: where the two differ, so do their signed values.
      const double size = from_facet(boundary, tree.nearest_triangle(p), p);
      return std::abs(own - size) < std::abs(own + size) ? size : -size;
    });
    error_ = interpolation + facet_error(value, boundary, grid.spacing);
    measure(grid, nodes);
  }

  // |f| / |grad f| at the middle of the facets; in two dimensions of the segment that two triangles stand on.
  double facet_error(const std::function<double(const Vec3&)>& value, const TriangleSurface& boundary,
                     double spacing) const {
    double largest = 0;
    for (const auto& corners : boundary.triangles) {
      Vec3 middle{};
      const double share = dimensions_ == 3 ? 1.0 / 3 : 0.5;
      for (std::size_t k = 0; k < (dimensions_ == 3 ? 3u : 2u); ++k)
        middle = add(middle, multiply(share, boundary.points[static_cast<std::size_t>(corners[k])]));
      if (dimensions_ == 2) middle[2] = 0;
      Vec3 gradient{};
      const double step = 1e-4 * spacing;
      for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions_); ++a) {
        Vec3 before = middle, after = middle;
        before[a] -= step;
        after[a] += step;
        gradient[a] = (value(after) - value(before)) / (2 * step);
      }
      const double slope = length(gradient), error = std::abs(value(middle)) / slope;
      // A function without a slope tells no distance; the facet is off by no more than its cell.
      largest = std::max(largest, std::isfinite(error) ? std::min(error, spacing) : spacing);
    }
    return largest;
  }

  // Bounds and volume of the positive part, which ends at the window.
  void measure(const NodeGrid& grid, const std::vector<double>& nodes) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    bounds_ = {{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
    const auto reach = [&](const Vec3& p) {
      for (std::size_t a = 0; a < 3; ++a) {
        bounds_.lower[a] = std::min(bounds_.lower[a], p[a]);
        bounds_.upper[a] = std::max(bounds_.upper[a], p[a]);
      }
    };
    for (const Vec3& p : body_.points) reach(p);
    for (std::size_t n = 0; n < nodes.size(); ++n)
      if (nodes[n] > 0) reach(grid.node(n));
    const double cell = std::pow(grid.spacing, dimensions_);
    // By how far the surface is from the middle of a cell, as if it were flat and across an axis.
    std::array<std::size_t, 3> cells{1, 1, 1};
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions_); ++a) cells[a] = grid.count[a] - 1;
    volume_ = parallel_sum(cells[0] * cells[1] * cells[2], [&](std::size_t n) {
      Vec3 middle = grid.node(grid.number(n % cells[0], n / cells[0] % cells[1], n / cells[0] / cells[1]));
      for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions_); ++a) middle[a] += 0.5 * grid.spacing;
      return cell * std::clamp(0.5 - values_.at(middle) / grid.spacing, 0.0, 1.0);
    });
  }

  int dimensions_;
  TriangleSurface body_;
  NodeValues values_;
  Bounds bounds_;
  double error_ = 0, volume_ = 0;
};

// The facets and their copies, but for copies in the grid, where they were found already.
void add_copies(TriangleSurface& boundary, const NodeGrid& grid, int dimensions, const std::vector<Vec3>& copies) {
  const std::size_t own_points = boundary.points.size(), own_facets = boundary.triangles.size();
  const auto covered = [&](const Vec3& p) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a) {
      const double cells = (p[a] - grid.lower[a]) / grid.spacing;
      if (!(cells >= 0 && cells <= static_cast<double>(grid.count[a] - 1))) return false;
    }
    return true;
  };
  for (const Vec3& shift : copies) {
    const auto before = static_cast<std::int32_t>(boundary.points.size());
    for (std::size_t k = 0; k < own_points; ++k) boundary.points.push_back(add(boundary.points[k], shift));
    for (std::size_t k = 0; k < own_facets; ++k) {
      const auto [a, b, c] = boundary.triangles[k];
      const auto place = [&](std::int32_t corner) {
        return boundary.points[static_cast<std::size_t>(before + corner)];
      };
      if (!covered(place(a)) || !covered(place(b)) || !covered(place(c)))
        boundary.triangles.push_back({before + a, before + b, before + c});
    }
  }
}

}  // namespace

ShapePointer make_distance_field(ShapePointer exact, const Bounds& box, double spacing, int dimensions) {
  return std::make_shared<DistanceField>(std::move(exact), box, spacing, dimensions);
}

ShapePointer make_level_set(const std::function<double(const Vec3&)>& value, const Bounds& window, double spacing,
                            int dimensions, const std::vector<Vec3>& copies) {
  const NodeGrid grid = cover(window, level_set_nodes * spacing, dimensions, most_nodes);
  std::vector<double> nodes(grid.size());
  std::size_t positive = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    nodes[n] = value(grid.node(n));
    if (!std::isfinite(nodes[n]))
      throw InputError("it is not finite at " + words(grid.node(n), dimensions) +
                       "; it must have a finite value everywhere in the domain and next to it");
    positive += nodes[n] > 0;
  }
  if (positive == 0 || positive == nodes.size())
    throw InputError(std::string("it is positive ") + (positive == 0 ? "nowhere" : "everywhere") +
                     " in the domain; expected a surface where it changes its sign");
  Isosurface surface = find_isosurface(value, grid, nodes, dimensions);
  add_copies(surface.boundary, grid, dimensions, copies);
  return std::make_shared<LevelSet>(value, grid, nodes, std::move(surface), dimensions);
}

}  // namespace spume
