// SPDX-License-Identifier: MIT
// Where the file of a case is.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace spume {

// The case file that `path` means: a TOML file, a folder that holds case.toml, or the name of a folder with a case.toml
// in one of `libraries`, the first that has it. Throws InputError, with a suggestion where a name is near.
std::string find_case_file(const std::string& path, const std::vector<std::filesystem::path>& libraries = {"cases"});

}  // namespace spume
