// SPDX-License-Identifier: MIT
#include "expression_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "checks.hpp"
#include "spume/core/vectors.hpp"
#include "spume/geometry/distance_field.hpp"

namespace spume {
namespace {

// Spacings around the domain within which methods ask for distances; and beyond which a body goes on.
constexpr double reach_of_expressions = 4, still_whole = 3;
// Spacings: a step of a surface at a periodic side as small as the facets are off where it is curved.
constexpr double smallest_step = 0.01;

// Where the expression is positive: asked in coordinates of the domain.
class Region {
 public:
  Region(const Draft& draft, const Expression& where, const Pose& pose)
      : draft_(draft), where_(where), pose_(pose), d_(static_cast<std::size_t>(draft.dimensions)) {}

  double value(const Vec3& p) const {
    const Vec3 own = to_own_coordinates(pose_, p);
    return where_(own[0], own[1], own[2], 0);
  }
  bool inside(const Vec3& p) const { return value(p) > 0; }

  // The domain and so many spacings around it.
  Bounds around(double spacings) const {
    Bounds window{to_vec3(draft_.lower), to_vec3(draft_.upper)};
    for (std::size_t a = 0; a < d_; ++a) {
      window.lower[a] -= spacings * draft_.options.spacing;
      window.upper[a] += spacings * draft_.options.spacing;
    }
    return window;
  }

  // Whether it is positive anywhere from `still_whole` to `reach_of_expressions` beyond the sides of an axis.
  bool goes_on(std::size_t axis) const {
    const Bounds window = around(reach_of_expressions);
    const double h = draft_.options.spacing;
    bool found = false;
    for (const double beyond : {still_whole, 0.5 * (still_whole + reach_of_expressions), reach_of_expressions})
      for (const double plane : {draft_.lower[axis] - beyond * h, draft_.upper[axis] + beyond * h})
        for_nodes(window, axis, plane, 0.5 * h,
                  [&](const Vec3& p, std::array<bool, 3>) { found = found || inside(p); });
    return found;
  }

  // A place on the lower side of an axis where the upper one says something else, farther than `smallest_step` from
  // where either of them ends.
  std::optional<Vec3> jump(std::size_t axis) const {
    std::optional<Vec3> found;
    for_nodes(around(0), axis, draft_.lower[axis], draft_.options.spacing,
              [&](const Vec3& p, std::array<bool, 3> more) {
                if (!found && differs(p, axis)) found = p;
                for (std::size_t b = 0; b < d_ && !found; ++b) {
                  Vec3 next = p;
                  next[b] += draft_.options.spacing;
                  if (!more[b]) continue;
                  const std::optional<Vec3> lower = root(p, next, axis, 0), upper = root(p, next, axis, period(axis));
                  if (lower && upper && std::abs((*lower)[b] - (*upper)[b]) > smallest_step * draft_.options.spacing)
                    found = multiply(0.5, add(*lower, *upper));
                }
              });
    return found;
  }

  double period(std::size_t axis) const { return draft_.upper[axis] - draft_.lower[axis]; }

  bool inside_shifted(Vec3 p, std::size_t axis, double shift) const {
    p[axis] += shift;
    return inside(p);
  }

 private:
  // The nodes of a lattice of spacings on a plane across an axis, the last beyond the window or on its end, and along
  // which axes there is another in the window.
  template <class Ask>
  void for_nodes(const Bounds& window, std::size_t axis, double plane, double h, Ask&& ask) const {
    std::array<std::size_t, 3> count{1, 1, 1};
    for (std::size_t a = 0; a < d_; ++a)
      if (a != axis) count[a] = 1 + static_cast<std::size_t>(std::ceil((window.upper[a] - window.lower[a]) / h - 1e-6));
    for (std::size_t n = 0; n < count[0] * count[1] * count[2]; ++n) {
      const std::array<std::size_t, 3> at{n % count[0], n / count[0] % count[1], n / count[0] / count[1]};
      Vec3 p = window.lower;
      std::array<bool, 3> more{};
      for (std::size_t a = 0; a < d_; ++a) {
        p[a] += h * static_cast<double>(at[a]);
        more[a] = at[a] + 1 < count[a];
      }
      p[axis] = plane;
      ask(p, more);
    }
  }

