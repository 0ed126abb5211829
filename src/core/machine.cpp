// SPDX-License-Identifier: MIT
#include "spume/core/machine.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

namespace spume {

double machine_memory_bytes() {
  const double installed = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return installed;
  return std::min(installed, static_cast<double>(limit.rlim_cur));
}

}  // namespace spume
