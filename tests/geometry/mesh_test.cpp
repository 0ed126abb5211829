// SPDX-License-Identifier: MIT
#include "spume/geometry/mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <numeric>
#include <sstream>

#include "solids.hpp"
#include "spume/core/error.hpp"
#include "support/temporary_folder.hpp"

// Of the leak sanitizer: assimp 5.2 loses a mesh of 1.3 kB for every OBJ file that it refuses.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp";
}

namespace spume {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Bounds window{{-1, -1, -1}, {1, 1, 1}};

Vec3 corner(const TriangleSurface& surface, std::size_t t, std::size_t k) {
  return surface.points[static_cast<std::size_t>(surface.triangles[t][k])];
}

std::string ascii_stl(const TriangleSurface& surface) {
  std::ostringstream text;
  text << "solid part\n";
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = corner(surface, t, k);
      text << "vertex " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    }
    text << "endloop\nendfacet\n";
  }
  text << "endsolid part\n";
  return text.str();
}

std::string binary_stl(const TriangleSurface& surface) {
  std::string data(80, ' ');
  const auto put = [&](auto value) { data.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(static_cast<std::uint32_t>(surface.triangles.size()));
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) put(0.f);
    for (std::size_t k = 0; k < 3; ++k)
      for (const double x : corner(surface, t, k)) put(static_cast<float>(x));
    put(std::uint16_t{0});
  }
  return data;
}

std::string obj(const TriangleSurface& surface) {
  std::ostringstream text;
  for (const Vec3& p : surface.points) text << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (const auto& [a, b, c] : surface.triangles) text << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return text.str();
}

std::string ply(const TriangleSurface& surface) {
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << surface.points.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face " << surface.triangles.size()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& p : surface.points) text << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (const auto& [a, b, c] : surface.triangles) text << "3 " << a << ' ' << b << ' ' << c << '\n';
  return text.str();
}

// Both byte orders, with values that are not asked for.
std::string binary_ply(const TriangleSurface& surface, bool big) {
  std::string data =
      std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
      "_endian 1.0\r\ncomment made by hand\r\nelement vertex " + std::to_string(surface.points.size()) +
      "\r\nproperty double x\r\nproperty float y\r\nproperty uchar red\r\nproperty float z\r\nelement face " +
      std::to_string(surface.triangles.size()) +
      "\r\nproperty list uchar float texture\r\nproperty list uint ushort vertex_index\r\nend_header\r\n";
  const auto put = [&](auto value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    if (big) std::reverse(bytes, bytes + sizeof value);
    data.append(bytes, sizeof value);
  };
  for (const Vec3& p : surface.points) {
    put(p[0]);
    put(static_cast<float>(p[1]));
    put(std::uint8_t{7});
    put(static_cast<float>(p[2]));
  }
  for (const auto& triangle : surface.triangles) {
    put(std::uint8_t{2});
    put(0.5f);
    put(0.25f);
    put(std::uint32_t{3});
    for (const std::int32_t corner : triangle) put(static_cast<std::uint16_t>(corner));
  }
  return data;
}

