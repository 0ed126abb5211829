// SPDX-License-Identifier: MIT
// Fuzzer of the case reader: any text is a case or is refused with InputError. Seeds: the cases of cases/.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>

#include "spume/core/error.hpp"
#include "spume/methods/registry.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string path = "/dev/shm/spume_fuzz_case_" + std::to_string(::getpid()) + ".toml";
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return 0;
  std::fwrite(data, 1, size, file);
  std::fclose(file);
  try {
    // Coarse, so that what is tested is the reading and not the filling of shapes.
    spume::load_case(path, {"resolution.spacing=0.3", "resolution.grid=4"});
  } catch (const spume::InputError& error) {
    if (error.problems().empty()) __builtin_trap();  // refused without a word
  }
  try {
    spume::load_case(path, {"resolution.spacing=0.3"});
  } catch (const spume::InputError&) {
  }
  return 0;
}
