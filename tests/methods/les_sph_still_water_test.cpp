// SPDX-License-Identifier: MIT
// Water at rest stays at rest, whatever solids are in it; liquid that leaves is removed and told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "methods/les_sph_simulation.hpp"

namespace spume::test {
namespace {

using testing::HasSubstr;

// 0.4 deep at spacing 0.04, which gives 250 particles without solids; sqrt(g H) = 1.98, sqrt(H/g) = 0.202.
std::string tank_with(const std::string& solids, const std::string& wall = "free-slip") {
  return "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [1, 0.6]\nleft = \"" + wall + "\"\nright = \"" +
         wall + "\"\nbottom = \"" + wall +
         "\"\n[resolution]\nspacing = 0.04\n[fluid]\ndensity = 1000\nviscosity = 1e-3\ngravity = 9.81\n"
         "[[liquid]]\nlower = [0, 0]\nupper = [1, 0.4]\n[time]\nend = 4\n" +
         solids;
}

std::string box(double x0, double y0, double x1, double y1, const std::string& wall = "free-slip") {
  const auto pair = [](double a, double b) { return "[" + std::to_string(a) + ", " + std::to_string(b) + "]"; };
  return "[[solid]]\nlower = " + pair(x0, y0) + "\nupper = " + pair(x1, y1) + "\nwall = \"" + wall + "\"\n";
}

// The largest speed within 20 sqrt(H/g), over sqrt(g H).
double largest_speed(const std::string& text, const Overrides& overrides = {}) {
  Simulation run(text, overrides);
  double largest = 0;
  while (run.method.time() < 4.04) {
    run.steps(1, run.method.step_limit().dt);
    largest = std::max(largest, run.series().at("max_speed"));
  }
  return largest / std::sqrt(9.81 * 0.4);
}

constexpr double bound = 1e-3;

TEST(StillWater, StaysStillOverBoxesThatTouchOverlapOrRepeat) {
  EXPECT_LT(largest_speed(tank_with(box(0.4, 0, 0.6, 0.2) + box(0.6, 0, 0.8, 0.2))), bound) << "side by side";
  EXPECT_LT(largest_speed(tank_with(box(0.4, 0, 0.6, 0.08) + box(0.4, 0.08, 0.6, 0.2))), bound) << "stacked";
  EXPECT_LT(largest_speed(tank_with(box(0.4, 0, 0.6, 0.2) + box(0.4, 0, 0.6, 0.2))), bound) << "twice";
  EXPECT_LT(largest_speed(tank_with(box(0.4, 0, 0.6, 0.2) + box(0.52, 0, 0.8, 0.28))), bound) << "overlapping";
  EXPECT_LT(largest_speed(tank_with(box(0.4, 0, 1, 0.04))), bound) << "one spacing high";
  std::string wedge;
  for (int k = 0; k < 7; ++k) wedge += box(0.4 + 0.04 * k, 0, 1, 0.04 * (k + 1));
  EXPECT_LT(largest_speed(tank_with(wedge)), bound) << "staircase";
}

TEST(StillWater, StaysStillBesideFacesOffTheLattice) {
  const std::string fine = "resolution.spacing=0.02";
  EXPECT_LT(largest_speed(tank_with(box(0.609, 0, 1, 0.309)), {fine}), bound);
  EXPECT_LT(largest_speed(tank_with(box(0.609, 0, 1, 0.309)), {fine, "fluid.sound_speed=40"}), bound) << "compressible";
  EXPECT_LT(largest_speed(tank_with(box(0.31, 0.11, 0.55, 0.29))), bound) << "three layers over it";
  EXPECT_LT(largest_speed(tank_with(box(0, 0.1, 0.21, 0.23))), bound) << "at a side";
  EXPECT_LT(largest_speed(tank_with(box(0.31, 0, 0.55, 0.5))), bound) << "through the surface";
}

// Layers and columns between the faces hold no whole number of particles: rows 5 % too thin drew particles in at rest,
// and those of a gap of 1.3 spacings took themselves for a surface. Speeds over sqrt(g H) without evening them out.
TEST(StillWater, StaysStillWhereCellsBetweenFacesAreOfOtherSizes) {
  const auto at = [](const char* spacing) { return Overrides{std::string("resolution.spacing=") + spacing}; };
  EXPECT_LT(largest_speed(tank_with(box(0.1553, 0.1713, 0.3707, 0.2882)), at("0.025")), bound) << "0.23";
  EXPECT_LT(largest_speed(tank_with(box(0.5, 0, 0.7906, 0.0753) + box(0.4494, 0.1607, 0.7492, 0.2526)), at("0.025")),
            bound)
      << "0.014";
  EXPECT_LT(largest_speed(tank_with(box(0.3836, 0, 0.5543, 0.053) + box(0.3663, 0.0266, 0.6189, 0.0835)), at("0.02")),
            bound)
      << "0.95";
  EXPECT_LT(largest_speed(tank_with(box(0.8067, 0, 0.9948, 0.0992) + box(0.3399, 0.2436, 0.6067, 0.4032) +
                                    box(0.3343, 0.0972, 0.4699, 0.2793)),
                          at("0.025")),
            bound)
      << "a gap of a fifth of a spacing, 2.5";
}

// Films over solids of 2.7, 1.6, half a layer, gaps below solids: what the surface rule finds there is off the level by
// up to six spacings. Speeds over sqrt(g H) with that.
struct Scattered {
  const char* boxes;
  std::string text, spacing;
};
std::vector<Scattered> scattered() {
  return {{"1.0",
           tank_with(box(0.2063, 0.3366, 0.4758, 0.393) + box(0.8075, 0, 0.8896, 0.1197) +
                     box(0.4655, 0.2169, 0.7396, 0.2928)),
           "0.04"},
          {"0.15",
           tank_with(box(0.1755, 0, 0.2712, 0.2497) + box(0.5374, 0.2536, 0.7768, 0.3338) +
                     box(0.8295, 0.0405, 0.9898, 0.2636)),
           "0.04"},
          {"1.0, a film of half a layer",
           tank_with(box(0.3325, 0, 0.5967, 0.2062) + box(0.4599, 0.0652, 0.7108, 0.2103) +
                     box(0.8143, 0.2221, 0.8997, 0.3798)),
           "0.04"},
          {"0.10",
           tank_with(box(0.1979, 0.09, 0.2554, 0.2708) + box(0.3644, 0.3477, 0.5748, 0.5955) +
                     box(0.1422, 0.2947, 0.2529, 0.3592)),
           "0.0333"}};
}

TEST(StillWater, StaysStillInFilmsAndGapsThatHoldNoWholeNumberOfLayers) {
  for (const auto& [before, text, spacing] : scattered())
    EXPECT_LT(largest_speed(text, {"resolution.spacing=" + spacing}), bound) << before;
}

// An acceleration of 1e-4 g over half of the time would pass the bound of the speed.
TEST(StillWater, StartsInEquilibriumHoweverItStands) {
  for (const auto& [before, text, spacing] : scattered())
    for (const char* sound_speed : {"0", "40"}) {
      StagedFlow start(text, {"resolution.spacing=" + spacing, std::string("fluid.sound_speed=") + sound_speed});
      start.start_before("acceptance");
      double largest = 0;
      for (std::size_t i = 0; i < start.flow.size(); ++i)
        largest = std::max(largest, std::sqrt(squared_norm(start.flow.acceleration, 2, i)));
      EXPECT_LT(largest, 1e-4 * 9.81) << before;
    }
}

// A column whose free side stands before a box, and one in motion: neither is at rest, and nothing holds them.
TEST(StillWater, LiquidThatIsToMoveIsNotHeld) {
  std::string column = tank_with(box(0.6, 0, 0.8, 0.2));
  column.replace(column.find("upper = [1, 0.4]"), 16, "upper = [0.52, 0.4]");
  std::string moving = tank_with(box(0.6, 0, 0.8, 0.23));
  moving.replace(moving.find("upper = [1, 0.4]"), 16, "upper = [1, 0.4]\nvelocity = [\"0\", \"-0.1\"]");
  for (const std::string& text : {column, moving}) {
    StagedFlow start(text);
    start.start_before("acceptance");
    for (std::size_t i = 0; i < start.flow.size(); ++i) {
      ASSERT_EQ((*start.flow.rest.share)[i], 0);
      ASSERT_EQ((*start.flow.rest.lift)[i], 0);
    }
  }
}

TEST(StillWater, ThatItStartedAtRestIsForgottenOverASpacing) {
  StagedFlow start(scattered()[1].text);
  start.start_before("acceptance");
  les_sph::RestMemory& rest = start.flow.rest;
  const auto most = std::max_element(rest.lift->begin(), rest.lift->end()) - rest.lift->begin();
  const auto i = static_cast<std::size_t>(most);
  const float lift = (*rest.lift)[i];
  EXPECT_GT(lift, 0.5 * 0.04);
  EXPECT_TRUE(start.flow.surface->is_covered(i));
  start.flow.forget_rest(i, 0.01);
  EXPECT_NEAR((*rest.share)[i], 0.75, 1e-6);
  start.flow.forget_rest(i, 0.02);
  EXPECT_NEAR((*rest.share)[i], 0.25, 1e-6);
  EXPECT_NEAR((*rest.lift)[i], 0.25 * lift, 1e-6 * lift);
  start.flow.forget_rest(i, 0.02);
  EXPECT_EQ((*rest.share)[i], 0);
  EXPECT_EQ((*rest.lift)[i], 0);
}

// Where all cells are those of the lattice, nothing is moved at the start; where they are not, the liquid below what
// the surface sees is even, and no particle is drawn into a gap that is too narrow for one.
TEST(StillWater, ParticlesBelowTheSurfaceStartEvenlyBesideSolids) {
  const std::string step_in_a_tank =
      "method = \"les-sph\"\n[domain]\nlower = [0, 0, 0]\nupper = [0.64, 0.64, 0.6]\nleft = \"free-slip\"\n"
      "right = \"free-slip\"\nfront = \"free-slip\"\nback = \"free-slip\"\nbottom = \"free-slip\"\n[resolution]\n"
      "spacing = 0.04\n[fluid]\ndensity = 1000\nviscosity = 1e-3\ngravity = 9.81\n[[liquid]]\nlower = [0, 0, 0]\n"
      "upper = [0.64, 0.64, 0.4]\n[time]\nend = 4\n[[solid]]\nlower = [0.32, 0.2, 0]\nupper = [0.64, 0.48, 0.16]\n";
  for (const std::string& text : {tank_with(box(0.4, 0, 0.6, 0.2)), step_in_a_tank}) {
    StagedFlow fitted(text);
    fitted.start_before("level");
    const InitialParticles& filled = fitted.loaded.scene.particles;
    const auto& identifier = *fitted.flow.particles.identifier;
    for (std::size_t i = 0; i < filled.size(); ++i)
      for (int axis = 0; axis < fitted.flow.dimensions; ++axis)
        ASSERT_EQ((*fitted.flow.particles.position[axis])[i],
                  filled.position[axis][static_cast<std::size_t>(identifier[i])]);
  }

  StagedFlow uneven(tank_with(box(0.5, 0, 0.7906, 0.0753) + box(0.4494, 0.1607, 0.7492, 0.2526)),
                    {"resolution.spacing=0.025"});
  uneven.start_before("surface");
  const les_sph::Flow& flow = uneven.flow;
  double sum = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < flow.particles.size(); ++i) {
    const double x = (*flow.particles.position[0])[i], y = (*flow.particles.position[1])[i];
    // Past an edge particles do not see all of the lattice, and a gap takes particles in at its ends alone.
    if (y > 0.4 - 5 * 0.025 || !flow.boundary.solids()->clear_around({x, y, 0}, flow.resolution.support_radius))
      continue;
    const double excess = flow.moments.kernel_sum[i] / flow.resolution.lattice.kernel_sum - 1;
    sum += excess;
    squares += excess * excess;
    count += 1;
  }
  // The standard deviation of columns is 0.05, of liquid that has been in motion 0.01 (number_density.cpp).
  EXPECT_LT(std::sqrt(squares / count - std::pow(sum / count, 2)), 0.02);

