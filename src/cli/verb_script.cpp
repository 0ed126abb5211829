// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "spume/cli/program.hpp"
#include "spume/core/error.hpp"
#include "spume/io/file.hpp"
#include "verbs.hpp"

namespace spume {

std::string own_executable() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

int script_verb(const std::string& script, const std::vector<std::string>& arguments) {
  const auto path = home_folder() / "tools" / script;
  if (!std::filesystem::exists(path))
    throw InputError("'" + path.string() + "' is not there; set SPUME_HOME to the folder of Spume's sources");
  const char* python = "/usr/bin/python3";
  std::vector<std::string> words = {python, path.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::fflush(nullptr);
  release_to_all_places();
  execv(python, pointers.data());
  throw_file_error(python, "start", errno);
}

}  // namespace spume
