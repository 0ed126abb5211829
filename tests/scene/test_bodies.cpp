// SPDX-License-Identifier: MIT
// Bodies of the case file: what they become, what liquid fills of them, and what is said of those that cannot be.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "helpers.hpp"
#include "spume/scene/load.hpp"

namespace spume {
namespace {

using test::CaseFile;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A method that keeps liquid within the walls of bodies, and one that does not.
const CaseSchema& schema() {
  static const CaseSchema made = [] {
    MethodDeclaration method;
    method.name = "walled";
    method.fills_regions = true;
    method.honours_bodies = true;
    method.bytes_per_particle = [](const Draft&) { return 100.0; };
    method.default_courant = [](const Case&, const Scene&) { return 0.2; };
    method.default_courant_in_words = "0.2";
    method.output_fields = [](const Case&) { return std::vector<OutputFieldInfo>{{"velocity"}}; };
    MethodDeclaration other = method;
    other.name = "wall-less";
    other.honours_bodies = false;
    return CaseSchema({method, other});
  }();
  return made;
}

const std::string head2 =
    "method = \"walled\"\n[domain]\nlower = [-1, -1]\nupper = [1, 1]\n[resolution]\nspacing = 0.05\n[time]\nend = 1\n"
    "[fluid]\nreynolds = 100\n";                                                  // 10 lines
const std::string liquid2 = "[[liquid]]\nlower = [-1, -1]\nupper = [1, -0.9]\n";  // 11 to 13
const std::string liquid_beside = "[[liquid]]\nlower = [-1, -1]\n";               // all but the body
const std::string head3 =
    "method = \"walled\"\n[domain]\nlower = [-1, -1, -1]\nupper = [1, 1, 1]\n[resolution]\nspacing = 0.1\n[time]\nend "
    "= 1\n[fluid]\nreynolds = 100\n[[liquid]]\nupper = [1, 1, -0.8]\n";  // 12 lines

LoadedCase load(const std::string& text) {
  return test::load_text(text, schema());
}

std::vector<std::string> problems(const std::string& text) {
  return test::problems_of(text, schema());
}

std::vector<std::string> warnings(const std::string& text) {
  std::vector<std::string> found;
  for (const Problem& problem : load(text).options.warnings)
    found.push_back(std::to_string(problem.line) + ":" + std::to_string(problem.column) + " " + problem.text);
  return found;
}

double distance2(const std::string& body, double x, double y) {
  const LoadedCase loaded = load(head2 + liquid_beside + "[[body]]\n" + body);
  return loaded.scene.bodies.front().solid->distance({x, y, 0});
}

double distance3(const std::string& body, const Vec3& p) {
  const LoadedCase loaded = load(head3 + "[[body]]\n" + body);
  return loaded.scene.bodies.front().solid->distance(p);
}

TEST(Bodies, EveryShapeStandsWhereItsKeysSay) {
  EXPECT_NEAR(distance2("shape = \"box\"\nsize = [0.4, 0.2]\nposition = [0.5, 0]", 0, 0), 0.3, 1e-15);
  EXPECT_NEAR(distance2("shape = \"box\"\nsize = [0.4, 0.2]\nrotation = [90]", 0.5, 0), 0.4, 1e-15);
  EXPECT_NEAR(distance2("shape = \"ball\"\nradius = 0.25\nscale = 2", 0, 0.7), 0.2, 1e-15);
  EXPECT_NEAR(distance2("shape = \"ball\"\nradius = 0.5\ninside = false", 0, 0), 0.5, 1e-15);
  EXPECT_NEAR(distance2("shape = \"cylinder\"\nradius = 0.5", 0, 0.7), 0.2, 1e-15);
  EXPECT_NEAR(distance2("shape = \"capsule\"\nradius = 0.1\nlength = 0.6", 0, 0.9), 0.5, 1e-15);
  EXPECT_NEAR(distance2("shape = \"ellipsoid\"\nsemi_axes = [0.6, 0.2]", 0.9, 0), 0.3, 1e-15);
  EXPECT_NEAR(distance2("shape = \"half-space\"\nposition = [0, -0.5]", 0.3, 0), 0.5, 1e-15);
  EXPECT_NEAR(distance2("shape = \"half-space\"\nnormal = [1, 0]", 0.3, 0), 0.3, 1e-15);
  EXPECT_NEAR(distance2("shape = \"outline\"\npoints = [[0, 0], [0.5, 0], [0, 0.5]]", -0.2, 0.2), 0.2, 1e-15);
  EXPECT_NEAR(distance2("where = \"0.25 - x^2 - y^2\"", 0.8, 0), 0.3, 1e-3);
  EXPECT_NEAR(distance2("where = \"0.25 - x^2 - y^2\"\nposition = [0.2, 0]\nscale = 0.5", 0.8, 0), 0.35, 1e-3);

  EXPECT_NEAR(distance3("shape = \"cylinder\"\nradius = 0.5", {0, 0.7, 0.9}), 0.2, 1e-15);
  EXPECT_NEAR(distance3("shape = \"cylinder\"\nradius = 0.5\nlength = 1", {0, 0.2, 0.9}), 0.4, 1e-15);
  EXPECT_NEAR(distance3("shape = \"cone\"\nradius = 0.5\nlength = 1", {0, 0, 0.7}), 0.2, 1e-15);
  EXPECT_NEAR(distance3("shape = \"cone\"\nradius = 0.5\nlength = 1\ntop_radius = 0.5", {0.7, 0, 0}), 0.2, 1e-15);
  EXPECT_NEAR(distance3("shape = \"outline\"\npoints = [[0, 0], [0.5, 0], [0, 0.5]]", {-0.2, 0.9, 0.2}), 0.2, 1e-15);
  EXPECT_NEAR(distance3("shape = \"outline\"\npoints = [[0, 0], [0.5, 0], [0, 0.5]]\nlength = 1", {0.1, 0.9, 0.1}), 0.4,
              1e-15);
  EXPECT_NEAR(distance3("shape = \"box\"\nsize = [1, 0.4, 0.2]\nrotation = [90, 0, 0]", {0, 0, 0.5}), 0.3, 1e-15);
}

TEST(Bodies, AMeshStandsBesideTheCase) {
  const std::string text = head3 + "[[body]]\nmesh = \"cube.obj\"\nposition = [0.5, 0, 0]\nscale = 0.1\n";
  const std::string cube =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const CaseFile file(text);
  const auto refused = [&] {
    try {
      load_case(file.path(), {}, schema());
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused(), HasSubstr("bad.toml:14:8: error: body.0.mesh: there is no mesh file '" + file.folder()));
  std::ofstream(file.folder() + "/cube.obj") << cube;
  const LoadedCase loaded = load_case(file.path(), {}, schema());
  EXPECT_NEAR(loaded.scene.bodies[0].solid->distance({0.4, 0.05, 0.05}), 0.1, 1e-7);
  EXPECT_EQ(loaded.scene.bodies[0].kind, "mesh");
  // In the run's folder the resolved case names the file in full.
  EXPECT_THAT(loaded.options.resolved, HasSubstr("mesh = \"" + file.folder() + "/cube.obj\""));
  std::ofstream(file.folder() + "/cube.obj") << cube.substr(0, cube.find("f 4 1"));
  EXPECT_THAT(refused(), HasSubstr("/cube.obj': it is not closed: the edge from (0, "));
  std::ofstream(file.folder() + "/cube.obj") << test::replaced(cube, "f 1 2 6 5", "f 5 6 2 1");
  EXPECT_THAT(refused(), HasSubstr("triangle 5 at ("));
}

TEST(Bodies, WallsAreJoinedAndTakenAwayInTheOrderOfTheFile) {
  const LoadedCase loaded = load(head2 + liquid2 +
                                 "[[body]]\nshape = \"box\"\nsize = [1, 1]\n"
                                 "[[body]]\nname = \"hole\"\nshape = \"ball\"\nradius = 0.3\nsubtract = true\nwall = "
                                 "\"no-slip\"\n"
                                 "[[body]]\nshape = \"ball\"\nradius = 0.1\n"
                                 "[[body]]\nshape = \"ball\"\nradius = 0.9\nwall = \"none\"\n");
  const Scene& scene = loaded.scene;
  ASSERT_EQ(scene.bodies.size(), 4u);
  EXPECT_EQ(scene.bodies[0].name, "body.0");
  EXPECT_EQ(scene.bodies[1].name, "hole");
  EXPECT_EQ(scene.bodies[1].wall, BoundaryKind::no_slip);
  EXPECT_EQ(scene.bodies[3].wall, BoundaryKind::open);
  EXPECT_NEAR(scene.walls.distance({0.2, 0, 0}), 0.1, 1e-15) << "0.1 from either, in the ring";
  EXPECT_NEAR(scene.walls.distance({0, 0, 0}), -0.1, 1e-15);
  EXPECT_NEAR(scene.walls.distance({0.8, 0, 0}), 0.3, 1e-15);
}

// The sum of the lattice's cells that the region fills, to what samples of a quarter of a cell at its surface leave:
// with n cells there and errors of up to an eighth of a cell that is 1/8 of them at most, and sqrt(n)/8 if they are
// random.
TEST(Bodies, LiquidFillsTheInsideOfABody) {
  const LoadedCase loaded =
      load(head2 +
           "[[body]]\nname = \"drop\"\nshape = \"ellipsoid\"\nsemi_axes = [0.8, 0.4]\nrotation = [30]\nwall = "
           "\"none\"\n[[liquid]]\nbody = \"drop\"\nvelocity = [1, 0]\n");
  const Scene& scene = loaded.scene;
  const double area = std::numbers::pi * 0.8 * 0.4;
  ASSERT_EQ(scene.fills.size(), 1u);
  EXPECT_NEAR(scene.fills[0].asked, area, 160 / 8.0 * 0.05 * 0.05 / 4);
  EXPECT_NEAR(scene.fills[0].got, scene.fills[0].asked, 1e-12);
  ASSERT_GT(scene.particles.size(), 380u);
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    EXPECT_LT(scene.bodies[0].shape->distance({scene.particles.position[0][i], scene.particles.position[1][i], 0}),
              0.02);
  EXPECT_TRUE(scene.free_surface);
  // Cut by the other limits of the region; the inside also of a body whose solid is outside.
  const LoadedCase half = load(head2 +
                               "[[body]]\nname = \"tank\"\nshape = \"ball\"\nradius = 0.9\ninside = false\n"
                               "[[liquid]]\nbody = \"tank\"\nwhere = \"-y\"\n");
  EXPECT_NEAR(half.scene.fills[0].asked, 0.5 * std::numbers::pi * 0.81, 0.01);
  // Closed forms and meshes alike, in space.
  const LoadedCase ball =
      load(test::replaced(head3, "[[liquid]]\nupper = [1, 1, -0.8]\n", "") +
           "[[body]]\nname = \"drop\"\nshape = \"ball\"\nradius = 0.8\nwall = \"none\"\n[[liquid]]\nbody = \"drop\"\n");
  EXPECT_NEAR(ball.scene.fills[0].asked, 4 * std::numbers::pi / 3 * 0.512, 0.01);
}

TEST(Bodies, KeysThatDoNotFitTheShapeAreRefused) {
  const std::string start = head2 + liquid2 + "[[body]]\n";  // the body's keys begin in line 15
  EXPECT_THAT(problems(start), ElementsAre(HasSubstr("14:1 missing shape in [[body]]; add  shape = ")));
  EXPECT_THAT(problems(start + "shape = \"ball\""),
              ElementsAre("14:1 missing key 'radius' in [[body]], a ball; add  radius = <number>  # length, > 0"));
  EXPECT_THAT(problems(start + "shape = \"boll\""),
              ElementsAre(AllOf(HasSubstr("15:9 body.0.shape must be"), HasSubstr("did you mean \"ball\"?"))));
  EXPECT_THAT(problems(start + "shape = \"where\""),
              ElementsAre(HasSubstr("'where' is a key of its own: write  where = ...  in its place")));
  EXPECT_THAT(problems(start + "shape = \"ball\"\nradius = 1\nsize = [1, 1]"),
              ElementsAre("17:1 body.0.size is no key of a ball in 2-D; remove it"));
  EXPECT_THAT(problems(start + "shape = \"cylinder\"\nradius = 1\nlength = 1"),
              ElementsAre("17:1 body.0.length is no key of a cylinder in 2-D; remove it"));
  EXPECT_THAT(problems(start + "shape = \"box\"\nsize = [1, 1, 1]"),
              ElementsAre("16:8 body.0.size must have 2 entries in a 2-D domain, found 3"));
  EXPECT_THAT(problems(start + "shape = \"box\"\nsize = [1, -1]"),
              ElementsAre("16:12 body.0.size[1] must be > 0, found -1"));
  EXPECT_THAT(problems(start + "shape = \"half-space\"\nnormal = [0, 0]\nrotation = [1, 2]"),
              ElementsAre("16:10 body.0.normal must not be zero",
                          "17:12 body.0.rotation must have 1 entry in a 2-D domain, found 2"));
  EXPECT_THAT(problems(start + "shape = \"ball\"\nradius = 1\nscale = 0"),
              ElementsAre("17:9 body.0.scale must be > 0, found 0"));
  EXPECT_THAT(problems(start + "shape = \"ball\"\nradius = 1\nwhere = \"x\""),
              ElementsAre(HasSubstr("body.0 has more than one shape")));
  EXPECT_THAT(problems(start + "mesh = \"a.stl\""), ElementsAre(HasSubstr("15:8 body.0.mesh needs a 3-D domain")));
  EXPECT_THAT(problems(start + "shape = \"outline\"\npoints = [[0, 0], [1, \"a\"], 3, [1, 2, 3]]"),
              ElementsAre(HasSubstr("16:19 body.0.points[1] must be a point of two finite numbers, found [1, \"a\"]"),
                          HasSubstr("16:29 body.0.points[2]"), HasSubstr("16:32 body.0.points[3]")));
  EXPECT_THAT(problems(start + "shape = \"outline\"\npoints = [[0, 0], [1, 1], [1, 0], [0, 1]]"),
              ElementsAre(HasSubstr("16:10 body.0.points: the side from point 1")));
  EXPECT_THAT(problems(start + "where = \"x + zz\""), ElementsAre(HasSubstr("15:14 body.0.where: unknown name 'zz'")));
  EXPECT_THAT(problems(start + "where = \"1 + x^2\""),
              ElementsAre(HasSubstr("15:9 body.0.where: it is positive everywhere in the domain")));
}

TEST(Bodies, NamesAreTheirOwnAndRefersExist) {
  const std::string ball = "shape = \"ball\"\nradius = 0.5\n";
  EXPECT_THAT(problems(head2 + liquid2 + "[[body]]\nname = \"a\"\n" + ball + "[[body]]\nname = \"a\"\n" + ball),
              ElementsAre(HasSubstr("another body has the name 'a' already")));
  EXPECT_THAT(problems(head2 + liquid2 + "[[body]]\nname = \"\"\n" + ball),
              ElementsAre(HasSubstr("must not be empty")));
  EXPECT_THAT(problems(head2 + "[[body]]\nname = \"tank\"\n" + ball + "[[liquid]]\nbody = \"tonk\"\n"),
              ElementsAre("16:8 liquid.0.body must be the name of a [[body]], \"tank\", found \"tonk\"; did you mean "
                          "\"tank\"?"));
  EXPECT_THAT(problems(head2 + "[[liquid]]\nbody = \"tank\"\n"), ElementsAre(HasSubstr("and there is none")));
  EXPECT_THAT(
      problems(head2 + liquid2 + "[[body]]\nsubtract = true\n" + ball),
      ElementsAre(HasSubstr("body.0.subtract takes away from the walls of bodies before it, and there are none")));
}

TEST(Bodies, WallsOfAMethodThatHasNoneAreRefused) {
  const std::string text =
      test::replaced(head2, "walled", "wall-less") + liquid2 + "[[body]]\nshape = \"ball\"\nradius = 0.5\n";
  EXPECT_THAT(problems(text),
              ElementsAre(AllOf(HasSubstr("14:1 body.0 is a wall, and method \"wall-less\" has no walls"),
                                HasSubstr("wall = \"none\""))));
  EXPECT_THAT(problems(text + "wall = \"none\"\n"), IsEmpty());
}

TEST(Bodies, SuspiciousBodiesAreWarnedOf) {
  const std::string start = head2 + "[[liquid]]\nlower = [-1, -1]\nupper = [1, 0.9]\n[[body]]\nname = \"it\"\n";
  EXPECT_THAT(warnings(start + "shape = \"ball\"\nradius = 0.5\n"), IsEmpty());
  EXPECT_THAT(
      warnings(start + "shape = \"ball\"\nradius = 0.5\nposition = [3, 0]\n"),
      Contains("14:1 the body 'it' lies outside the domain: x from 2.5 to 3.5, y from -0.5 to 0.5, the domain's x "
               "from -1 to 1, y from -1 to 1; move it with position, or remove it"));
  EXPECT_THAT(
      warnings(start + "shape = \"ball\"\nradius = 2000\nposition = [0, -2000.5]\n"),
      Contains(AllOf(HasSubstr("the body 'it' is 4000 long, 2000 times the domain of 2"), HasSubstr("set scale"))));
  EXPECT_THAT(warnings(start + "shape = \"ball\"\nradius = 400\nposition = [0, 1500]\n"),
              Contains(AllOf(HasSubstr("the body 'it' lies outside the domain"),
                             HasSubstr("it is 400 times as long as the domain"), HasSubstr("set scale"))));
  const std::string probe = "[[probe]]\nname = \"p\"\nposition = ";
  EXPECT_THAT(warnings(start + "shape = \"ball\"\nradius = 0.5\n" + probe + "[0.3, 0.3]\n"),
              ElementsAre(HasSubstr("20:12 the probe 'p' lies inside the body 'it' and records nothing but nan")));
  EXPECT_THAT(warnings(start + "shape = \"ball\"\nradius = 0.5\n" + probe + "[0, 0.5]\n"), IsEmpty());
  EXPECT_THAT(warnings(start + "shape = \"ball\"\nradius = 0.5\ninside = false\n" + probe + "[0.6, 0.6]\n"),
              ElementsAre(HasSubstr("the probe 'p' lies inside the body 'it'")));
  EXPECT_THAT(warnings(start + "shape = \"ball\"\nradius = 0.002\n"),
              Contains(AllOf(HasSubstr("the body 'it' is 0.004 long, less than a spacing, "), HasSubstr("set scale"))));
  EXPECT_THAT(warnings(start + "shape = \"box\"\nsize = [0.04, 1]\n"),
              Contains(HasSubstr("the body 'it' is thinner than a spacing, 0.05, behind 96 % of its surface")));
  // Plates hide what is behind them; what is curved does not, nor what others are taken away from.
  EXPECT_THAT(warnings(start + "shape = \"box\"\nsize = [0.05, 1]\n"), IsEmpty());
  // A short flat one is none either.
  EXPECT_THAT(warnings(start + "shape = \"box\"\nsize = [0.2, 0.2]\n"),
              ElementsAre(HasSubstr("behind 100 % of its surface, and is no plate")));
  EXPECT_THAT(warnings(start + "shape = \"box\"\nrotation = [20]\nsize = [0.1, 0.3]\n"), IsEmpty());
  // But one thinner than the support radius, 0.13, or twice as long as thick.
  for (const char* size : {"[0.12, 0.12]", "[0.16, 0.1]", "[0.2, 0.12]", "[0.26, 0.12]"})
    EXPECT_THAT(warnings(start + "shape = \"box\"\nsize = " + size + "\n"), IsEmpty()) << size;
  EXPECT_THAT(warnings(start + "shape = \"box\"\nsize = [0.24, 0.16]\n"), ElementsAre(HasSubstr("is no plate")));
  EXPECT_THAT(
      warnings(start + "shape = \"ball\"\nradius = 0.1\n"),
      ElementsAre(HasSubstr("the body 'it' is thinner than five spacings, 0.25, behind 100 % of its surface, and "
                            "is no plate with flat faces")));
  EXPECT_THAT(warnings(start + "shape = \"box\"\nsize = [0.1, 1]\n[[body]]\nshape = \"ball\"\nradius = "
                               "0.3\nsubtract = true\n"),
              Contains(HasSubstr("the body 'it' is thinner than five spacings, 0.25, behind")));
  EXPECT_THAT(warnings(start + "shape = \"box\"\nsize = [0.04, 1]\nwall = \"none\"\n"), IsEmpty());
  EXPECT_THAT(warnings(start + "shape = \"half-space\"\n"), IsEmpty());
  // What lies between the tank and the side of the domain goes on beyond it.
  EXPECT_THAT(warnings(start + "shape = \"ball\"\nradius = 0.98\ninside = false\n"), IsEmpty());
  EXPECT_THAT(warnings(head3 + "[[body]]\nshape = \"box\"\nsize = [0.5, 0.5, 0.05]\n"),
              Contains(HasSubstr("thinner than a spacing, 0.1")));
}

// Boxes whose faces leave 0.3 spacings; not those that touch, have room for a layer, face a wall with an edge, or
// take something away.
TEST(Bodies, SlotsThatHoldNoParticleAreWarnedOf) {
  const std::string walls = "left = \"free-slip\"\nbottom = \"free-slip\"\n";
  const std::string plane = test::replaced(head2, "[resolution]", walls + "[resolution]"),
                    space = test::replaced(head3, "[resolution]", walls + "[resolution]");
  const auto box = [](const char* position, const char* more = "") {
    return std::string("[[body]]\nname = \"it\"\nshape = \"box\"\nsize = [0.6, 0.6]\nposition = ") + position + "\n" +
           more;
  };
  const std::string start = plane + "[[liquid]]\nlower = [-1, -1]\nupper = [1, 0.9]\n";
  EXPECT_THAT(warnings(start + box("[0, -0.685]")),
              ElementsAre(HasSubstr("the body 'it' leaves a slot of 0.015, 0.3 spacings, to a side: no particle")));
  EXPECT_THAT(warnings(start + box("[0.3, 0]") + test::replaced(box("[-0.315, 0]"), "\"it\"", "\"other\"")),
              ElementsAre(HasSubstr("the body 'it' leaves a slot of 0.015, 0.3 spacings, to another body"),
                          HasSubstr("the body 'other' leaves a slot of 0.015")));
  for (const std::string& good : {box("[0, -0.7]"), box("[0, -0.67]"), box("[0, -0.565]", "rotation = [45]\n"),
                                  box("[0.3, 0]") + test::replaced(box("[-0.3, 0]"), "\"it\"", "\"other\""),
                                  box("[0, -0.685]", "wall = \"none\"\n")})
    EXPECT_THAT(warnings(start + good), testing::Not(Contains(HasSubstr("slot")))) << good;
  EXPECT_THAT(warnings(space + test::replaced(box("[0, 0, -0.67]"), "[0.6, 0.6]", "[0.6, 0.6, 0.6]")),
              Contains(HasSubstr("the body 'it' leaves a slot of 0.03, 0.3 spacings, to a side")));
}

// A body on the floor has a notch there, 2.2 spacings high, with room for four particles; one of six holds more.
TEST(Bodies, PoolsOfAFewParticlesAreLeftEmptyAndWarnedOf) {
  const std::string start =
      test::replaced(test::replaced(head2, "walled", "les-sph"), "[resolution]",
                     "left = \"free-slip\"\nright = \"free-slip\"\nbottom = \"free-slip\"\n[resolution]");
  const auto tank = [&](double height, const char* top) {
    return start + "[[liquid]]\nupper = [1, " + top + "]\n[[body]]\nshape = \"outline\"\npoints = [[-0.9, -1.2], [" +
           std::to_string(-height) + ", -1], [0, " + std::to_string(-1 + height) + "], [" + std::to_string(height) +
           ", -1], [0.9, -1.2], [0.9, -0.5], [-0.9, -0.5]]\n";
  };
  const LoadedCase small = test::load_text(tank(0.11, "0.9"));
  std::vector<std::string> texts;
  for (const Problem& problem : small.options.warnings) texts.push_back(problem.text);
  EXPECT_THAT(texts, Contains(HasSubstr("in pools of fewer than 7 that bodies close off, left out")));
  const auto below = [](const LoadedCase& loaded, double y) {
    int count = 0;
    for (std::size_t i = 0; i < loaded.scene.particles.size(); ++i)
      if (std::abs(loaded.scene.particles.position[0][i]) < 0.5 && loaded.scene.particles.position[1][i] < y) ++count;
    return count;
  };
  EXPECT_EQ(below(small, -0.6), 0);
  EXPECT_GT(below(test::load_text(tank(0.3, "0.9")), -0.6), 20);
}

// Two plates two spacings thick, the second turned by an angle and across the first or on it; 3-D; and a fold.
TEST(Bodies, AcuteCornersOfThinBodiesAreWarnedOf) {
  const std::string start = head2 + "[[liquid]]\nlower = [-1, -1]\nupper = [1, 0.9]\n";
  const std::string floor = "[[body]]\nname = \"floor\"\nshape = \"box\"\nsize = [1.2, 0.1]\n";
  const auto across = [&](const std::string& degrees, const std::string& position) {
    return warnings(start + floor + "[[body]]\nname = \"it\"\nshape = \"box\"\nsize = [0.9, 0.1]\nposition = " +
                    position + "\nrotation = [" + degrees + "]\n");
  };
  for (const char* degrees : {"20", "30", "40"}) {
    EXPECT_THAT(
        across(degrees, "[0, 0]"),
        ElementsAre(HasSubstr(std::string("18:1 the bodies 'floor' and 'it' meet at ") + degrees + " degrees")));
    EXPECT_THAT(
        across(degrees, "[0, 0.2]"),
        ElementsAre(HasSubstr(std::string("18:1 the bodies 'floor' and 'it' meet at ") + degrees + " degrees")));
  }
  for (const char* degrees : {"45", "50", "70", "90"}) {
    EXPECT_THAT(across(degrees, "[0, 0]"), IsEmpty()) << degrees;
    EXPECT_THAT(across(degrees, "[0, 0.3]"), IsEmpty()) << degrees;
  }
  EXPECT_THAT(across("0", "[0, 0.15]"), IsEmpty());  // a channel
  EXPECT_THAT(across("30", "[0, 0.6]"), IsEmpty());  // apart
  const std::string fold = "[[body]]\nname = \"v\"\nshape = \"outline\"\npoints = [[0, 0], [0.8, 0], [0.8, 0.1], ";
  EXPECT_THAT(warnings(start + fold + "[0.3, 0.1], [0.75, 0.36], [0.7, 0.446]]\n"),
              ElementsAre(HasSubstr("two faces of the body 'v' meet at 30 degrees")));
  const std::string start3 = head3 + "[[body]]\nname = \"a\"\nshape = \"box\"\nsize = ";
  EXPECT_THAT(
      warnings(start3 + "[1.6, 0.8, 0.2]\n[[body]]\nname = \"b\"\nshape = \"box\"\nsize = [1.5, 0.8, 0.2]\nrotation "
                        "= [0, 30, 0]\n"),
      ElementsAre(HasSubstr("the bodies 'a' and 'b' meet at 30 degrees")));
}

LoadedCase load_periodic(const std::string& where) {
  std::string text = head2;
  text.replace(text.find("[resolution]"), 0, "x = \"periodic\"\n");
  return load(text + liquid_beside + "[[body]]\nwhere = \"" + where + "\"\n");
}

// The liquid over a bed is the domain less the area below it, and the bed goes around: places beside the side are as
// far from it as from its copies. These filled the domain: of 844 particles 91 were left.
TEST(Bodies, ABedByAnExpressionGoesOnBeyondAPeriodicSide) {
  using std::numbers::pi;
  const struct {
    std::string where;
    std::function<double(double)> height;
    double free;
  } beds[] = {
      {"-0.5 + 0.2*sin(pi*x) - y", [](double x) { return -0.5 + 0.2 * std::sin(pi * x); }, 3},
      {"-0.5 - y", [](double) { return -0.5; }, 3},
      {"-0.6 + 0.2*x^2 - y", [](double x) { return -0.6 + 0.2 * x * x; }, 4 - 2 * (0.4 + 0.2 / 3)},
      {"0.022 - abs(y + 0.526)", [](double) { return -0.504; }, 4 - 2 * 0.044},  // thinner than a spacing
      {"y < -0.5 + 0.2*cos(2*pi*x)", [](double x) { return -0.5 + 0.2 * std::cos(2 * pi * x); }, 3},
  };
  for (const auto& given : beds) {
    SCOPED_TRACE(given.where);
    const LoadedCase loaded = load_periodic(given.where);
    // The volume of cells that the bed cuts is shared out by samples.
    const auto& particles = loaded.scene.particles;
    EXPECT_NEAR(static_cast<double>(particles.size()) * particles.volume, given.free, 1e-3 * given.free);
    const Shape& bed = *loaded.scene.bodies[0].shape;
    for (const double y : {-0.2, 0.3, 0.9})
      for (const double x : {-1.0, -0.9, 0.95, 1.0, 1.1}) {
        double nearest = infinite;
        for (int k = -4000; k <= 4000; ++k) {
          const double at = k / 1000.0, own = at - 2 * std::round(at / 2);
          nearest = std::min(nearest, std::hypot(at - x, given.height(own) - y));
        }
        // Half a spacing where the nearest place changes from one to another between nodes.
        EXPECT_NEAR(std::abs(bed.distance({x, y})), nearest, 0.5 * 0.05) << x << ", " << y;
      }
    EXPECT_EQ(bed.bounds().upper[0], infinite);
    double left = 1, right = -1;
    for (const Vec3& p : bed.surface({{-1, -1}, {1, 1}}, 0.05).points) {
      left = std::min(left, p[0]);
      right = std::max(right, p[0]);
    }
    EXPECT_EQ(left, -1);
    EXPECT_EQ(right, 1);
  }
}

// What stands before one periodic side and not before the other was a wall there on one side alone.
TEST(Bodies, AnExpressionWhoseSidesDisagreeIsRefused) {
  for (const auto& [where, place] :
       {std::pair{"0.16 - (x - 0.9)^2 - y^2", "positive at (1, -0.35) and not at (-1, -0.35)"},
        {"min(x - 0.5, -y)", "positive at (1, -1) and not at (-1, -1)"},
        {"-0.5 + 0.01*x - y", "positive at (1, -0.5) and not at (-1, -0.5)"},
        {"-0.52 - 0.001*x - y", "positive at (-1, -0.52) and not at (1, -0.52)"}})
    try {
      load_periodic(where);
      ADD_FAILURE() << where << " was taken";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("body.0.where goes on beyond a periodic side along x")) << where;
      EXPECT_THAT(error.what(), HasSubstr(place)) << where;
    }
  // By a hundredth of a spacing at most.
  EXPECT_NO_THROW(load_periodic("-0.52 + 0.0002*x - y"));
}

// Clear of the side, and across it by less than four spacings, where its copy is whole.
TEST(Bodies, AnExpressionThatEndsBesideAPeriodicSideIsOneBody) {
  for (const auto& [where, area] : {std::pair{"0.09 - x^2 - y^2", 0.09}, {"0.04 - (x - 0.9)^2 - y^2", 0.04}}) {
    const LoadedCase loaded = load_periodic(where);
    const double free = 4 - std::numbers::pi * area;
    EXPECT_NEAR(static_cast<double>(loaded.scene.particles.size()) * 0.05 * 0.05, free, 0.02 * free) << where;
  }
}

TEST(Bodies, TheResolvedCaseIsReadBackToTheSameBodies) {
  const std::string text = head2 + liquid_beside +
                           "[[body]]\nshape = \"outline\"\npoints = [[0, 0], [0.5, 0.25], [0, 0.5]]\nrotation = [15]\n"
                           "[[body]]\nname = \"b\"\nwhere = \"0.04 - x^2 - y^2\"\ninside = false\nwall = \"no-slip\"\n";
  const LoadedCase first = load(text), second = load(first.options.resolved);
  ASSERT_EQ(second.scene.bodies.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(second.scene.bodies[k].name, first.scene.bodies[k].name);
    EXPECT_EQ(second.scene.bodies[k].solid->distance({0.3, 0.2, 0}),
              first.scene.bodies[k].solid->distance({0.3, 0.2, 0}));
  }
}

}  // namespace
}  // namespace spume
