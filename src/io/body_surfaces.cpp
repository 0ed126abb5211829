// SPDX-License-Identifier: MIT
#include "spume/io/body_surfaces.hpp"

#include <vector>

#include "spume/io/polydata.hpp"

namespace spume {
namespace {

std::int8_t wall_code(BoundaryKind kind) {
  return kind == BoundaryKind::no_slip ? 2 : kind == BoundaryKind::free_slip ? 1 : 0;
}

}  // namespace

void write_body_surfaces(const std::filesystem::path& path, const Scene& scene) {
  PolyData data;
  std::vector<std::int32_t> number;
  std::vector<std::int8_t> wall, inside, subtract;
  const Bounds domain{scene.domain.lower, scene.domain.upper};
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const Body& body = scene.bodies[k];
    const TriangleSurface surface = body.solid->surface(domain, scene.spacing);
    const auto first = static_cast<std::int32_t>(data.points.size() / 3);
    for (const Vec3& p : surface.points)
      for (const double x : p) data.points.push_back(static_cast<float>(x));
    for (const auto& triangle : surface.triangles) {
      for (const std::int32_t corner : triangle) data.corners.push_back(first + corner);
      number.push_back(static_cast<std::int32_t>(k));
      wall.push_back(wall_code(body.wall));
      inside.push_back(body.inside ? 1 : 0);
      subtract.push_back(body.subtract ? 1 : 0);
    }
  }
  data.fields = {{"body", number}, {"wall", wall}, {"inside", inside}, {"subtract", subtract}};
  write_polydata(path, data);
}

}  // namespace spume
