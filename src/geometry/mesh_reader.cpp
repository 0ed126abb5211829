// SPDX-License-Identifier: MIT
// The only file that includes assimp.
#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

#include "ply_reader.hpp"
#include "spume/core/error.hpp"
#include "spume/core/vectors.hpp"
#include "spume/geometry/mesh.hpp"
#include "surfaces.hpp"

namespace spume {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_triangles = 40'000'000;

// With what stands before .gz.
std::string extension_of(const std::string& path) {
  const fs::path file(path);
  std::string extension = file.extension().string();
  if (extension == ".gz") extension = file.stem().extension().string() + extension;
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

// A reader of another kind is never tried on the file, whatever it begins with.
void keep_only(Assimp::Importer& importer, const std::string& extension) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* reader = importer.GetImporter(i);
    const aiImporterDesc* info = importer.GetImporterInfo(i);
    std::istringstream list(info->mFileExtensions);
    bool own = false;
    for (std::string one; list >> one;) own = own || one == extension.substr(1);
    if (!own) {
      importer.UnregisterLoader(reader);
      delete reader;
    }
  }
}

// The beginning of a text in one line.
std::string printable(const std::string& text) {
  constexpr std::size_t longest = 100;
  std::string line = text.substr(0, longest);
  for (char& c : line)
    if (!std::isprint(static_cast<unsigned char>(c))) c = ' ';
  return text.size() > longest ? line + "..." : line;
}

constexpr const char* save_again = "; save or copy it again";

// What says that a file was cut off, or holds more than it says: the reader of assimp takes what is there, or tells
// neither what it found nor what it expected.
void check_binary_stl(const std::string& path, std::uintmax_t size) {
  std::ifstream in(path, std::ios::binary);
  char head[84] = {};
  in.read(head, sizeof head);
  if (in.gcount() < 84 || std::strncmp(head, "solid", 5) == 0) return;
  std::uint32_t count = 0;
  std::memcpy(&count, head + 80, sizeof count);
  const std::uintmax_t wanted = 84 + 50 * static_cast<std::uintmax_t>(count);
  if (size != wanted)
    throw InputError("the mesh '" + path + "' is damaged: the " + std::to_string(count) +
                     " triangles that it counts need " + std::to_string(wanted) + " bytes, found " +
                     std::to_string(size) + save_again);
}

// Points that no face names do not come out of the reader of assimp, whatever they are.
void check_obj_points(const std::string& path) {
  std::ifstream in(path);
  std::size_t number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.compare(0, 2, "v ") != 0 && line.compare(0, 2, "v\t") != 0) continue;
    const char* at = line.c_str() + 1;
    for (int axis = 0; axis < 3; ++axis) {
      char* end = nullptr;
      const double value = std::strtod(at, &end);
      if (end == at || !std::isfinite(value))
        throw InputError("the mesh '" + path + "' is damaged: line " + std::to_string(number) +
                         " must give a point three finite numbers, found '" + printable(line) + "'" + save_again);
      at = end;
    }
  }
}

// A polygon in space is cut as seen along its normal, so that hollow corners stay hollow. One that cannot be cut, for
// it is crossed or flat, is left with an edge that no other triangle has.
void add_polygon(const std::vector<std::int32_t>& corners, TriangleSurface& surface) {
  const auto at = [&](std::size_t i) { return surface.points[static_cast<std::size_t>(corners[i])]; };
  Vec3 normal{};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    normal = add(normal, cross(subtract(at(i), at(0)), subtract(at(i + 1), at(0))));
  const Vec3 up = unit(normal);
  Vec3 axis{};
  axis[std::abs(up[0]) < 0.5 ? 0 : 1] = 1;
  const Vec3 u = unit(cross(axis, up)), v = cross(up, u);
  std::vector<Point2> flat;
  for (std::size_t i = 0; i < corners.size(); ++i) flat.push_back({dot(u, at(i)), dot(v, at(i))});
  for (const auto& [a, b, c] : fill_polygon(flat).triangles)
    surface.triangles.push_back({corners[static_cast<std::size_t>(a)], corners[static_cast<std::size_t>(b)],
                                 corners[static_cast<std::size_t>(c)]});
}

