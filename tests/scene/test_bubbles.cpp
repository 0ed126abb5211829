// SPDX-License-Identifier: MIT
// The sections of the bubbles: what is read, and what is refused with the reason.
#include <gmock/gmock.h>

#include "helpers.hpp"
#include "spume/physics/bubbles/options.hpp"

namespace spume::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A tank half full of liquid, 10 x 10 x 5 particles; `extra` follows.
std::string tank(const std::string& bubbles, const std::string& extra = "") {
  return "method = \"les-sph\"\n"
         "[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\ny = \"periodic\"\nbottom = \"no-slip\"\n"
         "[resolution]\nspacing = 0.1\n"
         "[fluid]\nreynolds = 1e4\nfroude = 1\n"
         "[[liquid]]\nupper = [1, 1, 0.5]\n"
         "[turbulence]\nmodel = \"mixed-scale\"\n"
         "[time]\nend = 2\n" +
         bubbles + extra;
}

std::vector<std::string> texts(const std::string& bubbles, const std::string& extra = "",
                               const std::vector<std::string>& overrides = {}) {
  auto problems = problems_of(tank(bubbles, extra), overrides);
  for (auto& problem : problems) problem.erase(0, problem.find(' ') + 1);
  return problems;
}

const std::string plain = "[bubbles]\nweber = 1e4\n";
const std::string sparger =
    "[[sparger]]\nposition = [0.5, 0.5, 0.2]\nrate = \"1e-4*(1 + sin(t))\"\nbubble_radius = 0.01\n";

TEST(BubbleSections, AreReadWithDefaults) {
  const LoadedCase loaded = load_text(
      tank(plain + "breakup = true\nmomentum_form = \"two-fluid\"\n",
           sparger + "[[bubble_cloud]]\ncentre = [0.5, 0.5, 0.3]\nradius = 0.1\nnumber = 12\nbubble_radius = 0.02\n"
                     "sizes = \"log-normal\"\ndeviation = 0.3\n"));
  const BubbleOptions& options = loaded.options.get<BubbleOptions>();
  EXPECT_TRUE(options.on);
  EXPECT_TRUE(options.breakup);
  EXPECT_FALSE(options.entrainment);
  EXPECT_EQ(options.momentum_form, MomentumForm::two_fluid);
  EXPECT_EQ(options.integrator, BubbleIntegrator::stable);
  EXPECT_DOUBLE_EQ(options.tension, 1e-4);
  EXPECT_NEAR(options.density_ratio, 833.333, 1e-3);
  EXPECT_DOUBLE_EQ(options.hinze_radius, std::pow(1e4, -0.6) / 2);
  EXPECT_DOUBLE_EQ(options.smallest_entrained_radius, std::pow(1e4, -0.6) / 40);
  const BubbleSources& sources = loaded.options.get<BubbleSources>();
  ASSERT_EQ(sources.spargers.size(), 1U);
  EXPECT_DOUBLE_EQ((*sources.spargers[0].rate)(0, 0, 0, 0), 1e-4);
  ASSERT_EQ(sources.clouds.size(), 1U);
  const BubbleCloud& cloud = sources.clouds[0];
  EXPECT_TRUE(cloud.ball);
  EXPECT_EQ(cloud.number, 12);
  EXPECT_EQ(cloud.sizes.law, SizeLaw::log_normal);
  EXPECT_DOUBLE_EQ(cloud.sizes.minimum, 0.002);
  EXPECT_DOUBLE_EQ(cloud.sizes.maximum, 0.1);
}

TEST(BubbleSections, AbsentMeanNoBubblesAlsoInTheResolvedCase) {
  const LoadedCase loaded = load_text(tank(""));
  EXPECT_FALSE(loaded.options.get<BubbleOptions>().on);
  EXPECT_EQ(loaded.options.resolved.find("[bubbles]"), std::string::npos);
  EXPECT_FALSE(load_text(loaded.options.resolved).options.get<BubbleOptions>().on);
  const LoadedCase with = load_text(tank(plain, sparger));
  const LoadedCase again = load_text(with.options.resolved);
  EXPECT_TRUE(again.options.get<BubbleOptions>().on);
  EXPECT_EQ(again.options.get<BubbleSources>().spargers.size(), 1U);
  EXPECT_EQ(again.options.resolved.size() > 0, true);
}

