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

TEST(LoadOutput, IntervalsAreNoShorterThanAMillionthOfTheRun) {
  EXPECT_THAT(problems_of(small_case("[output]\nevery = 1e-12\n")),
              ElementsAre("15:9 output.every = 1e-12 would make 1e+12 snapshots until time.end = 1; expected at most "
                          "1e+06; set it to 1e-06 or more, or to 0"));
  EXPECT_THAT(problems_of(small_case("[output]\nseries_every = 9e-7\nspectrum_every = 1e-300\n")),
              ElementsAre(HasSubstr("15:16 output.series_every = 9e-07 would make 1.11111e+06 rows of series.csv"),
                          HasSubstr("16:18 output.spectrum_every = 1e-300 would make 1e+300 spectra")));
  EXPECT_THAT(problems_of(small_case("[output]\nevery = 1e-6\nseries_every = 1e-5\ncheckpoint_every = 1e-9\n")),
              IsEmpty());
  EXPECT_THAT(problems_of(small_case(), {"time.end=1e7", "output.every=0.5"}),
              ElementsAre(HasSubstr("output.every = 0.5 would make 2e+07 snapshots until time.end = 1e+07")));
}

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

// A field that the case does not make is refused with what would make it, not left out of the snapshots.
TEST(LoadOutput, FieldsNeedWhatMakesThem) {
  const std::string fields = "[output]\nfields = [\"eddy_viscosity\", \"volume_fraction\", \"dissipation\"]\n";
  const std::vector<std::string> uncorrected = {"time.centred=false", "shifting.velocity_correction=\"none\""};
  const std::string rest = "; without it the case has velocity, pressure, id, divergence_of_position";
  EXPECT_THAT(problems_of(small_case(fields), uncorrected),
              ElementsAre("15:10 output.fields names 'eddy_viscosity', which needs a turbulence.model other than "
                          "\"none\"" +
                              rest,
                          "15:10 output.fields names 'volume_fraction', which needs a section [bubbles]" + rest,
                          HasSubstr("15:10 output.fields names 'dissipation', which needs a velocity gradient")));
  EXPECT_THAT(problems_of(small_case("[output]\nfields = [\"dissipation\", \"eddy_viscosity\"]\n"),
                          {"turbulence.model=\"smagorinsky\""}),
              IsEmpty());
  EXPECT_THAT(problems_of(small_case("[output]\nfields = [\"dissipations\"]\n")),
              ElementsAre(HasSubstr("which method \"les-sph\" does not have; it has velocity, pressure, id")));
}

std::vector<std::string> unused_of(const std::string& more, const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> texts;
  for (const Problem& one : load_text(small_case(more), overrides).options.warnings) {
    EXPECT_EQ(one.message("warning").find("error"), std::string::npos);
    texts.push_back((one.line > 0 ? std::to_string(one.line) + ':' + std::to_string(one.column) : one.file) + ' ' +
                    one.text);
  }
  return texts;
}

TEST(LoadOutput, KeysThatAnotherKeyMakesUselessAreRemarked) {
  EXPECT_THAT(unused_of("[turbulence]\nsmagorinsky_constant = 0.1\n"),
              ElementsAre("15:1 turbulence.smagorinsky_constant is not used with turbulence.model = \"none\"; it takes "
                          "effect with \"smagorinsky\"; remove it or set turbulence.model"));
  EXPECT_THAT(unused_of("[turbulence]\nmodel = \"smagorinsky\"\nsmagorinsky_constant = 0.1\n"), IsEmpty());
  EXPECT_THAT(unused_of("[shifting]\non = false\n", {"shifting.limit=0.2"}),
              ElementsAre("--set shifting.limit=0.2 shifting.limit is not used with shifting.on = false; it takes "
                          "effect with true; remove it or set shifting.on"));
  const std::string front = "[[probe]]\nname = \"f\"\nkind = \"front\"\nsamples = 7\naxis = \"x\"\n";
  const std::string line = "[[probe]]\nname = \"l\"\nkind = \"line\"\nposition = [0, 0]\nend = [1, 1]\nheight = 0.5\n";
  EXPECT_THAT(unused_of(front + line), ElementsAre(HasSubstr("17:1 probe.0.samples is not used with"),
                                                   HasSubstr("24:1 probe.1.height is not used with")));
  EXPECT_THAT(unused_of(""), IsEmpty());
}

TEST(LoadOutput, SlippingWallsThatMoveAlongThemselvesAreRemarked) {
  const auto moved = [](const std::string& wall, const std::string& velocity) {
    std::string text = small_case("[domain.wall_velocity]\nbottom = " + velocity + "\n");
    const std::string whole = "y = \"periodic\"";
    text.replace(text.find(whole), whole.size(), "bottom = \"" + wall + "\"");
    std::vector<std::string> texts;
    for (const Problem& one : load_text(text).options.warnings) texts.push_back(one.text);
    return texts;
  };
  EXPECT_THAT(moved("free-slip", "[\"1\", \"0\"]"),
              ElementsAre(HasSubstr("domain.wall_velocity.bottom moves a free-slip wall along itself, which no liquid "
                                    "feels; set domain.bottom = \"no-slip\", or give a velocity along y")));
  EXPECT_THAT(moved("free-slip", "[\"1\", \"0.1\"]"), IsEmpty());
  EXPECT_THAT(moved("no-slip", "[\"1\", \"0\"]"), IsEmpty());
}

// The resolved case gives every default: none of them is a choice.
TEST(LoadOutput, DefaultsAreNotRemarked) {
  const LoadedCase loaded = load_text(small_case("[shifting]\non = false\n"));
  EXPECT_THAT(load_text(loaded.options.resolved).options.warnings, IsEmpty());
}

// Rows further apart than the average would lose what happens between them.
TEST(LoadOutput, AnAverageOfAProbeSpansItsRows) {
  const std::string probe = "[[probe]]\nname = \"p\"\nposition = [0.5, 0.5]\naverage = 0.01\n";
  EXPECT_EQ(load_text(small_case(probe), {"output.series_every=0.01"}).options.probes[0].average, 0.01);
  EXPECT_EQ(load_text(small_case(probe)).options.probes[0].average, 0.01);
  EXPECT_THAT(problems_of(small_case(probe), {"output.series_every=0.02"}),
              ElementsAre(HasSubstr("probe.0.average is 0.01, shorter than output.series_every, 0.02")));
}

}  // namespace
}  // namespace spume
