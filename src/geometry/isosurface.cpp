// SPDX-License-Identifier: MIT
#include "spume/geometry/isosurface.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "spume/core/vectors.hpp"

namespace spume {

NodeGrid cover(const Bounds& box, double spacing, int dimensions, std::size_t most) {
  NodeGrid grid;
  for (;; spacing *= 1.1) {
    double nodes = 1;
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a)
      nodes *= std::max(1.0, std::ceil((box.upper[a] - box.lower[a]) / spacing)) + 1;
    if (nodes <= static_cast<double>(most)) break;
  }
  grid.spacing = spacing;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a) {
    const double cells = std::max(1.0, std::ceil((box.upper[a] - box.lower[a]) / spacing));
    grid.count[a] = static_cast<std::size_t>(cells) + 1;
    grid.lower[a] = 0.5 * (box.lower[a] + box.upper[a] - cells * spacing);
  }
  return grid;
}

namespace {

// In spacings: facets that are thinner are left out, which opens gaps no wider than that.
constexpr double thinnest = 1e-6;

class Marcher {
 public:
  // Without `value` linear between the nodes.
  Marcher(const std::function<double(const Vec3&)>* value, const NodeGrid& grid, const std::vector<double>& nodes)
      : value_(value), grid_(grid), nodes_(nodes) {}

  Isosurface in_space() {
    // The six tetrahedra around the diagonal of a cell: from its lowest corner along the axes in each order.
    static constexpr int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (std::size_t k = 0; k + 1 < grid_.count[2]; ++k)
      for (std::size_t j = 0; j + 1 < grid_.count[1]; ++j)
        for (std::size_t i = 0; i + 1 < grid_.count[0]; ++i) {
          if (!mixed(i, j, k)) continue;
          for (const auto& order : orders) {
            std::array<std::size_t, 3> at{i, j, k};
            std::array<std::size_t, 4> corners{grid_.number(i, j, k)};
            for (std::size_t s = 0; s < 3; ++s) {
              ++at[static_cast<std::size_t>(order[s])];
              corners[s + 1] = grid_.number(at[0], at[1], at[2]);
            }
            tetrahedron(corners);
          }
        }
    found_.body = found_.boundary;
    return std::move(found_);
  }

  Isosurface in_plane() {
    height_ = grid_.spacing * static_cast<double>(std::max(grid_.count[0], grid_.count[1]));
    for (std::size_t j = 0; j + 1 < grid_.count[1]; ++j)
      for (std::size_t i = 0; i + 1 < grid_.count[0]; ++i) {
        const std::size_t a = grid_.number(i, j, 0), b = grid_.number(i + 1, j, 0), c = grid_.number(i + 1, j + 1, 0),
                          d = grid_.number(i, j + 1, 0);
        flat_triangle({a, b, c});
        flat_triangle({a, c, d});
      }
    return std::move(found_);
  }

  Contour lines() {
    for (std::size_t j = 0; j + 1 < grid_.count[1]; ++j)
      for (std::size_t i = 0; i + 1 < grid_.count[0]; ++i) {
        const std::size_t a = grid_.number(i, j, 0), b = grid_.number(i + 1, j, 0), c = grid_.number(i + 1, j + 1, 0),
                          d = grid_.number(i, j + 1, 0);
        if (!std::isfinite(nodes_[a] + nodes_[b] + nodes_[c] + nodes_[d])) continue;
        line({a, b, c});
        line({a, c, d});
      }
    return {std::move(found_.boundary.points), std::move(corners_)};
  }

 private:
  bool positive(std::size_t node) const { return nodes_[node] > 0; }
  bool mixed(std::size_t i, std::size_t j, std::size_t k) const {
    int count = 0;
    for (int c = 0; c < 8; ++c) {
      const std::size_t node =
          grid_.number(i + static_cast<std::size_t>(c & 1), j + static_cast<std::size_t>(c >> 1 & 1),
                       k + static_cast<std::size_t>(c >> 2));
      if (!std::isfinite(nodes_[node])) return false;
      count += positive(node);
    }
    return count != 0 && count != 8;
  }

