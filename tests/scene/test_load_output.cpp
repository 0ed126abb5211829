// SPDX-License-Identifier: MIT
// What a case asks to be recorded, and keys that do nothing.
#include <gmock/gmock.h>

#include "helpers.hpp"

namespace spume {
namespace {

using test::load_text;
using test::problems_of;
using test::small_case;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(LoadOutput, APlaneHasANormalAndAPlace) {
  const std::string plane = "[[probe]]\nname = \"p\"\nkind = \"plane\"\n";
  const LoadedCase loaded =
      load_text(small_case(plane + "axis = \"y\"\nposition = [0.25]\n" +
                           "[[probe]]\nname = \"q\"\nkind = \"plane\"\nposition = [0.5, 0.75]\n"));
  ASSERT_EQ(loaded.options.probes.size(), 2u);
  EXPECT_EQ(loaded.options.probes[0].kind, ProbeKind::plane);
  EXPECT_EQ(loaded.options.probes[0].axis, 1);
  EXPECT_EQ(loaded.options.probes[0].position, (Vec3{0, 0.25, 0}));
  EXPECT_EQ(loaded.options.probes[1].axis, 0);
  EXPECT_EQ(loaded.options.probes[1].position, (Vec3{0.5, 0.75, 0}));

  EXPECT_THAT(problems_of(small_case(plane + "axis = \"z\"\nposition = [0.5]\n")),
              ElementsAre("17:8 probe.0.axis is z and the domain has two dimensions: choose x or y"));
  EXPECT_THAT(problems_of(small_case(plane + "axis = \"y\"\nposition = [1.5]\n")),
              ElementsAre("18:12 probe.0.position lies outside the domain: y = 1.5, the domain's y from 0 to 1"));
  EXPECT_THAT(problems_of(small_case(plane)),
              ElementsAre("14:1 missing key 'position' in [[probe]]; add  position = [<x>, <y>]  # length"));
  EXPECT_THAT(problems_of(small_case(plane + "position = [0.5, 0.5, 0.5]\n")),
              ElementsAre(HasSubstr("17:12 probe.0.position must have 2 entries")));
  const std::string area = "[[probe]]\nname = \"p_area\"\nkind = \"front\"\n";
  EXPECT_THAT(problems_of(small_case(plane + "position = [0.5]\n" + area)),
              ElementsAre(HasSubstr("its column 'p_area' of probes.csv is that of probe 'p' already")));
}

}  // namespace
}  // namespace spume
