// SPDX-License-Identifier: MIT
// Bodies that move: where they are, what floats, and what is said of motions that cannot be.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "helpers.hpp"
#include "spume/core/vectors.hpp"

namespace spume {
namespace {

using std::numbers::pi;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string plane =
    "method = \"les-sph\"\n[domain]\nlower = [-1, -1]\nupper = [1, 1]\n[resolution]\nspacing = 0.05\n[time]\nend = 2\n"
    "[fluid]\nreynolds = 100\n[[liquid]]\nlower = [-1, -1]\nupper = [1, -0.8]\n";
const std::string space =
    "method = \"les-sph\"\n[domain]\nlower = [-1, -1, -1]\nupper = [1, 1, 1]\n[resolution]\nspacing = 0.1\n[time]\nend "
    "= 2\n[fluid]\nreynolds = 100\n[[liquid]]\nupper = [1, 1, -0.8]\n";
const std::string slab = "[[body]]\nname = \"slab\"\nshape = \"box\"\nsize = [0.4, 0.2]\nposition = [0.1, 0.2]\n";
const std::string brick =
    "[[body]]\nname = \"brick\"\nshape = \"box\"\nsize = [0.4, 0.2, 0.6]\nposition = [0.1, 0.2, 0.3]\n";

BodyMotion motion_of(const std::string& text) {
  const LoadedCase loaded = test::load_text(text);
  EXPECT_EQ(loaded.scene.motions.size(), 1u);
  return loaded.scene.motions.at(0);
}

std::vector<std::string> complaints(const std::string& text) {
  std::vector<std::string> found;
  try {
    test::load_text(text);
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems()) found.push_back(problem.text);
  }
  return found;
}

void expect_near(const Vec3& found, const Vec3& expected, double tolerance) {
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(found[a], expected[a], tolerance) << "component " << a;
}

// Velocities are differences of fourth order over 2e-7: rounding leaves 1e-16 / 2e-7 of the way.
TEST(BodyMotion, IsWhatExpressionsSay) {
  const BodyMotion motion =
      motion_of(plane + slab + "displacement = [\"0.3*sin(t)\", \"t^2\"]\nangle = \"90*t\"\npivot = [0, 0.1]\n");
  const RigidPlace place = given_place(motion, 0.5);
  expect_near(place.now({0, 0.1, 0}), {0.3 * std::sin(0.5), 0.1 + 0.25, 0}, 1e-15);
  const double c = std::cos(pi / 4);
  expect_near(place.now({0.2, 0.1, 0}), {0.3 * std::sin(0.5) + 0.2 * c, 0.35 + 0.2 * c, 0}, 1e-15);
  expect_near(place.start(place.now({0.3, -0.4, 0})), {0.3, -0.4, 0}, 1e-15);
  expect_near(place.velocity, {0.3 * std::cos(0.5), 1, 0}, 1e-8);
  expect_near(place.angular_velocity, {0, 0, pi / 2}, 1e-8);
  expect_near(place.velocity_at(place.now({0.2, 0.1, 0})),
              {0.3 * std::cos(0.5) - 0.2 * c * pi / 2, 1 + 0.2 * c * pi / 2, 0}, 1e-8);
}

TEST(BodyMotion, StartsWhereItLeadsToAtTheStart) {
  const LoadedCase loaded = test::load_text(plane + slab + "displacement = [\"0.5 + t\", \"0\"]\nangle = \"90\"\n");
  const Body& body = loaded.scene.bodies.at(0);
  EXPECT_NEAR(body.solid->distance({0.6, 0.2, 0}), -0.1, 1e-15);
  EXPECT_NEAR(body.solid->distance({0.6, 0.5, 0}), 0.1, 1e-15);
  EXPECT_NEAR(loaded.scene.walls.distance({0.6, 0.5, 0}), 0.1, 1e-15);
  const RigidPlace place = given_place(loaded.scene.motions.at(0), 0.25);
  expect_near(place.now({0.6, 0.2, 0}), {0.85, 0.2, 0}, 1e-15);
  expect_near(place.now({0.6, 0.5, 0}), {0.85, 0.5, 0}, 1e-15);
}

TEST(BodyMotion, TurnsAboutItsAxisInThreeDimensions) {
  const BodyMotion motion = motion_of(space + brick + "angle = \"90*t\"\naxis = [0, 2, 0]\n");
  expect_near(given_place(motion, 1).now({0.3, 0.2, 0.3}), {0.1, 0.2, 0.1}, 1e-15);
}

TEST(BodyMotion, IsWhatATableSaysSmoothly) {
  std::string rows = "t, x, angle\n";
  for (int k = 0; k <= 40; ++k)
    rows += std::to_string(0.05 * k) + ", " + std::to_string(0.1 * std::sin(0.05 * k)) + ", " +
            std::to_string(10 * std::cos(0.05 * k)) + "\n";
  const test::CaseFile table(rows, "motion.csv");
  const BodyMotion motion = motion_of(plane + slab + "motion = \"" + table.path() + "\"\n");
  const RigidPlace place = given_place(motion, 0.775);
  // Cubics through rows 0.05 apart err by their fourth derivative, 3e-8 of the way; columns are rounded at 1e-6.
  EXPECT_NEAR(place.position[0], 0.1 + 0.1 * std::sin(0.775), 2e-6);
  EXPECT_NEAR(place.velocity[0], 0.1 * std::cos(0.775), 1e-3 * 0.1);
  EXPECT_NEAR(place.angular_velocity[2], -10 * std::sin(0.775) * pi / 180, 1e-3 * 10 * pi / 180);
}

// Cells that the surface passes count by the distance of their middle: 1e-4 of the area of a disc with 512 across.
TEST(BodyMotion, AFloatingBodyHasTheMassAndInertiaOfItsShape) {
  BodyMotion motion = motion_of(plane + slab + "density = 0.5\n");
  EXPECT_NEAR(motion.mass, 0.5 * 0.08, 1e-12);
  EXPECT_NEAR(motion.inertia[2][2], motion.mass * (0.16 + 0.04) / 12, 1e-5 * motion.mass);
  expect_near(motion.pivot, {0.1, 0.2, 0}, 1e-12);
  motion = motion_of(plane + "[[body]]\nshape = \"ball\"\nradius = 0.3\nposition = [0.1, 0]\nmass = 2\n");
  EXPECT_EQ(motion.mass, 2);
  EXPECT_NEAR(motion.inertia[2][2], 0.5 * 2 * 0.09, 1e-4 * 0.09);
  motion = motion_of(space + brick + "mass = 3\nfree = [\"z\", \"turn_y\"]\n");
  EXPECT_NEAR(motion.inertia[1][1], 3 * (0.16 + 0.36) / 12, 1e-3);
  expect_near(motion.free_along, {0, 0, 1}, 0);
  expect_near(motion.free_about, {0, 1, 0}, 0);
}

TEST(BodyMotion, TakesAlongTheBodiesThatMoveWithIt) {
  const LoadedCase loaded = test::load_text(
      plane + slab +
      "mass = 1\n[[body]]\nshape = \"ball\"\nradius = 0.1\nposition = [0.1, 0.4]\nmoves_with = \"slab\"\n");
  ASSERT_EQ(loaded.scene.motions.size(), 1u);
  EXPECT_THAT(loaded.scene.motions[0].bodies, testing::ElementsAre(0, 1));
  const double areas[] = {0.08, pi * 0.01};
  EXPECT_NEAR(loaded.scene.motions[0].pivot[1], (areas[0] * 0.2 + areas[1] * 0.4) / (areas[0] + areas[1]), 1e-3);
}

TEST(BodyMotion, ATankThatIsABodyHoldsItsLiquid) {
  const std::string water = test::replaced(plane, "reynolds = 100\n", "reynolds = 100\nfroude = 1\n");
  const std::string tank = "[[body]]\nshape = \"box\"\nsize = [1.8, 1.8]\ninside = false\nangle = \"t\"\n";
  EXPECT_THAT(test::load_text(test::replaced(water, "lower = [-1, -1]\nupper = [1, -0.8]", "upper = [1, -0.8]") + tank)
                  .options.warnings,
              IsEmpty());
  const auto without = test::load_text(water).options.warnings;
  ASSERT_FALSE(without.empty());
  EXPECT_THAT(without.front().text, HasSubstr("nothing holds the liquid"));
}

TEST(BodyMotion, AProbeIsCarriedByABody) {
  const std::string probe = "[[probe]]\nname = \"p\"\nposition = [0, 0]\nmoves_with = \"slab\"\n";
  EXPECT_EQ(test::load_text(plane + slab + "angle = \"t\"\n" + probe).options.probes.at(0).motion, 0u);
  EXPECT_THAT(complaints(plane + slab + probe), Contains(HasSubstr("must be the name of a moving [[body]]")));
}

const std::string bubbles =
    "[[body]]\nname = \"bubble\"\nshape = \"ball\"\nradius = 0.1\nposition = [0.2, -1.4]\n"
    "displacement = [\"0\", \"0.5*t + t^2\"]\n";
const std::string every_second = "release_interval = 0.6\nrelease_duration = 1.5\nrelease_delay = 0.25\n";

// Three are on their way at a time: the first sets out at 0.25, 2.05, ..., the others 0.6 and 1.2 later.
TEST(BodyMotion, ReleasedBodiesSetOutOneAfterAnother) {
  const LoadedCase loaded = test::load_text(plane + bubbles + every_second);
  const Scene& scene = loaded.scene;
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.bodies[2].name, "bubble.2");
  const Vec3 start{0.2, -1.4, 0};
  for (std::size_t copy = 0; copy < 3; ++copy) {
    ASSERT_EQ(scene.bodies[copy].motion, copy);
    const BodyMotion& motion = scene.motions[copy];
    EXPECT_THAT(motion.bodies, testing::ElementsAre(copy));
    const double first = 0.25 + 0.6 * static_cast<double>(copy);
    for (const double released : {first, first + 1.8, first + 18}) {
      const RigidPlace before = given_place(motion, released - 0.2), at = given_place(motion, released + 0.4),
                       end = given_place(motion, released + 1.4), after = given_place(motion, released + 1.6);
      expect_near(before.now(start), start, 0);
      expect_near(before.velocity, {}, 0);
      expect_near(at.now(start), {0.2, -1.4 + 0.2 + 0.16, 0}, 1e-13);
      expect_near(at.velocity, {0, 0.5 + 0.8, 0}, 1e-8);
      expect_near(end.velocity, {0, 0.5 + 2.8, 0}, 1e-8);
      expect_near(after.now(start), start, 0);
      expect_near(after.velocity, {}, 0);
    }
    EXPECT_EQ(given_place(motion, first + 0.4).scale, 1);
    EXPECT_EQ(given_place(motion, first - 0.1).scale, 0);
    EXPECT_EQ(given_place(motion, first + 1.6).scale, 0);
    // Nothing is as fast as what takes a body back.
    expect_near(given_place(motion, first + 1e-9).velocity, {0, 0.5, 0}, 1e-7);
    expect_near(given_place(motion, first + 1.5 - 1e-9).velocity, {0, 3.5, 0}, 1e-7);
  }
  EXPECT_NEAR(scene.bodies[1].solid->distance({0.2, -1.2, 0}), 0.1, 1e-15);
}

