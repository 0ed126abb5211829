// SPDX-License-Identifier: MIT
#include "spume/core/field_set.hpp"

#include <bit>
#include <stdexcept>
#include <utility>

#include "spume/core/parallel.hpp"

namespace spume {

bool FieldSet::has(std::string_view name) const {
  for (const auto& field : fields_)
    if (field->name == name) return true;
  return false;
}

void FieldSet::resize(std::size_t size) {
  size_ = size;
  for (auto& field : fields_) std::visit([&](auto& array) { array.resize(size); }, field->values);
}

void FieldSet::permute(std::span<const std::int32_t> order) {
  const std::int32_t* from = order.data();
  const std::size_t size = order.size();
  // Field and scratch keep their own capacities: swapping grows both to the same size within two steps.
  const auto permute_one = [&]<class T>(Array<T>& values) {
    if constexpr (std::is_same_v<T, std::int64_t>) {
      ScratchArray<double> moved(scratch_, size);
      parallel_for(size, [&](std::size_t k) { moved[k] = std::bit_cast<double>(values[from[k]]); });
      values.resize(size);
      parallel_for(size, [&](std::size_t k) { values[k] = std::bit_cast<std::int64_t>(moved[k]); });
    } else {
      ScratchArray<T> moved(scratch_, size);
      const T* source = values.data();
      T* target = moved.data();
      parallel_for(size, [=](std::size_t k) { target[k] = source[from[k]]; });
      values.swap(moved);
    }
  };
  for (auto& field : fields_)
    if (field->lifetime != Lifetime::result) std::visit(permute_one, field->values);
  if (size != size_) resize(size);
}

double FieldSet::bytes() const {
  double total = scratch_.idle_bytes();
  for (const auto& field : fields_) std::visit([&](const auto& array) { total += array.bytes(); }, field->values);
  return total;
}

FieldSet::Field& FieldSet::find_or_add(std::string_view name, Lifetime lifetime, decltype(Field::values) empty) {
  for (auto& field : fields_) {
    if (field->name != name) continue;
    if (field->lifetime != lifetime || field->values.index() != empty.index())
      throw std::logic_error("field " + field->name + " asked for twice with different types or lifetimes");
    return *field;
  }
  fields_.push_back(std::make_unique<Field>(Field{std::string(name), lifetime, std::move(empty)}));
  std::visit([&](auto& values) { values.resize(size_); }, fields_.back()->values);
  return *fields_.back();
}

}  // namespace spume
