// SPDX-License-Identifier: MIT
#include "spume/io/polydata.hpp"

#include <charconv>
#include <nlohmann/json.hpp>

#include "spume/core/error.hpp"
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

template <class T>
const char* type_name();
template <>
const char* type_name<std::int8_t>() {
  return "Int8";
}
template <>
const char* type_name<std::int32_t>() {
  return "Int32";
}
template <>
const char* type_name<float>() {
  return "Float32";
}

std::string in_digits(double value) {
  char digits[32];
  const auto written = std::to_chars(digits, digits + sizeof digits, value);
  return {digits, written.ptr};
}

}  // namespace

void write_polydata(const std::filesystem::path& path, const PolyData& data) {
  Appendix appendix;
  const auto array = [&]<class T>(const std::string& name, const std::vector<T>& values, int components = 1) {
    return std::string("<DataArray type=\"") + type_name<T>() + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
           std::to_string(components) + "\" " + appendix.add(values) + "/>\n";
  };
  const std::size_t cells = data.corners.size() / static_cast<std::size_t>(data.corners_per_cell);
  std::vector<std::int32_t> ends(cells);
  for (std::size_t k = 0; k < cells; ++k) ends[k] = static_cast<std::int32_t>(k + 1) * data.corners_per_cell;
  const std::string kind = data.corners_per_cell == 2 ? "Lines" : "Polys";
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<PolyData>\n";
  if (data.time)
    text += "<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">" +
            in_digits(*data.time) + "</DataArray>\n</FieldData>\n";
  text += "<Piece NumberOfPoints=\"" + std::to_string(data.points.size() / 3) + "\" NumberOf" + kind + "=\"" +
          std::to_string(cells) + "\">\n<CellData";
  if (!data.fields.empty()) text += " Scalars=\"" + data.fields.front().name + '"';
  text += ">\n";
  for (const PolyData::CellField& field : data.fields)
    text += std::visit([&](const auto& values) { return array(field.name, values); }, field.values);
  text += "</CellData>\n<Points>\n" + array("Points", data.points, 3);
  text += "</Points>\n<" + kind + ">\n" + array("connectivity", data.corners) + array("offsets", ends);
  text += "</" + kind + ">\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
  text += appendix.data() + "\n</AppendedData>\n</VTKFile>\n";
  write_text_atomically(path, text);
}

PolyDataSeries::PolyDataSeries(const std::filesystem::path& folder, std::string name)
    : folder_(folder), name_(std::move(name)) {
  const std::filesystem::path index = folder_ / index_name(name_);
  if (!std::filesystem::exists(index)) return;
  try {
    const auto read = nlohmann::json::parse(read_text(index));
    for (const auto& file : read.at("files")) times_.push_back(file.at("time").get<double>());
  } catch (const nlohmann::json::exception& error) {
    throw FileError("cannot read '" + index.string() + "': " + error.what());
  }
}

std::string PolyDataSeries::file_name(std::int64_t step) const {
  std::string number = std::to_string(step);
  if (number.size() < 4) number.insert(0, 4 - number.size(), '0');
  return name_ + "/" + number + ".vtp";
}

void PolyDataSeries::append(double time, const SurfaceSnapshot& surface) {
  PolyData data;
  data.corners_per_cell = surface.corners_per_cell;
  data.time = time;
  for (const auto& p : surface.points)
    for (const double x : p) data.points.push_back(static_cast<float>(x));
  data.corners = surface.corners;
  for (const auto& [field, values] : surface.fields) data.fields.push_back({field, values});
  std::error_code failed;
  std::filesystem::create_directories(folder_ / name_, failed);
  if (failed) throw_file_error(folder_ / name_, "create", failed.value());
  write_polydata(folder_ / file_name(steps()), data);
  times_.push_back(time);
  write_index();
}

void PolyDataSeries::keep_steps(std::int64_t count) {
  if (count > steps())
    throw FileError("cannot continue '" + (folder_ / index_name(name_)).string() + "': it names " +
                    std::to_string(steps()) + " files, and the state that continues has " + std::to_string(count));
  const std::int64_t had = steps();
  times_.resize(static_cast<std::size_t>(count));
  if (count < had) write_index();
  // Also one that was written and not named yet.
  for (std::int64_t step = count; std::filesystem::remove(folder_ / file_name(step)); ++step) continue;
}

void PolyDataSeries::write_index() const {
  std::string text = "{\n  \"file-series-version\" : \"1.0\",\n  \"files\" : [";
  for (std::int64_t step = 0; step < steps(); ++step)
    text += std::string(step == 0 ? "" : ",") + "\n    { \"name\" : \"" + file_name(step) +
            "\", \"time\" : " + in_digits(times_[static_cast<std::size_t>(step)]) + " }";
  text += "\n  ]\n}\n";
  write_text_atomically(folder_ / index_name(name_), text);
}

}  // namespace spume