// A surface place grows apart from the middle as s (2 - s), s the share of the time of growth.
TEST(BodyMotion, ReleasedBodiesGrow) {
  const LoadedCase loaded = test::load_text(plane + bubbles + every_second + "release_growth = 0.8\n");
  const BodyMotion& motion = loaded.scene.motions[0];
  const Vec3 start{0.3, -1.4, 0};
  const double s = 0.25, size = s * (2 - s), e = 1e-5;
  const RigidPlace place = given_place(motion, 0.25 + 0.2);
  EXPECT_NEAR(place.scale, size, 1e-14);
  expect_near(place.now(start), {0.2 + 0.1 * size, -1.4 + 0.1 + 0.04, 0}, 1e-14);
  expect_near(place.start(place.now({0.25, -1.33, 0})), {0.25, -1.33, 0}, 1e-14);
  const Vec3 before = given_place(motion, 0.45 - e).now(start), after = given_place(motion, 0.45 + e).now(start);
  expect_near(place.velocity_at(place.now(start)), multiply(1 / (2 * e), subtract(after, before)), 1e-8);
  EXPECT_EQ(given_place(motion, 0.25 + 0.8).scale, 1);
  EXPECT_EQ(given_place(motion, 0.25 + 0.8).growth, 0);
}

TEST(BodyMotion, ReleasedBodiesShrinkBeforeTheyAreTakenAway) {
  const LoadedCase loaded =
      test::load_text(plane + bubbles + every_second + "release_growth = 0.8\nrelease_shrinkage = 0.4\n");
  const BodyMotion& motion = loaded.scene.motions[0];
  const Vec3 start{0.3, -1.4, 0};
  const double end = 0.25 + 1.5, s = 0.25, e = 1e-5;
  const RigidPlace place = given_place(motion, end - 0.1);
  EXPECT_NEAR(place.scale, s * (2 - s), 1e-12);
  const Vec3 before = given_place(motion, end - 0.1 - e).now(start),
             after = given_place(motion, end - 0.1 + e).now(start);
  expect_near(place.velocity_at(place.now(start)), multiply(1 / (2 * e), subtract(after, before)), 1e-8);
  EXPECT_EQ(given_place(motion, end - 0.5).scale, 1);
  EXPECT_EQ(given_place(motion, end - 0.5).growth, 0);
  EXPECT_NEAR(given_place(motion, end - 1e-9).scale, 0, 1e-8);
}

