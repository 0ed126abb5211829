// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <stdexcept>

#include "spume/core/field_set.hpp"

namespace spume {
namespace {

TEST(FieldSet, AddsAFieldOnceAndFindsItAgain) {
  FieldSet fields;
  fields.resize(10);
  auto& pressure = fields.add<double>("pressure", Lifetime::state);
  EXPECT_EQ(pressure.size(), 10U);
  for (int k = 0; k < 50; ++k) fields.add<float>("other" + std::to_string(k), Lifetime::result);
  EXPECT_EQ(&fields.add<double>("pressure", Lifetime::state), &pressure);
  EXPECT_TRUE(fields.has("pressure"));
  EXPECT_FALSE(fields.has("temperature"));
}

TEST(FieldSet, RefusesAnotherTypeOrLifetime) {
  FieldSet fields;
  fields.add<double>("pressure", Lifetime::state);
  EXPECT_THROW(fields.add<float>("pressure", Lifetime::state), std::logic_error);
  EXPECT_THROW(fields.add<double>("pressure", Lifetime::result), std::logic_error);
}

TEST(FieldSet, ResizesAllFieldsAndKeepsValues) {
  FieldSet fields;
  fields.resize(3);
  auto& a = fields.add<double>("a", Lifetime::state);
  auto& b = fields.add<std::int32_t>("b", Lifetime::result);
  a[2] = 4;
  fields.resize(1000);
  EXPECT_EQ(a.size(), 1000U);
  EXPECT_EQ(b.size(), 1000U);
  EXPECT_EQ(a[2], 4);
}

TEST(FieldSet, PermutesCarriedFieldsOfEveryType) {
  FieldSet fields;
  fields.resize(4);
  auto& a = fields.add<double>("a", Lifetime::state);
  auto& b = fields.add<float>("b", Lifetime::state);
  auto& c = fields.add<std::int64_t>("c", Lifetime::state);
  auto& d = fields.add<std::int32_t>("d", Lifetime::state);
  auto& e = fields.add<double>("e", Lifetime::state);
  for (int i = 0; i < 4; ++i) {
    a[i] = i;
    b[i] = static_cast<float>(10 * i);
    c[i] = 100 * i;
    d[i] = 1000 * i;
    e[i] = -i;
  }
  Array<std::int32_t> order(4);
  const int from[] = {2, 0, 3, 1};
  for (int k = 0; k < 4; ++k) order[k] = from[k];
  fields.permute(order);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(a[k], from[k]);
    EXPECT_EQ(b[k], static_cast<float>(10 * from[k]));
    EXPECT_EQ(c[k], 100 * from[k]);
    EXPECT_EQ(d[k], 1000 * from[k]);
    EXPECT_EQ(e[k], -from[k]);
  }
}

TEST(FieldSet, SteadyUseAllocatesNothing) {
  FieldSet fields;
  fields.resize(1000);
  for (const char* name : {"a", "b", "c"}) fields.add<double>(name, Lifetime::state);
  Array<std::int32_t> order(1000);
  for (int k = 0; k < 1000; ++k) order[k] = 999 - k;
  fields.permute(order);
  const auto before = array_statistics().allocations;
  for (int step = 0; step < 5; ++step) {
    fields.permute(order);
    fields.add<double>("a", Lifetime::state);
    fields.resize(990 + step);
    fields.resize(1000);
  }
  EXPECT_EQ(array_statistics().allocations, before);
}

TEST(FieldSet, CountsItsBytes) {
  FieldSet fields;
  fields.resize(1000);
  EXPECT_EQ(fields.bytes(), 0);
  fields.add<double>("a", Lifetime::state);
  EXPECT_EQ(fields.bytes(), 8000);
}

}  // namespace
}  // namespace spume
