// SPDX-License-Identifier: MIT
// The arrays of a particle family, by name. An array exists only because an active stage asked for it: what
// nobody names takes no memory, is not sorted and is not saved.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "spume/core/array.hpp"

namespace spume {

// carried: part of the state between steps; sorted with the particles and saved in checkpoints.
// scratch: valid within a step only.
enum class Lifetime { carried, scratch };

class FieldSet {
 public:
  struct Field {
    std::string name;
    Lifetime lifetime;
    std::variant<Array<double>, Array<float>, Array<std::int64_t>, Array<std::int32_t>> values;
  };

  // Adds the field, or returns the one that exists; the reference stays valid for the life of the set.
  // Asking for an existing name with another type or lifetime is a programming error (std::logic_error).
  template <class T>
  Array<T>& add(std::string_view name, Lifetime lifetime) {
    return std::get<Array<T>>(find_or_add(name, lifetime, Array<T>()).values);
  }

  bool has(std::string_view name) const;
  std::size_t size() const { return size_; }
  void resize(std::size_t size);

  // field[k] <- field[order[k]] for every carried field; contents of scratch fields become undefined.
  void permute(const Array<std::int32_t>& order);

  const std::vector<std::unique_ptr<Field>>& fields() const { return fields_; }
  double bytes() const;

 private:
  // Room to permute doubles and integers of their size in: a scratch field, whose contents are nobody's now.
  Array<double>& idle_doubles();
  Field& find_or_add(std::string_view name, Lifetime lifetime, decltype(Field::values) empty);

  std::vector<std::unique_ptr<Field>> fields_;
  std::size_t size_ = 0;
  Array<double> scratch_f64_;
  Array<float> scratch_f32_;
  Array<std::int32_t> scratch_i32_;
};

}  // namespace spume