TEST(BodyMotion, TheWayBackIsNoPartOfTheWayBetweenTwoTimes) {
  const LoadedCase loaded = test::load_text(plane + bubbles + every_second);
  const BodyMotion& motion = loaded.scene.motions[0];
  const auto way = [&](double from, double to) {
    double sum = 0;
    for (const auto& [a, b] : ways_between(motion, from, to)) sum += length(subtract(b.position, a.position));
    return sum;
  };
  EXPECT_NEAR(way(0, 0.2), 0, 0);
  EXPECT_NEAR(way(0.1, 0.25 + 0.4), 0.36, 1e-13);         // it waits, then goes
  EXPECT_NEAR(way(0.25 + 0.4, 0.25 + 0.8), 0.68, 1e-13);  // 1.04 less 0.36
  EXPECT_NEAR(way(0.25 + 1.4, 1.8), 3.0 - 2.66, 1e-10);   // to the end, and back
  EXPECT_NEAR(way(0.25 + 1.4, 2.05 + 0.4), 0.34 + 0.36, 1e-10);
}

TEST(BodyMotion, AReleaseInTheLiquidIsWarnedOf) {
  const auto warnings = [](const std::string& text) {
    std::vector<std::string> found;
    for (const Problem& warning : test::load_text(text).options.warnings) found.push_back(warning.text);
    return found;
  };
  using testing::Not;
  const auto said = [](const char* text) { return Contains(HasSubstr(text)); };
  EXPECT_THAT(warnings(plane + bubbles + every_second), Not(said("the body 'bubble'")));
  const std::string inside = test::replaced(bubbles, "-1.4", "-0.9");
  EXPECT_THAT(warnings(plane + inside + every_second), said("the body 'bubble' appears"));
  EXPECT_THAT(warnings(plane + inside + every_second + "release_growth = 0.1\n"),
              testing::AllOf(Not(said("appears")), Not(said("grows where no liquid"))));
  // Two spacings from the middle to the face are little; the tank has a free surface.
  const auto growing = warnings(plane + bubbles + every_second + "release_growth = 0.1\n");
  EXPECT_THAT(growing, said("may displace less than half of its volume"));
  EXPECT_THAT(growing, said("the body 'bubble' grows where no liquid is within"));
  EXPECT_THAT(warnings(plane + bubbles + every_second + "release_shrinkage = 0.1\n"),
              said("may displace less than half of its volume"));
  EXPECT_THAT(growing, Not(said("nothing takes what it displaces")));
  const std::string closed = test::replaced(test::replaced(plane, "upper = [1, -0.8]", "upper = [1, 1]"),
                                            "[resolution]", "x = \"periodic\"\ny = \"periodic\"\n[resolution]");
  EXPECT_THAT(warnings(closed + bubbles + every_second + "release_growth = 0.1\n"),
              said("nothing takes what it displaces"));
  // Liquid beyond a periodic side is beside the body too.
  const std::string around =
      test::replaced(test::replaced(plane, "[resolution]", "x = \"periodic\"\n[resolution]"),
                     "lower = [-1, -1]\nupper = [1, -0.8]", "lower = [-1, -1]\nupper = [-0.9, 1]");
  const std::string aside = test::replaced(bubbles, "[0.2, -1.4]", "[0.95, 0]");
  EXPECT_THAT(warnings(around + aside + every_second), said("the body 'bubble' appears"));
  const std::string shorter = test::replaced(every_second, "1.5", "0.5");
  EXPECT_THAT(warnings(plane + bubbles + shorter), said("the body 'bubble' is taken away"));
  EXPECT_THAT(warnings(plane + bubbles + shorter + "release_shrinkage = 0.1\n"), Not(said("taken away")));
  // Where more enters it may come to what is dry at the start.
  const std::string dry = test::replaced(bubbles, "[0.2, -1.4]", "[0.2, 0.4]") + every_second;
  EXPECT_THAT(warnings(plane + dry + "[[inflow]]\nside = \"left\"\nvelocity = [1, 0]\n"),
              said("meets no liquid on its way as that stands at t = 0"));
  // Of several orifices it is said once.
  const std::string grows = bubbles + every_second + "release_growth = 0.1\n",
                    second = test::replaced(grows, "name = \"bubble\"", "name = \"second\""),
                    third = test::replaced(grows, "name = \"bubble\"", "name = \"third\"");
  const auto of_three = warnings(plane + grows + second + third);
  EXPECT_EQ(of_three.size(), growing.size());
  EXPECT_THAT(of_three, said("the same holds for 'second', 'third'"));
}

