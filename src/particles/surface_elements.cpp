// SPDX-License-Identifier: MIT
#include "spume/particles/surface_elements.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "spume/core/vectors.hpp"
#include "spume/particles/surface_pieces.hpp"

namespace spume {
namespace {

using Element = SurfaceElements::Element;

// Spacings: an element farther from the walls lies inside another body, or where the scene ends.
constexpr double of_own_surface = 0.25;
// Spacings: corners as near as that are one. Their places differ by rounding alone.
constexpr double same_corner = 1e-4;
// Of a lattice of such places, so that no round number lies between two of them.
constexpr double beside_lattice = 0.37;
// Spacings, and the cosine of normals: elements of two bodies that move as one and lie next to each other.
constexpr double next_to = 1.5, facing_away = -0.5;

// Which element each piece is a part of. In space those in one cell of a spacing that face one way are one: facets of a
// shape are often slivers, 61 for a square of a spacing around a cylinder, and each would take a fit.
std::vector<std::size_t> elements_of_pieces(const std::vector<SurfacePiece>& pieces, int dimensions, double spacing) {
  std::map<std::array<int, 4>, std::size_t> found;
  std::vector<std::size_t> element_of;
  for (const SurfacePiece& piece : pieces) {
    if (dimensions == 2) {
      element_of.push_back(element_of.size());
      continue;
    }
    std::array<int, 4> key{};
    std::size_t widest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      key[axis] = static_cast<int>(std::floor(piece.middle[axis] / spacing));
      if (std::abs(piece.area[axis]) > std::abs(piece.area[widest])) widest = axis;
    }
    key[3] = static_cast<int>(2 * widest) + (piece.area[widest] < 0 ? 1 : 0);
    element_of.push_back(found.try_emplace(key, found.size()).first->second);
  }
  return element_of;
}

std::array<std::int64_t, 3> corner_key(const Vec3& place, double spacing) {
  std::array<std::int64_t, 3> key{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    key[axis] = std::llround(place[axis] / (same_corner * spacing) + beside_lattice);
  return key;
}

}  // namespace

SurfaceElements::SurfaceElements(const Scene& scene, const BodyWalls& walls, double spacing) {
  std::vector<Corner> corners;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].wall != BoundaryKind::open) add_body(scene, b, walls.part_of(b), spacing, corners);
  find_neighbours(scene, spacing, corners);
}

// Areas of an element add up; its middle is the mean. Facets lie within a curved surface: their areas are made those of
// the volume of the shape, and their middles lie on it. The half of a spacing that facets have is off by 0.6 % of the
// volume of a ball of four spacings radius.
void SurfaceElements::add_body(const Scene& scene, std::size_t b, const RigidWalls& walls, double spacing,
                               std::vector<Corner>& corners) {
  const Body& body = scene.bodies[b];
  const int d = scene.domain.dimensions;
  const double sign = body.inside != body.subtract ? 1 : -1;
  const std::vector<SurfacePiece> pieces = surface_pieces(scene.domain, body, spacing);
  const std::vector<std::size_t> element_of = elements_of_pieces(pieces, d, spacing);
  double volume = 0;
  std::vector<Element> whole(pieces.size());
  std::vector<double> sizes(pieces.size(), 0);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    volume += dot(pieces[k].middle, pieces[k].area) / d;
    const double size = length(pieces[k].area);
    Element& element = whole[element_of[k]];
    element.middle = add(element.middle, multiply(size, pieces[k].middle));
    element.area = add(element.area, multiply(sign, pieces[k].area));
    sizes[element_of[k]] += size;
  }
  const double ratio = body.shape->volume() / volume;
  const double stretch = std::isfinite(ratio) && ratio > 0 ? std::pow(ratio, (d - 1.0) / d) : 1;
  std::vector<std::int32_t> number(pieces.size(), -1);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    if (!(sizes[n] > 0)) continue;
    const Vec3 middle = multiply(1 / sizes[n], whole[n].middle);
    if (std::abs(walls.exact_distance(middle)) >= of_own_surface * spacing) continue;
    number[n] = static_cast<std::int32_t>(elements_.size());
    elements_.push_back({walls.nearest(middle).point, multiply(stretch, whole[n].area), static_cast<std::int32_t>(b)});
  }
  for (std::size_t k = 0; k < pieces.size(); ++k)
    for (std::size_t c = 0; c < (d == 3 ? 3U : 2U) && number[element_of[k]] >= 0; ++c)
      corners.emplace_back(corner_key(pieces[k].corner[c], spacing), number[element_of[k]]);
}

