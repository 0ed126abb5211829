// SPDX-License-Identifier: MIT
// What VTKHDF files of particles and of grids share: extendible arrays, and the number of steps that readers trust.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "spume/io/hdf5.hpp"

namespace spume::vtkhdf {

using Notes = std::vector<std::pair<std::string, std::string>>;  // texts kept in the group /Spume

// An array of no rows that grows along its first axis; `row` is the shape of one row, `chunk` that of a chunk, with the
// first axis. Groups on the way are made.
void create_array(const hdf5::File& file, const std::string& name, hid_t type, const std::vector<hsize_t>& row,
                  const std::vector<hsize_t>& chunk, bool compress = false);

// Version, type ("PolyData", "ImageData"), no steps, and the notes. Precondition: the group /VTKHDF/Steps is there.
void write_header(const hdf5::File& file, const char* type, const Notes& notes);

// The number of steps; throws FileError, with `contents` as what was expected, when there are none to read or when the
// file is of the other kind. Files of particles tell their number of points, those of grids do not.
std::int64_t read_step_count(const hdf5::File& file, bool of_particles, const char* contents);
void write_step_count(const hdf5::File& file, std::int64_t steps);

std::vector<std::string> member_names(const hdf5::File& file, const std::string& group);

// Throws FileError when a file with fewer steps than a checkpoint counts is to be continued.
void require_steps(const std::filesystem::path& path, std::int64_t steps, std::int64_t count);

}  // namespace spume::vtkhdf
