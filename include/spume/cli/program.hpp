// SPDX-License-Identifier: MIT
// The command line: verbs, messages, exit codes.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "spume/run/driver.hpp"
#include "spume/scene/options.hpp"

namespace spume {

enum ExitCode : int {
  exit_done = 0,
  exit_verification = 1,
  exit_input = 2,
  exit_numerical = 3,
  exit_interrupted = 130
};

// What the verbs work with.
struct Program {
  CaseLoader load_case;
  MethodFactory make_method;
  std::function<const std::vector<OptionInfo>&()> option_table;
  std::vector<std::pair<std::string, std::string>> methods = {};  // names and descriptions
};

// Carries out one command line; results go to standard output, errors to standard error. Returns the exit code.
int run_program(int argc, char** argv, const Program& program);

// Waiting threads that spin steal the cores of other programs: in short parallel regions a peer ran 12 times slower
// beside a second busy program, against 2 with passive waiting. The OpenMP runtime reads its settings before main(),
// so the program sets what the user left open and starts itself once more. Returns when nothing was to be set.
void restart_with_openmp_environment(int argc, char** argv);

// With OMP_PROC_BIND the runtime has bound this thread to its first place, and a program started from here would find
// that place alone: all its threads on one core. To be called before any start.
void release_to_all_places();

// The folder that holds tools/ and cases/: $SPUME_HOME, or where the program was configured.
std::filesystem::path home_folder();

}  // namespace spume