  // On the two sides, and no less right beside the place along each other axis.
  bool differs(const Vec3& p, std::size_t axis) const {
    const bool lower = inside(p);
    const auto same_there = [&](const Vec3& q) {
      return inside(q) == lower && inside_shifted(q, axis, period(axis)) != lower;
    };
    if (!same_there(p)) return false;
    for (std::size_t b = 0; b < d_; ++b)
      for (const double way : {-smallest_step, smallest_step}) {
        if (b == axis) continue;
        Vec3 q = p;
        q[b] += way * draft_.options.spacing;
        if (!same_there(q)) return false;
      }
    return true;
  }

  // Where it ends between two places, shifted along an axis.
  std::optional<Vec3> root(Vec3 from, Vec3 to, std::size_t axis, double shift) const {
    const bool first = inside_shifted(from, axis, shift);
    if (inside_shifted(to, axis, shift) == first) return std::nullopt;
    for (int halving = 0; halving < 20; ++halving) {
      const Vec3 middle = multiply(0.5, add(from, to));
      (inside_shifted(middle, axis, shift) == first ? from : to) = middle;
    }
    return from;
  }

  const Draft& draft_;
  const Expression& where_;
  Pose pose_;
  std::size_t d_;
};

std::string place_words(const Vec3& p, int dimensions) {
  std::string text = "(" + brief(p[0]);
  for (std::size_t a = 1; a < static_cast<std::size_t>(dimensions); ++a) text += ", " + brief(p[a]);
  return text + ")";
}

// From a place to its copies next to it.
std::vector<Vec3> ways_to_copies(const Vec3& periods) {
  std::vector<Vec3> ways{{}};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t before = ways.size();
    for (std::size_t k = 0; k < before && periods[a] != 0; ++k)
      for (const double period : {-periods[a], periods[a]}) {
        ways.push_back(ways[k]);
        ways.back()[a] = period;
      }
  }
  ways.erase(ways.begin());
  return ways;
}

}  // namespace

ShapePointer make_expression_body(const Draft& draft, const std::string& name, const Expression& where,
                                  const Pose& pose, Problems& problems) {
  const int d = draft.dimensions;
  const Region region(draft, where, pose);
  const Vec3 lower = to_vec3(draft.lower);
  Vec3 periods{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(d); ++a) {
    if (!draft.periodic[a] || !region.goes_on(a)) continue;
    periods[a] = region.period(a);
    const std::optional<Vec3> jump = region.jump(a);
    if (!jump) continue;
    Vec3 within = *jump, outside = *jump;
    (region.inside(*jump) ? outside : within)[a] = draft.upper[a];
    problems.add(*draft.node(name + ".where"),
                 name + ".where goes on beyond a periodic side along " + std::string(1, "xyz"[a]) +
                     ", and its two sides disagree: it is positive at " + place_words(within, d) + " and not at " +
                     place_words(outside, d) +
                     "; expected an expression that is the same on both, such as one with the period " +
                     brief(periods[a]) + ", or a body that ends within " + brief(still_whole * draft.options.spacing) +
                     " of the domain there: change it, or write it as a shape, which goes around");
    return nullptr;
  }
  const auto value = [&](Vec3 p) {
    for (std::size_t a = 0; a < 3; ++a)
      if (periods[a] != 0) p[a] -= periods[a] * std::floor((p[a] - lower[a]) / periods[a]);
    return region.value(p);
  };
  ShapePointer shape =
      make_level_set(value, region.around(reach_of_expressions), draft.options.spacing, d, ways_to_copies(periods));
  return periods == Vec3{} ? shape : continue_periodically(std::move(shape), lower, periods);
}

}  // namespace spume
