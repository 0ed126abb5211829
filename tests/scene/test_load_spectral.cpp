// SPDX-License-Identifier: MIT
// Cases of the spectral method: what they say arrives, and what cannot work is refused in words.
#include <gmock/gmock.h>

#include "helpers.hpp"
#include "spume/methods/spectral/options.hpp"

namespace spume {
namespace {

using test::load_text;
using test::problems_of;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

// `initial` and `extra` go at the end.
std::string spectral_case(const std::string& initial = "kind = \"taylor-green\"\n", const std::string& extra = "",
                          const std::string& grid = "grid = [16, 12, 20]\n") {
  return "method = \"spectral\"\n"   // 1
         "[domain]\n"                // 2
         "lower = [0, 0, 0]\n"       // 3
         "upper = [1, 2, 2.5]\n"     // 4
         "x = \"periodic\"\n"        // 5
         "y = \"periodic\"\n"        // 6
         "z = \"periodic\"\n"        // 7
         "[resolution]\n" +          // 8
         grid +                      // 9
         "[time]\nend = 1\n"         // 10, 11
         "[fluid]\nreynolds = 50\n"  // 12, 13
         "[initial]\n" +             // 14
         initial +
         extra;
}

TEST(LoadSpectral, GridFluidAndNumericsArrive) {
  const LoadedCase loaded =
      load_text(spectral_case("kind = \"abc\"\namplitude = [1, 2, 3]\nwavenumber = 2\n",
                              "[spectral]\nintegrator = \"rk3\"\nprecision = \"single\"\ndealiasing = \"two-thirds\"\n"
                              "[forcing]\nkind = \"shell\"\ninjection = 0.1\nwavenumber = 1.5\n"));
  EXPECT_THAT(loaded.scene.grid, ElementsAre(16, 12, 20));
  EXPECT_DOUBLE_EQ(loaded.scene.spacing, 1.0 / 16);
  EXPECT_DOUBLE_EQ(loaded.scene.fluid.kinematic_viscosity, 1.0 / 50);
  EXPECT_EQ(loaded.options.get<SpectralOptions>().integrator, Integrator::rk3);
  EXPECT_EQ(loaded.options.get<SpectralOptions>().precision, FieldPrecision::f32);
  EXPECT_EQ(loaded.options.get<SpectralOptions>().dealiasing, Dealiasing::two_thirds);
  EXPECT_EQ(loaded.options.get<ForcingOptions>().kind, ForcingKind::shell);
  EXPECT_DOUBLE_EQ(loaded.options.get<ForcingOptions>().injection, 0.1);
  EXPECT_THAT(loaded.options.get<InitialOptions>().amplitude, ElementsAre(1, 2, 3));
  EXPECT_EQ(loaded.scene.particles.size(), 0u);
}

TEST(LoadSpectral, StepsOfRungeKuttaAreLongerUnlessParticlesFollow) {
  const auto courant = [](const std::string& integrator, const std::string& extra = "") {
    const std::string chosen = "[spectral]\nintegrator = \"" + integrator + "\"\n" + extra;
    return load_text(spectral_case("kind = \"taylor-green\"\n", chosen)).options.time.courant;
  };
  EXPECT_EQ(courant("ab2"), 0.2);
  EXPECT_EQ(courant("rk3"), 0.5);
  EXPECT_EQ(courant("rk4"), 0.9);
  EXPECT_EQ(courant("rk4", "[particles]\ncount = 10\ndiameter = 0.01\nresponse_time = 1\n"), 0.2);
}

TEST(LoadSpectral, OneNumberIsTheSameAlongEachAxis) {
  const LoadedCase loaded = load_text(spectral_case("kind = \"rest\"\n", "", "grid = 24\n"));
  EXPECT_THAT(loaded.scene.grid, ElementsAre(24, 24, 24));
}

TEST(LoadSpectral, SpectrumIsAnExpressionOfTheWavenumberWhateverElseIsCalledK) {
  const LoadedCase loaded = load_text(
      spectral_case("kind = \"random\"\nenergy = 0.5\nspectrum = \"a*k^2\"\n", "[constants]\nk = 7\na = \"k+1\"\n"));
  ASSERT_TRUE(loaded.scene.initial_spectrum);
  EXPECT_DOUBLE_EQ((*loaded.scene.initial_spectrum)(3, 0, 0, 0), 8 * 9);
}

TEST(LoadSpectral, ResolvedCaseReadsBack) {
  const LoadedCase loaded = load_text(spectral_case());
  EXPECT_THAT(loaded.options.resolved, HasSubstr("[spectral]"));
  EXPECT_THAT(loaded.options.resolved, testing::Not(HasSubstr("[pressure]")));
  const LoadedCase again = load_text(loaded.options.resolved);
  EXPECT_EQ(again.scene.grid, loaded.scene.grid);
  EXPECT_EQ(again.options.get<InitialOptions>().kind, InitialKind::taylor_green);
}

TEST(LoadSpectral, KeysOfTheOtherMethodAreRefusedInWords) {
  EXPECT_THAT(
      problems_of(spectral_case("kind = \"rest\"\n", "[pressure]\ntolerance = 1e-6\n[[liquid]]\n")),
      ElementsAre("16:2 [pressure] belongs to method \"les-sph\" or \"gfd\", and this case is of method \"spectral\"; "
                  "remove the section",
                  HasSubstr("18:3 [liquid] belongs to method \"les-sph\"")));
  EXPECT_THAT(problems_of(spectral_case("kind = \"rest\"\njitter = 0.1\n", "", "grid = 16\nspacing = 0.1\n")),
              ElementsAre(HasSubstr("10:1 resolution.spacing belongs to method \"les-sph\""),
                          HasSubstr("17:1 initial.jitter belongs to method \"les-sph\"")));
  EXPECT_THAT(problems_of(test::small_case("[forcing]\nkind = \"linear\"\n")),
              ElementsAre(HasSubstr("14:2 [forcing] belongs to method \"spectral\"")));
  EXPECT_THAT(problems_of(test::small_case(), {"resolution.grid=32"}),
              ElementsAre(HasSubstr("resolution.grid belongs to method \"spectral\"")));
}

TEST(LoadSpectral, WhatCannotWorkIsRefusedWithTheFix) {
  EXPECT_THAT(problems_of(spectral_case("kind = \"rest\"\n", "", "grid = [16, 15, 16]\n")),
              ElementsAre("9:8 resolution.grid must hold even numbers, found 15; take 16"));
  EXPECT_THAT(problems_of(spectral_case("kind = \"rest\"\n", "", "grid = [16, 16]\n")),
              ElementsAre("9:8 resolution.grid must be one number or three, found 2"));
  EXPECT_THAT(problems_of(spectral_case("kind = \"random\"\n")),
              ElementsAre(HasSubstr("missing key 'spectrum' in [initial]"), HasSubstr("missing key 'energy'")));
  EXPECT_THAT(
      problems_of(spectral_case("kind = \"rest\"\n", "[forcing]\nkind = \"shell\"\ninjection = 1\nwavenumber = 90\n")),
      ElementsAre(HasSubstr("holds no mode of the grid")));
  EXPECT_THAT(problems_of(spectral_case("kind = \"rest\"\n", "[forcing]\nkind = \"shell\"\n")),
              ElementsAre(HasSubstr("missing key 'injection' in [forcing]")));
  EXPECT_THAT(problems_of(spectral_case("kind = \"abc\"\nwavenumber = 6\n")),
              ElementsAre(HasSubstr("initial.wavenumber = 6 is not on the grid, whose largest is 5")));
  EXPECT_THAT(problems_of(spectral_case("kind = \"rest\"\n",
                                        "[[probe]]\nname = \"a\"\nkind = \"elevation\"\n"
                                        "position = [0, 0]\n")),
              Contains(HasSubstr("needs a free surface")));
  std::string open = spectral_case();
  open.replace(open.find("y = \"periodic\"\n"), 15, "");
  EXPECT_THAT(problems_of(open), ElementsAre(HasSubstr("needs a box that is periodic in y")));
  std::string inviscid = spectral_case();
  inviscid.replace(inviscid.find("reynolds = 50\n"), 14, "");
  EXPECT_THAT(problems_of(inviscid), ElementsAre(HasSubstr("Adams-Bashforth 2 is unstable without viscosity")));
}

}  // namespace
}  // namespace spume
