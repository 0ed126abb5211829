// SPDX-License-Identifier: MIT
// One function per verb; each returns an exit code and leaves errors to its caller.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spume/cli/program.hpp"

namespace spume {

struct RunArguments {
  std::string input;  // case or run folder
  std::optional<std::string> folder;
  std::vector<std::string> overrides;
  std::optional<double> until;
  bool quiet = false;
  bool view = false, paused = false;
  int port = 0;                       // of the view; 0: a free one
  std::optional<std::string> replay;  // steering.csv of another run
};

int run_verb(const RunArguments& arguments, const Program& program);
int resume_verb(const RunArguments& arguments, const Program& program);
int check_verb(const RunArguments& arguments, const Program& program);
int info_verb(const std::string& file, const Program& program);
struct ViewArguments {
  std::vector<std::string> paths;  // one or two
  int port = 0;                    // 0: a free one
};
int view_verb(const ViewArguments& arguments);
int options_verb(const std::string& section, const Program& program);

// Replaces this process by /usr/bin/python3 with a module of tools/spume_tools and the arguments.
int module_verb(const std::string& module, const std::vector<std::string>& arguments);
std::string own_executable();

// The case file that an argument means; a name is looked for in ./cases and then in the cases that came with the
// program.
std::string case_argument(const std::string& argument);

}  // namespace spume
