// SPDX-License-Identifier: MIT
// [particles]: what it says arrives, and what cannot work is refused in words.
#include <gmock/gmock.h>

#include <fstream>

#include "helpers.hpp"
#include "spume/methods/spectral/options.hpp"
#include "support/temporary_folder.hpp"

namespace spume {
namespace {

using test::load_text;
using test::problems_of;
using testing::ElementsAre;
using testing::HasSubstr;

std::string with_particles(const std::string& particles) {
  return "method = \"spectral\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\n"
         "x = \"periodic\"\ny = \"periodic\"\nz = \"periodic\"\n"
         "[resolution]\ngrid = [16]\n[time]\nend = 1\n[fluid]\nreynolds = 50\n"
         "[forcing]\nkind = \"shell\"\ninjection = 0.1\n[initial]\nkind = \"taylor-green\"\n[particles]\n" +
         particles;
}

TEST(LoadParticles, WhatTheCaseSaysArrives) {
  const auto p =
      load_text(with_particles("count = 1000\ndiameters = [0.01, 0.02]\nshares = [3, 1]\nbeta = 3\nstokes = 1\n"
                               "coupling = \"four-way\"\ndrag = \"schiller-naumann\"\ngravity = [0, 0, -1]\n"
                               "placement = \"clustered\"\nspline_order = 6\nrecords = \"double\"\n"))
          .options.get<ParticleCaseOptions>();
  EXPECT_TRUE(p.any());
  EXPECT_EQ(p.count, 1000);
  EXPECT_THAT(p.diameters, ElementsAre(0.01, 0.02));
  EXPECT_THAT(p.shares, ElementsAre(3, 1));
  EXPECT_EQ(p.coupling, Coupling::four_way);
  EXPECT_EQ(p.drag, DragLaw::schiller_naumann);
  EXPECT_EQ(p.placement, Placement::clustered);
  EXPECT_EQ(p.spline_order, 6);
  EXPECT_TRUE(p.double_records);
  EXPECT_FALSE(
      load_text(with_particles("count = 1\ndiameter = 0.1\n")).options.get<ParticleCaseOptions>().double_records);
}

TEST(LoadParticles, ContradictionsAreRefusedInWords) {
  const auto refused = [](const std::string& particles, const std::string& text) {
    EXPECT_THAT(problems_of(with_particles(particles)), testing::Contains(HasSubstr(text))) << particles;
  };
  refused("diameter = 0.1\n", "missing key 'count'");
  refused("count = 10\n", "missing key 'diameter'");
  refused("count = 10\nvolume_fraction = 0.1\ndiameter = 0.1\n", "exclude each other");
  refused("count = 10\ndiameter = 0.6\n", "half of the shortest side of the box, 1; found 0.6");
  refused("count = 1000\ndiameter = 0.2\n", "take at most 176");
  refused("count = 10\ndiameter = 0.1\nspline_order = 3\n", "must be 2, 4 or 6, found 3");
  refused("count = 10\ndiameter = 0.1\nbeta = 0\nstokes = 1\ncoupling = \"two-way\"\n", "infinite density");
  refused("count = 10\ndiameter = 0.1\nplacement = \"file\"\n", "missing key 'file'");
  refused("count = 10\ndiameters = [0.1, 0.2]\nshares = [1]\n", "one entry for each of the 2 diameters");
  refused("count = 10\ndiameter = 0.1\nlyapunov = 5\n", "records = \"double\"");
  refused("count = 10\ndiameters = [0.1, 0.2]\nshares = [0, 0]\n", "shares must not all be 0");
  refused("count = 10\ndiameter = 0.1\nbeta = 3.5\n", "particles.beta");
  // eta = (50^-3 / 0.1)^(1/4) = 0.0946.
  refused("count = 100\ndiameter_over_eta = 3\n", "fill 1.19");
  refused("count = 10\ndiameter_over_eta = 6\n", "makes a diameter, which must lie between");
}

// The resolved case lies in the folder of the run: it names files of the case's folder in full.
TEST(LoadParticles, TheFileIsFoundFromTheResolvedCase) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "case.toml") << with_particles(
      "count = 1\ndiameter = 0.1\nplacement = \"file\"\nfile = \"places.csv\"\n");
  const Case options = load_case((folder / "case.toml").string(), {}).options;
  EXPECT_THAT(options.resolved, HasSubstr("file = \"" + (folder / "places.csv").string() + '"'));
}

}  // namespace
}  // namespace spume