TEST(BodyMotion, AReleaseThatCannotBeIsRefused) {
  const auto expect = [](const std::string& text, const std::string& said) {
    EXPECT_THAT(complaints(plane + text), Contains(HasSubstr(said))) << text;
  };
  expect(bubbles + "release_interval = 0.6\n", "one key is missing");
  expect(bubbles + "release_interval = 1e-9\nrelease_duration = 1\n", "copies on their way at a time");
  expect(bubbles + "release_interval = 0\nrelease_duration = 1\n", "must be > 0");
  expect(bubbles + every_second + "release_growth = 1\ninside = false\n", "cannot grow");
  expect(bubbles + every_second + "release_growth = 1\nrelease_shrinkage = 0.6\n", "grows for 1 and shrinks for 0.6");
  expect(slab + every_second, "this one does not");
  expect(test::replaced(bubbles, "[0.2, -1.4]", "[0.2, 0.4]") + every_second, "nowhere on its way is liquid");
  expect(slab + "mass = 1\n" + every_second, "floats, and bodies are released on a given way alone");
  expect(bubbles + every_second + test::replaced(slab, "size", "moves_with = \"bubble\"\nsize"), "moves with it");
}

TEST(BodyMotion, WhatCannotMoveIsRefused) {
  const auto expect = [](const std::string& keys, const std::string& said) {
    EXPECT_THAT(complaints(plane + slab + keys), Contains(HasSubstr(said))) << keys;
  };
  expect("displacement = [\"x\", \"0\"]\n", "use t alone");
  expect("displacement = [\"t\"]\n", "must have 2 entries in a 2-D domain, found 1");
  expect("displacement = [\"1/t\", \"0\"]\n", "stands nowhere at t = 0");
  expect("displacement = [\"t\", \"0\"]\nmass = 1\n", "has a given motion and floats");
  expect("displacement = [\"t\", \"0\"]\nmotion = \"m.csv\"\n", "both say how it moves");
  expect("motion = \"missing.csv\"\n", "cannot read");
  expect("mass = 1\ndensity = 2\n", "follow from each other");
  expect("mass = 1\nfree = [\"z\"]\n", "must hold of \"x\", \"y\" or \"turn\"");
  expect("mass = 1\ninside = false\n", "all that lies outside its shape");
  expect("angle = \"t\"\naxis = [0, 1]\n", "in 2-D bodies turn about");
  expect("pivot = [0, 0]\n", "this one does not");
  expect("moves_with = \"bax\"\n", "must be the name of a moving [[body]] before it");
  expect("wall = \"none\"\nangle = \"t\"\n", "moves and is no wall");
  expect("velocity = [\"1\", \"0\"]\nangle = \"t\"\n", "slides the surface of a body that stands still");
  EXPECT_THAT(complaints(space + brick + "angle = \"t\"\n"), Contains(HasSubstr("missing key 'axis'")));
  EXPECT_THAT(complaints(plane + "[[body]]\nshape = \"half-space\"\nmass = 1\n"), Contains(HasSubstr("has no end")));
}