std::string refusal_of(const std::string& path) {
  try {
    read_mesh(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Every triangle for itself: the distance without a tree, and the share of directions that look at an inner side as the
// sign.
double brute_distance(const TriangleSurface& surface, const Vec3& p) {
  double best = 1e300, angle = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const Vec3 a = corner(surface, t, 0), b = corner(surface, t, 1), c = corner(surface, t, 2);
    // Golden sections along one side, for each place the nearest along the other: convex in both.
    const auto along_line = [&](double s) {
      const Vec3 from = moved(a, s, between(a, b)), way = between(a, c), to = between(from, p);
      const double square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
      const double u = std::clamp((way[0] * to[0] + way[1] * to[1] + way[2] * to[2]) / square, 0.0, 1 - s);
      return length_of(between(moved(from, u, way), p));
    };
    double low = 0, high = 1;
    for (int n = 0; n < 60; ++n) {
      const double left = high - 0.618 * (high - low), right = low + 0.618 * (high - low);
      (along_line(left) < along_line(right) ? high : low) = along_line(left) < along_line(right) ? right : left;
    }
    best = std::min(best, along_line(0.5 * (low + high)));
    const Vec3 u = between(p, a), v = between(p, b), w = between(p, c);
    const auto dot = [](const Vec3& x, const Vec3& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; };
    const Vec3 cross{v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]};
    const double lu = length_of(u), lv = length_of(v), lw = length_of(w);
    angle += 2 * std::atan2(dot(u, cross), lu * lv * lw + dot(u, v) * lw + dot(v, w) * lu + dot(w, u) * lv);
  }
  return angle > 2 * std::numbers::pi ? -best : best;
}

TEST(Mesh, DistancesAreThoseOfEveryTriangleForItself) {
  const TriangleSurface surfaces[] = {make_outline(notched, 1.0, 3)->surface(window, 0.1),
                                      make_cone(0.6, 0, 1.2, 3)->surface(window, 0.3),
                                      make_box({1.2, 0.8, 1.6}, 3)->surface(window, 0.3)};
  for (const TriangleSurface& surface : surfaces) {
    const ShapePointer mesh = make_mesh(surface);
    for (std::uint64_t i = 0; i < 200; ++i) {
      const Vec3 p = random_point(i, 1.4, 3);
      const NearestPoint found = mesh->nearest(p);
      const double brute = brute_distance(surface, p);
      // Golden sections find the place to 1e-8 of a side, as flat as the distance is there in rounding.
      EXPECT_NEAR(found.distance, brute, 1e-7) << i;
      EXPECT_NEAR(length_of(found.normal), 1, 1e-12);
      EXPECT_NEAR(length_of(between(p, found.point)), std::abs(found.distance), 1e-12);
    }
  }
}

// Several levels of the tree, slivers at its poles, triangles of very different sizes: points beside the surface, in
// the middle, where nothing is much nearer than the rest, and far away.
TEST(Mesh, TheNearestOfManyTrianglesIsFound) {
  TriangleSurface surface = make_ellipsoid({0.9, 0.5, 0.3}, 3)->surface(window, 0.1);
  const TriangleSurface box = place(make_box({0.1, 6, 0.2}, 3), {{2, 0, 0}}, true, 3)->surface(window, 1);
  const auto first = static_cast<std::int32_t>(surface.points.size());
  surface.points.insert(surface.points.end(), box.points.begin(), box.points.end());
  for (const auto& [a, b, c] : box.triangles) surface.triangles.push_back({a + first, b + first, c + first});
  ASSERT_GT(surface.triangles.size(), 1000u);
  const ShapePointer mesh = make_mesh(surface);
  for (std::uint64_t i = 0; i < 120; ++i) {
    Vec3 p = random_point(i, i % 4 == 3 ? 100 : 1.2, 3);
    if (i % 4 == 1) p = moved(corner(surface, 7 * i, 0), 1e-3, p);
    if (i % 4 == 2) p = moved({0, 0, 0}, 0.05, p);
    const double brute = brute_distance(surface, p);
    // Golden sections find the place to 1e-8 of a side, as flat as the distance is there in rounding.
    EXPECT_NEAR(mesh->distance(p), brute, 1e-7 * std::max(1.0, std::abs(brute))) << i;
  }
}

// What a mesh of flat faces bounds is the shape that it was made from.
TEST(Mesh, FlatShapesAndTheirMeshesAreTheSame) {
  for (const ShapePointer& shape :
       {make_box({1.2, 0.8, 1.6}, 3), make_outline(notched, 1.0, 3),
        place(make_box({0.5, 1, 0.7}, 3), {{0.2, 0.1, 0}, rotation_by({10, 20, 30}), 1.5}, true, 3)}) {
    const ShapePointer mesh = make_mesh(shape->surface(window, 0.1));
    EXPECT_NEAR(mesh->volume(), shape->volume(), 1e-12);
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const Vec3 p = random_point(i, 1.5, 3);
      const NearestPoint found = mesh->nearest(p), exact = shape->nearest(p);
      EXPECT_NEAR(found.distance, exact.distance, 1e-12);
      // Where two faces are as near, either will do.
      if (length_of(between(found.point, exact.point)) < 1e-9) {
        EXPECT_LT(length_of(between(found.normal, exact.normal)), 1e-9);
      }
    }
    for (const Vec3& p : mesh->surface(window, 1).points) {
      const NearestPoint found = mesh->nearest(p);
      EXPECT_NEAR(found.distance, 0, 1e-15);
      EXPECT_NEAR(length_of(found.normal), 1, 1e-12);
    }
  }
}