// Adds faces to the triangles. They are cut here: assimp's own step ends the program on polygons of damaged files.
void append(const PolygonMesh& mesh, const std::string& path, TriangleSurface& surface) {
  const auto first = static_cast<std::int32_t>(surface.points.size());
  for (const Vec3& p : mesh.points) {
    surface.points.push_back(p);
    for (const double x : p)
      if (!std::isfinite(x))
        throw InputError("the mesh '" + path + "' is damaged: point " + std::to_string(surface.points.size()) +
                         " is not finite" + save_again);
  }
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const std::vector<std::uint32_t>& face = mesh.faces[i];
    if (face.size() < 3) continue;  // points and lines
    constexpr std::size_t most_corners = 1000;
    if (face.size() > most_corners)
      throw InputError("face " + std::to_string(i + 1) + " of the mesh '" + path + "' has " +
                       std::to_string(face.size()) + " corners; expected triangles, or polygons of up to 1000");
    std::vector<std::int32_t> corners;
    for (const std::uint32_t corner : face) {
      if (corner >= mesh.points.size())
        throw InputError("the mesh '" + path + "' is damaged: face " + std::to_string(i + 1) + " names point " +
                         std::to_string(corner) + ", counted from 0, and there are " +
                         std::to_string(mesh.points.size()));
      corners.push_back(first + static_cast<std::int32_t>(corner));
    }
    if (corners.size() == 3)
      surface.triangles.push_back({corners[0], corners[1], corners[2]});
    else
      add_polygon(corners, surface);
  }
}

void check_size(std::size_t points, std::size_t faces, const std::string& path) {
  if (faces > most_triangles || points > 3 * most_triangles)
    throw InputError("the mesh '" + path + "' has " + std::to_string(faces) + " faces; at most 40000000 are possible");
}

PolygonMesh from_assimp(const aiMesh& mesh) {
  PolygonMesh polygons;
  for (unsigned i = 0; i < mesh.mNumVertices; ++i)
    polygons.points.push_back({mesh.mVertices[i].x, mesh.mVertices[i].y, mesh.mVertices[i].z});
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    polygons.faces.emplace_back(face.mIndices, face.mIndices + face.mNumIndices);
  }
  return polygons;
}

std::vector<PolygonMesh> read_with_assimp(const std::string& path, const std::string& extension) {
  Assimp::Importer importer;
  keep_only(importer, extension);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene == nullptr)
    throw InputError("the mesh '" + path + "' cannot be read: " + printable(importer.GetErrorString()) + save_again);
  std::vector<PolygonMesh> meshes;
  std::size_t points = 0, faces = 0;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    const aiMesh& mesh = *scene->mMeshes[i];
    check_size(points += mesh.mNumVertices, faces += mesh.mNumFaces, path);
    meshes.push_back(from_assimp(mesh));
  }
  return meshes;
}

// Corners at the same place become one point; formats such as STL write them once per triangle.
void weld(TriangleSurface& surface) {
  std::vector<std::int32_t> order(surface.points.size()), number(surface.points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [&](std::int32_t i) -> const Vec3& { return surface.points[static_cast<std::size_t>(i)]; };
  std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return at(a) < at(b); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto own = static_cast<std::size_t>(order[i]);
    number[own] = i > 0 && at(order[i]) == at(order[i - 1]) ? number[static_cast<std::size_t>(order[i - 1])] : order[i];
  }
  std::vector<std::int32_t> place(surface.points.size(), -1);
  std::vector<Vec3> points;
  for (auto& triangle : surface.triangles)
    for (std::int32_t& corner : triangle) {
      const auto owner = static_cast<std::size_t>(number[static_cast<std::size_t>(corner)]);
      if (place[owner] < 0) {
        place[owner] = static_cast<std::int32_t>(points.size());
        points.push_back(surface.points[owner]);
      }
      corner = place[owner];
    }
  surface.points = std::move(points);
}

}  // namespace

TriangleSurface read_mesh(const std::string& path) {
  const std::string extension = extension_of(path);
  const bool is_ply = extension == ".ply" || extension == ".ply.gz";
  if (extension != ".stl" && extension != ".obj" && !is_ply)
    throw InputError("the mesh '" + path + "' must be a .stl, .obj, .ply or .ply.gz file");
  std::error_code failure;
  if (!fs::is_regular_file(path, failure)) throw InputError("there is no mesh file '" + path + "'");
  const std::uintmax_t size = fs::file_size(path, failure);
  if (failure) throw InputError("cannot read the mesh '" + path + "': " + failure.message());
  if (size > largest_mesh_file) throw InputError("the mesh '" + path + "' is larger than 2 GiB");
  if (extension == ".stl") check_binary_stl(path, size);
  if (extension == ".obj") check_obj_points(path);

  std::vector<PolygonMesh> meshes;
  if (is_ply) {
    meshes.push_back(read_ply(path));
    check_size(meshes[0].points.size(), meshes[0].faces.size(), path);
  } else {
    meshes = read_with_assimp(path, extension);
  }
  TriangleSurface surface;
  for (const PolygonMesh& mesh : meshes) append(mesh, path, surface);
  if (surface.triangles.empty()) throw InputError("the mesh '" + path + "' holds no triangle");
  weld(surface);
  return surface;
}

}  // namespace spume
