// SPDX-License-Identifier: MIT
#include <cstdlib>

#include "home_paths.hpp"
#include "spume/cli/program.hpp"
#include "spume/scene/find_case.hpp"
#include "verbs.hpp"

namespace spume {

std::filesystem::path home_folder() {
  const char* chosen = std::getenv("SPUME_HOME");
  if (chosen != nullptr && *chosen != '\0') return chosen;
  const auto installed = std::filesystem::path(own_executable()).parent_path() / SPUME_SHARE;
  std::error_code ignored;
  if (std::filesystem::is_directory(installed / "tools", ignored)) return installed.lexically_normal();
  return SPUME_SOURCE;
}

std::string case_argument(const std::string& argument) {
  return find_case_file(argument, {"cases", home_folder() / "cases"});
}

}  // namespace spume
