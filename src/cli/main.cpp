// SPDX-License-Identifier: MIT
#include "spume/cli/program.hpp"
#include "spume/methods/factory.hpp"
#include "spume/scene/load.hpp"

int main(int argc, char** argv) {
  spume::restart_with_openmp_environment(argc, argv);
  return spume::run_program(argc, argv, {spume::load_case, spume::make_method, spume::option_table});
}
