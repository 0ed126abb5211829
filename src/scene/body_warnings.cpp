// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "bodies.hpp"
#include "spume/core/vectors.hpp"
#include "spume/scene/plates.hpp"

namespace spume {
namespace {

std::string sides_of(const Bounds& bounds, int dimensions) {
  std::string words;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a)
    words += (a == 0 ? "" : ", ") + std::string(1, "xyz"[a]) + " from " + brief(bounds.lower[a]) + " to " +
             brief(bounds.upper[a]);
  return words;
}

bool apart(const Bounds& a, const Bounds& b, int dimensions) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions); ++k)
    if (a.lower[k] >= b.upper[k] || a.upper[k] <= b.lower[k]) return true;
  return false;
}

double longest(const Bounds& bounds, int dimensions) {
  double size = 0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a)
    size = std::max(size, bounds.upper[a] - bounds.lower[a]);
  return size;
}

// Spacings: twice the support radius of the standard kernel, 2.6. Behind faces that are not flat, liquid on one side
// then sees none on the other.
constexpr double screening = 5;

// A place of the surface and its weight.
struct SurfacePart {
  Vec3 place;
  double size;
};

// The middle of every facet with its area; in two dimensions of every outer edge with its length.
std::vector<SurfacePart> parts_of(const TriangleSurface& surface, int dimensions) {
  std::vector<SurfacePart> parts;
  const auto at = [&](std::int32_t i) -> const Vec3& { return surface.points[static_cast<std::size_t>(i)]; };
  std::map<std::pair<Vec3, Vec3>, int> edges;
  for (const auto& corners : surface.triangles) {
    const Vec3 &a = at(corners[0]), &b = at(corners[1]), &c = at(corners[2]);
    if (dimensions == 3) {
      Vec3 middle{}, u{}, v{};
      for (std::size_t k = 0; k < 3; ++k) {
        middle[k] = (a[k] + b[k] + c[k]) / 3;
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
      }
      parts.push_back(
          {middle, 0.5 * std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])});
    }
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if (dimensions == 2) ++edges[std::minmax(from, to)];
  }
  for (const auto& [edge, count] : edges) {
    if (count != 1) continue;
    const auto& [a, b] = edge;
    parts.push_back({{0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0}, std::hypot(b[0] - a[0], b[1] - a[1])});
  }
  return parts;
}

// Whether the surface around one of its places is flat, on one side at least: the other may be past an edge.
bool is_flat(const Body& body, const NearestPoint& at, double spacing, int dimensions) {
  constexpr double flat = 0.2;  // of the curvature times a spacing: as of thin bodies (particles/thin_bodies.hpp)
  const Vec3 n = at.normal;
  Vec3 along = dimensions == 3 ? cross(n, std::abs(n[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}) : Vec3{-n[1], n[0], 0};
  along = unit(along, dimensions);
  const std::array<Vec3, 2> ways{along, cross(n, along)};
  const auto turned = [&](const Vec3& way) {
    const Vec3 before = add(at.point, add(multiply(0.25 * spacing, n), way));
    return length(subtract(body.solid->nearest(before).normal, n));
  };
  for (int way = 0; way < dimensions - 1; ++way) {
    const Vec3 step = multiply(spacing, ways[static_cast<std::size_t>(way)]);
    if (std::min(turned(step), turned(multiply(-1, step))) > flat) return false;
  }
  return true;
}

// The share of the surface in the domain behind which the solid ends within a spacing; `curved`: where it is not flat.
double thin_share(const Body& body, const Bounds& domain, double spacing, int dimensions, bool curved = false) {
  double thin = 0, all = 0;
  const std::vector<SurfacePart> parts = parts_of(body.solid->surface(domain, spacing), dimensions);
  // Of a large mesh some of its facets tell the share to a per cent: each is asked for nine distances.
  constexpr std::size_t most_parts = 4000;
  const std::size_t stride = 1 + parts.size() / most_parts;
  for (std::size_t i = 0; i < parts.size(); i += stride) {
    const SurfacePart& part = parts[i];
    const auto in_domain = [&] {
      for (std::size_t a = 0; a < static_cast<std::size_t>(dimensions); ++a)
        if (part.place[a] < domain.lower[a] || part.place[a] > domain.upper[a]) return false;
      return true;
    };
    if (!in_domain()) continue;
    const NearestPoint found = body.solid->nearest(part.place);
    // Where the surface was cut at the window the solid goes on: that is no face of it.
    if (std::abs(found.distance) > 0.5 * spacing) continue;
    all += part.size;
    if (curved && is_flat(body, found, spacing / screening, dimensions)) continue;
    constexpr int steps = 8;
    for (int k = 1; k <= steps; ++k) {
      Vec3 p = found.point;
      // Rounding decides at the far face of a body that is just a spacing thick.
      for (std::size_t a = 0; a < 3; ++a) p[a] -= found.normal[a] * spacing * (1 - 1e-6) * k / steps;
      if (body.solid->distance(p) <= 0) continue;
      thin += part.size;
      break;
    }
  }
  return all > 0 ? thin / all : 0;
}

// The body whose wall the place lies in, or null.
const Body* around(const Scene& scene, const Vec3& place) {
  const Body* found = nullptr;
  double distance = infinite;
  for (const Body& body : scene.bodies) {
    if (body.wall == BoundaryKind::open || body.motion) continue;
    const double own = body.solid->distance(place);
    if (body.subtract ? -own > distance : own < distance) {
      distance = body.subtract ? -own : own;
      found = &body;
    }
  }
  return distance < -1e-6 * scene.spacing ? found : nullptr;  // on the surface: by rounding
}

bool in_box(const SolidBox& box, const Vec3& place, const Domain& domain, double margin) {
  for (int a = 0; a < domain.dimensions; ++a)
    if (place[a] < box.lower[a] + margin || place[a] > box.upper[a] - margin) return false;
  return true;
}

}  // namespace

