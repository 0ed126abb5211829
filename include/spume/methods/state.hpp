// SPDX-License-Identifier: MIT
// The state of a method as named arrays: the checkpoint writes what `save` gives and hands it back to `load` unchanged.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "spume/core/array.hpp"

namespace spume {

class StateWriter {
 public:
  virtual ~StateWriter() = default;
  virtual void f64(const std::string& name, std::span<const double> values) = 0;
  virtual void i64(const std::string& name, std::span<const std::int64_t> values) = 0;
};

class StateReader {
 public:
  virtual ~StateReader() = default;
  // Resizes `values` to what was saved; throws FileError when the name is absent or has another type.
  virtual void f64(const std::string& name, Array<double>& values) = 0;
  virtual void i64(const std::string& name, Array<std::int64_t>& values) = 0;
};

}  // namespace spume
