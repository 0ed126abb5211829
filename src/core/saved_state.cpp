// SPDX-License-Identifier: MIT
#include "spume/core/saved_state.hpp"

#include <algorithm>

#include "spume/core/error.hpp"

namespace spume {

void save_fields(const FieldSet& fields, StateWriter& writer) {
  for (const auto& field : fields.fields()) {
    if (field->lifetime != Lifetime::state) continue;
    if (const auto* f64 = std::get_if<Array<double>>(&field->values)) writer.f64(field->name, *f64);
    if (const auto* i64 = std::get_if<Array<std::int64_t>>(&field->values)) writer.i64(field->name, *i64);
    if (const auto* f32 = std::get_if<Array<float>>(&field->values)) {
      ScratchArray<double> wide(fields.scratch(), f32->size());  // floats are saved as the doubles that they are
      std::copy(f32->begin(), f32->end(), wide.begin());
      writer.f64(field->name, wide);
    }
  }
}

void load_fields(FieldSet& fields, std::size_t size, const std::string& owner, StateReader& reader) {
  fields.resize(size);
  Array<double> wide;
  for (const auto& field : fields.fields()) {
    if (field->lifetime != Lifetime::state) continue;
    if (auto* f64 = std::get_if<Array<double>>(&field->values)) reader.f64(field->name, *f64);
    if (auto* i64 = std::get_if<Array<std::int64_t>>(&field->values)) reader.i64(field->name, *i64);
    if (auto* f32 = std::get_if<Array<float>>(&field->values)) {
      reader.f64(field->name, wide);
      f32->resize(wide.size());
      std::transform(wide.begin(), wide.end(), f32->begin(), [](double value) { return static_cast<float>(value); });
    }
    if (std::visit([](const auto& array) { return array.size(); }, field->values) != size)
      throw FileError("the checkpoint's array '" + field->name + "' does not have one value per " + owner);
  }
}

}  // namespace spume
