// SPDX-License-Identifier: MIT
// [[inflow]] and [[outflow]]: what the scene makes of them, and what is refused.
#include <gmock/gmock.h>

#include "helpers.hpp"

namespace spume {
namespace {

using test::load_text;
using test::problems_of;
using test::replaced;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// Line 15 is the inflow, 18 the outflow.
const std::string stream = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [2, 1]
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.1
[fluid]
reynolds = 100
[[liquid]]
[time]
end = 2

[[inflow]]
side = "left"
velocity = ["y*t", "0"]
[[outflow]]
side = "right"
pressure = "1 + t"
)toml";

std::vector<std::string> of(const std::string& from, const std::string& to) {
  return problems_of(replaced(stream, from, to));
}

TEST(Openings, CoverASideThroughWhichTheLiquidGoesOn) {
  const Scene scene = load_text(stream).scene;
  ASSERT_EQ(scene.openings.size(), 2U);
  const Opening &in = scene.openings[0], &out = scene.openings[1];
  EXPECT_TRUE(in.inflow && !out.inflow);
  EXPECT_EQ(in.axis, 0);
  EXPECT_EQ(in.side, 0);
  EXPECT_EQ(out.side, 1);
  EXPECT_EQ((*in.velocity)({0, 0.5, 0}, 2)[0], 1);
  EXPECT_EQ((*out.pressure)(0, 0, 0, 2), 3);
  EXPECT_TRUE(scene.domain.sides[0][0].opening && scene.domain.sides[0][1].opening);
  EXPECT_FALSE(scene.free_surface);
  EXPECT_EQ(scene.particles.size(), 200U);
}

TEST(Openings, CoverASideTogether) {
  const std::string upper = "[[inflow]]\nside = \"left\"\nlower = [0, 0.4]\nvelocity = [1, 0]\n";
  const std::string lower = replaced(stream, "side = \"left\"", "side = \"left\"\nupper = [0, 0.4]");
  const LoadedCase both = load_text(lower + upper);
  EXPECT_TRUE(both.scene.domain.sides[0][0].opening);
  EXPECT_FALSE(both.scene.free_surface);
  EXPECT_THAT(both.options.warnings, testing::IsEmpty());
  EXPECT_FALSE(load_text(lower).scene.domain.sides[0][0].opening);
}

TEST(Openings, APartOfAWallLeavesTheRestAWall) {
  const Scene scene =
      load_text(replaced(replaced(stream, "side = \"left\"", "side = \"left\"\nlower = [0, 0.2]\nupper = [0, 0.6]"),
                         "bottom =", "left = \"no-slip\"\nbottom ="))
          .scene;
  EXPECT_EQ(scene.domain.sides[0][0].kind, BoundaryKind::no_slip);
  EXPECT_FALSE(scene.domain.sides[0][0].opening);
  EXPECT_EQ(scene.openings[0].lower[1], 0.2);
  EXPECT_FALSE(scene.free_surface);
}

TEST(Openings, ValuesComeFromATable) {
  const test::CaseFile folder("", "other.toml");
  const std::string table = folder.folder() + "/inlet.csv";
  std::ofstream(table) << "# measured\nt, flow_rate, level\n0, 1, 0.5\n2, 3, 0.5\n";
  const std::string given = "table = \"" + table + "\"";
  const Scene scene = load_text(replaced(stream, "velocity = [\"y*t\", \"0\"]", given)).scene;
  const Opening& in = scene.openings[0];
  EXPECT_EQ((*in.flow_rate)(0, 0, 0, -1), 1);
  EXPECT_EQ((*in.flow_rate)(0, 0, 0, 0.5), 1.5);
  EXPECT_EQ((*in.flow_rate)(0, 0, 0, 9), 3);
  EXPECT_EQ((*in.level)(0, 0, 0, 1), 0.5);
  // The resolved case stands in the folder of the run, where a name beside the case is none.
  const test::CaseFile beside(replaced(stream, "velocity = [\"y*t\", \"0\"]", "table = \"inlet.csv\""), "third.toml");
  std::filesystem::copy_file(table, beside.folder() + "/inlet.csv");
  EXPECT_THAT(load_case(beside.path()).options.resolved, HasSubstr("table = \"" + beside.folder() + "/inlet.csv\""));
  std::ofstream(table) << "t, flow_rate, speed\n0, 1, 2\n";
  EXPECT_THAT(of("velocity = [\"y*t\", \"0\"]", given),
              ElementsAre(HasSubstr("17:9 inflow.0.table has a column 'speed'; those of an inflow are t, level, "
                                    "velocity_x, velocity_y, flow_rate")));
  std::ofstream(table) << "t, flow_rate\n0, 1\n0, 2\n";
  EXPECT_THAT(of("velocity = [\"y*t\", \"0\"]", given),
              ElementsAre(HasSubstr("has a time that does not come after the one before")));
  std::ofstream(table) << "t, flow_rate\n0, fast\n";
  EXPECT_THAT(of("velocity = [\"y*t\", \"0\"]", given), ElementsAre(HasSubstr("has 'fast', which is no number")));
  EXPECT_THAT(of("velocity = [\"y*t\", \"0\"]", "table = \"none.csv\""), ElementsAre(HasSubstr("cannot read")));
}

TEST(Openings, AreRefusedWhereNothingCanPass) {
  EXPECT_THAT(of("side = \"left\"", "side = \"front\""),
              ElementsAre("16:8 inflow.0.side: a 2-D domain has left, right, bottom, top"));
  EXPECT_THAT(
      of("bottom =", "x = \"periodic\"\nbottom ="),
      Contains("17:8 inflow.0.side is a side of the periodic direction x, which has none; choose another side"));
  EXPECT_THAT(of("side = \"left\"", "side = \"left\"\nlower = [0, 0.2]\nupper = [0, 1.4]"),
              ElementsAre("18:9 inflow.0 reaches beyond its side: y from 0.2 to 1.4, the domain's from 0 to 1"));
  EXPECT_THAT(of("side = \"left\"", "side = \"left\"\nlower = [0.5, 0.2]\nupper = [1, 0.4]"),
              ElementsAre("18:9 inflow.0 lies off its side: x from 0.5 to 1, the left side is at 0; let the box reach "
                          "it, or leave lower and upper out"));
  EXPECT_THAT(of("side = \"left\"", "side = \"left\"\nlower = [0, 0.2]\nupper = [0, 0.25]"),
              ElementsAre("18:9 inflow.0 is narrower than a spacing: y from 0.2 to 0.25, the spacing is 0.1; make it "
                          "wider, or the spacing smaller"));
  EXPECT_THAT(of("side = \"right\"", "side = \"left\""),
              ElementsAre("19:8 outflow.0 and inflow.0 share a part of the left side; give them parts of their own by "
                          "lower and upper"));
  // Boxes that are flat on the side share a part of it too.
  EXPECT_THAT(of("side = \"right\"", "side = \"left\"\nlower = [0, 0.4]\nupper = [0, 1]").size(), 1U);
  EXPECT_THAT(
      problems_of(replaced(replaced(stream, "side = \"right\"", "side = \"left\"\nlower = [0, 0.4]\nupper = [0, 1]"),
                           "side = \"left\"\nvel", "side = \"left\"\nlower = [0, 0]\nupper = [0, 0.6]\nvel")),
      ElementsAre(HasSubstr("outflow.0 and inflow.0 share a part of the left side")));
  EXPECT_TRUE(
      problems_of(replaced(replaced(stream, "side = \"right\"", "side = \"left\"\nlower = [0, 0.6]\nupper = [0, 1]"),
                           "side = \"left\"\nvel", "side = \"left\"\nlower = [0, 0]\nupper = [0, 0.6]\nvel"))
          .empty());
  EXPECT_THAT(problems_of(stream + "[[body]]\nshape = \"box\"\nsize = [0.6, 3]\nposition = [0, 0.5]\n"),
              ElementsAre("15:1 inflow.0 lets nothing enter: solids cover all of it; move it or the solids"));
  // A slot between two lips, wherever it is, and a gate that may open.
  const auto lip = [](const std::string& size, const std::string& height, const std::string& more = "") {
    return "[[body]]\nshape = \"box\"\nsize = [0.6, " + size + "]\nposition = [0, " + height + "]\n" + more;
  };
  EXPECT_THAT(
      problems_of(replaced(stream, "spacing = 0.1", "spacing = 0.02") + lip("0.514", "0.257") + lip("0.444", "0.778")),
      testing::IsEmpty());
  EXPECT_THAT(problems_of(stream + lip("3", "0.5", "displacement = [\"0\", \"t\"]\n")), testing::IsEmpty());
  EXPECT_THAT(of("side = \"left\"", "side = \"left\"\nwhere = \"y - 3\""),
              ElementsAre(HasSubstr("inflow.0.where is nowhere positive on its side")));
}

TEST(Openings, AreRefusedWhenTheFlowMakesNoSense) {
  EXPECT_THAT(of("velocity = [\"y*t\", \"0\"]\n", ""),
              ElementsAre("15:1 missing key 'velocity' in [[inflow]]; add  velocity = [<expression>, ...]  or  "
                          "flow_rate = <expression>"));
  EXPECT_THAT(of("velocity = [\"y*t\", \"0\"]\n", "velocity = [1, 0]\nflow_rate = 1\n"),
              ElementsAre("18:13 inflow.0 has a velocity and a flow rate, which follow from each other; remove one of "
                          "them"));
  EXPECT_THAT(of("[\"y*t\", \"0\"]", "[\"1 - t\", \"0\"]"),
              ElementsAre(HasSubstr("17:12 inflow.0.velocity leads out of the domain at (0, ")));
  EXPECT_THAT(of("[\"y*t\", \"0\"]", "[1]"),
              ElementsAre("17:12 inflow.0.velocity must have 2 entries in a 2-D domain, found 1"));
  EXPECT_THAT(of("[\"y*t\", \"0\"]", "[\"1/(y*0)\", 0]"), ElementsAre(HasSubstr("is not a finite number")));
  EXPECT_THAT(of("[\"y*t\", \"0\"]", "[\"1\", \"1/(y*0)\"]"), ElementsAre(HasSubstr("is not a finite number")));
  EXPECT_THAT(of("pressure = \"1 + t\"", "pressure = \"0/(y*0)\""),
              ElementsAre(HasSubstr("outflow.0.pressure is not a finite number")));
  // Nothing leaves a full tank.
  EXPECT_THAT(
      of("[[outflow]]\nside = \"right\"\npressure = \"1 + t\"\n", "[[inflow]]\nside = \"right\"\nvelocity = [-1, 0]\n"),
      ElementsAre("15:1 inflow.0 fills a tank that is full and closed; add an [[outflow]], or leave room above "
                  "the liquid"));
}

TEST(Openings, AreRefusedWhereLiquidEntersFasterThanSoundAllows) {
  // y t reaches 1 in the middle of the side at the end: half of the sound speed 2 is allowed.
  EXPECT_TRUE(of("reynolds = 100", "reynolds = 100\nmach = 0.45").empty());
  EXPECT_THAT(of("reynolds = 100", "reynolds = 100\nmach = 0.55"),
              ElementsAre(HasSubstr("18:12 inflow.0 lets liquid enter with 0.9")));
}

// Half of a tank 2 x 1 is room for 1; half a side lets 0.5 t enter by t^2 / 4.
TEST(Openings, AClosedTankIsNotFilledBeyondItsRoom) {
  const std::string tank =
      replaced(replaced(replaced(replaced(stream, "[[outflow]]\nside = \"right\"\npressure = \"1 + t\"\n", ""),
                                 "side = \"left\"", "side = \"left\"\nlower = [0, 0]\nupper = [0, 0.5]"),
                        "\"y*t\"", "\"t\""),
               "[[liquid]]", "[[liquid]]\nupper = [2, 0.5]");
  const std::string walled = replaced(tank, "bottom =", "left = \"free-slip\"\nright = \"free-slip\"\nbottom =");
  EXPECT_TRUE(problems_of(replaced(walled, "end = 2", "end = 1.95")).empty());
  const std::vector<std::string> found = problems_of(replaced(walled, "end = 2", "end = 4"));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0], HasSubstr("18:1 inflow.0 fills the closed tank: its room of 1 is full at t = 2"));
  EXPECT_THAT(found[0], HasSubstr("the run ends at 4; add an [[outflow]], open a side (top = \"open\"), or end"));
  EXPECT_TRUE(problems_of(replaced(replaced(walled, "end = 2", "end = 4"), "top = \"free-slip\"\n", "")).empty());
  // A body that fills half of the room leaves it full at sqrt 2.
  const std::string body = "[[body]]\nshape = \"box\"\nsize = [1, 0.5]\nposition = [1.5, 0.75]\n";
  EXPECT_THAT(problems_of(walled + body), ElementsAre(HasSubstr("its room of 0.5 is full at t = 1.41")));
}

