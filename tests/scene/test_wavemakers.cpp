// SPDX-License-Identifier: MIT
// [[wavemaker]] and [[sponge]]: what the scene makes of them, and what is refused or warned of.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "helpers.hpp"
#include "spume/scene/second_order_waves.hpp"
#include "spume/scene/wave_absorption.hpp"
#include "spume/scene/wave_theory.hpp"

namespace spume {
namespace {

using std::numbers::pi;
using test::load_text;
using test::problems_of;
using test::replaced;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A flume 10 long with liquid 1 deep; line 18 is the wavemaker, 23 the sponge.
const std::string flume = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [10, 1.5]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.1
[fluid]
froude = 1
[[liquid]]
where = "1 - y"
conform = true
[time]
end = 20

[[wavemaker]]
side = "left"
waves = "regular"
height = 0.1
period = 5
[[sponge]]
side = "right"
length = 4
)toml";

std::shared_ptr<const TabulatedOscillations> second_of(const std::vector<Oscillation>& first,
                                                       WavemakerKind kind = WavemakerKind::piston) {
  return std::make_shared<TabulatedOscillations>(second_order_motion(first, kind, 1, 1), 20);
}

double velocity_of(const Scene& scene, int end, double t) {
  const auto& velocity = scene.domain.sides[0][static_cast<std::size_t>(end)].velocity;
  EXPECT_TRUE(velocity.has_value());
  EXPECT_EQ(velocity->component[1], nullptr);
  return (*velocity)({0, 0.3, 0}, t)[0];
}

TEST(Wavemakers, ARegularWaveMovesTheSideByTheoryOfSecondOrder) {
  const LoadedCase loaded = load_text(flume);
  const double w = 2 * pi / 5, kh = wavenumber(w, 1, 1), stroke = 0.1 / piston_transfer(kh);
  const OscillatingPiston second({{stroke / 2, w, 0}}, 10, second_of({{stroke / 2, w, 0}}));
  const OscillatingPiston first({{stroke / 2, w, 0}}, 3);
  const Scene one = load_text(flume, {"wavemaker.0.order=1", "wavemaker.0.ramp=3"}).scene;
  const Scene right = load_text(flume, {"wavemaker.0.side=right", "sponge.0.side=left"}).scene;
  for (const double t : {0.0, 0.3, 4.0, 12.0, 12.7}) {
    // The depth is measured: columns of particles of equal height give it to rounding.
    EXPECT_NEAR(velocity_of(loaded.scene, 0, t), second.velocity(t), 1e-12) << t;
    EXPECT_NEAR(velocity_of(one, 0, t), first.velocity(t), 1e-12) << t;
    EXPECT_NEAR(velocity_of(right, 1, t), -second.velocity(t), 1e-12) << t;
  }
  EXPECT_FALSE(loaded.scene.domain.sides[0][1].velocity.has_value());
  EXPECT_THAT(loaded.options.groups.at("wavemaker left"),
              testing::AllOf(HasSubstr("wavelength "), HasSubstr("kh "), HasSubstr("steepness"), HasSubstr("stroke"),
                             HasSubstr("largest speed"), HasSubstr("depth 1")));
  EXPECT_THAT(loaded.options.warnings, IsEmpty());
}

TEST(Wavemakers, AFlapTurnsAboutItsHingeByTheoryOfSecondOrder) {
  const double w = 2 * pi / 5, kh = wavenumber(w, 1, 1);
  const std::vector<Oscillation> first{{0.05 / flap_transfer(kh), w, 0}};
  const OscillatingPiston way(first, 10, second_of(first, WavemakerKind::flap));
  for (const bool left : {true, false}) {
    const LoadedCase loaded = left ? load_text(flume, {"wavemaker.0.kind=flap", "wavemaker.0.depth=1"})
                                   : load_text(flume, {"wavemaker.0.kind=flap", "wavemaker.0.depth=1",
                                                       "wavemaker.0.side=right", "sponge.0.side=left"});
    const Scene& scene = loaded.scene;
    EXPECT_FALSE(scene.domain.sides[0][left ? 0 : 1].velocity.has_value());
    ASSERT_EQ(scene.motions.size(), 1U);
    ASSERT_EQ(scene.bodies.size(), 1U);
    const double inwards = left ? 1 : -1, hinge = scene.motions[0].pivot[0];
    // Where it stands, at rest, liquid ends; a place that it holds at the still surface goes as theory says.
    EXPECT_NEAR(scene.bodies[0].solid->distance({hinge + inwards * 0.2, 0.7, 0}), 0.2, 1e-12);
    const double side = left ? 0 : 10;
    EXPECT_GT(inwards * (hinge - side), 0.26 + 1.5 * 0.05 / flap_transfer(kh));
    EXPECT_LT(inwards * (hinge - side), 0.26 + 1.5 * 0.05 / flap_transfer(kh) + 0.1);
    for (const double t : {0.0, 0.3, 4.0, 12.0, 12.7}) {
      const RigidPlace place = given_place(scene.motions[0], t);
      const Vec3 top = place.now({hinge, 1, 0});
      EXPECT_NEAR((top[0] - hinge) / top[1], inwards * way.displacement(t), 1e-12) << t;
      // Of the angle atan x: x' / (1 + x^2), about z.
      EXPECT_NEAR(place.angular_velocity[2], -inwards * way.velocity(t) / (1 + std::pow(way.displacement(t), 2)), 1e-8);
    }
    EXPECT_THAT(loaded.options.groups.at(left ? "wavemaker left" : "wavemaker right"),
                HasSubstr("flap with its hinge at x = "));
    EXPECT_THAT(loaded.options.warnings, IsEmpty());
  }
}

TEST(Wavemakers, AFlapThatCannotBeIsRefused) {
  const auto with = [](const std::string& keys) {
    return problems_of(
        replaced(flume, "side = \"left\"\nwaves", "side = \"left\"\nkind = \"flap\"\n" + keys + "waves"));
  };
  EXPECT_THAT(with(""), ElementsAre(HasSubstr("missing key 'depth' in [[wavemaker]]")));
  EXPECT_THAT(with("depth = 2\n"), ElementsAre(HasSubstr("wavemaker.0.depth must be less than the height")));
  EXPECT_TRUE(with("depth = 1\norder = 2\n").empty());
  EXPECT_THAT(with("depth = 1\nabsorption = \"tuned\"\n"),
              ElementsAre(HasSubstr("wavemaker.0.absorption is for pistons; set  kind = \"piston\"")));
  EXPECT_THAT(with("depth = 1\nhinge = 0.2\n"), ElementsAre(HasSubstr("wavemaker.0.hinge is 0.2 from the left side")));
  EXPECT_TRUE(with("depth = 1\nhinge = 0.5\n").empty());
  EXPECT_THAT(problems_of(replaced(replaced(flume, "waves = \"regular\"\nheight = 0.1\nperiod = 5\n",
                                            "kind = \"flap\"\nwaves = \"solitary\"\nheight = 0.1\ndepth = 1\n"),
                                   "length = 4", "length = 4\nstrength = 1")),
              ElementsAre(HasSubstr("need a piston")));
}

TEST(Wavemakers, OtherWavesMoveTheSideByTheirTheory) {
  const Scene solitary =
      load_text(flume, {"wavemaker.0.waves=solitary", "wavemaker.0.height=0.2", "wavemaker.0.depth=1.02"}).scene;
  const SolitaryPiston piston(SolitaryWave(0.2, 1.02, 1));
  const Scene irregular = load_text(flume, {"wavemaker.0.waves=jonswap", "wavemaker.0.seed=3", "seed=9"}).scene;
  const auto waves = piston_motion(jonswap_waves(0.1, 5, 3.3, 100, 9, 3), 1, 1);
  const OscillatingPiston sum(waves, 10, second_of(waves));
  const std::string focus = replaced(flume, "waves = \"regular\"\nheight = 0.1",
                                     "waves = \"focused\"\namplitude = 0.05\nfocus_place = 6\nfocus_time = 30");
  const Scene focused = load_text(focus).scene;
  const auto group = piston_motion(focused_waves(0.05, 5, 3.3, 100, 6, 30, 1, 1), 1, 1);
  const OscillatingPiston meeting(group, 10, second_of(group));
  const Scene linear = load_text(focus, {"wavemaker.0.order=1"}).scene;
  const Scene many = load_text(focus, {"wavemaker.0.components=301"}).scene;
  const OscillatingPiston meeting_linear(group, 10);
  const OscillatingPiston meeting_many(piston_motion(focused_waves(0.05, 5, 3.3, 301, 6, 30, 1, 1), 1, 1), 10);
  for (const double t : {0.5, 8.0, 15.0, 31.0}) {
    EXPECT_DOUBLE_EQ(velocity_of(solitary, 0, t), piston.velocity(t));
    EXPECT_NEAR(velocity_of(irregular, 0, t), sum.velocity(t), 1e-12);
    EXPECT_NEAR(velocity_of(focused, 0, t), meeting.velocity(t), 1e-12);
    EXPECT_NEAR(velocity_of(linear, 0, t), meeting_linear.velocity(t), 1e-12);
    EXPECT_NEAR(velocity_of(many, 0, t), meeting_many.velocity(t), 1e-12);
  }
}

TEST(Wavemakers, TheDepthIsThatAboveTheBedBesideTheWall) {
  const std::string bed = "[[solid]]\nlower = [0, 0]\nupper = [10, 0.3]\n";
  EXPECT_THAT(load_text(flume + bed).options.groups.at("wavemaker left"), HasSubstr("depth 0.7"));
}

TEST(Wavemakers, ACloneOfTheVelocityFollowsItsOwnTime) {
  const Scene scene = load_text(flume).scene;
  const VectorExpression& velocity = *scene.domain.sides[0][0].velocity;
  const double at_3 = velocity({}, 3)[0];
  const VectorExpression copy = velocity.clone();
  EXPECT_NE(copy({}, 11)[0], at_3);
  EXPECT_EQ(copy({}, 3)[0], at_3);
  EXPECT_EQ(velocity({}, 3)[0], at_3);
}

TEST(Wavemakers, AnAbsorbingSideHasTheLawOfItsWavesAndTheElevationThatItMakes) {
  const FaceOfPiston face{1, 1, 0.15};
  const double w = 2 * pi / 5;
  const LoadedCase loaded = load_text(flume, {"wavemaker.0.absorption=tuned", "wavemaker.0.order=1"});
  ASSERT_TRUE(loaded.scene.domain.sides[0][0].absorption.has_value());
  const WaveAbsorption& of = *loaded.scene.domain.sides[0][0].absorption;
  const AbsorptionLaw tuned = tuned_law(face, w), longer = long_wave_law(face);
  EXPECT_NEAR(of.law.gain, tuned.gain, 1e-12);
  EXPECT_NEAR(of.law.smoothing, tuned.smoothing, 1e-12);
  EXPECT_NEAR(of.still, 1, 1e-12);
  const std::vector<Oscillation> first{{0.05 / piston_transfer(wavenumber(w, 1, 1)), w, 0}};
  const auto elevation = OscillatingPiston(first, 10).elevation(face);
  const auto second = OscillatingPiston(first, 10, second_of(first)).elevation(face);
  const Scene both = load_text(flume, {"wavemaker.0.absorption=tuned"}).scene;
  for (const double t : {3.0, 11.0, 12.0}) {
    EXPECT_NEAR((*of.elevation)(0, 0, 0, t), (*elevation)(0, 0, 0, t), 1e-12);
    EXPECT_NEAR((*both.domain.sides[0][0].absorption->elevation)(0, 0, 0, t), (*second)(0, 0, 0, t), 1e-12);
  }
  EXPECT_THAT(loaded.options.groups.at("wavemaker left"), HasSubstr("absorbs: velocity "));

  // One that only absorbs takes the period of the other.
  const std::string two = replaced(flume, "[[sponge]]\nside = \"right\"\nlength = 4\n",
                                   "[[wavemaker]]\nside = \"right\"\nwaves = \"none\"\nabsorption = \"tuned\"\n");
  const Scene absorber = load_text(two).scene;
  EXPECT_FALSE(absorber.domain.sides[0][0].absorption.has_value());
  EXPECT_NEAR(absorber.domain.sides[0][1].absorption->law.gain, tuned.gain, 1e-12);
  EXPECT_EQ(absorber.domain.sides[0][1].absorption->elevation, nullptr);
  EXPECT_EQ(velocity_of(absorber, 1, 3), 0);
  EXPECT_NEAR(load_text(two, {"wavemaker.1.period=8"}).scene.domain.sides[0][1].absorption->law.gain,
              tuned_law(face, 2 * pi / 8).gain, 1e-12);
  EXPECT_NEAR(load_text(two, {"wavemaker.1.absorption=long-wave"}).scene.domain.sides[0][1].absorption->law.gain,
              longer.gain, 1e-12);
  // A wall that only absorbs has no waves that a sponge could take its strength from.
  EXPECT_THAT(problems_of(replaced(flume, "waves = \"regular\"\nheight = 0.1\nperiod = 5\n",
                                   "waves = \"none\"\nabsorption = \"long-wave\"\n")),
              ElementsAre(HasSubstr("sponge.0 has no strength, and no wavemaker has waves to take it from")));
  EXPECT_THAT(problems_of(two, {"wavemaker.1.absorption=none"}),
              ElementsAre(HasSubstr("wavemaker.1 makes no waves and absorbs none; add  absorption = \"tuned\"")));
}

TEST(Wavemakers, ASpongeTakesItsStrengthFromTheWaves) {
  const Scene scene = load_text(flume).scene;
  ASSERT_EQ(scene.sponges.size(), 1U);
  EXPECT_EQ(scene.sponges[0].axis, 0);
  EXPECT_EQ(scene.sponges[0].side, 1);
  EXPECT_DOUBLE_EQ(scene.sponges[0].length, 4);
  EXPECT_DOUBLE_EQ(scene.sponges[0].strength, 3 * 2 * pi / 5);
  const Scene other = load_text(flume, {"sponge.0.strength=2", "sponge.0.side=top", "sponge.0.length=0.5",
                                        "sponge.0.velocity=[0.5, 0]"})
                          .scene;
  EXPECT_EQ(other.sponges[0].axis, 1);
  EXPECT_DOUBLE_EQ(other.sponges[0].strength, 2);
  EXPECT_DOUBLE_EQ(other.sponges[0].velocity[0], 0.5);
}

TEST(Wavemakers, WhatCannotBeIsRefusedWithTheFix) {
  EXPECT_THAT(problems_of(replaced(flume, "left = \"free-slip\"\n", "")),
              ElementsAre("18:8 wavemaker.0 moves a side that is not a wall; add  left = \"free-slip\"  to [domain]"));
  EXPECT_THAT(problems_of(flume, {"domain.wall_velocity.left=[\"t\", 0]"}),
              ElementsAre("19:8 wavemaker.0 and domain.wall_velocity.left move the same wall; remove one of the two"));
  EXPECT_THAT(problems_of(flume + "[[wavemaker]]\nside = \"left\"\nwaves = \"regular\"\nheight = 0.1\nperiod = 2\n"),
              ElementsAre("27:8 another wavemaker moves the left wall already"));
  EXPECT_THAT(problems_of(replaced(flume, "froude = 1", "mach = 0")),
              ElementsAre(HasSubstr("18:1 wavemaker.0 needs gravity, without which there are no waves")));
  EXPECT_THAT(problems_of(replaced(flume, "height = 0.1\nperiod = 5\n", "")),
              ElementsAre("18:1 missing key 'height' in [[wavemaker]]; add  height = <number>  # length",
                          "18:1 missing key 'period' in [[wavemaker]]; add  period = <number>  # time"));
  EXPECT_THAT(problems_of(flume, {"wavemaker.0.waves=jonswap", "wavemaker.0.order=2", "wavemaker.0.components=400"}),
              ElementsAre(HasSubstr("components is 400, and theory of second order takes 300 at most")));
  EXPECT_THAT(problems_of(flume, {"wavemaker.0.waves=focused", "wavemaker.0.amplitude=0.1",
                                  "wavemaker.0.focus_place=11", "wavemaker.0.focus_time=9"}),
              ElementsAre(HasSubstr("focus_place lies outside the domain: x = 11, the domain's x from 0 to 10")));
  EXPECT_THAT(problems_of(replaced(flume, "where = \"1 - y\"\nconform = true", "lower = [5, 0]\nupper = [10, 1]")),
              ElementsAre("18:1 wavemaker.0 has no liquid beside its wall; fill the domain there, or choose the other "
                          "side"));
  EXPECT_THAT(problems_of(flume, {"wavemaker.0.height=9", "wavemaker.0.period=15", "wavemaker.0.ramp=0"}),
              ElementsAre(HasSubstr("into the liquid, which has room for 9.38; make the waves lower or shorter, or the "
                                    "domain longer")));
  EXPECT_THAT(
      problems_of(flume, {"fluid.mach=0.9", "wavemaker.0.height=2"}),
      ElementsAre(HasSubstr("more than half the sound speed 1.11111; make the waves lower or longer, or raise")));
}

TEST(Wavemakers, SpongesThatCannotBeAreRefusedWithTheFix) {
  EXPECT_THAT(problems_of(flume, {"sponge.0.side=back"}),
              ElementsAre("--set sponge.0.side=back sponge.0.side: a 2-D domain has left, right, bottom, top"));
  EXPECT_THAT(problems_of(flume, {"sponge.0.length=11"}),
              ElementsAre(HasSubstr("sponge.0.length is 11, longer than the domain, which is 10 long in x")));
  EXPECT_THAT(problems_of(flume, {"sponge.0.velocity=[1]"}),
              ElementsAre(HasSubstr("sponge.0.velocity must have 2 entries in a 2-D domain, found 1")));
  EXPECT_THAT(problems_of(flume + "[[sponge]]\nside = \"right\"\nlength = 1\n"),
              ElementsAre("27:8 another sponge lies at the side right already; keep one of them"));
  const std::size_t maker = flume.find("[[wavemaker]]"), sponge = flume.find("[[sponge]]");
  const std::string alone = flume.substr(0, maker) + flume.substr(sponge);
  EXPECT_THAT(problems_of(alone), ElementsAre(HasSubstr("18:1 sponge.0 has no strength, and no wavemaker has waves")));
  EXPECT_THAT(problems_of(replaced(alone, "left = \"free-slip\"\nright = \"free-slip\"", "x = \"periodic\""),
                          {"sponge.0.strength=1"}),
              ElementsAre(HasSubstr("18:8 sponge.0.side is a side of the periodic direction x, which has none")));
}

std::vector<std::string> warnings_of(const std::vector<std::string>& overrides) {
  std::vector<std::string> texts;
  for (const Problem& warning : load_text(flume, overrides).options.warnings) texts.push_back(warning.text);
  return texts;
}

TEST(Wavemakers, WavesThatBreakAndSpongesTooShortAreWarnedOf) {
  EXPECT_THAT(warnings_of({"wavemaker.0.waves=jonswap", "wavemaker.0.components=301"}),
              ElementsAre(HasSubstr("wavemaker.0.components is 301, and above 300 the motion is of first order")));
  EXPECT_THAT(warnings_of({"wavemaker.0.height=0.8", "wavemaker.0.order=1"}),
              ElementsAre(HasSubstr("the wave height 0.8 is 0.8 of the depth; waves break above 0.78")));
  // kh = 4: 1.58 long; 0.14 tanh kh is 0.14 of that.
  EXPECT_THAT(warnings_of({"wavemaker.0.height=0.23", "wavemaker.0.period=3.143"}),
              ElementsAre(HasSubstr("of the wavelength; waves break above 0.14 tanh kh = 0.1399")));
  EXPECT_THAT(warnings_of({"wavemaker.0.height=0.21", "wavemaker.0.period=3.143"}), IsEmpty());
  EXPECT_THAT(warnings_of({"wavemaker.0.height=0.3", "wavemaker.0.period=12", "sponge.0.length=6"}),
              ElementsAre(HasSubstr("are too long for second-order theory: H L^2 / h^3 is")));
  EXPECT_THAT(warnings_of({"wavemaker.0.depth=1.06"}),
              ElementsAre("wavemaker.0.depth is 1.06, and the liquid beside the wall is 1 deep; remove the key to "
                          "take that"));
  EXPECT_THAT(warnings_of({"sponge.0.length=1.7"}), ElementsAre(HasSubstr("sponge.0.length is 0.4")));
  EXPECT_THAT(warnings_of({"sponge.0.side=left"}),
              ElementsAre(HasSubstr("sponge.0 damps the waves where wavemaker.0 makes them")));
}

}  // namespace
}  // namespace spume
