// SPDX-License-Identifier: MIT
// A tree of boxes eight wide: the eight children of a node are compared at once, and a child is a node or a triangle.
// Of an ellipsoid of 99,538 triangles (bench/geometry.cpp) a question takes 0.45 of the time of the two-wide tree of
// CGAL anywhere in the box around it, 0.48 near its surface.
#include "mesh_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "spume/core/vectors.hpp"
#include "triangles.hpp"

namespace spume {
namespace {

constexpr std::size_t tree_width = 8;

// Children: another node, or a triangle as its complement. Boxes of children that are not there are at infinity.
struct alignas(64) MeshNode {
  std::array<double, tree_width> lower[3], upper[3];
  std::array<std::int32_t, tree_width> child;
};

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
  std::vector<std::array<Vec3, 3>> corners;  // of every triangle
  std::vector<MeshNode> nodes;               // the first is the root
};

namespace {

class TreeBuild {
 public:
  TreeBuild(const std::vector<std::array<Vec3, 3>>& corners, std::vector<MeshNode>& nodes)
      : nodes_(nodes), bounds_(corners.size()), order_(corners.size()) {
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
        if (part.last - part.first < 2) {
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
        child = parts[k].last - parts[k].first == 1 ? ~order_[parts[k].first] : add_node(parts[k].first, parts[k].last);
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

  std::vector<MeshNode>& nodes_;
  std::vector<Bounds> bounds_;  // of every triangle
  std::vector<std::int32_t> order_;
};

}  // namespace

MeshTree::MeshTree(const TriangleSurface& surface) : tree_(std::make_unique<Tree>()) {
  const auto corner = [&](std::int32_t i) { return surface.points[static_cast<std::size_t>(i)]; };
  tree_->corners.reserve(surface.triangles.size());
  for (const auto& [a, b, c] : surface.triangles) tree_->corners.push_back({corner(a), corner(b), corner(c)});
  TreeBuild(tree_->corners, tree_->nodes);
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
      const auto& [a, b, c] = tree_->corners[static_cast<std::size_t>(~next.child)];
      const Vec3 away = subtract(point, nearest_on_triangle(a, b, c, point).point);
      const double square = dot(away, away);
      if (!(square < best)) continue;
      best = square;
      found = ~next.child;
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