// It was cut at four spacings beyond the domain: the mass of a tower without end was that of 1.4 m at a spacing of 0.05
// and of 1.3 m at half of it, and a piston left a gap behind it.
TEST(BodyMotion, AnExpressionThatGoesOnBeyondTheDomainIsRefusedWhereThatMatters) {
  const auto said = [](const std::string& where, const std::string& keys) {
    return complaints(plane + "[[body]]\nwhere = \"" + where + "\"\n" + keys);
  };
  const std::string tower = "min(0.1 - abs(x), y + 0.5)", mass = "density = 2\n";
  EXPECT_THAT(said(tower, mass), Contains(HasSubstr("floats and goes on beyond the domain along y")));
  EXPECT_THAT(said("min(0.1 - abs(y), x)", mass), Contains(HasSubstr("floats and goes on beyond the domain along x")));
  EXPECT_THAT(said("min(0.1 - abs(x), min(y + 0.5, 1.1 - y))", mass), IsEmpty());
  // Given motions need no mass, but that its end stays outside.
  EXPECT_THAT(said("-0.7 - x", "displacement = [\"0.5*t\", \"0\"]\n"),
              Contains(HasSubstr("goes on beyond the domain along x, and its motion leads into it")));
  EXPECT_THAT(said("-0.7 - x", "displacement = [\"0.1*sin(t)\", \"t\"]\n"),
              Contains(HasSubstr("goes on beyond the domain along y, and its motion leads into it")));
  EXPECT_THAT(said("-0.7 - x", "displacement = [\"0.1*sin(t)\", \"0\"]\n"), IsEmpty());
  EXPECT_THAT(said(tower, "displacement = [\"0.5*t\", \"-0.05*t\"]\n"), IsEmpty());
  EXPECT_THAT(said(tower, "angle = \"90*t\"\n"), Contains(HasSubstr("goes on beyond the domain along y, and")));
  // A bed between periodic sides ends below alone; one that goes along it is the same again.
  std::string periodic = plane;
  periodic.insert(periodic.find("[resolution]"), "x = \"periodic\"\n");
  const std::string bed = "[[body]]\nwhere = \"-0.9 - y + 0.05*sin(pi*x)\"\n";
  EXPECT_THAT(complaints(periodic + bed + "displacement = [\"0\", \"t^2\"]\n"),
              Contains(HasSubstr("goes on beyond the domain along y, and its motion leads into it")));
  EXPECT_THAT(complaints(periodic + bed + "displacement = [\"3*t\", \"0\"]\n"), IsEmpty());
}

