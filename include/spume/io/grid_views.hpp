// SPDX-License-Identifier: MIT
// The steps of a VTKHDF 2.0 grid file for readers that know version 1.0 only, which has no time: VTK 9.1 and Debian
// 12's ParaView 5.11.
//
// Beside <name>.vtkhdf, one small file per step, <name>_steps/000000.hdf, sees the arrays of that step through virtual
// datasets: no field is stored twice. <name>.hdf.series (JSON) lists them with their times; it is what ParaView opens.
// The views read as zeros where <name>.vtkhdf is missing: the three belong together. Every function throws FileError.
#pragma once

#include <cstddef>
#include <filesystem>

namespace spume {

// Makes the views of all steps of a grid file, or of those from `first` on, and the list; drops those that the file
// does not have any more.
void write_grid_views(const std::filesystem::path& grid_file, std::size_t first = 0);

// Removes views and list, as far as they are there.
void remove_grid_views(const std::filesystem::path& grid_file);

// The list of the views of a grid file.
std::filesystem::path grid_view_list(std::filesystem::path grid_file);

}  // namespace spume