TEST(Mesh, EveryFormatGivesTheSameTriangles) {
  const TemporaryFolder folder;
  const TriangleSurface box = make_box({1, 2, 0.5}, 3)->surface(window, 1);
  write_contents(folder / "a.stl", ascii_stl(box));
  write_contents(folder / "b.STL", binary_stl(box));
  write_contents(folder / "c.obj", obj(box));
  write_contents(folder / "d.ply", ply(box));
  write_contents(folder / "e.ply", binary_ply(box, false));
  write_contents(folder / "f.ply", binary_ply(box, true));
  for (const char* name : {"a.stl", "b.STL", "c.obj", "d.ply", "e.ply", "f.ply"}) {
    SCOPED_TRACE(name);
    const TriangleSurface read = read_mesh(folder / name);
    EXPECT_EQ(read.points.size(), 8u);
    ASSERT_EQ(read.triangles.size(), 12u);
    EXPECT_THAT(mesh_faults(read), IsEmpty());
    for (std::size_t t = 0; t < 12; ++t)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(corner(read, t, k), corner(box, t, k));
    EXPECT_NEAR(enclosed_volume(read), 1, 1e-15);
  }
  // As gzip leaves it, whole and cut off.
  const std::string path = folder / "g.ply.gz";
  const auto zipped = gzopen(path.c_str(), "wb");
  const std::string text = ply(box);
  ASSERT_EQ(gzwrite(zipped, text.data(), static_cast<unsigned>(text.size())), static_cast<int>(text.size()));
  gzclose(zipped);
  EXPECT_EQ(read_mesh(path).triangles, read_mesh(folder / "d.ply").triangles);
  EXPECT_EQ(read_mesh(path).points, read_mesh(folder / "d.ply").points);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 20);
  EXPECT_THAT(refusal_of(path), HasSubstr("is damaged"));
  // Polygons, and corners that share a place but not a number.
  write_contents(folder / "quads.obj",
                 "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv 0 0 0\n"
                 "f 4 3 2 1\nf 5 6 7 8\nf 9 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  const TriangleSurface cube = read_mesh(folder / "quads.obj");
  EXPECT_EQ(cube.points.size(), 8u);
  EXPECT_THAT(mesh_faults(cube), IsEmpty());
  EXPECT_NEAR(enclosed_volume(cube), 1, 1e-15);
}

TriangleSurface two_boxes(double size, const Vec3& at, bool turned) {
  TriangleSurface both = make_box({1, 1, 1}, 3)->surface(window, 1);
  const ShapePointer other = place(make_box({size, size, size}, 3), {at}, !turned, 3);
  const TriangleSurface second = other->surface(window, 1);
  const auto first = static_cast<std::int32_t>(both.points.size());
  both.points.insert(both.points.end(), second.points.begin(), second.points.end());
  for (const auto& [a, b, c] : second.triangles) both.triangles.push_back({a + first, b + first, c + first});
  return both;
}

