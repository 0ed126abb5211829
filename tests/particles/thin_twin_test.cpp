// SPDX-License-Identifier: MIT
// Lists, fits and sums beside thin bodies against those of a slow twin that looks along every way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "particles/walled.hpp"
#include "reference/thin_sight.hpp"
#include "spume/operators/sph_operators.hpp"

namespace spume::test {
namespace {

using reference::ThinSight;
using Answer = ThinSight::Answer;

const std::string open_space =
    "lower = [-0.8, -0.7, -0.7]\nupper = [0.8, 0.7, 0.7]\nleft = \"open\"\nright = \"open\"\nfront = \"open\"\nback = "
    "\"open\"\nbottom = \"open\"\n";

// With its ends in the liquid.
Layout ell_in_space() {
  return {"L in space",
          scene_text(open_space, 0.1,
                     "[[body]]\nshape = \"outline\"\npoints = [[-0.35, -0.3], [0.35, -0.3], [0.35, -0.1], "
                     "[-0.15, -0.1], [-0.15, 0.3], [-0.35, 0.3]]\nlength = 0.5\nrotation = [0, 20, 0]\n")};
}

std::vector<Layout> thin_layouts() {
  const std::string plane =
      "lower = [-0.7, -0.6]\nupper = [0.7, 0.6]\nleft = \"open\"\nright = \"open\"\nbottom = \"open\"\n";
  return {
      {"plate", scene_text(plane, 0.05,
                           "[[body]]\nshape = \"box\"\nsize = [0.6, 0.05]\nposition = [0.02, 0.01]\nrotation = "
                           "[30]\nwall = \"no-slip\"\nvelocity = [\"0.3\", \"y\"]\n")},
      {"L", scene_text(plane, 0.05,
                       "[[body]]\nshape = \"outline\"\npoints = [[-0.3, -0.2], [0.3, -0.2], [0.3, -0.1], [-0.2, -0.1], "
                       "[-0.2, 0.3], [-0.3, 0.3]]\nrotation = [20]\nwall = \"no-slip\"\n")},
      {"fold",
       scene_text(
           plane, 0.05,
           "[[body]]\nshape = \"outline\"\npoints = [[-0.35, -0.02], [-0.01, -0.02], [0.32, 0.16], [0.28, 0.25], "
           "[-0.03, 0.08], [-0.35, 0.08]]\n")},
      {"plate in space", scene_text(open_space, 0.1,
                                    "[[body]]\nshape = \"box\"\nsize = [0.7, 0.5, 0.1]\nrotation = [20, 30, 10]\n"
                                    "wall = \"no-slip\"\n")}};
}

// Values that differ on the two sides.
reference::Carried split(const Vec3& r) {
  reference::Carried carried = smooth(r);
  if (r[1] + 0.3 * r[0] > 0) carried.scalar += 10;
  return carried;
}

struct ThinTwin {
  const Walled& walled;
  ThinSight sight{walled.scene().walls, walled.resolution.spacing};
  std::vector<std::size_t> wet;  // among all wall points
  reference::WallSums sums = walled.twin(split);
  mutable bool unclear = false;  // something asked since it was set to false

  explicit ThinTwin(const Walled& of) : walled(of) {
    const BodyWalls& bodies = *of.boundary.bodies();
    for (std::size_t g = 0; g < bodies.points(); ++g)
      if (bodies.is_wet(g)) wet.push_back(g);
    sums.sees = [this](const Vec3& from, const Vec3& to) {
      // Within reach of any sum or fit.
      if (length(subtract(from, to)) > 1.3 * sums.support_radius) return true;
      return take(sight.between(from, to));
    };
    sums.sees_point = [this](const Vec3& eye, const WallPoint& point) {
      if (length(subtract(eye, point.position)) > sums.support_radius) return true;
      return take(sight.point(eye, point));
    };
  }
  ThinTwin(const ThinTwin&) = delete;
  bool take(Answer answer) const {
    unclear = unclear || answer == Answer::unclear;
    return answer == Answer::yes;
  }
  // Three times as many particles as monomials, on all sides of the mirror but that of the wall.
  bool bears_quadratics(const WallPoint& point) const {
    const Domain& domain = walled.scene().domain;
    for (int axis = 0; axis < domain.dimensions; ++axis)
      if (std::min(point.mirror[axis] - domain.lower[axis], domain.upper[axis] - point.mirror[axis]) <
          1.25 * sums.support_radius)
        return false;
    return sums.near(point).offset.size() > 3 * sums.monomials({}, 2).size();
  }
  const WallPoint& point(std::size_t g) const { return walled.boundary.bodies()->all_points()[g]; }
};

}  // namespace

TEST(ThinTwins, ListsHoldWhatItSees) {
  std::vector<Layout> layouts = thin_layouts();
  layouts.push_back(ell_in_space());
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    const Walled walled(layout.text);
    ASSERT_NE(walled.boundary.bodies()->thin(), nullptr);
    const ThinTwin twin(walled);
    const NeighbourList& list = walled.arrangement.list;
    const Images& images = walled.arrangement.images;
    const auto n = static_cast<std::int32_t>(walled.particles.size());
    std::size_t clear = 0, unclear = 0, behind = 0;
    for (std::size_t i = 0; i < walled.particles.size(); ++i) {
      const Vec3 eye = walled.place(i);
      if (walled.boundary.bodies()->distance(eye) > walled.resolution.support_radius) continue;
      std::set<std::int32_t> particles, points;
      for (const std::int32_t j : list.of(i))
        (j < n ? particles : points).insert(j < n ? j : images.wall_point()[j - n]);
      const auto compare = [&](Answer answer, bool listed, double r) {
        // Single precision decides at the rim.
        if (std::abs(r - walled.resolution.support_radius) < 1e-4 * walled.resolution.spacing) return;
        ++(answer == Answer::unclear ? unclear : clear);
        if (answer != Answer::unclear && r < walled.resolution.support_radius) {
          EXPECT_EQ(listed, answer == Answer::yes);
        }
      };
      for (std::int32_t j = 0; j < n; ++j) {
        const Vec3 place = walled.place(static_cast<std::size_t>(j));
        const double r = length(subtract(place, eye));
        if (r > walled.resolution.support_radius || j == static_cast<std::int32_t>(i)) continue;
        compare(twin.sight.between(eye, place), particles.contains(j), r);
      }
      for (std::size_t g = 0; g < twin.wet.size(); ++g) {
        const WallPoint& point = twin.point(twin.wet[g]);
        const double r = length(subtract(point.position, eye));
        if (r > walled.resolution.support_radius) continue;
        ++behind;
        compare(twin.sight.point(eye, point), points.contains(static_cast<std::int32_t>(g)), r);
      }
    }
    EXPECT_GT(behind, 300U);
    EXPECT_GT(clear, 10 * unclear);
  }
}

