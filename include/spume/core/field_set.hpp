// SPDX-License-Identifier: MIT
// The arrays of a particle family, by name. An array exists only because an active stage asked for it: what
// nobody names takes no memory, is not sorted and is not saved.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/scratch_pool.hpp"

namespace spume {

// state: what a step starts from; sorted with the particles and saved in checkpoints.
// sorted: found anew by every step, before the particles are sorted, and sorted with them.
// result: found by a step once its particles are sorted, valid until the next sort.
enum class Lifetime { state, sorted, result };

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

  // field[k] <- field[order[k]] for every field but the results, which belong to the order before. An order of fewer
  // entries drops the others, one that repeats some copies them.
  void permute(std::span<const std::int32_t> order);

  const std::vector<std::unique_ptr<Field>>& fields() const { return fields_; }
  double bytes() const;  // of the fields and of the scratch memory that is not leased now

  // Memory that the users of these fields share within a step, no part of what they hold; permute() and save_fields()
  // take what they need from it.
  ScratchPool& scratch() const { return scratch_; }

 private:
  Field& find_or_add(std::string_view name, Lifetime lifetime, decltype(Field::values) empty);

  std::vector<std::unique_ptr<Field>> fields_;
  std::size_t size_ = 0;
  mutable ScratchPool scratch_;
};

}  // namespace spume
