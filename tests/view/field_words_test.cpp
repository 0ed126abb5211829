// SPDX-License-Identifier: MIT
// What the page says of fields.
#include "spume/view/field_words.hpp"

#include <gtest/gtest.h>

#include "spume/methods/registry.hpp"

namespace spume {
namespace {

TEST(FieldWords, EveryFieldThatACaseMayNameHasAFormula) {
  for (const Registration& method : registered_methods()) {
    Case options;
    for (const Section& section : method.sections)
      if (section.declare) section.declare(options);
    const std::vector<OutputFieldInfo> fields = method.output_fields(options);
    EXPECT_FALSE(fields.empty()) << method.name;
    for (const OutputFieldInfo& field : fields) {
      const auto words = field_words().find(field.name);
      ASSERT_NE(words, field_words().end()) << method.name << ": " << field.name;
      EXPECT_FALSE(words->second.formula.empty()) << field.name;
    }
  }
}

// Those of families beside the flow, which are written without being named.
TEST(FieldWords, FieldsOfBubblesHaveAFormula) {
  for (const char* name : {"velocity", "radius", "diameter", "age", "slip", "id"})
    EXPECT_TRUE(field_words().contains(name)) << name;
}

}  // namespace
}  // namespace spume
