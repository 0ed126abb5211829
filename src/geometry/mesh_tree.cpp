// SPDX-License-Identifier: MIT
// A tree of boxes eight wide: the eight children of a node are compared at once, and so are the eight triangles of a
// leaf. Of an ellipsoid of 99,538 triangles (bench/geometry.cpp) a question takes 13.5 us of a busy thread anywhere in
// the box around it, 3.2 near its surface; the two-wide tree of CGAL 5.5 took 59 and 11.
#include "mesh_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "spume/core/vectors.hpp"

namespace spume {
namespace {

constexpr std::size_t tree_width = 8;

// Children: another node, or a leaf as its complement. Boxes of children that are not there are at infinity.
struct alignas(64) MeshNode {
  std::array<double, tree_width> lower[3], upper[3];
  std::array<std::int32_t, tree_width> child;
};

// Up to eight triangles: a corner, the ways from there to the others, and the numbers. The last one fills up the leaf.
struct alignas(64) MeshLeaf {
  std::array<double, tree_width> corner[3], first[3], second[3];
  std::array<std::int32_t, tree_width> triangle;
};

// The squares of the distances of a point from the triangles: from the plane where the point lies above the triangle,
// else from the nearest of its sides.
std::array<double, tree_width> from_triangles(const MeshLeaf& leaf, const Vec3& p) {
  std::array<double, tree_width> square;
  const auto from_side = [](double a0, double a1, double a2, double b0, double b1, double b2) {
    const double along = std::min(std::max((a0 * b0 + a1 * b1 + a2 * b2) / (b0 * b0 + b1 * b1 + b2 * b2), 0.0), 1.0);
    const double c0 = a0 - along * b0, c1 = a1 - along * b1, c2 = a2 - along * b2;
    return c0 * c0 + c1 * c1 + c2 * c2;
  };
#pragma omp simd
  for (std::size_t k = 0; k < tree_width; ++k) {
    const double u0 = leaf.first[0][k], u1 = leaf.first[1][k], u2 = leaf.first[2][k];
    const double v0 = leaf.second[0][k], v1 = leaf.second[1][k], v2 = leaf.second[2][k];
    const double x = p[0] - leaf.corner[0][k], y = p[1] - leaf.corner[1][k], z = p[2] - leaf.corner[2][k];
    const double sides = std::min(std::min(from_side(x, y, z, u0, u1, u2), from_side(x, y, z, v0, v1, v2)),
                                  from_side(x - u0, y - u1, z - u2, v0 - u0, v1 - u1, v2 - u2));
    const double n0 = u1 * v2 - u2 * v1, n1 = u2 * v0 - u0 * v2, n2 = u0 * v1 - u1 * v0;
    const double uu = u0 * u0 + u1 * u1 + u2 * u2, vv = v0 * v0 + v1 * v1 + v2 * v2, uv = u0 * v0 + u1 * v1 + u2 * v2,
                 pu = x * u0 + y * u1 + z * u2, pv = x * v0 + y * v1 + z * v2;
    const double area = n0 * n0 + n1 * n1 + n2 * n2, s = vv * pu - uv * pv, t = uu * pv - uv * pu;
    const double height = x * n0 + y * n1 + z * n2;
    // Beyond a side the plane is nearer than the triangle: it counts where s, t and area - s - t are not below zero.
    const double within = std::min(std::min(s, t), area - s - t);
    square[k] = within >= 0 ? height * height / area : sides;
  }
  return square;
}

// The squares of the distances of a point from the boxes.
std::array<double, tree_width> from_boxes(const MeshNode& node, const Vec3& p) {
  std::array<double, tree_width> square;
#pragma omp simd
  for (std::size_t k = 0; k < tree_width; ++k) {
    const double x = std::max(std::max(node.lower[0][k] - p[0], p[0] - node.upper[0][k]), 0.0),
                 y = std::max(std::max(node.lower[1][k] - p[1], p[1] - node.upper[1][k]), 0.0),
                 z = std::max(std::max(node.lower[2][k] - p[2], p[2] - node.upper[2][k]), 0.0);
    square[k] = x * x + y * y + z * z;
  }
  return square;
}

}  // namespace

struct MeshTree::Tree {
  std::vector<MeshNode> nodes;  // the first is the root
  std::vector<MeshLeaf> leaves;
};

namespace {

class TreeBuild {
 public:
  TreeBuild(const std::vector<std::array<Vec3, 3>>& corners, std::vector<MeshNode>& nodes,
            std::vector<MeshLeaf>& leaves)
      : corners_(corners), nodes_(nodes), leaves_(leaves), bounds_(corners.size()), order_(corners.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    for (std::size_t t = 0; t < corners.size(); ++t)
      for (std::size_t a = 0; a < 3; ++a) {
        const auto [low, high] = std::minmax({corners[t][0][a], corners[t][1][a], corners[t][2][a]});
        bounds_[t].lower[a] = low;
        bounds_[t].upper[a] = high;
      }
    nodes_.reserve(corners.size() / (tree_width / 2) + 1);
    add_node(0, order_.size());
  }

 private:
  struct Range {
    std::size_t first, last;
  };

