// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

#include "spume/core/vectors.hpp"
#include "spume/geometry/mesh.hpp"

namespace spume {
namespace {

using Triangle = std::array<std::int32_t, 3>;

std::string words(const Vec3& p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.6g, %.6g, %.6g)", p[0], p[1], p[2]);
  return text;
}

class Faults {
 public:
  explicit Faults(const TriangleSurface& surface) : surface_(surface), part_(surface.triangles.size()) {
    std::iota(part_.begin(), part_.end(), 0);
  }

  std::vector<std::string> find() {
    look_at_areas();
    look_at_edges();
    // Of a surface with holes nobody can tell what is inside.
    if (faults_.empty()) look_at_parts();
    return std::move(faults_);
  }

 private:
  struct Edge {
    std::int32_t low, high;
    std::size_t triangle;
    bool forward;  // from low to high
  };

  const Vec3& point(std::int32_t i) const { return surface_.points[static_cast<std::size_t>(i)]; }
  std::string triangle_at(std::size_t t) const {
    const Triangle& corners = surface_.triangles[t];
    const Vec3 centre = multiply(1.0 / 3, add(add(point(corners[0]), point(corners[1])), point(corners[2])));
    return "triangle " + std::to_string(t + 1) + " at " + words(centre);
  }
  std::string edge_at(const Edge& edge) const {
    return "the edge from " + words(point(edge.low)) + " to " + words(point(edge.high)) + " of triangle " +
           std::to_string(edge.triangle + 1);
  }
  static std::string in_all(std::size_t count, const std::string& what) {
    return count == 1 ? "" : " (the first of " + std::to_string(count) + " such " + what + ")";
  }

  // Of a triangle whose height is below 1e-12 of its longest side the normal is known to three digits at best.
  bool has_area(const Triangle& corners) const {
    const Vec3 a = subtract(point(corners[1]), point(corners[0])), b = subtract(point(corners[2]), point(corners[0]));
    const Vec3 c = subtract(b, a);
    const double longest = std::max({dot(a, a), dot(b, b), dot(c, c)});
    return length(cross(a, b)) > 1e-12 * longest;
  }

  void look_at_areas() {
    std::size_t count = 0, first = 0;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t)
      if (!has_area(surface_.triangles[t]) && count++ == 0) first = t;
    if (count == 0) return;
    faults_.push_back(triangle_at(first) + " has no area" + in_all(count, "triangles") +
                      "; expected corners that are not on one line: remove such triangles, as mesh programs do under "
                      "'degenerate faces'");
  }

