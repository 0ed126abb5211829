// SPDX-License-Identifier: MIT
// What the page says of a field when its name is pointed at: unit, and formula in words of the field.
#pragma once

#include <map>
#include <string>

namespace spume {

struct FieldWords {
  std::string unit;     // in the words of the case; "" without dimension
  std::string formula;  // "u = dx/dt: velocity"
};

// By the name of the field.
const std::map<std::string, FieldWords>& field_words();

}  // namespace spume