TEST(ThinTwins, FitsAndSumsAreTheSame) {
  for (const Layout& layout : thin_layouts()) {
    SCOPED_TRACE(layout.name);
    Walled walled(layout.text);
    const ThinTwin twin(walled);
    const int d = walled.particles.dimensions;
    const std::size_t n = walled.particles.size();
    const WallStencils& stencils = walled.boundary.bodies()->stencils();
    Array<double> scalar(n);
    std::array<Array<double>, 3> velocity;
    for (auto& component : velocity) component.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      scalar[i] = twin.sums.value[i].scalar;
      for (std::size_t axis = 0; axis < 3; ++axis) velocity[axis][i] = twin.sums.value[i].velocity[axis];
    }
    std::vector<WallPoint> points;
    std::vector<reference::Carried> carried[2];
    std::vector<bool> is_clear;
    std::size_t fits = 0;
    for (std::size_t g = 0; g < twin.wet.size(); ++g) {
      const WallPoint& point = twin.point(twin.wet[g]);
      points.push_back(point);
      twin.unclear = false;
      for (const bool friction : {false, true})
        carried[friction].push_back(twin.sums.at(point, walled.scene().bodies[0], friction));
      is_clear.push_back(!twin.unclear && twin.bears_quadratics(point));
      if (!is_clear.back()) {
        carried[0].back().scalar = stencils.mirrored(g, scalar.data());
        continue;
      }
      ++fits;
      EXPECT_NEAR(stencils.mirrored(g, scalar.data()), carried[0].back().scalar, 1e-7);
    }
    EXPECT_GT(fits, twin.wet.size() / 3);
    std::array<Array<float>, 6> identity;
    std::array<const float*, 6> correction{};
    for (std::size_t k = 0; k < 6; ++k) {
      const bool diagonal = d == 2 ? k == 0 || k == 2 : k == 0 || k == 3 || k == 5;
      identity[k] = Array<float>(n, diagonal ? 1.0F : 0.0F);
      correction[k] = identity[k].data();
    }
    std::array<Array<float>, 3> gradient, viscous;
    std::array<float*, 3> gradient_out{}, viscous_out{};
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(d); ++axis) {
      gradient[axis].resize(n);
      viscous[axis].resize(n);
      gradient_out[axis] = gradient[axis].data();
      viscous_out[axis] = viscous[axis].data();
    }
    const Array<float> kappa(n, 1.0F);
    const std::array<const double*, 3> u{velocity[0].data(), velocity[1].data(), d == 3 ? velocity[2].data() : nullptr};
    gradient_sweep(walled.arrangement.context, walled.arrangement.packed, scalar.data(), 0, correction, gradient_out);
    viscous_sweep(walled.arrangement.context, walled.arrangement.packed, u, walled.boundary.velocity_rule(),
                  kappa.data(), viscous_out, false);
    // As sums beside thick bodies, of values up to ten.
    const double h = walled.resolution.smoothing_length, tolerance = d == 2 ? 4e-5 : 8e-5;
    std::size_t sums = 0, beside = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (walled.boundary.bodies()->distance(walled.place(i)) > walled.resolution.support_radius) continue;
      ++beside;
      Vec3 of_gradient{}, of_viscous{};
      twin.unclear = false;
      bool all_clear = true;
      for (std::size_t g = 0; g < points.size(); ++g)
        all_clear = all_clear && (is_clear[g] || length(subtract(points[g].position, walled.place(i))) >
                                                     walled.resolution.support_radius);
      twin.sums.sum(i, points, carried[0], false, [&](const Vec3& way, double r, const reference::Carried& other) {
        for (int axis = 0; axis < d; ++axis)
          of_gradient[axis] += twin.sums.g(r) * (other.scalar - twin.sums.value[i].scalar) * way[axis];
      });
      twin.sums.sum(i, points, carried[1], true, [&](const Vec3&, double r, const reference::Carried& other) {
        for (int axis = 0; axis < d; ++axis)
          of_viscous[axis] += 2 * twin.sums.g(r) * (other.velocity[axis] - twin.sums.value[i].velocity[axis]);
      });
      if (twin.unclear) continue;
      ++sums;
      for (int axis = 0; axis < d; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        EXPECT_NEAR(gradient[a][i] * h, of_gradient[axis] * h, tolerance);
        if (!all_clear) continue;
        EXPECT_NEAR(viscous[a][i] * h * h, of_viscous[axis] * h * h, tolerance);
      }
    }
    EXPECT_GT(10 * sums, beside) << sums << " of " << beside;
  }
}

}  // namespace spume::test