  StagedFlow raised(tank_with(box(0.05, 0.0099, 0.25, 0.15)), {"resolution.spacing=0.025"});
  raised.start_before("surface");
  for (std::size_t i = 0; i < raised.flow.particles.size(); ++i) {
    const Vec3 place = vector_at(raised.flow.particles.position, 2, i);
    EXPECT_FALSE(place[0] > 0.05 && place[0] < 0.25 && place[1] < 0.0099);
  }
}

// 8 x 8 x 5 spacings, with a box through the surface; sqrt(g H) = 1.98, sqrt(H/g) = 0.202. What a particle sees past a
// vertical edge, counted by whole particles, made a surface there that was 2 % of a spacing too high or too low.
TEST(StillWater, StaysStillAroundPillarsThatPierceTheSurface) {
  const auto pillar = [](const char* lower, const char* upper) {
    return std::string(
               "method = \"les-sph\"\n[domain]\nlower = [0, 0, 0]\nupper = [0.64, 0.64, 0.6]\nleft = \"free-slip\"\n"
               "right = \"free-slip\"\nfront = \"free-slip\"\nback = \"free-slip\"\nbottom = \"free-slip\"\n"
               "[resolution]\nspacing = 0.08\n[fluid]\ndensity = 1000\nviscosity = 1e-3\ngravity = 9.81\n"
               "[[liquid]]\nlower = [0, 0, 0]\nupper = [0.64, 0.64, 0.4]\n[time]\nend = 4\n[[solid]]\nlower = ") +
           lower + "\nupper = " + upper + "\n";
  };
  EXPECT_LT(largest_speed(pillar("[0.24, 0.24, 0]", "[0.4, 0.4, 0.6]")), bound) << "of two spacings";
  EXPECT_LT(largest_speed(pillar("[0.2405, 0.2407, 0]", "[0.4005, 0.4007, 0.6]")), bound) << "just off the lattice";
  EXPECT_LT(largest_speed(pillar("[0.27, 0.21, 0]", "[0.42, 0.4, 0.6]")), bound) << "off the lattice";
  EXPECT_LT(largest_speed(pillar("[0, 0.25, 0]", "[0.23, 0.41, 0.6]")), bound) << "against a wall";
}

TEST(StillWater, StaysStillBesidePlatesAndInGaps) {
  EXPECT_LT(largest_speed(tank_with(box(0.5, 0, 0.52, 0.2))), bound) << "half a spacing thick";
  EXPECT_LT(largest_speed(tank_with(box(0.5, 0, 0.52, 0.6))), bound) << "a wall half a spacing thick";
  EXPECT_LT(largest_speed(tank_with(box(0.3, 0, 0.4, 0.2) + box(0.48, 0, 0.6, 0.2))), bound) << "gap of two spacings";
  EXPECT_LT(largest_speed(tank_with(box(0.4, 0, 0.6, 0.4))), bound) << "flush with the surface";
  EXPECT_LT(largest_speed(tank_with(box(0.4, 0, 0.6, 0.2, "no-slip") + box(0.6, 0, 1, 0.1, "no-slip"), "no-slip"),
                          {"fluid.viscosity=1"}),
            bound)
      << "no slip";
}

// Gaps of 2.9, 2.8, 3.5 and 3.2 cells, each over the whole depth. Cut in two below the four upper layers their columns
// moved at 0.01 sqrt(g H).
TEST(StillWater, StaysStillBetweenPillarsOfBrokenCells) {
  const std::string pillars = box(0.1156, 0, 0.2878, 0.5) + box(0.4008, 0, 0.5837, 0.5) + box(0.7235, 0, 0.8727, 0.5);
  EXPECT_LT(largest_speed(tank_with(pillars)), bound);
}

// Not quite two layers over a box: 0.017 sqrt(g H), or still, as rounding has it. The warning names the place, and with
// the spacing that it names the water is still.
TEST(StillWater, CellsThatDoNotFitAreWarnedOfWithASpacingThatDoes) {
  const std::string text = tank_with(box(0.6431, 0.1769, 0.8323, 0.3338));
  const Simulation run(text, {"resolution.spacing=0.0333"});
  ASSERT_EQ(run.loaded.options.warnings.size(), 1U);
  const std::string warning = run.loaded.options.warnings[0].text;
  EXPECT_THAT(warning, HasSubstr("between y = 0.3338 and 0.4 at x = 0.7377 there is room for 1.88 layers"));
  const std::string with = "With resolution.spacing = ";
  ASSERT_THAT(warning, HasSubstr(with));
  const std::string fitting =
      "resolution.spacing=" + std::to_string(std::stod(warning.substr(warning.find(with) + with.size())));
  EXPECT_TRUE(Simulation(text, {fitting}).loaded.options.warnings.empty());
  EXPECT_LT(largest_speed(text, {fitting}), bound);
}

// A wall half a spacing thick between liquids of different heights: each has its own pressure, and none gets through.
// Without the pressure of the ripples the speed grows by e in 36 sqrt(dr/g), to 0.05 sqrt(gH) after 700.
TEST(StillWater, RipplesDoNotGrowHoweverLongItStands) {
  for (const Overrides& overrides : {Overrides{}, Overrides{"fluid.sound_speed=40"}, Overrides{"time.centred=false"}}) {
    Simulation run(tank_with(""), overrides);
    while (run.method.time() < 800 * std::sqrt(0.04 / 9.81)) run.steps(1, run.method.step_limit().dt);
    EXPECT_LT(run.series().at("max_speed"), 1e-5 * std::sqrt(9.81 * 0.4));
  }
}

TEST(StillWater, AKernelThatIsTooWideBelowASurfaceIsToldOf) {
  using testing::Contains, testing::Field, testing::IsEmpty;
  const auto remarks = [](const Overrides& overrides) {
    Simulation run(tank_with(""), overrides);
    run.steps(1, run.method.step_limit().dt);
    return run.method.take_remarks();
  };
  const std::string quintic = "resolution.kernel=\"quintic-spline\"";
  EXPECT_THAT(remarks({}), IsEmpty());
  EXPECT_THAT(remarks({quintic, "resolution.smoothing_ratio=1.2"}), IsEmpty());
  EXPECT_THAT(remarks({quintic}), Contains(Field(&Remark::text, HasSubstr("take 1.2 at most"))));
  EXPECT_THAT(remarks({"resolution.smoothing_ratio=1.6"}),
              Contains(Field(&Remark::text, HasSubstr("take 1.5 at most"))));
}

TEST(StillWater, APlateSeparatesTwoLevels) {
  std::string text = tank_with(box(0.5, 0, 0.52, 0.6) + "[[liquid]]\nlower = [0.52, 0]\nupper = [1, 0.2]\n");
  text.replace(text.find("upper = [1, 0.4]"), 16, "upper = [0.5, 0.4]");
  EXPECT_LT(largest_speed(text), bound);
}

TEST(OpenSides, LiquidThatFallsOutIsToldAndRemoved) {
  std::string text = tank_with("");
  text.erase(text.find("bottom"), text.find("[resolution]") - text.find("bottom"));
  Simulation run(text);
  ASSERT_EQ(run.loaded.options.warnings.size(), 1U);
  EXPECT_THAT(run.loaded.options.warnings[0].text, HasSubstr("nothing holds the liquid: domain.bottom is open"));
  const double mass = run.series().at("mass");
  std::string remarks;
  for (int k = 0; k < 60; ++k) {
    run.steps(1, 0.01);
    for (const Remark& remark : run.method.take_remarks()) remarks += remark.text;
  }
  // After 0.6 the water has fallen by 1.77, past the bottom by more than its depth.
  EXPECT_EQ(run.method.flow().size(), 0U);
  EXPECT_NEAR(run.series().at("mass_removed"), mass, 1e-9 * mass);
  EXPECT_THAT(remarks, HasSubstr("liquid leaves through an open side"));
}

TEST(OpenSides, NoWarningWhereWallsOrSolidsHoldTheLiquid) {
  EXPECT_TRUE(Simulation(tank_with("")).loaded.options.warnings.empty());
  std::string text = tank_with(box(0, -0.2, 1, 0));
  text.replace(text.find("lower = [0, 0]"), 14, "lower = [0, -0.2]");
  text.erase(text.find("bottom"), text.find("[resolution]") - text.find("bottom"));
  EXPECT_TRUE(Simulation(text).loaded.options.warnings.empty());
}

}  // namespace
}  // namespace spume::test
