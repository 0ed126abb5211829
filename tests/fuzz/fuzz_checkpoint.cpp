// SPDX-License-Identifier: MIT
// Fuzzer of the checkpoint reader: any file is a checkpoint or is refused with FileError. Seeds: checkpoints of small
// runs.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>

#include "spume/core/error.hpp"
#include "spume/io/checkpoint.hpp"

// HDF5 1.10 itself leaks the object header that it cannot read (some hundred bytes, in H5O_protect).
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5\n";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string path = "/dev/shm/spume_fuzz_checkpoint_" + std::to_string(::getpid()) + ".h5";
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return 0;
  std::fwrite(data, 1, size, file);
  std::fclose(file);
  try {
    const spume::CheckpointReader reader(path);
    for (const auto& entry : reader.entries()) {
      spume::Array<double> reals;
      spume::Array<std::int64_t> integers;
      if (entry.type == "f64")
        reader.f64(entry.name, reals);
      else
        reader.i64(entry.name, integers);
    }
  } catch (const spume::FileError&) {
  }
  return 0;
}
