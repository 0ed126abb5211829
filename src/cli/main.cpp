// SPDX-License-Identifier: MIT
#include "spume/cli/program.hpp"
#include "spume/methods/registry.hpp"

int main(int argc, char** argv) {
  spume::restart_with_openmp_environment(argc, argv);
  spume::Program program{[](const std::string& path, const std::vector<std::string>& overrides) {
                           return spume::load_case(path, overrides);
                         },
                         spume::make_method, spume::option_table};
  for (const spume::Registration& method : spume::registered_methods())
    program.methods.emplace_back(method.name, method.description);
  return spume::run_program(argc, argv, program);
}
