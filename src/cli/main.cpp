// SPDX-License-Identifier: MIT
#include "spume/cli/programme.hpp"
#include "spume/methods/factory.hpp"
#include "spume/scene/load.hpp"

int main(int argc, char** argv) {
  spume::restart_with_patient_threads(argc, argv);
  return spume::run_programme(argc, argv, {spume::load_case, spume::make_method, spume::option_table});
}