  void look_at_edges() {
    std::vector<Edge> edges;
    edges.reserve(3 * surface_.triangles.size());
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      const Triangle& corners = surface_.triangles[t];
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t from = corners[k], to = corners[(k + 1) % 3];
        edges.push_back({std::min(from, to), std::max(from, to), t, from < to});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::tuple(a.low, a.high, a.triangle) < std::tuple(b.low, b.high, b.triangle);
    });
    std::vector<Edge> open, crowded;
    std::vector<int> turned(surface_.triangles.size());  // edges at which a triangle and its neighbour disagree
    std::size_t most_crowded = 0;
    for (std::size_t i = 0; i < edges.size();) {
      std::size_t end = i;
      while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
      if (end - i == 1) open.push_back(edges[i]);
      if (end - i > 2) {
        if (crowded.empty()) most_crowded = end - i;
        crowded.push_back(edges[i]);
      }
      if (end - i == 2) {
        join(edges[i].triangle, edges[i + 1].triangle);
        if (edges[i].forward == edges[i + 1].forward)
          for (std::size_t k = i; k < end; ++k) ++turned[edges[k].triangle];
      }
      i = end;
    }
    const auto earliest = [](const std::vector<Edge>& list) {
      return *std::min_element(list.begin(), list.end(),
                               [](const Edge& a, const Edge& b) { return a.triangle < b.triangle; });
    };
    if (!open.empty())
      faults_.push_back("it is not closed: " + edge_at(earliest(open)) + " belongs to no other triangle" +
                        in_all(open.size(), "edges") +
                        "; expected two triangles at every edge: close the hole, or merge corners that should be the "
                        "same");
    if (!crowded.empty())
      faults_.push_back(edge_at(crowded.front()) + " belongs to " + std::to_string(most_crowded) + " triangles" +
                        in_all(crowded.size(), "edges") +
                        "; expected two: remove inner walls, or move parts that touch there apart");
    const auto worst = std::max_element(turned.begin(), turned.end());
    if (worst != turned.end() && *worst > 0) {
      const auto count = std::count_if(turned.begin(), turned.end(), [](int edges_of) { return edges_of > 1; });
      faults_.push_back(triangle_at(static_cast<std::size_t>(worst - turned.begin())) +
                        " is turned over against its neighbours" +
                        in_all(static_cast<std::size_t>(std::max<std::ptrdiff_t>(count, 1)), "triangles") +
                        "; expected corners that are counter-clockwise seen from outside, everywhere: make the "
                        "normals consistent");
    }
  }

  std::size_t root(std::size_t t) {
    while (part_[t] != t) t = part_[t] = part_[part_[t]];
    return t;
  }
  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    part_[std::max(a, b)] = std::min(a, b);
  }

  struct Part {
    std::vector<std::size_t> triangles;
    Bounds bounds;
    double volume = 0;
  };

  // The share of all directions in which a point sees the inner side of a part: 1 inside, 0 outside, -1 inside a part
  // that is inside out (A. Van Oosterom and J. Strackee, IEEE Trans. Biomed. Eng. 30, 1983).
  double winding(const Part& part, const Vec3& p) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (p[a] < part.bounds.lower[a] || p[a] > part.bounds.upper[a]) return 0;
    double total = 0;
    for (const std::size_t t : part.triangles) {
      const Triangle& corners = surface_.triangles[t];
      const Vec3 a = subtract(point(corners[0]), p), b = subtract(point(corners[1]), p),
                 c = subtract(point(corners[2]), p);
      const double la = length(a), lb = length(b), lc = length(c);
      total += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return total / (4 * std::numbers::pi);
  }

  struct Span {
    std::size_t triangle = 0, part = 0;
    std::array<Vec3, 3> corners{};
    Bounds bounds{};
  };

  static bool meet(const Bounds& a, const Bounds& b) {
    for (std::size_t k = 0; k < 3; ++k)
      if (a.lower[k] > b.upper[k] || a.upper[k] < b.lower[k]) return false;
    return true;
  }
  // Whether the line from a to b passes the triangle between its corners.
  static bool passes(const Vec3& a, const Vec3& b, const std::array<Vec3, 3>& corners) {
    const auto side = [](const Vec3& o, const Vec3& u, const Vec3& v, const Vec3& w) {
      return dot(subtract(u, o), cross(subtract(v, o), subtract(w, o)));
    };
    const auto& [u, v, w] = corners;
    if (!(side(a, u, v, w) * side(b, u, v, w) < 0)) return false;
    const double first = side(a, b, u, v), second = side(a, b, v, w), third = side(a, b, w, u);
    return (first > 0 && second > 0 && third > 0) || (first < 0 && second < 0 && third < 0);
  }
  static bool cross_each_other(const Span& s, const Span& t) {
    for (const auto& [own, other] : {std::pair(&s, &t), std::pair(&t, &s)})
      for (std::size_t k = 0; k < 3; ++k)
        if (passes(own->corners[k], own->corners[(k + 1) % 3], other->corners)) return true;
    return false;
  }

  // The first two triangles that cross once every part is moved by `way` against the part before it. Triangles are
  // looked at in their order along x, each beside those that reach as far as it begins.
  std::optional<std::pair<std::size_t, std::size_t>> crossing(const std::vector<Part>& parts,
                                                              const std::vector<std::size_t>& number, const Vec3& way) {
    std::vector<Span> spans;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      Span span{.triangle = t, .part = number[root(t)]};
      for (std::size_t c = 0; c < 3; ++c)
        span.corners[c] = add(point(surface_.triangles[t][c]), multiply(static_cast<double>(span.part), way));
      span.bounds = {span.corners[0], span.corners[0]};
      for (const Vec3& corner : span.corners)
        for (std::size_t k = 0; k < 3; ++k) {
          span.bounds.lower[k] = std::min(span.bounds.lower[k], corner[k]);
          span.bounds.upper[k] = std::max(span.bounds.upper[k], corner[k]);
        }
      const bool near = std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
        return &part != &parts[span.part] && meet(part.bounds, span.bounds);
      });
      if (near) spans.push_back(span);
    }
    std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
      return std::tuple(a.bounds.lower[0], a.triangle) < std::tuple(b.bounds.lower[0], b.triangle);
    });
    std::vector<const Span*> open;
    for (const Span& span : spans) {
      std::erase_if(open, [&](const Span* one) { return one->bounds.upper[0] < span.bounds.lower[0]; });
      for (const Span* one : open)
        if (one->part != span.part && meet(one->bounds, span.bounds) && cross_each_other(*one, span))
          return std::minmax(one->triangle, span.triangle);
      open.push_back(&span);
    }
    return std::nullopt;
  }

  // Moved a little, so that no edge meets an edge, as those of boxes do: parts that only touch then cross one way
  // alone.
  bool look_at_crossings(const std::vector<Part>& parts, const std::vector<std::size_t>& number) {
    double size = 0;
    for (const Part& part : parts) size = std::max(size, length(subtract(part.bounds.upper, part.bounds.lower)));
    const Vec3 way = multiply(1e-7 * size, {0.61, 0.47, 0.63});
    const auto found = crossing(parts, number, way);
    if (!found || !crossing(parts, number, multiply(-1, way))) return false;
    faults_.push_back("its parts cross: " + triangle_at(found->first) + " and " + triangle_at(found->second) +
                      " pass through each other; expected parts that lie apart or within each other: unite them to one "
                      "surface, or write a [[body]] for each");
    return true;
  }

  // Every part is closed and of one direction. A part in nothing faces outwards, a hollow in a part inwards.
  void look_at_parts() {
    std::vector<Part> parts;
    std::vector<std::size_t> number(part_.size());
    constexpr double infinite = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < part_.size(); ++t) {
      const std::size_t first = root(t);
      if (first == t) {
        number[t] = parts.size();
        parts.push_back({{}, {{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}}, 0});
      }
      Part& part = parts[number[first]];
      part.triangles.push_back(t);
      const Triangle& corners = surface_.triangles[t];
      const Vec3& origin = point(surface_.triangles[part.triangles.front()][0]);
      const Vec3 a = subtract(point(corners[0]), origin), b = subtract(point(corners[1]), origin),
                 c = subtract(point(corners[2]), origin);
      part.volume += dot(a, cross(b, c)) / 6;
      for (const std::int32_t corner : corners)
        for (std::size_t k = 0; k < 3; ++k) {
          part.bounds.lower[k] = std::min(part.bounds.lower[k], point(corner)[k]);
          part.bounds.upper[k] = std::max(part.bounds.upper[k], point(corner)[k]);
        }
    }
    if (parts.size() > 1 && look_at_crossings(parts, number)) return;
    for (const Part& part : parts) {
      const std::size_t first = part.triangles.front();
      const Vec3& corner = point(surface_.triangles[first][0]);
      double around = 0;
      for (const Part& other : parts)
        if (&other != &part) around += winding(other, corner);
      const bool hollow = std::abs(around) > 0.5;
      if ((part.volume > 0) != hollow) continue;
      const std::string size = std::to_string(part.triangles.size()) + " triangles with " + triangle_at(first);
      faults_.push_back(hollow ? "its part of " + size +
                                     " lies within another part and faces outwards as that does; expected a hollow, "
                                     "which faces inwards: turn it over, or unite the parts"
                               : (parts.size() == 1 ? "it is inside out: its " : "its part of ") + size +
                                     (parts.size() == 1 ? " face inwards" : " is inside out") +
                                     "; expected corners that are counter-clockwise seen from outside: turn the "
                                     "normals over; for liquid inside it write  inside = false");
      return;
    }
  }

  const TriangleSurface& surface_;
  std::vector<std::size_t> part_;  // the first triangle of what it hangs together with, over several steps
  std::vector<std::string> faults_;
};

}  // namespace

std::vector<std::string> mesh_faults(const TriangleSurface& surface) {
  return Faults(surface).find();
}

}  // namespace spume
