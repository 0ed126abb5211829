// SPDX-License-Identifier: MIT
// The only file that includes CGAL, whose headers take most of its compile time, 8.5 s of a core of a Zen 5 with
// optimisation. The tree of boxes is under the GNU GPL, version 3 or later; a program that links it is distributed
// under it, as one that links FFTW is under version 2 or later.
#include "mesh_tree.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <vector>

namespace spume {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;

struct MeshTree::Tree {
  Triangles triangles;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> boxes;
};

MeshTree::MeshTree(const TriangleSurface& surface) : tree_(std::make_unique<Tree>()) {
  const auto corner = [&](std::int32_t i) {
    const Vec3& p = surface.points[static_cast<std::size_t>(i)];
    return Kernel::Point_3(p[0], p[1], p[2]);
  };
  tree_->triangles.reserve(surface.triangles.size());
  for (const auto& [a, b, c] : surface.triangles) tree_->triangles.emplace_back(corner(a), corner(b), corner(c));
  tree_->boxes.insert(tree_->triangles.cbegin(), tree_->triangles.cend());
  tree_->boxes.build();
  // Built here, since the first question would build it, and threads may ask at once.
  tree_->boxes.accelerate_distance_queries();
}

MeshTree::~MeshTree() = default;

std::size_t MeshTree::nearest_triangle(const Vec3& point) const {
  const auto found = tree_->boxes.closest_point_and_primitive(Kernel::Point_3(point[0], point[1], point[2]));
  return static_cast<std::size_t>(found.second - tree_->triangles.cbegin());
}

}  // namespace spume