TEST(BodyMotion, IsNoFasterThanSoundAllows) {
  const auto with_sound = [](double mach, const std::string& keys) {
    return complaints(test::replaced(plane, "reynolds = 100", "reynolds = 100\nmach = " + std::to_string(mach)) + slab +
                      keys);
  };
  // Half of the sound speed 1 / mach is allowed; the corners are 0.2236 from the middle.
  const std::string slides = "displacement = [\"3*t\", \"0\"]\n", turns = "angle = \"180/3.14159265*t\"\n";
  EXPECT_THAT(with_sound(0.16, slides), IsEmpty());
  EXPECT_THAT(with_sound(0.17, slides),
              Contains(HasSubstr("the surface of the body 'slab' moves with 3 at t = 0, more than half the sound speed "
                                 "5.88")));
  EXPECT_THAT(with_sound(1, turns), IsEmpty());
  EXPECT_THAT(with_sound(1, "angle = \"2.3*180/3.14159265*t\"\n"), Contains(HasSubstr("moves with 0.514")));
  EXPECT_THAT(with_sound(0.3, "wall = \"no-slip\"\nvelocity = [\"2\", \"0\"]\n"), Contains(HasSubstr("moves with 2")));
  EXPECT_THAT(with_sound(0.3, "velocity = [\"2\", \"0\"]\n"), IsEmpty());  // the liquid slips along it
  EXPECT_THAT(with_sound(0, slides), IsEmpty());
}

