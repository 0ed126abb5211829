// SPDX-License-Identifier: MIT
// A case of one method that the command line gives to another: what becomes of its fluid, its boxes and the rest.
#include <gmock/gmock.h>

#include "helpers.hpp"
#include "spume/scene/load.hpp"

namespace spume {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string tank_and_time =
    "[domain]\nlower = [0, 0]\nupper = [1, 1]\nleft = \"free-slip\"\nright = \"free-slip\"\nbottom = \"free-slip\"\n"
    "[resolution]\nspacing = 0.05\n[time]\nend = 1\n";                                             // 10 lines
const std::string of_liquid = "method = \"les-sph\"\n" + tank_and_time;                            // 11
const std::string pool = "[[liquid]]\nupper = [1, 0.5]\nvelocity = [0.1, 0]\n";                    // 3
const std::string fluid_of_water = "[fluid]\ndensity = 1000\nviscosity = 1e-3\ngravity = 9.81\n";  // 4
const std::string of_phase = "method = \"wcsph\"\n" + tank_and_time;
const std::string phase_of_water = "[[phase]]\nname = \"water\"\ndensity = 1000\nviscosity = 1e-3\n";
const std::string lower_half = "[[region]]\nphase = \"water\"\nupper = [1, 0.5]\nvelocity = [0.1, 0]\n";

std::vector<std::string> warning_texts(const std::vector<Problem>& problems) {
  std::vector<std::string> list;
  for (const Problem& problem : problems) list.push_back(problem.text);
  return list;
}

void expect_same_particles(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.particles.size(), b.particles.size());
  for (std::size_t i = 0; i < a.particles.size(); ++i)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      EXPECT_EQ(a.particles.position[axis][i], b.particles.position[axis][i]);
      EXPECT_EQ(a.particles.velocity[axis][i], b.particles.velocity[axis][i]);
    }
}

TEST(Translate, ALiquidIsAPhaseForAMethodOfPhases) {
  const LoadedCase original = test::load_text(of_liquid + fluid_of_water + pool);
  const LoadedCase loaded = test::load_text(of_liquid + fluid_of_water + pool, {"method=wcsph"});
  ASSERT_EQ(loaded.scene.phases.size(), 1u);
  EXPECT_EQ(loaded.scene.phases[0].name, "liquid");
  EXPECT_EQ(loaded.scene.phases[0].density, 1000);
  EXPECT_EQ(loaded.scene.phases[0].viscosity, 1e-3);
  EXPECT_EQ(loaded.scene.fluid.gravity[1], -9.81);
  for (std::size_t i = 0; i < loaded.scene.particles.size(); ++i) EXPECT_EQ(loaded.scene.particles.phase[i], 0);
  expect_same_particles(original.scene, loaded.scene);
  EXPECT_THAT(loaded.options.warnings, IsEmpty());
}

TEST(Translate, GroupsAreTheViscosityAndTheGravityOfAPhaseOfDensityOne) {
  const std::string groups = "[fluid]\nreynolds = 100\nfroude = 0.5\nmach = 0.05\n";
  const LoadedCase loaded = test::load_text(of_liquid + groups + pool, {"method=wcsph"});
  ASSERT_EQ(loaded.scene.phases.size(), 1u);
  EXPECT_EQ(loaded.scene.phases[0].density, 1);
  EXPECT_EQ(loaded.scene.phases[0].viscosity, 0.01);
  EXPECT_EQ(loaded.scene.phases[0].sound_speed, 0);
  EXPECT_EQ(loaded.scene.fluid.gravity[1], -4);
  EXPECT_THAT(warning_texts(loaded.options.warnings),
              ElementsAre("fluid.mach is not used by method \"wcsph\", which has its own sound speed or none"));
  EXPECT_EQ(loaded.options.warnings[0].line, 15);
  EXPECT_EQ(loaded.options.warnings[0].column, 1);
  EXPECT_THAT(loaded.options.resolved, HasSubstr("case, length/time"));  // not m/s
}

// What a run writes and is resumed from holds no override of the method.
TEST(Translate, ACaseWrittenFromGroupsStaysInGroups) {
  const std::string groups = "[fluid]\nreynolds = 100\nfroude = 0.5\n";
  const LoadedCase translated = test::load_text(of_liquid + groups + pool, {"method=wcsph"});
  const LoadedCase again = test::load_text(translated.options.resolved);
  EXPECT_EQ(again.scene.phases.at(0).viscosity, 0.01);
  EXPECT_EQ(again.scene.fluid.gravity[1], -4);
  EXPECT_THAT(again.options.resolved, HasSubstr("froude = 0.5"));
  EXPECT_THAT(again.options.resolved, HasSubstr("case, length/time"));
}

