// SPDX-License-Identifier: MIT
// An HDF5 driver that changes a file in one move, so that a program that is killed at any moment leaves it as it was
// before the change or as it is after.
//
// What HDF5 writes beyond the end that the file had goes straight there: nobody refers to it yet. What it writes over
// older parts (chunk indices, object headers, the last chunk) stays in memory until the file is closed; then it is
// written to <file>.journal with a checksum, the journal gets its name by a rename, the pages are copied into the file,
// and the journal is removed. A journal that is found when a file is opened belongs to a program that was killed while
// copying: it is copied again. Not for power cuts, which may reorder what the system had not yet written.
#pragma once

#include <hdf5.h>

#include <filesystem>

namespace spume::hdf5 {

// Sets the driver in a file access property list. For files opened to be written that exist.
void use_journal(hid_t access);

// Completes a change that was broken off, if there is one. Throws FileError.
void replay_journal(const std::filesystem::path& path);

// Removes a file that was begun and could not be finished, and its journal, as far as they are there.
void remove_with_journal(const std::filesystem::path& path);

}  // namespace spume::hdf5