TEST(BodyMotion, OfWallsKeepsTheVolumeOfAFullTank) {
  const std::string tank =
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nleft = \"free-slip\"\nright = \"free-slip\"\n"
      "bottom = \"free-slip\"\ntop = \"free-slip\"\nwall_velocity.left = [\"0.1*t\", \"0\"]\n[resolution]\n"
      "spacing = 0.05\n[time]\nend = 2\n[fluid]\nreynolds = 100\n[[liquid]]\n";
  EXPECT_THAT(complaints(tank),
              Contains(HasSubstr("the left wall changes the volume of a tank that is full and closed")));
  EXPECT_THAT(complaints(tank + "upper = [1, 0.5]\n"), IsEmpty());
  EXPECT_THAT(complaints(test::replaced(tank, "reynolds = 100", "reynolds = 100\nmach = 0.1")), IsEmpty());
  EXPECT_THAT(
      complaints(test::replaced(tank, "[resolution]", "wall_velocity.right = [\"0.1*t\", \"0\"]\n[resolution]")),
      IsEmpty());
  // Phases that fill a tank are pressed too, and by a flap.
  const std::string phases =
      test::replaced(test::replaced(tank, "[fluid]\nreynolds = 100\n[[liquid]]\n", ""), "les-sph", "gfd") +
      "[[phase]]\nname = \"water\"\ndensity = 1\nviscosity = 0.1\n[[region]]\nphase = \"water\"\n";
  EXPECT_THAT(complaints(phases), Contains(HasSubstr("the left wall changes the volume of a tank that is full")));
  const std::string flap =
      "[[wavemaker]]\nside = \"left\"\nkind = \"flap\"\nwaves = \"regular\"\nheight = 0.1\nperiod = 2\ndepth = 0.9\n";
  const std::string still = test::replaced(test::replaced(tank, "wall_velocity.left = [\"0.1*t\", \"0\"]\n", ""),
                                           "reynolds = 100", "reynolds = 100\nfroude = 1");
  EXPECT_THAT(complaints(still + flap), Contains(HasSubstr("the flap would press a tank that is full and closed")));
}

