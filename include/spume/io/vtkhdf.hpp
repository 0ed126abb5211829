// SPDX-License-Identifier: MIT
// Particles over time in one VTKHDF 2.0 PolyData file, which current ParaView opens directly; with the H5Part
// view the same file also opens in older viewers (through a symbolic link <name>.h5part beside it).
//
// Layout: https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html (VTKHDF, transient data).
// One part and one vertex cell per particle in every step; positions and real fields are stored as float32,
// identifiers as int64. The H5Part view, groups /Step#n of virtual datasets, duplicates no particle data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "spume/io/snapshot.hpp"

namespace spume {

// What a file holds.
struct VtkhdfContents {
  struct Field {
    std::string name;
    int components = 1;
  };
  std::vector<double> times;
  std::vector<std::int64_t> sizes;  // particles per step
  std::vector<Field> fields;
};
VtkhdfContents read_vtkhdf_contents(const std::filesystem::path& path);  // throws FileError

// The file is opened, extended and closed for every snapshot, so that a viewer can look at any time and a crash
// costs at most the snapshot being written. Every member throws FileError with the file and the reason.
class VtkhdfFile {
 public:
  struct Options {
    bool h5part_view = true;
    std::vector<std::pair<std::string, std::string>> notes;  // texts kept in the group /Spume
  };
  VtkhdfFile(std::filesystem::path path, Options options);

  // Adds a step; when the first one fails, there is no file. A snapshot without particles adds none: readers misplace
  // the step after an empty one. Precondition: the same fields with the same number of components as in the steps
  // before.
  void append(double time, const ParticleSnapshot& snapshot);

  // Drops all steps but the first `count`; with 0 the file itself. Throws FileError when fewer are there.
  void keep_steps(std::int64_t count);

  std::int64_t steps() const { return steps_; }

 private:
  void write(double time, const ParticleSnapshot& snapshot);
  std::filesystem::path path_;
  Options options_;
  std::int64_t steps_ = 0;
};

}  // namespace spume
