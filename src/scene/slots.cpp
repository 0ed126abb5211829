// SPDX-License-Identifier: MIT
#include "slots.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "bodies.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

constexpr double parallel = 0.1;           // of the sum of two normals: 6 degrees
constexpr double off_surface = 0.005;      // spacings: nearer walls touch (particles/wall_gaps.cpp)
constexpr int halvings = 20;               // of the way across a slot
constexpr double most_along = 64;          // pieces along an edge of a facet
constexpr std::size_t most_facets = 4000;  // of a mesh, which some of its facets tell to a per cent

struct SurfacePlace {
  Vec3 place{};
  double size = 0;  // length or area
};

double pieces_along(double way, double spacing) {
  return std::clamp(std::ceil(way / spacing), 1.0, most_along);
}

void add_edges(const TriangleSurface& surface, double spacing, std::vector<SurfacePlace>& places) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& corner : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[std::minmax(corner[k], corner[(k + 1) % 3])];
  for (const auto& [edge, count] : edges) {
    if (count != 1) continue;
    const Vec3 &from = surface.points[static_cast<std::size_t>(edge.first)],
               way = subtract(surface.points[static_cast<std::size_t>(edge.second)], from);
    const double pieces = pieces_along(length(way), spacing);
    for (double k = 0; k < pieces; ++k)
      places.push_back({add(from, multiply((k + 0.5) / pieces, way)), length(way) / pieces});
  }
}

// Each facet in n^2 of its own shape.
void add_facets(const TriangleSurface& surface, double spacing, std::vector<SurfacePlace>& places) {
  const std::size_t stride = 1 + surface.triangles.size() / most_facets;
  for (std::size_t t = 0; t < surface.triangles.size(); t += stride) {
    const auto at = [&](std::size_t k) { return surface.points[static_cast<std::size_t>(surface.triangles[t][k])]; };
    const Vec3 a = at(0), u = subtract(at(1), a), v = subtract(at(2), a);
    const double n = pieces_along(std::max({length(u), length(v), length(subtract(u, v))}), spacing);
    const double size = 0.5 * length(cross(u, v)) / (n * n) * static_cast<double>(stride);
    const auto add_place = [&](double i, double j) {
      places.push_back({add(a, add(multiply(i / n, u), multiply(j / n, v))), size});
    };
    for (double i = 0; i < n; ++i)
      for (double j = 0; i + j < n; ++j) {
        add_place(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j + 1 < n) add_place(i + 2.0 / 3, j + 2.0 / 3);
      }
  }
}

struct Found {
  double size = 0, width = infinite;
  bool beside_side = false;
};

Found slots_of(const Scene& scene, const Body& body) {
  const int dimensions = scene.domain.dimensions;
  const double spacing = scene.spacing;
  const Bounds domain{scene.domain.lower, scene.domain.upper};
  const TriangleSurface surface = body.solid->surface(domain, spacing);
  std::vector<SurfacePlace> places;
  dimensions == 3 ? add_facets(surface, spacing, places) : add_edges(surface, spacing, places);
  Found found;
  for (const SurfacePlace& at : places) {
    bool in_domain = true;
    for (int axis = 0; axis < dimensions; ++axis)
      in_domain = in_domain && at.place[axis] > domain.lower[axis] && at.place[axis] < domain.upper[axis];
    if (!in_domain) continue;
    const NearestPoint near = body.solid->nearest(at.place);
    if (std::abs(near.distance) > 0.5 * spacing) continue;  // where it was cut at the window it has no face
    const Vec3 before = add(near.point, multiply(off_surface * spacing, near.normal));
    if (scene.walls.distance(before) <= 0) continue;
    const std::optional<SlotWidth> slot = slot_at(scene.walls, scene.domain, before, too_narrow * spacing);
    if (!slot || slot->width <= 2 * off_surface * spacing) continue;
    found.size += at.size;
    if (slot->width >= found.width) continue;
    found.width = slot->width;
    found.beside_side = slot->beside_side;
  }
  return found;
}

}  // namespace

std::optional<SlotWidth> slot_at(const Combination& walls, const Domain& domain, const Vec3& place, double width) {
  const NearestPoint face = walls.nearest(place);
  if (!(face.distance < width)) return std::nullopt;
  const Vec3 across = add(place, multiply(width - face.distance, face.normal));
  const auto faces = [&](const Vec3& normal) { return length(add(face.normal, normal)) < parallel; };
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (std::size_t end = 0; end < 2; ++end) {
      const BoundaryKind kind = domain.sides[axis][end].kind;
      if (kind != BoundaryKind::free_slip && kind != BoundaryKind::no_slip) continue;
      Vec3 inwards{};
      inwards[axis] = end == 0 ? 1 : -1;
      const double behind = inwards[axis] * ((end == 0 ? domain.lower : domain.upper)[axis] - across[axis]);
      if (behind > 0 && faces(inwards)) return SlotWidth{width - behind, true};
    }
  if (!(walls.distance(across) < 0)) return std::nullopt;
  // The face that the way enters by: behind an edge another may be nearer.
  double in = 1, out = 0;
  const Vec3 way = subtract(across, place);
  for (int n = 0; n < halvings; ++n) {
    const double middle = 0.5 * (in + out);
    (walls.distance(add(place, multiply(middle, way))) > 0 ? out : in) = middle;
  }
  if (!faces(walls.nearest(add(place, multiply(out, way))).normal)) return std::nullopt;
  return SlotWidth{face.distance + in * length(way), false};
}

std::vector<Problem> slot_warnings(const Draft& draft, const Scene& scene, const std::string& file) {
  std::vector<Problem> warnings;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const Body& body = scene.bodies[k];
    const Node* node = node_of_body(draft, scene, k);
    const bool released = body.motion && scene.motions[*body.motion].release;
    if (node == nullptr || released || body.subtract || body.wall == BoundaryKind::open) continue;
    const Found found = slots_of(scene, body);
    const double least = std::pow(scene.spacing, scene.domain.dimensions - 1);
    if (found.size < least) continue;
    warnings.push_back({file, node->place.line, node->place.column,
                        "the body '" + body.name + "' leaves a slot of " + brief(found.width) + ", " +
                            brief(std::round(100 * found.width / scene.spacing) / 100) + " spacings, to " +
                            (found.beside_side ? "a side" : "another body") +
                            ": no particle stands in slots narrower than half a spacing, nothing flows through, and "
                            "the force there is by the pressure at the mouth; for what flows in "
                            "it resolution.spacing = " +
                            brief(found.width) + " or less is needed, for none let the body touch"});
  }
  return warnings;
}

}  // namespace spume