// Behind where a wall stood at the start a body at rest has no wall points: liquid over a bed that a piston bared went
// through it, and the run ended.
TEST(BodyMotion, OfAWallThatBaresABodyAtRestIsWarnedOf) {
  const auto warnings = [](const std::string& velocity, const std::string& body) {
    std::vector<std::string> found;
    for (const Problem& problem :
         test::load_text(
             "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\nleft = \"free-slip\"\nright = "
             "\"free-slip\"\nbottom = \"free-slip\"\nwall_velocity.left = [\"" +
             velocity +
             "\", \"0\"]\n[resolution]\nspacing = 0.05\n[time]\nend = 2\n[fluid]\nreynolds = 100\n[[liquid]]\n"
             "upper = [1, 0.5]\n[[body]]\nname = \"bed\"\n" +
             body)
             .options.warnings)
      found.push_back(problem.text);
    return found;
  };
  const std::string bed = "shape = \"half-space\"\nposition = [0, 0.2]\n";
  EXPECT_THAT(warnings("-0.3*t", bed), Contains(HasSubstr("the left wall moves off by 0.6 and bares the body 'bed'")));
  // There and back, by the integral of the sine over half of its period.
  EXPECT_THAT(warnings("-0.3*sin(pi*t)", bed), Contains(HasSubstr("the left wall moves off by 0.19")));
  for (const auto& [velocity, body] : {std::pair{std::string("0.3*t"), bed},
                                       {"-0.01*t", bed},
                                       {"-0.3*t", bed + "displacement = [\"0*t\", \"0\"]\n"},
                                       {"-0.3*t", "shape = \"box\"\nsize = [0.4, 0.2]\nposition = [0.2, 0.1]\n"}})
    EXPECT_THAT(warnings(velocity, body), testing::Not(Contains(HasSubstr("bares")))) << velocity << body;
}

TEST(BodyMotion, IntoABodyOrAWallIsWarnedOf) {
  const auto warnings = [](const std::string& keys, const std::string& more) {
    std::vector<std::string> found;
    for (const Problem& problem : test::load_text(plane + slab + keys + more).options.warnings)
      found.push_back(problem.text);
    return found;
  };
  const std::string post = "[[body]]\nname = \"post\"\nshape = \"box\"\nsize = [0.3, 0.5]\nposition = [0.8, 0.2]\n";
  // The faces are 0.35 apart.
  EXPECT_THAT(warnings("displacement = [\"0.15*t\", \"0\"]\n", post), testing::Not(Contains(HasSubstr("moves into"))));
  EXPECT_THAT(warnings("displacement = [\"0.3*t\", \"0\"]\n", post),
              Contains(HasSubstr("the body 'slab' moves into the body 'post' before t = 1.3")));
  EXPECT_THAT(warnings("displacement = [\"0\", \"-0.8*t\"]\n", ""), testing::Not(Contains(HasSubstr("moves through"))));
  const std::string floored =
      test::replaced(plane, "upper = [1, 1]\n[res", "upper = [1, 1]\nbottom = \"free-slip\"\n[res");
  std::vector<std::string> found;
  for (const Problem& problem :
       test::load_text(floored + slab + "displacement = [\"0\", \"-0.8*t\"]\n").options.warnings)
    found.push_back(problem.text);
  EXPECT_THAT(found, Contains(HasSubstr("the body 'slab' moves through the bottom wall before t = ")));
  // A small body may meet the middle of a face, away from its corners.
  EXPECT_THAT(warnings("displacement = [\"0.3*t\", \"0\"]\n",
                       "[[body]]\nname = \"post\"\nshape = \"ball\"\nradius = 0.06\nposition = [0.7, 0.2]\n"),
              Contains(HasSubstr("the body 'slab' moves into the body 'post'")));
  // Bodies that share a place from the start are meant to.
  EXPECT_THAT(warnings("displacement = [\"0.3*t\", \"0\"]\n", test::replaced(post, "[0.8, 0.2]", "[0.4, 0.2]")),
              testing::Not(Contains(HasSubstr("moves into"))));
}

}  // namespace
}  // namespace spume