TEST(BubbleSections, InSiUnits) {
  std::string text = tank("[bubbles]\nsurface_tension = 0.072\ngas_density = 1.25\n");
  text.replace(text.find("reynolds = 1e4\nfroude = 1"), std::string("reynolds = 1e4\nfroude = 1").size(),
               "density = 1000\nviscosity = 1e-3\ngravity = 9.81");
  const BubbleOptions options = load_text(text).options.get<BubbleOptions>();
  EXPECT_DOUBLE_EQ(options.tension, 7.2e-5);
  EXPECT_DOUBLE_EQ(options.density_ratio, 800);
  EXPECT_THAT(problems_of(text, {"bubbles.weber=100"}), ElementsAre(HasSubstr("belongs to the other set of units")));
  EXPECT_THAT(problems_of(text, {"bubbles.gas_density=1250"}),
              ElementsAre(HasSubstr("1.25 times as dense as the liquid")));
}

TEST(BubbleSections, WithoutWeberNumberAreRefused) {
  EXPECT_THAT(texts("[bubbles]\nentrainment = true\n"), ElementsAre(HasSubstr("missing key 'weber'")));
  EXPECT_THAT(texts("[bubbles]\n"), ElementsAre(HasSubstr("surface_interaction")));
  EXPECT_THAT(texts("[bubbles]\nsurface_interaction = false\n"), ElementsAre());
}

TEST(BubbleSections, NeedThreeDimensionsAViscousLiquidAndAClosure) {
  EXPECT_THAT(problems_of(small_case("[bubbles]\nweber = 1e4\n")),
              ElementsAre(HasSubstr("bubbles are spheres and need a 3-D domain")));
  EXPECT_THAT(texts(plain + "breakup = true\n", "", {"turbulence.model=\"none\""}),
              ElementsAre(HasSubstr("bubbles.breakup uses the unresolved turbulence")));
  EXPECT_THAT(texts(plain, "", {"pressure.solver=\"cg\""}), ElementsAre(HasSubstr("symmetric matrix")));
  std::string text = tank(plain);
  text.erase(text.find("reynolds = 1e4\n"), std::string("reynolds = 1e4\n").size());
  EXPECT_THAT(problems_of(text), ElementsAre(HasSubstr("bubbles need a viscous liquid")));
}

TEST(BubbleSections, RefuseBubblesLargerThanTheSpacing) {
  EXPECT_THAT(texts(plain, sparger, {"sparger.0.bubble_radius=0.11"}),
              ElementsAre(HasSubstr("bubble_radius = 0.11 is larger than the spacing, 0.1")));
  EXPECT_THAT(texts(plain, sparger + "sizes = \"log-normal\"\ndeviation = 0.2\nlargest = 0.2\n"),
              ElementsAre(HasSubstr("largest = 0.2 is larger than the spacing")));
  EXPECT_THAT(texts(plain, sparger + "sizes = \"truncated-gaussian\"\n"),
              ElementsAre(HasSubstr("deviation must be positive")));
}

TEST(BubbleSections, RefuseSourcesOutsideTheLiquid) {
  EXPECT_THAT(texts(plain, sparger, {"sparger.0.position=[0.5,0.5,0.8]"}),
              ElementsAre(HasSubstr("position lies outside the liquid; move it below the surface")));
  EXPECT_THAT(texts(plain, sparger, {"sparger.0.position=[0.5,0.5,1.8]"}),
              ElementsAre(HasSubstr("outside the domain")));
  EXPECT_THAT(texts(plain, sparger + "shape = \"disc\"\n"), ElementsAre(HasSubstr("missing key 'radius'")));
  EXPECT_THAT(texts("", sparger), ElementsAre(HasSubstr("add a section [bubbles]")));
  EXPECT_THAT(texts(plain, "[[bubble_cloud]]\ncentre = [0.5, 0.5, 0.9]\nbubble_radius = 0.01\n"),
              ElementsAre(HasSubstr("reaches out of the liquid: there is none at (0.5, 0.5, 0.9)")));
}

