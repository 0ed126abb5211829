// SPDX-License-Identifier: MIT
// Fields on a uniform grid over time in one VTKHDF 2.0 ImageData file, which current ParaView opens directly. With
// views older readers open it too (grid_views.hpp).
//
// Layout: https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html (VTKHDF, ImageData, transient data).
// Arrays have the shape (time, z, y, x) or (time, z, y, x, components), as float32.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "spume/io/snapshot.hpp"

namespace spume {

// What a file holds; throws FileError.
struct GridContents {
  std::array<std::int64_t, 3> points{};
  std::vector<double> times;
  std::vector<std::string> fields;
};
GridContents read_grid_contents(const std::filesystem::path& path);

// Whether a file is one of these; false for files that cannot be read.
bool is_grid_file(const std::filesystem::path& path);

// The file is opened, extended and closed for every snapshot. Every member throws FileError with the file and the
// reason.
class VtkhdfGridFile {
 public:
  struct Options {
    bool views = true;
    std::vector<std::pair<std::string, std::string>> notes;  // texts kept in the group /Spume
  };
  VtkhdfGridFile(std::filesystem::path path, Options options);

  // Adds a step; when the first one fails, there is no file. Precondition: the same grid and fields as in the steps
  // before.
  void append(double time, const GridSnapshot& snapshot);
  // Drops all steps but the first `count`; with 0 the file itself. Throws FileError when fewer are there.
  void keep_steps(std::int64_t count);
  std::int64_t steps() const { return steps_; }

 private:
  void write(double time, const GridSnapshot& snapshot);
  std::filesystem::path path_;
  Options options_;
  std::int64_t steps_ = 0;
};

}  // namespace spume
