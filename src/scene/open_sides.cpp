// SPDX-License-Identifier: MIT
#include "open_sides.hpp"

#include <algorithm>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/scene/side_names.hpp"
#include "spume/scene/solid_union.hpp"

namespace spume {
namespace {

// Whether the straight way from one place to another meets a wall of a body: by steps of its distance, of which those
// of unions and differences are never too long.
bool bodies_between(const Scene& scene, const Vec3& from, const Vec3& to) {
  if (scene.walls.empty()) return false;
  const Vec3 way = subtract(to, from);
  const double whole = length(way), least = 0.1 * scene.spacing;
  for (double gone = 0; gone < whole;) {
    const double distance = scene.walls.distance(add(from, multiply(gone / whole, way)));
    if (distance < least) return true;
    gone += distance;
  }
  return false;
}

bool has_opening(const Scene& scene, int axis, int side) {
  return std::any_of(scene.openings.begin(), scene.openings.end(),
                     [&](const Opening& one) { return one.axis == axis && one.side == side; });
}

// The openings of a side, with expressions of their own: those of a scene are not for several threads.
class OpeningsOfSide {
 public:
  OpeningsOfSide(const Scene& scene, int axis, int side) : axis_(axis), dimensions_(scene.domain.dimensions) {
    for (const Opening& one : scene.openings)
      if (one.axis == axis && one.side == side)
        openings_.push_back({&one, one.where == nullptr ? nullptr : one.where->clone()});
  }
  // Whether the foot of a place on the side is in one.
  bool before(const Vec3& r) const {
    return std::any_of(openings_.begin(), openings_.end(), [&](const One& one) {
      Vec3 foot = r;
      foot[axis_] = one.opening->lower[axis_];
      for (int a = 0; a < dimensions_; ++a)
        if (a != axis_ && (r[a] < one.opening->lower[a] || r[a] > one.opening->upper[a])) return false;
      return one.where == nullptr || (*one.where)(foot[0], foot[1], foot[2], 0) > 0;
    });
  }

 private:
  struct One {
    const Opening* opening;
    std::unique_ptr<Expression> where;
  };
  int axis_, dimensions_;
  std::vector<One> openings_;
};

// Times at which expressions of an opening are asked.
constexpr int level_samples = 100;

// Height of the liquid before an opening at the start; without any the floor of the opening.
double surface_before(const Scene& scene, const Opening& opening) {
  const Domain& domain = scene.domain;
  const auto up = static_cast<std::size_t>(domain.dimensions - 1), normal = static_cast<std::size_t>(opening.axis);
  const double plane = opening.side == 0 ? domain.lower[normal] : domain.upper[normal];
  return parallel_max(scene.particles.size(), opening.lower[up], [&](std::size_t i) {
    for (std::size_t a = 0; a < up; ++a) {
      const double x = scene.particles.position[a][i];
      const bool before =
          a == normal ? std::abs(x - plane) < 2 * scene.spacing : x > opening.lower[a] && x < opening.upper[a];
      if (!before) return opening.lower[up];
    }
    return scene.particles.position[up][i] + scene.spacing / 2;
  });
}

}  // namespace

std::vector<Problem> open_side_warnings(const Draft& draft, const Scene& scene, const std::string& file) {
  std::vector<Problem> warnings;
  const Domain& domain = scene.domain;
  const int up = domain.dimensions - 1;
  // Without it liquid that nothing holds may stay where it is; beside an opening of its side the stream spreads there.
  const bool falls = scene.fluid.gravity[up] < 0;
  if (!falls && scene.openings.empty()) return warnings;
  const InitialParticles& particles = scene.particles;
  const Node* node = draft.node("domain");
  const auto warn = [&](const std::string& text) {
    warnings.push_back({file, node == nullptr ? 0 : node->place.line, node == nullptr ? 0 : node->place.column, text});
  };
  const auto count = [&](int axis, int side, auto&& meets) {
    return parallel_reduce(
        particles.size(), 0.0,
        [&](std::size_t first, std::size_t last) {
          const OpeningsOfSide openings(scene, axis, side);
          double sum = 0;
          for (std::size_t i = first; i < last; ++i) {
            Vec3 r{};
            for (int a = 0; a < domain.dimensions; ++a) r[a] = particles.position[a][i];
            sum += meets(r, openings) ? 1 : 0;
          }
          return sum;
        },
        [](double a, double b) { return a + b; });
  };
  SolidUnion::Planes sides{};
  for (int a = 0; a < domain.dimensions; ++a) sides[a] = {domain.lower[a], domain.upper[a]};
  const SolidUnion solids(domain, sides, scene.spacing);
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (int side = 0; side < 2; ++side) {
      if (domain.sides[axis][side].bounds_liquid() || (falls && axis == up && side == 1)) continue;
      if (!falls && !has_opening(scene, axis, side)) continue;
      const std::string name = side_names(axis, domain.dimensions)[static_cast<std::size_t>(side)];
      const double plane = side == 0 ? domain.lower[axis] : domain.upper[axis];
      const double loose = count(axis, side, [&](const Vec3& r, const OpeningsOfSide& openings) {
        if ((axis != up || !falls) && std::abs(r[axis] - plane) > scene.spacing) return false;
        if (!falls && openings.before(r)) return false;
        Vec3 foot = r;
        foot[axis] = plane + (side == 0 ? -1 : 1) * scene.spacing;
        return solids.sees(r, foot, foot) && !bodies_between(scene, r, foot);
      });
      if (loose == 0) continue;
      warn("nothing holds the liquid: domain." + name + " is open" + (falls ? "" : " around its opening") + " and " +
           std::to_string(static_cast<long long>(loose)) + " particles lie " +
           (falls && axis == up ? "above" : "beside") + " it, which leave the domain and are removed; set  " + name +
           " = \"free-slip\"  to hold them");
    }
  return warnings;
}

std::vector<Problem> outflow_warnings(const Draft& draft, const Scene& scene, const std::string& file) {
  std::vector<Problem> warnings;
  const int up = scene.domain.dimensions - 1;
  if (!scene.free_surface || !(scene.fluid.gravity[up] < 0)) return warnings;
  for (const Opening& opening : scene.openings) {
    if (opening.inflow || !opening.level || opening.axis == up) continue;
    const double surface = surface_before(scene, opening), end = draft.options.time.end;
    for (int n = 0; n <= level_samples; ++n) {
      const double t = end * n / level_samples, level = (*opening.level)(0, 0, 0, t);
      if (!(level > surface + scene.spacing)) continue;
      const Node* node = draft.node(opening.name + ".level");
      if (node == nullptr) node = draft.node(opening.name);
      warnings.push_back({file, node->place.line, node->place.column,
                          opening.name + ".level is " + brief(level) + " at t = " + brief(t) +
                              ", and the liquid before it stands at " + brief(surface) +
                              " at the start: an outflow does not fill a tank, what comes back through it at the "
                              "surface breaks up; let it enter by an [[inflow]] with flow_rate and level"});
      break;
    }
  }
  return warnings;
}

}  // namespace spume
