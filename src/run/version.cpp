// SPDX-License-Identifier: MIT
#include "spume/run/version.hpp"

#include "commit.hpp"  // written by the build

namespace spume {

std::string program_version() {
  return SPUME_VERSION;
}

std::string program_commit() {
  return SPUME_COMMIT;
}

std::string vector_instructions() {
#if defined(__AVX512F__)
  return "AVX-512 (8 doubles)";
#elif defined(__AVX2__)
  return "AVX2 (4 doubles)";
#elif defined(__AVX__)
  return "AVX (4 doubles)";
#elif defined(__SSE2__)
  return "SSE2 (2 doubles)";
#elif defined(__ARM_NEON)
  return "NEON (2 doubles)";
#else
  return "scalar";
#endif
}

}  // namespace spume