void warn_of_probes(const Draft& draft, const Scene& scene, Problems& problems) {
  for (std::size_t k = 0; k < draft.options.probes.size(); ++k) {
    const ProbeOptions& probe = draft.options.probes[k];
    const Node* node = draft.node("probe." + std::to_string(k) + ".position");
    if (probe.kind != ProbeKind::point || probe.motion || node == nullptr) continue;
    const auto warn = [&](const std::string& solid) {
      problems.warn(*node, "the probe '" + probe.name + "' lies inside " + solid +
                               " and records nothing but nan; move it into the liquid");
    };
    if (const Body* body = around(scene, probe.position)) warn("the body '" + body->name + "'");
    for (std::size_t b = 0; b < scene.domain.boxes.size(); ++b)
      if (in_box(scene.domain.boxes[b], probe.position, scene.domain, 1e-6 * scene.spacing)) {
        warn("solid." + std::to_string(b));
        break;
      }
  }
}

const Node* node_of_body(const Draft& draft, const Scene& scene, std::size_t k) {
  if (k < draft.bodies.size()) return draft.node("body." + std::to_string(k));
  const std::string& name = scene.bodies[k].name;
  return name.starts_with("solid.") ? draft.node(name) : nullptr;
}

std::vector<Problem> body_warnings(const Draft& draft, const Scene& scene, const std::string& file) {
  std::vector<Problem> warnings;
  const int dimensions = scene.domain.dimensions;
  const Bounds domain{scene.domain.lower, scene.domain.upper};
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const Body& body = scene.bodies[k];
    const Node* node = node_of_body(draft, scene, k);
    if (node == nullptr) continue;
    const auto warn = [&](const std::string& text) {
      warnings.push_back({file, node->place.line, node->place.column, "the body '" + body.name + "' " + text});
    };
    const Bounds bounds = body.shape->bounds();
    const double size = longest(bounds, dimensions), room = longest(domain, dimensions);
    // A hull in mm in a tank in m.
    constexpr double factor = 1000;
    if (std::isfinite(size) && size >= factor * room) {
      warn("is " + brief(size) + " long, " + brief(size / room) + " times the domain of " + brief(room) +
           "; if its lengths are in another unit, set scale, 0.001 from mm to m");
      continue;
    }
    if (size < scene.spacing && body.wall != BoundaryKind::open) {
      warn("is " + brief(size) + " long, less than a spacing, " + brief(scene.spacing) +
           ": the liquid does not feel it; if its lengths are in another unit, set scale, 1000 from km to m, or lower "
           "resolution.spacing");
      continue;
    }
    const bool released = body.motion && scene.motions[*body.motion].release;
    if (released) continue;  // it waits outside
    if (apart(bounds, domain, dimensions)) {
      // A tank is as long as its bodies, or a few times shorter than those that reach out of it.
      constexpr double another_unit = 10;
      warn("lies outside the domain: " + sides_of(bounds, dimensions) + ", the domain's " +
           sides_of(domain, dimensions) + "; move it with position, or remove it" +
           (std::isfinite(size) && size >= another_unit * room
                ? "; it is " + brief(std::round(size / room)) +
                      " times as long as the domain: if its lengths are in another unit, set scale, 0.001 from mm to m"
                : ""));
      continue;
    }
    // Edges of a shape that is thick elsewhere are thin too, a wedge behind a part of its faces.
    constexpr double most_thin = 0.05;
    const double thin = body.wall == BoundaryKind::open ? 0 : thin_share(body, domain, scene.spacing, dimensions);
    if (thin > most_thin)
      warn("is thinner than a spacing, " + brief(scene.spacing) + ", behind " + brief(std::round(100 * thin)) +
           " % of its surface; liquid may pass there: make it thicker, or lower resolution.spacing");
    // What bodies are taken away from is not looked at.
    const bool cut = std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& other) {
      return other.subtract && other.wall != BoundaryKind::open && other.motion == body.motion;
    });
    constexpr double most_unscreened = 0.5;
    const double deep = screening * scene.spacing;
    double unscreened =
        body.wall == BoundaryKind::open || thin > most_thin ? 0 : thin_share(body, domain, deep, dimensions);
    // Flat plates are walls of two sides (particles/thin_bodies.hpp).
    if (unscreened > most_unscreened && !cut && is_plate(scene, body, scene.spacing, standard_support * scene.spacing))
      unscreened = thin_share(body, domain, deep, dimensions, true);
    if (unscreened > most_unscreened)
      warn("is thinner than five spacings, " + brief(deep) + ", behind " + brief(std::round(100 * unscreened)) +
           " % of its surface, and is no plate with flat faces; liquid on its two sides acts on each other through it: "
           "lower resolution.spacing, or make it thicker unless there is liquid on one side alone");
  }
  return warnings;
}

}  // namespace spume
