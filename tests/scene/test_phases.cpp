// SPDX-License-Identifier: MIT
// Phases, the regions that they fill, and what is said of those that cannot be, by a method that these tests register.
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "helpers.hpp"
#include "spume/scene/load.hpp"

namespace spume {
namespace {

using test::CaseFile;
using testing::ElementsAre;
using testing::HasSubstr;

const CaseSchema& phase_schema() {
  static const CaseSchema made = [] {
    MethodDeclaration method;
    method.name = "mixed";
    method.fills_phases = true;
    method.honours_bodies = true;
    method.bytes_per_particle = [](const Draft&) { return 100.0; };
    method.default_courant = [](const Case&, const Scene&) { return 0.2; };
    method.default_courant_in_words = "0.2";
    method.output_fields = [](const Case&) { return std::vector<OutputFieldInfo>{{"velocity"}}; };
    return CaseSchema({method});
  }();
  return made;
}

const std::string head =
    "method = \"mixed\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nx = \"periodic\"\ny = \"periodic\"\n"
    "[resolution]\nspacing = 0.1\n[time]\nend = 1\n";                                         // 10 lines
const std::string water = "[[phase]]\nname = \"water\"\ndensity = 1000\nviscosity = 1e-3\n";  // 11 to 14
const std::string air =
    "[[phase]]\nname = \"air\"\ndensity = 1.2\nviscosity = 1.8e-5\nsound_speed = 340\n";  // 15 to 19
const std::string everywhere = "[[region]]\nphase = \"water\"\n";                         // 20, 21

LoadedCase load_phases(const std::string& text) {
  return test::load_text(text, phase_schema());
}

std::vector<std::string> phase_problems(const std::string& text) {
  return test::problems_of(text, phase_schema());
}

// Particles start at 0.05, 0.15, ...: in each quadrant about the middle (0.05, 0.05), (0.05, 0.15), (0.15, 0.05) and
// (0.15, 0.15) are within 0.25 of it, (0.05, 0.25) is 0.255 away.
TEST(Phases, ALaterRegionReplacesWhatAnEarlierOneFilled) {
  const LoadedCase loaded =
      load_phases(head + water + air + everywhere +
                  "[[region]]\nphase = \"air\"\ncentre = [0.5, 0.5]\nradius = 0.25\nvelocity = [2, 0]\n"
                  "[[region]]\nphase = \"water\"\nwhere = \"0.1 - y\"\n[interface]\nsurface_tension = 0.072\n"
                  "[fluid]\ngravity = 9.81\n");
  const Scene& scene = loaded.scene;
  ASSERT_EQ(scene.phases.size(), 2u);
  EXPECT_EQ(scene.phases[0].name, "water");
  EXPECT_EQ(scene.phases[0].density, 1000);
  EXPECT_EQ(scene.phases[0].sound_speed, 0);
  EXPECT_EQ(scene.phases[1].viscosity, 1.8e-5);
  EXPECT_EQ(scene.phases[1].sound_speed, 340);
  EXPECT_EQ(scene.surface_tension, 0.072);
  EXPECT_EQ(scene.fluid.gravity[1], -9.81);
  EXPECT_EQ(scene.fluid.kinematic_viscosity, 1e-6);
  EXPECT_FALSE(scene.free_surface);
  const InitialParticles& particles = scene.particles;
  ASSERT_EQ(particles.size(), 100u);
  ASSERT_EQ(particles.phase.size(), 100u);
  std::size_t bubble = 0, bottom = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double x = particles.position[0][i], y = particles.position[1][i];
    const bool in_ball = (x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) < 0.25 * 0.25;
    EXPECT_EQ(particles.phase[i], in_ball ? 1 : 0);
    EXPECT_EQ(particles.region[i], in_ball ? 1 : y < 0.1 ? 2 : 0);
    EXPECT_EQ(particles.velocity[0][i], in_ball ? 2 : 0);
    bubble += in_ball;
    bottom += y < 0.1;
  }
  EXPECT_EQ(bubble, 16u);
  EXPECT_EQ(bottom, 10u);
  EXPECT_THAT(loaded.options.groups.at("phase air"), HasSubstr("1.2 kg/m3"));
  EXPECT_THAT(loaded.options.resolved, HasSubstr("spacing = 0.1                             # case, m\n"));
  const LoadedCase again = load_phases(loaded.options.resolved);
  EXPECT_EQ(again.scene.phases.size(), 2u);
  EXPECT_EQ(again.scene.surface_tension, 0.072);
}

// Sites of the lattice that bodies take are not missing.
TEST(Phases, FillATankThatIsABody) {
  const std::string tank =
      "method = \"mixed\"\n[domain]\nlower = [-1.1, -1.1]\nupper = [1.1, 1.1]\n[resolution]\nspacing = "
      "0.1\n[time]\nend "
      "= 1\n" +
      water + everywhere + "[[body]]\nshape = \"cylinder\"\nradius = 1\ninside = false\n";
  EXPECT_FALSE(load_phases(tank).scene.free_surface);
  EXPECT_FALSE(load_phases(tank + "[[body]]\nshape = \"cylinder\"\nradius = 0.4\n").scene.free_surface);
  std::string half = tank;
  half.replace(half.find(everywhere), everywhere.size(), everywhere + "where = \"0.5 - y\"\n");
  EXPECT_TRUE(load_phases(half).scene.free_surface);
}

// Centres of cells that lie within a circle of 8 spacings about a corner of the lattice are 208, its area is 201.1;
// within such a ball they are 2,176, its volume is 2,144.7. Cells of one layer as far from the wall go together: 4 or
// 8, in two layers at once up to 32.
TEST(Phases, ARoundTankHasAsManySitesAsItsVolume) {
  const auto sites = [](int dimensions, double radius, const std::string& shape) {
    const std::string end = std::to_string(static_cast<int>(std::ceil(radius)) + 2);
    const std::string third = dimensions == 3 ? ", " : "";
    const LoadedCase loaded = load_phases(
        "method = \"mixed\"\n[domain]\nlower = [-" + end + ", -" + end + third + (dimensions == 3 ? "-" + end : "") +
        "]\nupper = [" + end + ", " + end + third + (dimensions == 3 ? end : "") +
        "]\n[resolution]\nspacing = 1\n[time]\nend = 1\n" + water + everywhere + "[[body]]\nshape = \"" + shape +
        "\"\nradius = " + std::to_string(radius) + "\ninside = false\n");
    EXPECT_FALSE(loaded.scene.free_surface);
    return static_cast<double>(loaded.scene.particles.size());
  };
  EXPECT_NEAR(sites(2, 8, "cylinder"), std::numbers::pi * 64, 3);
  EXPECT_NEAR(sites(3, 8, "ball"), 4.0 / 3 * std::numbers::pi * std::pow(8, 3), 16);
  // Along the axis of a tube 16 columns lack sites here and there.
  const LoadedCase tube = load_phases(
      "method = \"mixed\"\n[domain]\nlower = [-10, -10, -6]\nupper = [10, 10, 6]\n[resolution]\nspacing = 1\n[time]\n"
      "end = 1\n" +
      water + everywhere + "[[body]]\nshape = \"cylinder\"\nradius = 8\ninside = false\n");
  EXPECT_NEAR(static_cast<double>(tube.scene.particles.size()), 12 * std::numbers::pi * 64, 16);
  std::map<double, int> layers;
  for (const double z : tube.scene.particles.position[2]) ++layers[z];
  for (const auto& [z, count] : layers) EXPECT_NEAR(count, std::numbers::pi * 64, 10) << z;
}

// Sites of the lattice are whole or nothing: a column 0.333 wide and 0.47 high gets 3 by 5 of them, less a disc in it.
// Volumes asked for come from 256 samples a cell.
TEST(Phases, TheMassThatEachGetsIsSaidBesideWhatWasAsked) {
  const LoadedCase loaded = load_phases(head + water + air + "[[region]]\nphase = \"air\"\n" +
                                        "[[region]]\nphase = \"water\"\nupper = [0.333, 0.47]\n" +
                                        "[[region]]\nphase = \"air\"\ncentre = [0.1, 0.2]\nradius = 0.1\n");
  const std::vector<RegionFill>& fills = loaded.scene.fills;
  ASSERT_EQ(fills.size(), 2u);
  EXPECT_EQ(fills[0].name, "water");
  const double disc = std::numbers::pi * 0.01, exact = 0.333 * 0.47 - disc;
  // Faces and the disc are known to 3 samples in 256 along 13 and 12 cells.
  EXPECT_NEAR(fills[0].asked, exact, 25 * 3 / 256.0 * 0.01);
  EXPECT_NEAR(fills[0].asked + fills[1].asked, 1, 1e-12);
  EXPECT_NEAR(fills[0].got, (3 * 5 - 4) * 0.01, 1e-12);
  EXPECT_NEAR(fills[0].got + fills[1].got, 1, 1e-12);
  EXPECT_THAT(loaded.options.groups.at("mass of water"), HasSubstr("110 got in 11 particles"));
}

TEST(Phases, WhatIsMissingIsNamed) {
  EXPECT_THAT(phase_problems(head),
              ElementsAre("1:1 no phase: add a fluid,  [[phase]]  with  name, density, viscosity",
                          "1:1 no region: say what a phase fills,  [[region]]  with  phase = \"<name>\""));
  EXPECT_THAT(phase_problems(head + "[[phase]]\nname = \"water\"\ndensity = 1000\n" + everywhere),
              ElementsAre("11:1 missing key 'viscosity' in [[phase]]; add  viscosity = <number>  # Pa s, >= 0"));
  EXPECT_THAT(phase_problems(head + water + "[[region]]\nradius = 0.1\n"),
              ElementsAre("15:1 missing key 'phase' in [[region]]; add  phase = \"<text>\"",
                          HasSubstr("15:1 missing key 'centre' in [[region]], which has a radius")));
}

TEST(Phases, NamesAreKnownAndUnique) {
  EXPECT_THAT(phase_problems(head + water + air + "[[region]]\nphase = \"wter\"\n"),
              ElementsAre("21:9 region.0.phase must be the name of a phase, \"water\" or \"air\", found \"wter\"; did "
                          "you mean \"water\"?"));
  EXPECT_THAT(phase_problems(head + water + water + everywhere),
              ElementsAre("16:8 another phase has the name 'water' already"));
  EXPECT_THAT(phase_problems(head + water + "[[phase]]\nname = \"\"\ndensity = 1\nviscosity = 0\n" + everywhere),
              ElementsAre("16:8 phase.1.name must not be empty"));
}

TEST(Phases, TensionIsPositiveAndBetweenTwo) {
  EXPECT_THAT(phase_problems(head + water + air + everywhere + "[interface]\nsurface_tension = -1\n"),
              ElementsAre("23:19 interface.surface_tension must be >= 0 (N/m), found -1"));
  EXPECT_THAT(
      phase_problems(head + water + everywhere + "[interface]\nsurface_tension = 1\n"),
      ElementsAre("18:19 interface.surface_tension needs two phases, found one; add a [[phase]], or remove it"));
}

TEST(Phases, RegionsLieInTheDomainAndHoldSomething) {
  EXPECT_THAT(phase_problems(head + water + "[[region]]\nphase = \"water\"\nlower = [0, 0]\nupper = [1, 2]\n"),
              ElementsAre(HasSubstr("15:1 region.0 reaches outside the domain: y from 0 to 2")));
  EXPECT_THAT(phase_problems(head + water + air + everywhere + "[[region]]\nphase = \"air\"\n"),
              ElementsAre("20:1 region.0 is empty: later regions replace all of it"));
  EXPECT_THAT(phase_problems(head + water + everywhere + "[[region]]\nphase = \"water\"\nwhere = \"sqrt(-1 - x)\"\n"),
              ElementsAre(HasSubstr("19:9 region.1.where is not finite at")));
}

TEST(Phases, OneFluidAndSeveralDoNotMix) {
  EXPECT_THAT(phase_problems(head + water + everywhere + "[fluid]\ndensity = 1\n"),
              ElementsAre("18:1 fluid.density is taken by no method of this version, and this case is of method "
                          "\"mixed\"; remove it"));
  EXPECT_THAT(
      test::problems_of(test::small_case("[[phase]]\nname = \"water\"\n")),
      ElementsAre("14:3 [phase] belongs to method \"gfd\" or \"wcsph\", and this case is of method \"les-sph\"; "
                  "remove the section"));
}

}  // namespace
}  // namespace spume