// Liquid 0.5 deep before an outflow whose level rises above it by more than a spacing, 0.1.
TEST(Openings, AnOutflowThatIsToFillATankIsWarnedOf) {
  const auto said = [](const std::string& level) {
    const std::string scene =
        replaced(replaced(stream, "top = \"free-slip\"\n", ""), "[[liquid]]\n", "[[liquid]]\nupper = [2, 0.5]\n");
    const LoadedCase loaded = load_text(
        replaced(replaced(scene, "reynolds = 100", "reynolds = 100\nfroude = 1"), "pressure = \"1 + t\"", level));
    return std::any_of(loaded.options.warnings.begin(), loaded.options.warnings.end(), [](const Problem& warning) {
      return warning.text.find("outflow.0.level is 0.602 at t = 1.02, and the liquid before it stands at 0.5") !=
             std::string::npos;
    });
  };
  EXPECT_TRUE(said("level = \"0.5 + 0.1*t\""));
  EXPECT_FALSE(said("level = \"0.5 + 0.02*t\""));
  EXPECT_FALSE(said("level = 0.4"));
  EXPECT_FALSE(said("pressure = 3"));
}

// Without gravity, of a side 1 high in spacings of 0.1 a patch of half: five particles stand beside the rest.
TEST(Openings, TheOpenRestOfTheirSideIsWarnedOf) {
  const auto warnings_of = [](const std::string& text) {
    std::vector<std::string> found;
    for (const Problem& warning : load_text(text).options.warnings) found.push_back(warning.text);
    return found;
  };
  const std::string patch = replaced(stream, "side = \"left\"", "side = \"left\"\nlower = [0, 0]\nupper = [0, 0.5]");
  EXPECT_THAT(warnings_of(patch),
              Contains(HasSubstr("nothing holds the liquid: domain.left is open around its opening and 5 particles lie "
                                 "beside it, which leave the domain and are removed; set  left = \"free-slip\"")));
  EXPECT_THAT(warnings_of(stream), Not(Contains(HasSubstr("nothing holds the liquid"))));
  // The openings of a shape are asked by all threads: of 100 particles beside the side those above the middle.
  const std::string half = replaced(replaced(stream, "spacing = 0.1", "spacing = 0.01"), "side = \"left\"",
                                    "side = \"left\"\nwhere = \"0.5 - y\"");
  EXPECT_THAT(warnings_of(half), Contains(HasSubstr("around its opening and 50 particles lie")));
  EXPECT_THAT(warnings_of(replaced(patch, "bottom =", "left = \"free-slip\"\nbottom =")),
              Not(Contains(HasSubstr("nothing holds the liquid"))));
}

TEST(Openings, DoNotGoWithWhatCannotPassThem) {
  EXPECT_THAT(of("[time]", "[bubbles]\nweber = 100\ndensity_ratio = 800\n[time]"),
              Contains(HasSubstr("[bubbles] does not go with [[inflow]]")));
  EXPECT_THAT(of("[time]", "[[solid]]\nlower = [0.8, 0]\nupper = [1.2, 0.4]\n[time]"), ElementsAre());  // a body
  EXPECT_THAT(of("[time]", "[pressure]\nsolver = \"cg\"\n[time]"),
              ElementsAre(HasSubstr("pressure.solver = \"cg\" needs a symmetric matrix")));
  EXPECT_THAT(of("[resolution]", "left = \"free-slip\"\n[domain.wall_velocity]\nleft = [1, 0]\n[resolution]"),
              ElementsAre(HasSubstr("inflow.0 opens a side that domain.wall_velocity.left moves; remove one of the "
                                    "two")));
}

}  // namespace
}  // namespace spume
