// SPDX-License-Identifier: MIT
// Polygon File Format: G. Turk, The PLY polygon file format, 1994. A head of lines names elements and their properties;
// then follow the values of every element, as words of text or as bytes.
#include "ply_reader.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <sstream>

#include "spume/core/error.hpp"

namespace spume {
namespace {

struct Type {
  int bytes = 0;
  enum { whole, natural, real } kind = whole;
};

bool find_type(const std::string& name, Type& type) {
  static const std::pair<const char*, Type> known[] = {
      {"char", {1, Type::whole}},     {"int8", {1, Type::whole}},     {"uchar", {1, Type::natural}},
      {"uint8", {1, Type::natural}},  {"short", {2, Type::whole}},    {"int16", {2, Type::whole}},
      {"ushort", {2, Type::natural}}, {"uint16", {2, Type::natural}}, {"int", {4, Type::whole}},
      {"int32", {4, Type::whole}},    {"uint", {4, Type::natural}},   {"uint32", {4, Type::natural}},
      {"float", {4, Type::real}},     {"float32", {4, Type::real}},   {"double", {8, Type::real}},
      {"float64", {8, Type::real}}};
  for (const auto& [word, meaning] : known)
    if (name == word) {
      type = meaning;
      return true;
    }
  return false;
}

struct Property {
  std::string name;
  bool list = false;
  Type count, value;
};
struct Element {
  std::string name;
  double count = 0;
  std::vector<Property> properties;
};

class Reader {
 public:
  Reader(const std::string& path, std::string data) : path_(path), data_(std::move(data)) {}

  PolygonMesh read() {
    read_head();
    PolygonMesh mesh;
    for (const Element& element : elements_) read_element(element, mesh);
    return mesh;
  }

 private:
  enum class Format { text, little, big };

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError("the mesh '" + path_ + "' is damaged: " + what);
  }

  std::string next_line() {
    const std::size_t end = data_.find('\n', at_);
    if (end == std::string::npos) refuse("its head has no line 'end_header'");
    std::string line = data_.substr(at_, end - at_);
    at_ = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    ++line_;
    return line;
  }

  void read_head() {
    if (next_line() != "ply") refuse("its first line must be 'ply'");
    for (bool formatted = false;;) {
      std::istringstream words(next_line());
      std::string word, first, second, third, name;
      words >> word;
      const std::string here = "line " + std::to_string(line_) + " of its head ";
      if (word == "end_header") {
        if (!formatted) refuse("its head has no line 'format'");
        return;
      }
      if (word == "comment" || word == "obj_info") continue;
      if (word == "format") {
        words >> first;
        if (first != "ascii" && first != "binary_little_endian" && first != "binary_big_endian")
          refuse(here + "must name the format ascii, binary_little_endian or binary_big_endian");
        format_ = first == "ascii" ? Format::text : first == "binary_little_endian" ? Format::little : Format::big;
        formatted = true;
      } else if (word == "element") {
        Element element;
        // An element takes a byte at least.
        if (!(words >> element.name >> element.count) || !(element.count >= 0) ||
            element.count > static_cast<double>(data_.size()) || element.count != std::floor(element.count))
          refuse(here + "must count elements that a file of " + std::to_string(data_.size()) + " bytes can hold");
        elements_.push_back(std::move(element));
      } else if (word == "property" && !elements_.empty()) {
        Property property;
        words >> first;
        property.list = first == "list";
        bool known = property.list ? words >> second >> third >> name && find_type(second, property.count) &&
                                         property.count.kind != Type::real && find_type(third, property.value)
                                   : words >> name && find_type(first, property.value);
        if (!known) refuse(here + "must be  property <type> <name>  or  property list <type> <type> <name>");
        property.name = name;
        elements_.back().properties.push_back(std::move(property));
      } else {
        refuse(here + "is none of format, element, property, comment and end_header");
      }
    }
  }

  double text_number() {
    while (at_ < data_.size() && std::isspace(static_cast<unsigned char>(data_[at_]))) ++at_;
    const std::size_t first = at_;
    while (at_ < data_.size() && !std::isspace(static_cast<unsigned char>(data_[at_]))) ++at_;
    if (first == at_) refuse("it ends before its last element");
    double value = 0;
    const char* begin = data_.data() + first + (data_[first] == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, data_.data() + at_, value);
    if (error != std::errc() || end != data_.data() + at_)
      refuse("byte " + std::to_string(first + 1) + " must begin a number");
    return value;
  }

