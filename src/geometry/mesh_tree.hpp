// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "spume/geometry/shape.hpp"

namespace spume {

// Finds the triangle of a surface that is nearest to a point. Keeps what it needs of the surface. Any number of threads
// may ask at once. It has a triangle at least.
class MeshTree {
 public:
  explicit MeshTree(const TriangleSurface& surface);
  MeshTree(const MeshTree&) = delete;
  MeshTree& operator=(const MeshTree&) = delete;
  ~MeshTree();
  std::size_t nearest_triangle(const Vec3& point) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace spume