TEST(Translate, GroupsOfAPhaseAreGroupsOfALiquidWhereItsDensityIsTheUnit) {
  const std::string froude = "[fluid]\nfroude = 0.5\n";
  const auto phase = [](const std::string& values) { return "[[phase]]\nname = \"water\"\n" + values + "\n"; };
  const auto fluid_of = [&](const std::string& values) {
    return test::load_text(of_phase + froude + phase(values) + lower_half, {"method=les-sph"});
  };
  const LoadedCase unit = fluid_of("density = 1\nviscosity = 0.01");
  EXPECT_NEAR(unit.scene.fluid.kinematic_viscosity, 0.01, 1e-17);
  EXPECT_EQ(unit.scene.fluid.gravity[1], -4);
  EXPECT_THAT(unit.options.resolved, HasSubstr("froude = 0.5"));
  const LoadedCase inviscid = fluid_of("density = 1\nviscosity = 0");
  EXPECT_EQ(inviscid.scene.fluid.kinematic_viscosity, 0);
  EXPECT_EQ(inviscid.scene.fluid.gravity[1], -4);
  const LoadedCase heavy = fluid_of("density = 10\nviscosity = 0.1");
  EXPECT_EQ(heavy.scene.fluid.density, 10);
  EXPECT_NEAR(heavy.scene.fluid.kinematic_viscosity, 0.01, 1e-17);
  EXPECT_EQ(heavy.scene.fluid.gravity[1], -4);
}

TEST(Translate, PhasesHaveOneGravity) {
  try {
    test::load_text(of_phase + "[fluid]\ngravity = 9.81\nfroude = 1\n" + phase_of_water + lower_half);
    FAIL() << "gravity and froude were taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("give one of them"));
  }
}

TEST(Translate, AFluidThatWouldBeRefusedIsNotTaken) {
  for (const std::string fluid : {"density = 1000\nreynolds = 100", "viscosity = 1e-3\ngravity = 9.81", "reynolds = -5",
                                  "reynolds = 10\nfroude = 0", "density = -1", "density = 1000\nviscosity = \"x\"",
                                  "reynolds = 10\ngravity = 9.81"})
    EXPECT_THROW(test::load_text(of_liquid + "[fluid]\n" + fluid + "\n" + pool, {"method=wcsph"}), InputError) << fluid;
}

TEST(Translate, OnePhaseIsALiquidForAMethodOfOneLiquid) {
  const std::string gravity = "[fluid]\ngravity = 9.81\n";
  const LoadedCase original = test::load_text(of_phase + gravity + phase_of_water + lower_half);
  const LoadedCase loaded = test::load_text(of_phase + gravity + phase_of_water + lower_half, {"method=les-sph"});
  EXPECT_THAT(loaded.scene.phases, IsEmpty());
  EXPECT_EQ(loaded.scene.fluid.density, 1000);
  EXPECT_EQ(loaded.scene.fluid.kinematic_viscosity, 1e-6);
  EXPECT_EQ(loaded.scene.fluid.gravity[1], -9.81);
  expect_same_particles(original.scene, loaded.scene);
}

TEST(Translate, SeveralPhasesAreRefusedByAMethodOfOneLiquid) {
  const std::string air = "[[phase]]\nname = \"air\"\ndensity = 1\nviscosity = 1e-5\n[[region]]\nphase = \"air\"\n";
  try {
    test::load_text(of_phase + phase_of_water + air + lower_half, {"method=les-sph"});
    FAIL() << "two phases were taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("[phase] belongs to method \"gfd\" or \"wcsph\""));
  }
}

// The box stands on the bottom and against the right side: behind those its faces are beyond the kernel support.
TEST(Translate, ABoxIsABodyForAMethodWithoutBoxes) {
  const std::string step = "[[solid]]\nlower = [0.6, 0]\nupper = [1, 0.3]\nwall = \"no-slip\"\n";
  const LoadedCase loaded = test::load_text(of_liquid + fluid_of_water + pool + step, {"method=wcsph"});
  EXPECT_THAT(loaded.scene.domain.boxes, IsEmpty());
  ASSERT_EQ(loaded.scene.bodies.size(), 1u);
  const Body& body = loaded.scene.bodies[0];
  EXPECT_EQ(body.name, "solid.0");
  EXPECT_EQ(body.wall, BoundaryKind::no_slip);
  EXPECT_NEAR(body.solid->distance({0.6, 0.1, 0}), 0, 1e-12);
  EXPECT_NEAR(body.solid->distance({0.8, 0.3, 0}), 0, 1e-12);
  EXPECT_NEAR(body.solid->distance({1.0, 0.0, 0}), -0.2, 1e-12);  // four spacings inside of the outer faces
  for (std::size_t i = 0; i < loaded.scene.particles.size(); ++i) {
    const auto& p = loaded.scene.particles.position;
    EXPECT_FALSE(p[0][i] > 0.6 && p[1][i] < 0.3);
  }
}

TEST(Translate, WhatBelongsToAnotherMethodStaysBehindWithAWarning) {
  const std::string own = "[turbulence]\nmodel = \"mixed-scale\"\n[shifting]\ncoefficient = 0.1\n";
  const LoadedCase loaded = test::load_text(of_liquid + fluid_of_water + pool + own, {"method=wcsph"});
  EXPECT_THAT(warning_texts(loaded.options.warnings),
              testing::UnorderedElementsAre("[turbulence] is not used by method \"wcsph\"; it belongs to les-sph",
                                            HasSubstr("[shifting] is not used by method \"wcsph\"")));
}

TEST(Translate, WhatTheCommandLineSetsItselfIsRefused) {
  EXPECT_THROW(test::load_text(of_liquid + fluid_of_water + pool, {"method=wcsph", "turbulence.model=mixed-scale"}),
               InputError);
}

TEST(Translate, ACaseThatNamesItsMethodItselfIsNotRewritten) {
  EXPECT_THROW(test::load_text(test::replaced(of_liquid, "les-sph", "wcsph") + fluid_of_water + pool), InputError);
}

}  // namespace
}  // namespace spume
