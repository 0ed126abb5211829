// SPDX-License-Identifier: MIT
#include <cstdlib>

#include "spume/cli/program.hpp"

namespace spume {

std::filesystem::path home_folder() {
  const char* chosen = std::getenv("SPUME_HOME");
  return chosen != nullptr && *chosen != '\0' ? chosen : SPUME_HOME;
}

}  // namespace spume