void SurfaceElements::find_neighbours(const Scene& scene, double spacing, std::vector<Corner>& corners) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  const auto body_of = [&](std::int32_t e) { return elements_[static_cast<std::size_t>(e)].body; };
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  for (std::size_t first = 0, last = 0; first < corners.size(); first = last) {
    while (last < corners.size() && corners[last].first == corners[first].first) ++last;
    for (std::size_t k = first; k < last; ++k)
      for (std::size_t l = first; l < last; ++l) {
        const std::int32_t own = corners[k].second, other = corners[l].second;
        if (own != other && body_of(own) == body_of(other)) pairs.emplace_back(own, other);
      }
  }
  if (scene.bodies.size() > 1) {
    const double reach = next_to * spacing;
    std::map<std::array<int, 3>, std::vector<std::int32_t>> cells;
    const auto cell_of = [&](const Vec3& place) {
      std::array<int, 3> cell{};
      for (std::size_t axis = 0; axis < 3; ++axis) cell[axis] = static_cast<int>(std::floor(place[axis] / reach));
      return cell;
    };
    for (std::size_t e = 0; e < size(); ++e)
      cells[cell_of(elements_[e].middle)].push_back(static_cast<std::int32_t>(e));
    const auto motion_of = [&](const Element& element) {
      return scene.bodies[static_cast<std::size_t>(element.body)].motion;
    };
    for (std::size_t e = 0; e < size(); ++e) {
      const Element& own = elements_[e];
      const std::array<int, 3> middle = cell_of(own.middle);
      for (int n = 0; n < 27; ++n) {
        const auto found = cells.find({middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1});
        if (found == cells.end()) continue;
        for (const std::int32_t k : found->second) {
          const Element& other = elements_[static_cast<std::size_t>(k)];
          if (other.body == own.body || motion_of(other) != motion_of(own)) continue;
          const double facing = dot(other.area, own.area) / (length(other.area) * length(own.area));
          if (length(subtract(other.middle, own.middle)) < reach && facing > facing_away)
            pairs.emplace_back(static_cast<std::int32_t>(e), k);
        }
      }
    }
  }
  const auto away = [&](const std::pair<std::int32_t, std::int32_t>& pair) {
    return length(subtract(elements_[static_cast<std::size_t>(pair.first)].middle,
                           elements_[static_cast<std::size_t>(pair.second)].middle));
  };
  std::sort(pairs.begin(), pairs.end(), [&](const auto& a, const auto& b) {
    if (a.first != b.first) return a.first < b.first;
    return std::tuple(away(a), a.second) < std::tuple(away(b), b.second);
  });
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  first_.assign(size() + 1, 0);
  beside_.reserve(pairs.size());
  for (const auto& [own, other] : pairs) {
    ++first_[static_cast<std::size_t>(own) + 1];
    beside_.push_back(other);
  }
  for (std::size_t e = 0; e < size(); ++e) first_[e + 1] += first_[e];
}

std::vector<std::int32_t> SurfaceElements::nearest_sources(const std::vector<Role>& role,
                                                           const std::vector<std::size_t>& seeking) const {
  std::vector<std::int32_t> found(size(), -1), next(seeking.size(), -1);
  for (std::size_t e = 0; e < size(); ++e)
    if (role[e] == Role::source || role[e] == Role::end) found[e] = static_cast<std::int32_t>(e);
  for (bool any = true; any;) {
    any = false;
    for (std::size_t k = 0; k < seeking.size(); ++k) {
      if (next[k] >= 0) continue;
      for (const std::int32_t e : beside(seeking[k])) {
        const std::int32_t source = found[static_cast<std::size_t>(e)];
        if (source < 0) continue;
        const bool better = next[k] < 0 || (role[static_cast<std::size_t>(next[k])] == Role::end &&
                                            role[static_cast<std::size_t>(source)] == Role::source);
        if (better) next[k] = source;
      }
      any = any || next[k] >= 0;
    }
    for (std::size_t k = 0; k < seeking.size(); ++k) found[seeking[k]] = next[k];
  }
  return next;
}

}  // namespace spume
