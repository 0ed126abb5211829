// SPDX-License-Identifier: MIT
// The sections [[scalar]]: what is read, and what is refused with the reason.
#include <gmock/gmock.h>

#include "helpers.hpp"
#include "spume/physics/scalars/options.hpp"

namespace spume::test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::Not;

std::string box_with(const std::string& scalars) {
  return "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nx = \"periodic\"\ny = \"periodic\"\n"
         "[resolution]\nspacing = 0.1\n[fluid]\nreynolds = 100\n[[liquid]]\n[time]\nend = 1\n" +
         scalars;
}

TEST(ScalarSections, AreReadWithDefaults) {
  const LoadedCase loaded =
      load_text(box_with("[[scalar]]\nname = \"oxygen\"\nunit = \"g/m3\"\ninitial = \"2*x\"\ndiffusivity = "
                         "2e-9\n[[scalar]]\nname = \"dye\"\n"));
  const auto& scalars = loaded.options.get<ScalarOptions>().scalars;
  ASSERT_EQ(scalars.size(), 2U);
  EXPECT_EQ(scalars[0].name, "oxygen");
  EXPECT_EQ(scalars[0].unit, "g/m3");
  EXPECT_DOUBLE_EQ((*scalars[0].initial)(0.25, 0, 0, 0), 0.5);
  EXPECT_DOUBLE_EQ(scalars[0].diffusivity, 2e-9);
  EXPECT_DOUBLE_EQ(scalars[0].turbulent_schmidt, usual_turbulent_schmidt);
  EXPECT_EQ(scalars[1].initial, nullptr);
  EXPECT_EQ(scalars[1].diffusivity, 0);
}

TEST(ScalarSections, WrongOnesAreRefusedWithPlaceFindingAndFix) {
  EXPECT_THAT(problems_of(box_with("[[scalar]]\nname = \"a b\"\n")),
              ElementsAre(HasSubstr("15:8 scalar.0.name is \"a b\"; a name begins with a letter")));
  EXPECT_THAT(problems_of(box_with("[[scalar]]\nname = \"velocity\"\n")),
              ElementsAre(HasSubstr("the name 'velocity' is that of another output field; rename the scalar")));
  EXPECT_THAT(problems_of(box_with("[[scalar]]\nname = \"dye\"\n[[scalar]]\nname = \"dye\"\n")),
              ElementsAre(HasSubstr("17:8 another scalar has the name 'dye' already; rename")));
  EXPECT_THAT(problems_of(box_with("[[scalar]]\nname = \"dye\"\ndiffusivity = -1\n")),
              ElementsAre(HasSubstr("16:15 scalar.0.diffusivity must be >= 0")));
  EXPECT_THAT(problems_of(box_with("[[scalar]]\ndiffusivity = 1\n")),
              ElementsAre(HasSubstr("missing key 'name' in [[scalar]]")));
  EXPECT_THAT(problems_of(box_with("[[scalar]]\nname = \"dye\"\ninitial = \"x +\"\n")),
              ElementsAre(HasSubstr("16:15 scalar.0.initial")));
  EXPECT_THAT(problems_of(box_with("[[scalar]]\nname = \"dye\"\ninitial = \"sqrt(x - 0.5)\"\n")),
              ElementsAre(HasSubstr("it must be a finite number where there is liquid")));
  EXPECT_THAT(problems_of(box_with("[[scalar]]\nname = \"dye\"\ninflow = \"1\"\n")),
              ElementsAre(HasSubstr("scalar.0.inflow needs an opening where liquid enters")));
}

TEST(ScalarSections, WhatEntersIsCheckedAndWhatIsNotGivenIsSaid) {
  const std::string stream =
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [1, 0.5]\nbottom = \"free-slip\"\ntop = \"free-slip\"\n"
      "[resolution]\nspacing = 0.05\n[fluid]\nreynolds = 20\n[[liquid]]\nvelocity = [\"1\", \"0\"]\n[[inflow]]\nside = "
      "\"left\"\nvelocity = [\"1\", \"0\"]\n[[outflow]]\nside = \"right\"\n[time]\nend = 2\n[[scalar]]\nname = "
      "\"dye\"\n";
  EXPECT_THAT(problems_of(stream + "inflow = \"1/(1 - t)\"\n"),
              ElementsAre(HasSubstr("scalar.0.inflow is inf in the middle of inflow.0 at t = 1")));
  EXPECT_THAT(test::load_text(stream).options.warnings,
              Contains(Field(&Problem::text,
                             HasSubstr("the concentration of the nearest liquid of 'dye', which have no key inflow"))));
  EXPECT_THAT(test::load_text(stream + "inflow = \"1\"\n").options.warnings,
              Not(Contains(Field(&Problem::text, HasSubstr("nearest liquid")))));
}

}  // namespace
}  // namespace spume::test
