// SPDX-License-Identifier: MIT
// Reads states over time: particles from VTKHDF files (PolyData, UnstructuredGrid) and H5Part files, fields on a grid
// from VTKHDF files (ImageData), of this program or of another. A VTKHDF file without steps holds one state.
//
// Layouts: https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html; H5Part: groups Step#n with a data set
// per component, x, y, z and name or name_0, name_1, ..., and the attribute TimeValue.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "spume/io/snapshot.hpp"

namespace spume {

// A state with its arrays: positions have three components.
struct ResultStep {
  std::vector<ParticleSnapshot> families;
  std::vector<GridSnapshot> grids;
  std::deque<std::vector<double>> reals;
  std::deque<std::vector<std::int64_t>> integers;
  std::deque<std::vector<float>> grid_values;
};

class ResultFile {
 public:
  // The family is called as the file is, without its ending. Throws FileError for what is no such file.
  explicit ResultFile(std::filesystem::path path);

  const std::string& family() const { return family_; }
  const std::vector<double>& times() const { return times_; }
  // Reads the times again, as a run may have added some. Throws FileError.
  void refresh();
  // Adds the family of a state to `into`. Precondition: step < times().size(). Throws FileError, also for a file whose
  // arrays do not fit together.
  void read(std::size_t step, ResultStep& into) const;

 private:
  enum class Kind { vtkhdf_particles, vtkhdf_grid, h5part };
  std::filesystem::path path_;
  std::string family_;
  Kind kind_ = Kind::h5part;
  std::vector<double> times_;
  std::vector<std::string> groups_;  // of H5Part, in the order of time
};

}  // namespace spume
