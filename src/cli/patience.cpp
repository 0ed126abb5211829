// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#include "spume/cli/programme.hpp"

namespace spume {
namespace {

bool set_when_absent(const char* name, const char* value) {
  if (std::getenv(name) != nullptr) return false;
  setenv(name, value, 1);
  return true;
}

bool names_threads(int argc, char** argv) {
  if (std::getenv("OMP_NUM_THREADS") != nullptr) return true;
  for (int i = 1; i < argc; ++i)
    if (std::strncmp(argv[i], "--threads", 9) == 0) return true;
  return false;
}

}  // namespace

void restart_with_patient_threads(int argc, char** argv) {
  // Passive alone would sleep between any two regions; about 50 us of spinning bridges the gaps of a Krylov loop
  // and is too short to hurt anyone.
  bool changed = set_when_absent("GOMP_SPINCOUNT", "1000");
  changed |= set_when_absent("OMP_WAIT_POLICY", "passive");
  // Bound threads stay with the memory that they touched first. With fewer threads than cores, binding would put
  // every such program on the same first cores, so it is left to the system then.
  if (!names_threads(argc, argv)) changed |= set_when_absent("OMP_PROC_BIND", "true");
  // The mark stops a second restart where the environment does not take the settings.
  if (!changed || !set_when_absent("SPUME_RESTARTED", "1")) return;
  // Where the system refuses, the program simply goes on with the settings it has.
  execv("/proc/self/exe", argv);
}

}  // namespace spume
