// SPDX-License-Identifier: MIT
#include <omp.h>
#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "spume/cli/program.hpp"

namespace spume {
namespace {

constexpr const char* mark = "SPUME_SETTINGS";  // names of the variables that this program has set for itself

void set_when_absent(const std::string& name, const char* value, std::string& names) {
  if (std::getenv(name.c_str()) != nullptr) return;
  setenv(name.c_str(), value, 1);
  names += name + ' ';
}

// Programs started from here set their own.
void unset(const char* names) {
  std::istringstream words(names);
  for (std::string name; words >> name;) unsetenv(name.c_str());
  unsetenv(mark);
}

bool names_threads(int argc, char** argv) {
  if (std::getenv("OMP_NUM_THREADS") != nullptr) return true;
  for (int i = 1; i < argc; ++i)
    if (std::strncmp(argv[i], "--threads", 9) == 0) return true;
  return false;
}

}  // namespace

void release_to_all_places() {
  if (omp_get_num_places() == 0) return;
  cpu_set_t processors;
  CPU_ZERO(&processors);
  for (int place = 0; place < omp_get_num_places(); ++place) {
    std::vector<int> members(static_cast<std::size_t>(omp_get_place_num_procs(place)));
    omp_get_place_proc_ids(place, members.data());
    for (const int processor : members) CPU_SET(processor, &processors);
  }
  sched_setaffinity(0, sizeof processors, &processors);
}

void restart_with_openmp_environment(int argc, char** argv) {
  if (const char* names = std::getenv(mark); names != nullptr) return unset(std::string(names).c_str());
  std::string names;
  // Passive waiting alone sleeps between any two parallel regions. About 50 us of spinning covers the gaps within a
  // Krylov loop, and costs other programs little.
  set_when_absent("GOMP_SPINCOUNT", "1000", names);
  set_when_absent("OMP_WAIT_POLICY", "passive", names);
  // Bound threads stay near the memory that they touched first. With fewer threads than cores, binding would put every
  // program on the same first cores; the system places the threads then.
  if (!names_threads(argc, argv)) set_when_absent("OMP_PROC_BIND", "true", names);
  if (names.empty()) return;
  setenv(mark, names.c_str(), 1);
  release_to_all_places();
  // When the system refuses, the program continues with the settings that it has.
  execv("/proc/self/exe", argv);
  unset(names.c_str());
}

}  // namespace spume
