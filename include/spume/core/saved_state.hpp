// SPDX-License-Identifier: MIT
// State as named blobs: a checkpoint writes what a method saves and hands it back unchanged.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "spume/core/field_set.hpp"

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

// The fields of the state between steps, by their names. Loading resizes the set to `size` and throws FileError for a
// field that does not have one value for each; `owner` names who has one: "particle".
void save_fields(const FieldSet& fields, StateWriter& writer);
void load_fields(FieldSet& fields, std::size_t size, const std::string& owner, StateReader& reader);

}  // namespace spume
