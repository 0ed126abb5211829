// SPDX-License-Identifier: MIT
// The tests of the command line start this executable again, with "--as-spume" first, as the program with the fake
// method of tests/support: exit codes, signals and files are then those of a real process.
#include <gtest/gtest.h>

#include <cstring>

#include "spume/cli/program.hpp"
#include "support/fake_method.hpp"

namespace {

const std::vector<spume::OptionInfo>& fake_options() {
  static const std::vector<spume::OptionInfo> table = {
      {"", "title", "text", "", "\"\"", "", "Name of the case"},
      {"time", "end", "number", "time", "(required)", "> 0", "Time at which the run ends"},
      {"output", "every", "number", "time", "0", ">= 0", "Time between snapshots"}};
  return table;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "--as-spume") == 0) {
    spume::restart_with_openmp_environment(argc, argv);
    argv[1] = argv[0];
    return spume::run_program(argc - 1, argv + 1,
                              {spume::test::load_fake_case, spume::test::make_fake_method, fake_options});
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
