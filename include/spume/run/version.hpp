// SPDX-License-Identifier: MIT
// What program this is: version of the project, commit at configure time, width of the vector instructions.
#pragma once

#include <string>

namespace spume {

std::string program_version();
std::string program_commit();
std::string vector_instructions();  // "AVX-512 (8 doubles)"

}  // namespace spume