TEST(Mesh, FaultsAreNamedWithTheirTriangleAndPlace) {
  const TriangleSurface good = make_box({2, 2, 2}, 3)->surface(window, 1);
  TriangleSurface mesh = good;
  EXPECT_THAT(mesh_faults(mesh), IsEmpty());

  mesh.triangles.erase(mesh.triangles.begin() + 4);
  EXPECT_THAT(mesh_faults(mesh),
              ElementsAre(AllOf(HasSubstr("it is not closed: the edge from ("),
                                HasSubstr("belongs to no other triangle (the first of 3 such edges); "
                                          "expected two triangles at every edge"))));

  mesh = good;
  std::swap(mesh.triangles[6][0], mesh.triangles[6][1]);
  EXPECT_THAT(mesh_faults(mesh),
              ElementsAre(AllOf(HasSubstr("triangle 7 at ("), HasSubstr("is turned over against "))));

  mesh = good;
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_THAT(mesh_faults(mesh),
              ElementsAre(AllOf(HasSubstr("it is inside out: its 12 triangles with triangle 1 at (-0.333333, -1, "),
                                HasSubstr("inside = false"))));

  // A corner drawn on to the middle of the opposite side of its triangle.
  mesh = good;
  mesh.points.push_back({0, 0, -1});
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_THAT(mesh_faults(mesh), ElementsAre(HasSubstr("triangle 13 at (")));
  EXPECT_THAT(mesh_faults(mesh).front(), HasSubstr("has no area"));

  mesh = good;
  mesh.points.push_back({0, 0, 5});
  const auto [a, b, c] = mesh.triangles[0];
  mesh.triangles.push_back({b, a, 8});
  EXPECT_THAT(mesh_faults(mesh), testing::Contains(HasSubstr("belongs to 3 triangles")));

  EXPECT_THAT(mesh_faults(two_boxes(0.5, {0, 0, 0}, true)), IsEmpty()) << "a hollow";
  EXPECT_THAT(mesh_faults(two_boxes(0.5, {3, 0, 0}, false)), IsEmpty()) << "two parts";
  EXPECT_THAT(mesh_faults(two_boxes(0.5, {3, 0, 0}, true)),
              ElementsAre(HasSubstr("its part of 12 triangles with triangle 13 at (2.9")));
  EXPECT_THAT(mesh_faults(two_boxes(0.5, {0, 0, 0}, false)), ElementsAre(HasSubstr("lies within another part")));
  EXPECT_NEAR(make_mesh(two_boxes(0.5, {0, 0, 0}, true))->distance({0, 0, 0}), 0.25, 1e-15);
  // Into a side, with edges on the edges and diagonals of triangles, and beside each other.
  EXPECT_THAT(mesh_faults(two_boxes(0.5, {0.5, 0.03, 0.01}, false)),
              ElementsAre(AllOf(HasSubstr("its parts cross: triangle "), HasSubstr("pass through each other"))));
  EXPECT_THAT(mesh_faults(two_boxes(1, {0.5, 0.5, 0.5}, false)), ElementsAre(HasSubstr("its parts cross")));
  EXPECT_THAT(mesh_faults(two_boxes(0.5, {0.75, 0.25, 0}, false)), testing::Each(testing::Not(HasSubstr("cross"))));
}

