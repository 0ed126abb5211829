// SPDX-License-Identifier: MIT
// Lines and triangles as VTK's .vtp files, and series of them over time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "spume/io/snapshot.hpp"

namespace spume {

// Cells of one kind with their data, raw and little-endian; `time` as VTK reads it. Written atomically. Throws
// FileError.
struct PolyData {
  struct CellField {
    std::string name;  // the first is what a viewer colours by
    std::variant<std::vector<std::int8_t>, std::vector<std::int32_t>> values;
  };
  std::vector<float> points;          // x, y, z of each
  std::vector<std::int32_t> corners;  // of all cells, in their order
  int corners_per_cell = 3;           // 2: lines
  std::vector<CellField> fields;
  std::optional<double> time;
};
void write_polydata(const std::filesystem::path& path, const PolyData& data);

// Surfaces of a run: <name>/0000.vtp, 0001.vtp, ... and <name>.vtp.series, which names them with their times. A file is
// there as a whole before the series names it, so that a reader finds the state of before or of after.
class PolyDataSeries {
 public:
  // Continues what is there.
  PolyDataSeries(const std::filesystem::path& folder, std::string name);

  void append(double time, const SurfaceSnapshot& surface);
  std::int64_t steps() const { return static_cast<std::int64_t>(times_.size()); }
  void keep_steps(std::int64_t count);  // cuts what came later; throws FileError where there are fewer

  static std::string index_name(const std::string& name) { return name + ".vtp.series"; }

 private:
  std::string file_name(std::int64_t step) const;
  void write_index() const;

  std::filesystem::path folder_;
  std::string name_;
  std::vector<double> times_;
};

}  // namespace spume
