// SPDX-License-Identifier: MIT
#include "spume/particles/convex_corners.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "particles/walled.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/surface_pieces.hpp"

namespace spume::test {
namespace {

using CornerKind = ConvexCorner::Kind;

struct FoundCorner {
  Vec3 at{};
  ConvexCorner corner;
};

// At the corners of the pieces of the only body, which floats.
std::vector<FoundCorner> corners_found(const std::string& domain, const std::string& body, double spacing = 0.05) {
  const LoadedCase loaded = load_text(scene_text(domain, spacing, "[[body]]\ndensity = 2\n" + body));
  const int d = loaded.scene.domain.dimensions;
  const Resolution resolution(d, spacing, KernelKind::wendland_c2, 1.3);
  const BodyWalls walls(loaded.scene, resolution, loaded.scene.particles.volume);
  std::map<Vec3, Vec3> outwards;
  for (const SurfacePiece& piece : surface_pieces(loaded.scene.domain, loaded.scene.bodies[0], spacing))
    for (int k = 0; k < d; ++k) {
      Vec3& sum = outwards[piece.corner[static_cast<std::size_t>(k)]];
      sum = add(sum, unit(piece.area, d));
    }
  std::vector<FoundCorner> found;
  for (const auto& [at, normal] : outwards)
    found.push_back({at, convex_corner(walls.moving(0), at, normal, spacing, d)});
  return found;
}

// Ends of pieces that differ by rounding are one.
std::size_t corner_count(const std::vector<FoundCorner>& found, CornerKind kind) {
  std::vector<Vec3> places;
  for (const FoundCorner& f : found)
    if (f.corner.kind == kind &&
        std::none_of(places.begin(), places.end(), [&](const Vec3& at) { return length(subtract(at, f.at)) < 1e-9; }))
      places.push_back(f.at);
  return places.size();
}

// A polygon of n sides in a circle of radius 0.4.
std::string regular_polygon(int n) {
  std::string text = "shape = \"outline\"\npoints = [";
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * std::numbers::pi * k / n;
    text += "[" + std::to_string(0.4 * std::cos(angle)) + ", " + std::to_string(0.4 * std::sin(angle)) + "],";
  }
  return text + "]\n";
}

const std::string cubic_room = "lower = [-1, -1, -1]\nupper = [1, 1, 1]\nbottom = \"free-slip\"\n";

}  // namespace

TEST(ConvexCorners, OfPolygonsAreTheirCornersAndOfRoundShapesNone) {
  EXPECT_EQ(corner_count(corners_found(square, "shape = \"box\"\nsize = [0.43, 0.31]\nrotation = [17]\n"),
                         CornerKind::corner),
            4u);
  for (const int n : {3, 6, 24})
    EXPECT_EQ(corner_count(corners_found(square, regular_polygon(n)), CornerKind::corner), std::size_t(n));
  // Turns by 0.1 rad at each of its corners.
  EXPECT_EQ(corner_count(corners_found(square, regular_polygon(60)), CornerKind::corner), 0u);
  for (const double radius : {0.1, 0.4})
    EXPECT_EQ(corner_count(corners_found(square, "shape = \"ball\"\nradius = " + std::to_string(radius) + "\n"),
                           CornerKind::corner),
              0u);
  EXPECT_EQ(corner_count(corners_found(square, "shape = \"ellipsoid\"\nsemi_axes = [0.5, 0.2]\n"), CornerKind::corner),
            0u);
}

// An L has six corners, of which one is hollow.
TEST(ConvexCorners, HollowOnesAreNone) {
  const std::string points = "points = [[0, 0], [0.5, 0], [0.5, 0.2], [0.2, 0.2], [0.2, 0.5], [0, 0.5]]\n";
  for (const FoundCorner& f : corners_found(square, "shape = \"outline\"\n" + points)) {
    const bool at_corner = std::abs(f.at[0] * (f.at[0] - 0.2) * (f.at[0] - 0.5)) < 1e-9 &&
                           std::abs(f.at[1] * (f.at[1] - 0.2) * (f.at[1] - 0.5)) < 1e-9;
    const bool hollow = std::abs(f.at[0] - 0.2) < 1e-9 && std::abs(f.at[1] - 0.2) < 1e-9;
    const bool beside = (std::abs(f.at[0] - 0.2) < 1e-9 && f.at[1] < 1e-9) ||  // within the two long faces
                        (std::abs(f.at[1] - 0.2) < 1e-9 && f.at[0] < 1e-9);
    EXPECT_EQ(f.corner.kind == CornerKind::corner, at_corner && !hollow && !beside) << f.at[0] << " " << f.at[1];
  }
}

TEST(ConvexCorners, InSpaceAreToldFromEdges) {
  const Vec3 half{0.2, 0.15, 0.3};
  for (const FoundCorner& f : corners_found(cubic_room, "shape = \"box\"\nsize = [0.4, 0.3, 0.6]\n", 0.1)) {
    int faces = 0;
    Vec3 along{};
    for (int axis = 0; axis < 3; ++axis) {
      const bool on = std::abs(std::abs(f.at[axis]) - half[axis]) < 1e-9;
      faces += on;
      if (!on) along[axis] = 1;
    }
    EXPECT_EQ(f.corner.kind, faces == 3 ? CornerKind::corner : faces == 2 ? CornerKind::edge : CornerKind::none);
    if (f.corner.kind == CornerKind::edge) {
      EXPECT_NEAR(std::abs(dot(f.corner.along, along)), 1, 1e-6);
    }
  }
  for (const FoundCorner& f : corners_found(cubic_room, "shape = \"ball\"\nradius = 0.3\n", 0.1))
    EXPECT_EQ(f.corner.kind, CornerKind::none);
}

// A rim is an edge, whose direction is that of its circle.
TEST(ConvexCorners, RimsAreEdges) {
  std::size_t edges = 0;
  for (const FoundCorner& f : corners_found(cubic_room, "shape = \"cylinder\"\nradius = 0.3\nlength = 0.4\n", 0.1)) {
    const double radius = std::hypot(f.at[0], f.at[1]);
    const bool rim = std::abs(radius - 0.3) < 1e-6 && std::abs(std::abs(f.at[2]) - 0.2) < 1e-6;
    EXPECT_EQ(f.corner.kind, rim ? CornerKind::edge : CornerKind::none);
    if (!rim) continue;
    ++edges;
    EXPECT_NEAR(std::abs(f.corner.along[0] * -f.at[1] + f.corner.along[1] * f.at[0]) / radius, 1, 1e-3);
  }
  EXPECT_GT(edges, 10u);
}

}  // namespace spume::test
