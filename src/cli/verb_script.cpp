// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "spume/cli/program.hpp"
#include "spume/core/error.hpp"
#include "spume/io/file.hpp"
#include "verbs.hpp"

namespace spume {
namespace {

// The folder that holds the package goes before what the user has on the path.
void put_on_python_path(const std::string& folder) {
  const char* before = std::getenv("PYTHONPATH");
  const bool any = before != nullptr && *before != '\0';
  setenv("PYTHONPATH", (any ? folder + ':' + before : folder).c_str(), 1);
}

}  // namespace

std::string own_executable() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

int module_verb(const std::string& module, const std::vector<std::string>& arguments) {
  const auto tools = home_folder() / "tools";
  if (!std::filesystem::exists(tools / "spume_tools" / module))
    throw InputError(
        "'" + (tools / "spume_tools" / module).string() +
        "' is not there; set SPUME_HOME to the folder of Spume's sources or to share/spume of an installation");
  put_on_python_path(std::filesystem::absolute(tools).string());
  const char* python = "/usr/bin/python3";
  // -P: a file of the working folder must not stand in for a module of the same name.
  std::vector<std::string> words = {python, "-P", "-m", "spume_tools." + module};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::fflush(nullptr);
  release_to_all_places();
  execv(python, pointers.data());
  throw_file_error(python, "start", errno);
}

}  // namespace spume
