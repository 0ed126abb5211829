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

// The functions that the verbs use: those of the program, or those of a test.
struct Program {
  CaseLoader load_case;
  MethodFactory make_method;
  std::function<const std::vector<OptionInfo>&()> option_table;
  std::vector<std::pair<std::string, std::string>> methods = {};  // names and descriptions
};

// Executes one command line; results go to standard output, errors to standard error. Returns the exit code.
int run_program(int argc, char** argv, const Program& program);

// Sets the OpenMP variables that the user has not set and starts the program once more, because the OpenMP runtime
// reads them before main(). Waiting threads then sleep: with spinning threads a program of short parallel regions ran
// 12 times slower beside a second busy program, with sleeping threads 2 times. Returns when there is nothing to set.
void restart_with_openmp_environment(int argc, char** argv);

// Removes the affinity that OMP_PROC_BIND has given this thread. A program started from here inherits it and would run
// all its threads on one core. To be called before a program is started.
void release_to_all_places();

// The folder that holds tools/ and cases/: $SPUME_HOME; else that of the installation which the executable belongs to;
// else the sources that it was built from.
std::filesystem::path home_folder();

}  // namespace spume
