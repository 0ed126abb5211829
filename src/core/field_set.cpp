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

Array<double>& FieldSet::idle_doubles() {
  for (auto& field : fields_)
    if (auto* values = std::get_if<Array<double>>(&field->values); values && field->lifetime == Lifetime::scratch)
      return *values;
  return scratch_f64_;
}

void FieldSet::permute(const Array<std::int32_t>& order) {
  Array<double>& doubles = idle_doubles();
  const auto permute_into = [&]<class T>(Array<T>& values, Array<T>& scratch) {
    scratch.resize(size_);
    const T* source = values.data();
    T* target = scratch.data();
    const std::int32_t* from = order.data();
    parallel_for(size_, [=](std::size_t k) { target[k] = source[from[k]]; });
    // Field and scratch keep their own capacities: swapping grows both to the same size within two steps.
    values.swap(scratch);
  };
  for (auto& field : fields_) {
    if (field->lifetime != Lifetime::carried) continue;
    std::visit(
        [&]<class T>(Array<T>& array) {
          if constexpr (std::is_same_v<T, double>)
            permute_into(array, doubles);
          else if constexpr (std::is_same_v<T, float>)
            permute_into(array, scratch_f32_);
          else if constexpr (std::is_same_v<T, std::int64_t>) {
            doubles.resize(size_);
            parallel_for(size_, [&](std::size_t k) {
              doubles[k] = std::bit_cast<double>(array[static_cast<std::size_t>(order[k])]);
            });
            parallel_for(size_, [&](std::size_t k) { array[k] = std::bit_cast<std::int64_t>(doubles[k]); });
          } else
            permute_into(array, scratch_i32_);
        },
        field->values);
  }
}

double FieldSet::bytes() const {
  double total = 0;
  const auto count = [&](const auto& array) { total += static_cast<double>(array.capacity() * sizeof(array[0])); };
  for (const auto& field : fields_) std::visit(count, field->values);
  count(scratch_f64_);
  count(scratch_f32_);
  count(scratch_i32_);
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
