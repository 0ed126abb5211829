// SPDX-License-Identifier: MIT
// What thin bodies hide, and the points behind their faces.
#include "spume/particles/thin_walls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "particles/walled.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/thin_bodies.hpp"

namespace spume::test {
namespace {

const std::string thin_tank =
    "lower = [0, 0]\nupper = [1.6, 1.2]\nleft = \"no-slip\"\nright = \"free-slip\"\nbottom = "
    "\"free-slip\"\n";
const std::string thin_tank_3d = "lower = [0, 0, 0]\nupper = [1, 0.8, 1]\nx = \"periodic\"\nbottom = \"free-slip\"\n";
// One spacing thick.
const std::string plate = "[[body]]\nshape = \"box\"\nsize = [0.6, 0.05]\nposition = [0.8, 0.6]\nrotation = [30]\n";
const std::string flat_plate = "[[body]]\nshape = \"box\"\nsize = [0.6, 0.05]\nposition = [0.8, 0.525]\n";
const std::string wall_of_a_tank =
    "[[body]]\nshape = \"box\"\nsize = [0.05, 4]\nposition = [0.825, 0.5]\nwall = "
    "\"no-slip\"\n";
const std::string plate_3d =
    "[[body]]\nshape = \"box\"\nsize = [0.7, 0.5, 0.1]\nposition = [0.9, 0.4, 0.5]\nrotation = [20, 30, 10]\n";

// The least distance along a straight way, at so many places that it is off by 1 % of a spacing in a support.
double least_distance(const Walled& walled, const Vec3& from, const Vec3& to) {
  constexpr int steps = 400;
  double least = infinite;
  for (int k = 0; k <= steps; ++k)
    least = std::min(least, walled.boundary.bodies()->thin()->distance(
                                add(multiply(1 - double(k) / steps, from), multiply(double(k) / steps, to))));
  return least;
}

// Of the particles of a lattice beside the bodies, without the surface.
std::array<double, 2> range_of_kernel_sums(const Walled& walled, double top) {
  const double h = walled.resolution.smoothing_length, reach = walled.resolution.support_radius;
  std::array<double, 2> range{infinite, 0};
  const NeighbourList& list = walled.arrangement.list;
  for (std::size_t i = 0; i < walled.particles.size(); ++i) {
    if (walled.boundary.bodies()->distance(walled.place(i)) > reach || walled.place(i)[1] > top) continue;
    double sum = WendlandC2::w(0.0);
    for (const std::int32_t j : list.of(i))
      sum += WendlandC2::w(
          std::hypot(list.coordinate(0)[j] - list.coordinate(0)[i], list.coordinate(1)[j] - list.coordinate(1)[i]) / h);
    sum *= walled.particles.volume * WendlandC2::normalisation(2) / (h * h) / walled.resolution.lattice.kernel_sum;
    range = {std::min(range[0], sum), std::max(range[1], sum)};
  }
  return range;
}

bool is_thin(const std::string& body, const std::string& domain = thin_tank, double spacing = 0.05) {
  const LoadedCase loaded = load_text(scene_text(domain, spacing, body));
  const Resolution resolution(loaded.scene.domain.dimensions, loaded.scene.spacing, KernelKind::wendland_c2, 1.3);
  return find_thin_bodies(loaded.scene, resolution)[0] != 0;
}

}  // namespace

TEST(ThinWalls, AreFlatBodiesThinnerThanTwiceTheSupport) {
  EXPECT_TRUE(is_thin(plate));
  EXPECT_TRUE(is_thin(plate_3d, thin_tank_3d, 0.1));
  const std::string of_width = "[[body]]\nshape = \"box\"\nposition = [0.8, 0.6]\nsize = [0.8, ";
  EXPECT_TRUE(is_thin(of_width + "0.24]\n"));
  EXPECT_FALSE(is_thin(of_width + "0.3]\n"));
  // Deeper than the support radius, 0.13, in the middle between places half a spacing apart.
  EXPECT_FALSE(is_thin(of_width + "0.265]\n"));
  EXPECT_FALSE(is_thin("[[body]]\nshape = \"box\"\nposition = [0.8, 0.6]\nrotation = [45]\nsize = [0.8, 0.265]\n"));
  // Pillars of 0.2 by 0.28 on the floor and through it.
  const std::string pillar = "[[body]]\nshape = \"box\"\nsize = [0.2, ";
  EXPECT_FALSE(is_thin(pillar + "0.28]\nposition = [0.8, 0.14]\n"));
  EXPECT_FALSE(is_thin(pillar + "0.78]\nposition = [0.8, -0.11]\n"));
  EXPECT_TRUE(is_thin(pillar + "0.78]\nposition = [0.8, 0.39]\n"));
  EXPECT_FALSE(is_thin("[[body]]\nshape = \"cylinder\"\nradius = 0.1\nposition = [0.8, 0.6]\n"));
  EXPECT_FALSE(is_thin("[[body]]\nshape = \"outline\"\npoints = [[0, 0], [1.6, 0], [1.6, 0.5]]\n"));
  EXPECT_FALSE(is_thin("[[body]]\nshape = \"box\"\nsize = [1, 1]\nposition = [0.8, 0.6]\ninside = false\n"));
  // A box 1.8 times as long as thick is none however it is turned, one 2.2 times as long is.
  const std::string of_thickness = "[[body]]\nshape = \"box\"\nposition = [0.8, 0.6]\nrotation = [30]\nsize = [";
  EXPECT_FALSE(is_thin(of_thickness + "0.36, 0.2]\n"));
  EXPECT_TRUE(is_thin(of_thickness + "0.44, 0.2]\n"));
  // A cylinder whose wall is a shell is not; one of twenty spacings radius that is cut is none either, as it is not
  // looked at.
  EXPECT_FALSE(
      is_thin("[[body]]\nshape = \"cylinder\"\nradius = 0.5\nposition = [0.8, 0.6]\n[[body]]\nshape = "
              "\"cylinder\"\nradius = 0.45\nposition = [0.8, 0.6]\nsubtract = true\n"));
}

// `spume check` warns of those that are none.
TEST(ThinWalls, AreThoseThatNobodyIsWarnedOf) {
  const auto is_warned_of = [](const std::string& body, const std::string& domain, double spacing) {
    const LoadedCase loaded = load_text(scene_text(domain, spacing, body));
    return std::any_of(loaded.options.warnings.begin(), loaded.options.warnings.end(), [](const Problem& problem) {
      return problem.text.find("is no plate with flat faces") != std::string::npos;
    });
  };
  for (const char* size :
       {"[0.12, 0.12]", "[0.16, 0.1]", "[0.2, 0.12]", "[0.26, 0.12]", "[0.2, 0.2]", "[0.24, 0.16]", "[0.5, 0.2]"}) {
    const std::string box =
        "[[body]]\nshape = \"box\"\nposition = [0.8, 0.6]\nrotation = [10]\nsize = " + std::string(size) + "\n";
    EXPECT_NE(is_thin(box), is_warned_of(box, thin_tank, 0.05)) << size;
  }
  for (const char* size : {"[0.4, 0.4, 0.24]", "[0.4, 0.4, 0.3]", "[0.8, 0.3, 0.3]", "[0.4, 0.3, 0.3]"}) {
    const std::string box = "[[body]]\nshape = \"box\"\nposition = [0.5, 0.4, 0.5]\nsize = " + std::string(size) + "\n";
    EXPECT_NE(is_thin(box, thin_tank_3d, 0.1), is_warned_of(box, thin_tank_3d, 0.1)) << size;
  }
}

TEST(ThinWalls, NoneCostNothing) {
  const Walled walled(scene_text(thin_tank, 0.05, turned));
  EXPECT_EQ(walled.boundary.bodies()->thin(), nullptr);
  EXPECT_EQ(walled.arrangement.images.sight(), nullptr);
  for (const WallPoint& point : walled.boundary.bodies()->all_points()) EXPECT_FALSE(point.one_sided);
}

// Two plates, A with friction, each with points past its ends, some nearer to the other's surface than to their own.
TEST(ThinWalls, PointsAreOfTheBodyOfTheirFace) {
  const std::string a = "[[body]]\nshape = \"box\"\nsize = [0.8, 0.1]\nposition = [0.7, 0.5]\nwall = \"no-slip\"\n";
  for (const char* b : {"size = [0.1, 0.5]\nposition = [0.8, 0.78]\nrotation = [-10]\n",
                        "size = [0.6, 0.1]\nposition = [0.85, 0.75]\nrotation = [50]\n",
                        "size = [0.1, 0.5]\nposition = [1.22, 0.62]\nrotation = [-10]\n"}) {
    const Walled walled(scene_text(thin_tank, 0.05, a + "[[body]]\nshape = \"box\"\n" + b));
    const BodyWalls& bodies = *walled.boundary.bodies();
    std::size_t wet = 0, of_a = 0;
    for (std::size_t g = 0; g < bodies.points(); ++g) {
      if (!bodies.is_wet(g)) continue;
      const WallPoint& point = bodies.all_points()[g];
      const bool no_slip = bodies.stencils().no_slip[wet++] != 0;
      if (!point.one_sided) continue;
      // The faces of A are along the axes, those of B are not.
      const bool along_axes = std::max(std::abs(point.normal[0]), std::abs(point.normal[1])) > 0.9999;
      EXPECT_EQ(no_slip, along_axes) << "at " << point.position[0] << " " << point.position[1];
      of_a += along_axes ? 1 : 0;
    }
    EXPECT_GT(of_a, 50U);
    EXPECT_GT(wet, of_a + 50);
  }
}

TEST(ThinWalls, HideWhatAStraightWayThroughThemLeadsTo) {
  for (const std::string& text :
       {scene_text(thin_tank, 0.05, plate + wall_of_a_tank), scene_text(thin_tank_3d, 0.1, plate_3d)}) {
    const Walled walled(text);
    const ThinWalls& thin = *walled.boundary.bodies()->thin();
    const double spacing = walled.resolution.spacing;
    std::size_t hidden = 0, seen = 0;
    for (std::size_t i = 0; i < walled.particles.size(); ++i)
      for (std::size_t j = i + 1; j < walled.particles.size(); ++j) {
        const Vec3 a = walled.place(i), b = walled.place(j);
        if (length(subtract(a, b)) > walled.resolution.support_radius) continue;
        if (walled.boundary.bodies()->distance(a) > walled.resolution.support_radius) continue;
        const bool hides = thin.hides(a, b);
        ASSERT_EQ(hides, thin.hides(b, a));
        const double least = least_distance(walled, a, b);
        // No deeper than a tenth of a spacing may pass, and what does not touch passes.
        if (least < -0.11 * spacing) {
          ASSERT_TRUE(hides) << least / spacing;
        } else if (least > 0) {
          ASSERT_FALSE(hides) << least / spacing;
        }
        ++(hides ? hidden : seen);
      }
    EXPECT_GT(hidden, 50U);
    EXPECT_GT(seen, 50U);
  }
}

// Neither particles nor images of them nor wall points that stand for liquid beyond, beside periodic and mirror sides
// and round the edges of the plate too.
TEST(ThinWalls, ListsHoldNothingThatTheyHide) {
  const std::array<std::int8_t, 3> not_mirrored{-1, -1, -1};
  for (const std::string& text :
       {scene_text(thin_tank, 0.05, plate + wall_of_a_tank), scene_text(thin_tank_3d, 0.1, plate_3d)}) {
    const Walled walled(text);
    const BodyWalls& bodies = *walled.boundary.bodies();
    const ThinWalls& thin = *bodies.thin();
    const Images& images = walled.arrangement.images;
    const auto n = static_cast<std::int32_t>(walled.particles.size());
    std::size_t of_liquid = 0, of_faces = 0;
    for (std::size_t i = 0; i < walled.particles.size(); ++i) {
      const Vec3 eye = walled.place(i);
      for (const std::int32_t j : walled.arrangement.list.of(i)) {
        Vec3 place{};
        for (int axis = 0; axis < walled.particles.dimensions; ++axis)
          place[axis] = j < n ? walled.place(static_cast<std::size_t>(j))[axis] : images.position(axis)[j - n];
        const std::int32_t g = j < n ? -1 : images.wall_point()[j - n];
        if (g < 0) {
          ++of_liquid;
          ASSERT_FALSE(thin.hides(eye, place));
          continue;
        }
        ++of_faces;
        // Where a way into a body begins, what the point holds comes from there without crossing one.
        const auto entry = thin.entry(eye, thin.distance(eye), place);
        // Points past an edge complete what is seen there, also from beyond it; those of corners are seen through one
        // face and mirrored at both.
        const bool not_behind_face =
            std::any_of(bodies.all_points().begin(), bodies.all_points().end(), [&](const WallPoint& point) {
              return (point.past_edge || point.in_corner) &&
                     length(subtract(point.position, place)) < 1e-3 * walled.resolution.spacing;
            });
        const bool mirrored = images.paths()[static_cast<std::size_t>(images.path()[j - n])].side != not_mirrored;
        if (not_behind_face || mirrored) continue;
        if (!entry) {
          // Past an edge, by so little that the plane of the face counts for the face.
          ASSERT_LT(least_distance(walled, eye, place), 0.1 * walled.resolution.spacing);
          continue;
        }
        // An eye on a surface may enter either of two faces.
        if (thin.distance(eye) < 0.1 * walled.resolution.spacing) continue;
        const Vec3 before = add(entry->place, multiply(0.1 * walled.resolution.spacing, entry->normal));
        const WallStencils& stencils = bodies.stencils();
        for (std::int64_t k = stencils.first[g]; k < stencils.first[g + 1]; ++k) {
          const Vec3 source = walled.place(static_cast<std::size_t>(stencils.source[k]));
          if (length(subtract(source, eye)) < 0.5 && std::abs(stencils.coefficient[k]) > 0.2) {
            EXPECT_GT(least_distance(walled, before, source), -0.11 * walled.resolution.spacing)
                << "of " << eye[0] << " " << eye[1] << " " << eye[2];
          }
        }
      }
    }
    EXPECT_GT(of_liquid, 1000U);
    EXPECT_GT(of_faces, 100U);
  }
}

// A lattice beside a plate that fits it, which ends in the liquid, and beside a wall that divides the tank down to its
// floor: sums are those of a lattice within 3 % at the wall and 8 % at the edges, where points are reflected off the
// lattice. Without what lies past the edges they are down to 0.80, with what is hidden up to 1.3.
TEST(ThinWalls, EveryPlaceAroundThemIsSeenOnce) {
  const auto divided = range_of_kernel_sums(Walled(scene_text(thin_tank, 0.05, wall_of_a_tank), 0), 1);
  EXPECT_GT(divided[0], 0.96);
  EXPECT_LT(divided[1], 1.04);
  const auto ends = range_of_kernel_sums(Walled(scene_text(thin_tank, 0.05, flat_plate), 0), 1);
  EXPECT_GT(ends[0], 0.92);
  EXPECT_LT(ends[1], 1.08);
}

// A plate that stands on a floor of its own, both thin. Of the sum of a lattice at half a spacing from both the
// quadrant behind both faces has 4.6 %, so that without it the sum there is below 0.95.
TEST(ThinWalls, CornersMirrorTheLiquidAtBothFaces) {
  const std::string floor = "[[body]]\nshape = \"box\"\nsize = [4, 0.1]\nposition = [0.8, 0.15]\n";
  const Walled walled(scene_text(thin_tank, 0.05,
                                 floor + "[[body]]\nshape = \"box\"\nsize = [0.05, 0.6]\nposition = "
                                         "[0.825, 0.5]\n"),
                      0);
  const auto range = range_of_kernel_sums(walled, 0.6);
  EXPECT_GT(range[0], 0.96);
  EXPECT_LT(range[1], 1.04);
  const double h = walled.resolution.smoothing_length;
  const NeighbourList& list = walled.arrangement.list;
  std::size_t corners = 0;
  for (std::size_t i = 0; i < walled.particles.size(); ++i) {
    const Vec3 eye = walled.place(i);
    const double plate = eye[0] < 0.825 ? 0.8 : 0.85, side = eye[0] < 0.825 ? 1 : -1;
    if (std::abs(std::abs(eye[0] - 0.825) - 0.05) > 1e-6 || std::abs(eye[1] - 0.225) > 1e-6) continue;
    ++corners;
    double behind_both = 0, on_lattice = 0;
    const auto weight = [&](double x, double y) {
      return walled.particles.volume * WendlandC2::normalisation(2) / (h * h) * WendlandC2::w(std::hypot(x, y) / h);
    };
    for (const std::int32_t j : list.of(i)) {
      const double x = list.coordinate(0)[j] - list.coordinate(0)[i], y = list.coordinate(1)[j] - list.coordinate(1)[i];
      if (side * (eye[0] + x - plate) > 0 && eye[1] + y < 0.2) behind_both += weight(x, y);
    }
    for (int k = 1; k <= 2; ++k)
      for (int l = 1; l <= 2; ++l) on_lattice += weight(0.05 * k, 0.05 * l);
    EXPECT_NEAR(behind_both, on_lattice, 0.15 * on_lattice) << "of " << eye[0];
  }
  EXPECT_EQ(corners, 2U);
}

TEST(ThinWalls, WaysThroughThemAreReflected) {
  const Walled walled(scene_text(thin_tank, 0.05, wall_of_a_tank));
  // 1.1 spacings in a step, past the middle of the plate and out of its other side.
  for (const double end : {0.81, 0.83, 0.86}) {
    const Vec3 from{0.795, 0.5, 0};
    Vec3 place{end, 0.51, 0}, velocity{1, 0.2, 0};
    walled.boundary.apply_walls(walled.boundary.walls, place, &velocity, &from);
    EXPECT_LT(place[0], 0.8);
    EXPECT_GT(place[0], 0.73);
    EXPECT_EQ(velocity[0], 0);
    EXPECT_EQ(velocity[1], 0.2);
  }
}

TEST(ThinWalls, WaysThatEndBeforeThemAreLeftAlone) {
  const Walled walled(scene_text(thin_tank, 0.05, wall_of_a_tank));
  const Vec3 from{0.79, 0.5, 0}, to{0.7985, 0.5, 0};  // to 0.03 spacings before it
  Vec3 place = to, velocity{1, 0.2, 0};
  walled.boundary.apply_walls(walled.boundary.walls, place, &velocity, &from);
  EXPECT_EQ(place, to);
  EXPECT_EQ(velocity[0], 1);
}

// Two plates that move apart: each holds what meets it with its own velocity.
TEST(ThinWalls, EachOfThemHoldsWithItsVelocity) {
  const auto plate_at = [](double x, const std::string& way) {
    return "[[body]]\nshape = \"box\"\nsize = [0.05, 0.6]\nposition = [" + std::to_string(x) +
           ", 0.6]\ndisplacement = [\"" + way + "\", \"0\"]\n";
  };
  Walled walled(scene_text(thin_tank, 0.05, plate_at(0.525, "-0.25*t") + plate_at(0.825, "0.5*t")));
  BodyWalls& bodies = *walled.boundary.bodies();
  bodies.move_to(0);
  bodies.accept();
  bodies.move_to(0.01);
  for (const bool first : {true, false}) {
    const double face = first ? 0.5 - 0.0025 : 0.8 + 0.005, own = first ? -0.25 : 0.5;
    const Vec3 from{first ? 0.495 : 0.795, 0.6, 0};
    Vec3 place{face + 0.02, 0.6, 0}, velocity{1, 0.2, 0};
    walled.boundary.apply_walls(walled.boundary.walls, place, &velocity, &from);
    EXPECT_LT(place[0], face);
    EXPECT_NEAR(velocity[0], own, 1e-9);  // of a motion, by differences over time
    EXPECT_EQ(velocity[1], 0.2);
  }
}

}  // namespace spume::test
