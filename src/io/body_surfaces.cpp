// SPDX-License-Identifier: MIT
#include "spume/io/body_surfaces.hpp"

#include <cstring>
#include <vector>

#include "spume/io/file.hpp"

namespace spume {
namespace {

// The arrays of the file, which stand one behind the other after the text, each with its size in bytes before it.
class Appendix {
 public:
  // Gives the attribute that refers to the array.
  template <class T>
  std::string add(const std::vector<T>& values) {
    std::string reference = "format=\"appended\" offset=\"" + std::to_string(data_.size()) + "\"";
    const std::uint64_t bytes = values.size() * sizeof(T);
    append(&bytes, sizeof bytes);
    append(values.data(), bytes);
    return reference;
  }
  const std::string& data() const { return data_; }

 private:
  void append(const void* from, std::size_t bytes) {
    if (bytes > 0) data_.append(static_cast<const char*>(from), bytes);
  }
  std::string data_;
};

std::int8_t wall_code(BoundaryKind kind) {
  return kind == BoundaryKind::no_slip ? 2 : kind == BoundaryKind::free_slip ? 1 : 0;
}

}  // namespace

void write_body_surfaces(const std::filesystem::path& path, const Scene& scene) {
  std::vector<float> points;
  std::vector<std::int32_t> corners, offsets, number;
  std::vector<std::int8_t> wall, inside, subtract;
  const Bounds domain{scene.domain.lower, scene.domain.upper};
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const Body& body = scene.bodies[k];
    const TriangleSurface surface = body.solid->surface(domain, scene.spacing);
    const auto first = static_cast<std::int32_t>(points.size() / 3);
    for (const Vec3& p : surface.points)
      for (const double x : p) points.push_back(static_cast<float>(x));
    for (const auto& triangle : surface.triangles) {
      for (const std::int32_t corner : triangle) corners.push_back(first + corner);
      offsets.push_back(static_cast<std::int32_t>(corners.size()));
      number.push_back(static_cast<std::int32_t>(k));
      wall.push_back(wall_code(body.wall));
      inside.push_back(body.inside ? 1 : 0);
      subtract.push_back(body.subtract ? 1 : 0);
    }
  }
  Appendix appendix;
  const auto array = [&](const std::string& type, const std::string& name, const auto& values, int components = 1) {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" + std::to_string(components) +
           "\" " + appendix.add(values) + "/>\n";
  };
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<PolyData>\n<Piece NumberOfPoints=\"" +
      std::to_string(points.size() / 3) + "\" NumberOfPolys=\"" + std::to_string(offsets.size()) +
      "\">\n<CellData Scalars=\"body\">\n";
  text += array("Int32", "body", number) + array("Int8", "wall", wall) + array("Int8", "inside", inside) +
          array("Int8", "subtract", subtract);
  text += "</CellData>\n<Points>\n" + array("Float32", "Points", points, 3);
  text += "</Points>\n<Polys>\n" + array("Int32", "connectivity", corners) + array("Int32", "offsets", offsets);
  text += "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
  text += appendix.data() + "\n</AppendedData>\n</VTKFile>\n";
  write_text_atomically(path, text);
}

}  // namespace spume
