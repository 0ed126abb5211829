// SPDX-License-Identifier: MIT
// The liquid at rest that pressures of a closed tank are measured from.
#include "spume/particles/still_liquid.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scene/helpers.hpp"

namespace spume::test {
namespace {

const std::string closed_tank = R"toml(method = "wcsph"
[domain]
lower = [-1, 0.5]
upper = [1, 2]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.1
[fluid]
gravity = 2
[[phase]]
name = "heavy"
density = 1200
viscosity = 0
[[phase]]
name = "light"
density = 800
viscosity = 0
[[region]]
phase = "light"
[[region]]
phase = "heavy"
upper = [1, 1]
[time]
end = 1
)toml";

StillLiquid still_of(const std::string& text, bool shifting = false) {
  const LoadedCase loaded = load_text(text);
  return still_liquid(loaded.scene, shifting);
}

TEST(StillLiquid, IsOfTheLightestDensityBelowTheTop) {
  const StillLiquid still = still_of(closed_tank);
  ASSERT_TRUE(still);
  EXPECT_DOUBLE_EQ(still.density, 800);
  EXPECT_DOUBLE_EQ(still.range, 400 * 2 * 1.5);
  const std::vector<double> x{0.3, 0.3, -1}, y{2, 1, 0.5};
  std::vector<float> pressure{7, 7 + 1600, 7 + 1600 + 1200};  // of layers at rest, 7 at the top
  still.subtract({x.data(), y.data(), nullptr}, 3, pressure.data());
  EXPECT_FLOAT_EQ(pressure[0], 7);
  EXPECT_FLOAT_EQ(pressure[1], 7);
  EXPECT_FLOAT_EQ(pressure[2], 7 + 400);
  EXPECT_DOUBLE_EQ(still.lost_share(1.0 / 800), 1);
}

TEST(StillLiquid, IsNoneBesideASurfaceGasTensionAndWithoutWeightAcrossSides) {
  EXPECT_FALSE(still_of(replaced(closed_tank, "top = \"free-slip\"", "")));
  EXPECT_FALSE(still_of(replaced(closed_tank, "density = 800", "density = 1.2")));
  EXPECT_TRUE(still_of(closed_tank + "[[body]]\nshape = \"ball\"\nposition = [0, 1.2]\nradius = 0.3\n"));
  EXPECT_FALSE(still_of(replaced(closed_tank, "gravity = 2", "")));
  EXPECT_FALSE(still_of(closed_tank + "[interface]\nsurface_tension = 1\n"));
}

TEST(StillLiquid, IsOfOnePhaseWhereItsParticlesAreShifted) {
  const std::string one = replaced(closed_tank, "density = 1200", "density = 800");
  EXPECT_TRUE(still_of(one));  // two phases of one density
  const std::string alone =
      replaced(replaced(closed_tank, "[[phase]]\nname = \"heavy\"\ndensity = 1200\nviscosity = 0\n", ""),
               "[[region]]\nphase = \"heavy\"\nupper = [1, 1]\n", "");
  EXPECT_TRUE(still_of(alone, true));
  EXPECT_FALSE(still_of(alone));
}

TEST(StillLiquid, LiquidsFlowUnlessTheyLieInLayersAtRest) {
  const auto flow = [](const std::string& text, bool driven = false) {
    return liquids_flow(load_text(text).scene, driven);
  };
  EXPECT_FALSE(flow(closed_tank));
  EXPECT_TRUE(flow(closed_tank, true));
  EXPECT_TRUE(flow(replaced(closed_tank, "upper = [1, 1]", "upper = [0, 2]")));  // side by side
  EXPECT_TRUE(flow(replaced(closed_tank, "upper = [1, 1]", "upper = [1, 1]\nvelocity = [\"y\", \"0\"]")));
  EXPECT_TRUE(flow(replaced(closed_tank, "density = 1200", "density = 700")));  // the lighter one below
  EXPECT_TRUE(flow(replaced(closed_tank, "density = 1200", "density = 800")));
  EXPECT_FALSE(flow(replaced(closed_tank, "density = 800", "density = 1.2"), true));
  EXPECT_TRUE(flow(closed_tank + "[[body]]\nshape = \"ball\"\nposition = [0, 1.2]\nradius = 0.3\n", true));
  EXPECT_FALSE(flow(replaced(closed_tank, "top = \"free-slip\"", ""), true));
}

}  // namespace
}  // namespace spume::test