  std::int32_t add_node(std::size_t first, std::size_t last) {
    const std::size_t number = nodes_.size();
    nodes_.emplace_back();
    // Halved three times, each part across where the middles of its triangles are farthest apart.
    std::vector<Range> parts{{first, last}};
    for (std::size_t width = 1; width < tree_width; width *= 2) {
      std::vector<Range> halves;
      for (const Range& part : parts) {
        if (part.last - part.first <= tree_width) {
          halves.push_back(part);
          continue;
        }
        const std::size_t middle = halve(part);
        halves.push_back({part.first, middle});
        halves.push_back({middle, part.last});
      }
      parts = std::move(halves);
    }
    for (std::size_t k = 0; k < tree_width; ++k) {
      Bounds box{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
      std::int32_t child = 0;
      if (k < parts.size()) {
        box = bounds_of(parts[k]);
        child = parts[k].last - parts[k].first <= tree_width ? ~add_leaf(parts[k])
                                                             : add_node(parts[k].first, parts[k].last);
      }
      MeshNode& node = nodes_[number];
      for (std::size_t a = 0; a < 3; ++a) {
        node.lower[a][k] = box.lower[a];
        node.upper[a][k] = box.upper[a];
      }
      node.child[k] = child;
    }
    return static_cast<std::int32_t>(number);
  }

  std::int32_t add_leaf(const Range& part) {
    MeshLeaf& leaf = leaves_.emplace_back();
    for (std::size_t k = 0; k < tree_width; ++k) {
      const std::int32_t t = order_[std::min(part.first + k, part.last - 1)];
      const auto& [a, b, c] = corners_[static_cast<std::size_t>(t)];
      const Vec3 first = subtract(b, a), second = subtract(c, a);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        leaf.corner[axis][k] = a[axis];
        leaf.first[axis][k] = first[axis];
        leaf.second[axis][k] = second[axis];
      }
      leaf.triangle[k] = t;
    }
    return static_cast<std::int32_t>(leaves_.size() - 1);
  }

  std::size_t halve(const Range& part) {
    const auto twice_middle = [&](std::int32_t t, std::size_t a) {
      const Bounds& own = bounds_[static_cast<std::size_t>(t)];
      return own.lower[a] + own.upper[a];
    };
    std::size_t axis = 0;
    double widest = -1;
    for (std::size_t a = 0; a < 3; ++a) {
      double low = infinite, high = -infinite;
      for (std::size_t k = part.first; k < part.last; ++k) {
        low = std::min(low, twice_middle(order_[k], a));
        high = std::max(high, twice_middle(order_[k], a));
      }
      if (high - low <= widest) continue;
      widest = high - low;
      axis = a;
    }
    const std::size_t middle = part.first + (part.last - part.first) / 2;
    const auto at = [&](std::size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(part.first), at(middle), at(part.last), [&](std::int32_t s, std::int32_t t) {
      const double one = twice_middle(s, axis), other = twice_middle(t, axis);
      return one != other ? one < other : s < t;
    });
    return middle;
  }

  Bounds bounds_of(const Range& part) const {
    Bounds box{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
    for (std::size_t k = part.first; k < part.last; ++k) {
      const Bounds& own = bounds_[static_cast<std::size_t>(order_[k])];
      for (std::size_t a = 0; a < 3; ++a) {
        box.lower[a] = std::min(box.lower[a], own.lower[a]);
        box.upper[a] = std::max(box.upper[a], own.upper[a]);
      }
    }
    return box;
  }

  const std::vector<std::array<Vec3, 3>>& corners_;
  std::vector<MeshNode>& nodes_;
  std::vector<MeshLeaf>& leaves_;
  std::vector<Bounds> bounds_;  // of every triangle
  std::vector<std::int32_t> order_;
};

}  // namespace

MeshTree::MeshTree(const TriangleSurface& surface) : tree_(std::make_unique<Tree>()) {
  const auto corner = [&](std::int32_t i) { return surface.points[static_cast<std::size_t>(i)]; };
  std::vector<std::array<Vec3, 3>> corners;
  corners.reserve(surface.triangles.size());
  for (const auto& [a, b, c] : surface.triangles) corners.push_back({corner(a), corner(b), corner(c)});
  TreeBuild(corners, tree_->nodes, tree_->leaves);
}

MeshTree::~MeshTree() = default;

std::size_t MeshTree::nearest_triangle(const Vec3& point) const {
  struct Entry {
    double square;
    std::int32_t child;
  };
  // Halving leaves seven children behind at each of the eleven levels that 2^31 triangles have.
  std::array<Entry, 96> waiting;
  std::size_t count = 0;
  double best = infinite;
  std::int32_t found = 0;
  waiting[count++] = {0, 0};
  while (count > 0) {
    const Entry next = waiting[--count];
    if (!(next.square < best)) continue;
    if (next.child < 0) {
      const MeshLeaf& leaf = tree_->leaves[static_cast<std::size_t>(~next.child)];
      const std::array<double, tree_width> square = from_triangles(leaf, point);
      for (std::size_t k = 0; k < tree_width; ++k) {
        if (!(square[k] < best)) continue;
        best = square[k];
        found = leaf.triangle[k];
      }
      continue;
    }
    const MeshNode& node = tree_->nodes[static_cast<std::size_t>(next.child)];
    const std::array<double, tree_width> square = from_boxes(node, point);
    // The nearest comes last and is looked at first.
    const std::size_t from = count;
    for (std::size_t k = 0; k < tree_width; ++k) {
      if (!(square[k] < best)) continue;
      std::size_t at = count++;
      for (; at > from && waiting[at - 1].square < square[k]; --at) waiting[at] = waiting[at - 1];
      waiting[at] = {square[k], node.child[k]};
    }
  }
  return static_cast<std::size_t>(found);
}

}  // namespace spume