TEST(Mesh, FilesThatAreNoMeshAreRefusedWithTheReason) {
  const TemporaryFolder folder;
  const TriangleSurface box = make_box({1, 2, 0.5}, 3)->surface(window, 1);
  EXPECT_THAT(refusal_of(folder / "none.stl"), HasSubstr("there is no mesh file"));
  write_contents(folder / "hull.step", "ISO");
  EXPECT_THAT(refusal_of(folder / "hull.step"), HasSubstr("must be a .stl, .obj, .ply or .ply.gz file"));
  write_contents(folder / "cut.stl", binary_stl(box).substr(0, 300));
  EXPECT_THAT(refusal_of(folder / "cut.stl"),
              HasSubstr("12 triangles that it counts need 684 bytes, found 300; save or copy it again"));
  write_contents(folder / "longer.stl", binary_stl(box) + std::string(50, ' '));
  EXPECT_THAT(refusal_of(folder / "longer.stl"), HasSubstr("12 triangles that it counts need 684 bytes, found 734"));
  write_contents(folder / "ply.stl", ply(box));
  EXPECT_NE(refusal_of(folder / "ply.stl"), "");
  write_contents(folder / "points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  EXPECT_NE(refusal_of(folder / "points.obj"), "");
  write_contents(folder / "nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_NE(refusal_of(folder / "nan.obj"), "");
  // A point that no face names.
  write_contents(folder / "unused.obj", obj(box) + "v 1 2 three\n");
  EXPECT_THAT(refusal_of(folder / "unused.obj"),
              HasSubstr("is damaged: line 21 must give a point three finite numbers, found 'v 1 2 three'"));
  write_contents(folder / "beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  EXPECT_NE(refusal_of(folder / "beyond.obj"), "");
  std::string text = ply(box);
  text.insert(text.find("\n3 ") + 3, "77");
  write_contents(folder / "beyond.ply", text);
  EXPECT_THAT(refusal_of(folder / "beyond.ply"), HasSubstr("face 1 names point 773, counted from 0, and there are 8"));
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\n", xy = "property float x\nproperty float y\n";
  for (const auto& [damaged, reason] :
       {std::pair<std::string, const char*>{"ply\nformat ascii 1.0\n", "no line 'end_header'"},
        {"obj\n", "its first line must be 'ply'"},
        {"ply\nend_header\n", "no line 'format'"},
        {"ply\nformat ebcdic 1.0\nend_header\n", "line 2 of its head must name the format"},
        {"ply\nformat ascii 1.0\nelement vertex 99999999\nend_header\n", "line 3 of its head must count elements"},
        {head + "property real x\nend_header\n", "line 4 of its head must be  property"},
        {head + xy + "end_header\n0 0\n", "must have the properties x, y and z"},
        {head + xy + "property float z\nend_header\n0 0 zero\n", "must begin a number"},
        {head + xy + "property float z\nend_header\n0 0 0 0 0\n", "it ends before its last element"}}) {
    write_contents(folder / "damaged.ply", damaged);
    EXPECT_THAT(refusal_of(folder / "damaged.ply"), HasSubstr(reason));
  }
  for (const char* name : {"empty.stl", "empty.obj", "empty.ply"}) {
    write_contents(folder / name, "");
    EXPECT_NE(refusal_of(folder / name), "") << name;
  }
}

// Whatever stands in a file, it is read or refused: cut off anywhere, and with bytes changed at fixed random places.
TEST(Mesh, DamagedFilesAreReadOrRefused) {
  const TemporaryFolder folder;
  const TriangleSurface ball = make_ball(0.5, 3)->surface(window, 1);
  const std::pair<const char*, std::string> files[] = {{"a.stl", ascii_stl(ball)},
                                                       {"b.stl", binary_stl(ball)},
                                                       {"c.obj", obj(ball)},
                                                       {"d.ply", ply(ball)},
                                                       {"e.ply", binary_ply(ball, true)}};
  std::uint64_t draw = 0;
  for (const auto& [name, whole] : files) {
    for (std::size_t part = 0; part < 40; ++part) {
      write_contents(folder / name, whole.substr(0, whole.size() * part / 40));
      refusal_of(folder / name);
    }
    for (int change = 0; change < 150; ++change) {
      std::string damaged = whole;
      for (int n = 0; n < 1 + change % 5; ++n) {
        const auto u = random_uniform(11, RandomPurpose::test, draw++, 0, 0);
        // Half of the changes hit the head, which holds the counts.
        const double span = static_cast<double>(n % 2 ? damaged.size() : std::min<std::size_t>(damaged.size(), 250));
        damaged[static_cast<std::size_t>(u[0] * span)] = static_cast<char>(static_cast<int>(u[1] * 256));
      }
      write_contents(folder / name, damaged);
      try {
        const TriangleSurface read = read_mesh(folder / name);
        if (mesh_faults(read).empty()) make_mesh(read)->nearest({0.1, 0.2, 0.3});
      } catch (const InputError&) {
      }
    }
  }
}

}  // namespace
}  // namespace spume