// Not only their centres: around the box is no liquid, above its lower half air.
TEST(BubbleSections, RefuseSourcesThatReachOutOfTheLiquid) {
  const auto out = ElementsAre(HasSubstr("reaches out of the liquid"));
  EXPECT_THAT(texts(plain, sparger + "shape = \"line\"\nend = [0.9, 0.9, 0.2]\n"), ElementsAre());
  EXPECT_THAT(texts(plain, sparger + "shape = \"disc\"\nradius = 0.3\n"), ElementsAre());
  const std::string cloud = "[[bubble_cloud]]\nnumber = 10\nbubble_radius = 0.01\n";
  EXPECT_THAT(texts(plain, cloud), out);
  EXPECT_THAT(texts(plain, cloud + "upper = [1, 1, 0.9]\n"), out);
  EXPECT_THAT(texts(plain, cloud + "upper = [1, 1, 0.45]\n"), ElementsAre());
  EXPECT_THAT(texts(plain, cloud + "centre = [0.5, 0.5, 0.3]\nradius = 0.5\n"), out);
  EXPECT_THAT(texts(plain, cloud + "centre = [0.05, 0.5, 0.25]\nradius = 0.2\n"),
              ElementsAre());  // through a periodic side
}

TEST(BubbleSections, RefuseEntrainmentOfNothingSmallerThanTheSpacing) {
  const std::string entrains = "[bubbles]\nentrainment = true\n";
  EXPECT_THAT(texts(entrains + "weber = 1e4\nsmallest_entrained_radius = 0.3\n"),
              ElementsAre(HasSubstr("smallest_entrained_radius = 0.3 is not below the spacing, 0.1")));
  EXPECT_THAT(texts(entrains + "weber = 0.05\n"),
              ElementsAre(HasSubstr("smallest_entrained_radius = 0.150854, which follows from this, is not below")));
  EXPECT_THAT(texts("[bubbles]\nweber = 0.05\n"), ElementsAre());
}

TEST(BubbleSections, RefuseNegativeAndAbsurdRates) {
  EXPECT_THAT(texts(plain, sparger, {"sparger.0.rate=\"1 - 2*t\""}),
              ElementsAre(HasSubstr("rate must be a number >= 0 at all times")));
  EXPECT_THAT(texts(plain, sparger, {"sparger.0.rate=\"1\""}), ElementsAre(HasSubstr("more than the liquid holds")));
  const auto still = load_text(tank(plain, sparger), {"sparger.0.rate=0"}).options.warnings;
  ASSERT_EQ(still.size(), 1U);
  EXPECT_THAT(still[0].text, HasSubstr("sparger.0.rate is 0 at all times: no bubble is set out"));
  // What rises leaves: a tank may be aerated for long.
  EXPECT_THAT(texts(plain, sparger, {"sparger.0.rate=\"0.002\"", "time.end=2000"}), ElementsAre());
  EXPECT_THAT(texts(plain, sparger, {"sparger.0.rate=\"0.1\"", "sparger.0.bubble_radius=1e-5"}),
              ElementsAre(HasSubstr("lower the rate or enlarge bubble_radius")));
  EXPECT_THAT(texts(plain, "[[bubble_cloud]]\nupper = [1, 1, 0.5]\nnumber = 10000\nbubble_radius = 0.05\n"),
              ElementsAre(HasSubstr("more than the liquid")));
}

}  // namespace
}  // namespace spume::test