  template <class T>
  double bytes_as(const char* bytes) const {
    char own[sizeof(T)];
    std::memcpy(own, bytes, sizeof(T));
    if ((format_ == Format::big) != (std::endian::native == std::endian::big)) std::reverse(own, own + sizeof(T));
    T value;
    std::memcpy(&value, own, sizeof(T));
    return static_cast<double>(value);
  }

  double number(const Type& type) {
    if (format_ == Format::text) return text_number();
    if (data_.size() - at_ < static_cast<std::size_t>(type.bytes)) refuse("it ends before its last element");
    const char* bytes = data_.data() + at_;
    at_ += static_cast<std::size_t>(type.bytes);
    if (type.kind == Type::real) return type.bytes == 4 ? bytes_as<float>(bytes) : bytes_as<double>(bytes);
    const bool natural = type.kind == Type::natural;
    if (type.bytes == 1) return natural ? bytes_as<std::uint8_t>(bytes) : bytes_as<std::int8_t>(bytes);
    if (type.bytes == 2) return natural ? bytes_as<std::uint16_t>(bytes) : bytes_as<std::int16_t>(bytes);
    return natural ? bytes_as<std::uint32_t>(bytes) : bytes_as<std::int32_t>(bytes);
  }

  void read_element(const Element& element, PolygonMesh& mesh) {
    const bool vertices = element.name == "vertex", faces = element.name == "face";
    if (element.properties.empty()) return;
    for (double n = 0; n < element.count; ++n) {
      Vec3 point{};
      std::vector<std::uint32_t> corners;
      int known = 0;
      for (const Property& property : element.properties) {
        if (!property.list) {
          const double value = number(property.value);
          if (!vertices || property.name.size() != 1 || property.name[0] < 'x' || property.name[0] > 'z') continue;
          point[static_cast<std::size_t>(property.name[0] - 'x')] = value;
          ++known;
          continue;
        }
        const double count = number(property.count);
        if (!(count >= 0 && count <= static_cast<double>(data_.size() - at_)) || count != std::floor(count))
          refuse(element.name + " " + std::to_string(static_cast<long long>(n) + 1) +
                 " has a list that is longer than the file");
        const bool wanted = faces && (property.name == "vertex_indices" || property.name == "vertex_index");
        for (double k = 0; k < count; ++k) {
          const double value = number(property.value);
          if (!wanted) continue;
          if (!(value >= 0 && value < 4294967295.0))
            refuse("face " + std::to_string(static_cast<long long>(n) + 1) + " names a point that cannot be");
          corners.push_back(static_cast<std::uint32_t>(value));
        }
      }
      if (vertices && known != 3) refuse("its points must have the properties x, y and z");
      if (vertices) mesh.points.push_back(point);
      if (faces) mesh.faces.push_back(std::move(corners));
    }
  }

  const std::string& path_;
  std::string data_;
  std::size_t at_ = 0;
  int line_ = 0;
  Format format_ = Format::text;
  std::vector<Element> elements_;
};

// Also of a file that gzip has made smaller, by what it begins with.
std::string contents_of(const std::string& path) {
  const std::unique_ptr<gzFile_s, decltype(&gzclose)> in(gzopen(path.c_str(), "rb"), &gzclose);
  if (in == nullptr) throw InputError("cannot read the mesh '" + path + "'");
  std::string data;
  std::vector<char> block(std::size_t{1} << 20);
  for (int count = 1; count > 0;) {
    count = gzread(in.get(), block.data(), static_cast<unsigned>(block.size()));
    if (count > 0) data.append(block.data(), static_cast<std::size_t>(count));
    if (data.size() > largest_mesh_file) throw InputError("the mesh '" + path + "' is larger than 2 GiB");
  }
  int status = Z_OK;
  const char* reason = gzerror(in.get(), &status);
  if (status == Z_ERRNO) throw InputError("cannot read the mesh '" + path + "'");
  if (status != Z_OK)
    throw InputError("the mesh '" + path + "' is damaged: " + (*reason != 0 ? reason : "gzip cannot read it") +
                     "; save or copy it again");
  return data;
}

}  // namespace

PolygonMesh read_ply(const std::string& path) {
  return Reader(path, contents_of(path)).read();
}

}  // namespace spume