  Vec3 root(std::size_t in, std::size_t out) const {
    Vec3 inner = grid_.node(in), outer = grid_.node(out);
    if (value_ == nullptr) {
      const double share = nodes_[in] / (nodes_[in] - nodes_[out]);
      return add(multiply(1 - share, inner), multiply(share, outer));
    }
    const Vec3 end = outer;
    // 40 halvings: 1e-12 of the spacing.
    for (int i = 0; i < 40; ++i) {
      const Vec3 middle = multiply(0.5, add(inner, outer));
      ((*value_)(middle) > 0 ? inner : outer) = middle;
    }
    const Vec3 found = multiply(0.5, add(inner, outer));
    // A root at a node is that node; a condition is 0 there and may end anywhere between.
    return nodes_[out] == 0 && length(subtract(found, end)) <= thinnest * grid_.spacing ? end : found;
  }

  // The point of `points` on the edge between two nodes, one positive, the other not.
  std::int32_t on_edge(std::size_t in, std::size_t out) {
    const auto [entry, fresh] = edges_.try_emplace({std::min(in, out), std::max(in, out)},
                                                   static_cast<std::int32_t>(found_.boundary.points.size()));
    if (fresh) found_.boundary.points.push_back(root(in, out));
    return entry->second;
  }

  // Counter-clockwise seen from where the function is not positive. Roots next to a node make needles.
  void facet(std::int32_t a, std::int32_t b, std::int32_t c, const Vec3& positive_side) {
    const auto& points = found_.boundary.points;
    const Vec3 &p = points[static_cast<std::size_t>(a)], &q = points[static_cast<std::size_t>(b)],
               &r = points[static_cast<std::size_t>(c)];
    const Vec3 normal = cross(subtract(q, p), subtract(r, p));
    const double longest = std::max({length(subtract(q, p)), length(subtract(r, q)), length(subtract(p, r))});
    if (length(normal) <= thinnest * grid_.spacing * longest) return;
    if (dot(normal, subtract(positive_side, p)) > 0) std::swap(b, c);
    found_.boundary.triangles.push_back({a, b, c});
  }

  void tetrahedron(const std::array<std::size_t, 4>& corners) {
    std::array<std::size_t, 4> in{}, out{};
    std::size_t ins = 0, outs = 0;
    for (const std::size_t corner : corners) (positive(corner) ? in[ins++] : out[outs++]) = corner;
    if (ins == 0 || outs == 0) return;
    const Vec3 side = grid_.node(in[0]);
    if (ins == 2) {
      const std::int32_t a = on_edge(in[0], out[0]), b = on_edge(in[0], out[1]), c = on_edge(in[1], out[1]),
                         d = on_edge(in[1], out[0]);
      facet(a, b, c, multiply(0.5, add(side, grid_.node(in[1]))));
      facet(a, c, d, multiply(0.5, add(side, grid_.node(in[1]))));
    } else if (ins == 1) {
      facet(on_edge(in[0], out[0]), on_edge(in[0], out[1]), on_edge(in[0], out[2]), side);
    } else {
      facet(on_edge(in[0], out[0]), on_edge(in[1], out[0]), on_edge(in[2], out[0]),
            multiply(1.0 / 3, add(side, add(grid_.node(in[1]), grid_.node(in[2])))));
    }
  }

  // From where the triangle, counter-clockwise, ceases to be positive to where it begins.
  void line(const std::array<std::size_t, 3>& corners) {
    std::int32_t first = -1, last = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t from = corners[k], to = corners[(k + 1) % 3];
      if (positive(from) == positive(to)) continue;
      (positive(from) ? first : last) = positive(from) ? on_edge(from, to) : on_edge(to, from);
    }
    if (first < 0) return;
    const auto& points = found_.boundary.points;
    if (length(subtract(points[static_cast<std::size_t>(first)], points[static_cast<std::size_t>(last)])) <=
        thinnest * grid_.spacing)
      return;
    corners_.insert(corners_.end(), {first, last});
  }

  // The point of the body at a node, or between two of which one is positive: triangles that meet there share it.
  std::int32_t point_of_body(std::size_t from, std::size_t to) {
    std::vector<Vec3>& points = found_.body.points;
    const auto next = static_cast<std::int32_t>(points.size());
    const auto [entry, fresh] = edges_.try_emplace({std::min(from, to), std::max(from, to)}, next);
    if (!fresh) return entry->second;
    const Vec3 place = from == to ? grid_.node(from) : positive(from) ? root(from, to) : root(to, from);
    for (const std::size_t node : {from, to})
      if (from != to && length(subtract(place, grid_.node(node))) <= thinnest * grid_.spacing) {
        const std::int32_t at_node = point_of_body(node, node);  // `entry` may have moved
        return edges_[{std::min(from, to), std::max(from, to)}] = at_node;
      }
    points.push_back(place);
    return next;
  }

  // What of a triangle is positive, as a fan, and the segment where it ends.
  void flat_triangle(const std::array<std::size_t, 3>& corners) {
    std::vector<std::int32_t> area, ends;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t from = corners[k], to = corners[(k + 1) % 3];
      if (positive(from)) area.push_back(point_of_body(from, from));
      if (positive(from) == positive(to)) continue;
      area.push_back(point_of_body(from, to));
      ends.push_back(area.back());
    }
    // Roots at a node are that node.
    area.erase(std::unique(area.begin(), area.end()), area.end());
    if (area.size() > 1 && area.front() == area.back()) area.pop_back();
    for (std::size_t k = 1; k + 1 < area.size(); ++k) found_.body.triangles.push_back({area[0], area[k], area[k + 1]});
    const auto place = [&](std::size_t k) { return found_.body.points[static_cast<std::size_t>(ends[k])]; };
    if (ends.size() != 2 || length(subtract(place(0), place(1))) <= thinnest * grid_.spacing) return;
    TriangleSurface& wall = found_.boundary;
    const auto foot = static_cast<std::int32_t>(wall.points.size());
    for (const double z : {-height_, height_})
      for (const std::size_t k : {0U, 1U}) wall.points.push_back({place(k)[0], place(k)[1], z});
    wall.triangles.push_back({foot, foot + 1, foot + 3});
    wall.triangles.push_back({foot, foot + 3, foot + 2});
  }

  using Edge = std::pair<std::size_t, std::size_t>;
  struct Hash {
    std::size_t operator()(const Edge& edge) const { return edge.first * 0x9E3779B97F4A7C15ull + edge.second; }
  };

  const std::function<double(const Vec3&)>* value_;
  const NodeGrid& grid_;
  const std::vector<double>& nodes_;
  std::unordered_map<Edge, std::int32_t, Hash> edges_;
  Isosurface found_;
  std::vector<std::int32_t> corners_;  // of lines
  double height_ = 0;
};

}  // namespace

Isosurface find_isosurface(const std::function<double(const Vec3&)>& value, const NodeGrid& grid,
                           const std::vector<double>& nodes, int dimensions) {
  Marcher marcher(&value, grid, nodes);
  return dimensions == 3 ? marcher.in_space() : marcher.in_plane();
}

Contour find_contour(const NodeGrid& grid, const std::vector<double>& nodes, int dimensions) {
  Marcher marcher(nullptr, grid, nodes);
  if (dimensions == 2) return marcher.lines();
  Isosurface found = marcher.in_space();
  Contour contour{std::move(found.boundary.points), {}};
  for (const auto& triangle : found.boundary.triangles)
    contour.corners.insert(contour.corners.end(), triangle.begin(), triangle.end());
  return contour;
}

}  // namespace spume
