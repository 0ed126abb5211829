// SPDX-License-Identifier: MIT
// The pressure of the start under gravity, and which liquid is at rest.
#include "spume/particles/column_pressure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "scene/helpers.hpp"

namespace spume::test {
namespace {

// A tank 16 cells wide and 12 high, with a floor and walls.
const std::string pool_tank = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1.6, 1.2]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.1
[fluid]
gravity = 2
[[phase]]
name = "water"
density = 10
viscosity = 0
[time]
end = 1
)toml";

std::string region_with(const std::string& keys) {
  return "[[region]]\nphase = \"water\"\n" + keys;
}

std::string box_at(double x, double y, double width, double height, const std::string& more = "") {
  return "[[body]]\nshape = \"box\"\nposition = [" + std::to_string(x) + ", " + std::to_string(y) + "]\nsize = [" +
         std::to_string(width) + ", " + std::to_string(height) + "]\n" + more;
}

struct Start {
  explicit Start(const std::string& text)
      : loaded(load_text(text)),
        particles(loaded.scene.domain.dimensions, loaded.scene.particles),
        phase(particles.size()) {
    phase.fill(0);
    pressure = column_pressure(loaded.scene, particles, phase);
  }
  // Of the particle in the cell of a place.
  double at(double x, double y) const {
    for (std::size_t i = 0; i < particles.size(); ++i)
      if (std::abs((*particles.position[0])[i] - x) < 0.05 && std::abs((*particles.position[1])[i] - y) < 0.05)
        return pressure[i];
    ADD_FAILURE() << "no particle at " << x << ", " << y;
    return NAN;
  }

  LoadedCase loaded;
  ParticleStore particles;
  Array<std::int64_t> phase;
  Array<double> pressure;
};

TEST(ColumnPressure, IsTheWeightOfWhatIsAbove) {
  const Start start(pool_tank + region_with("upper = [1.6, 0.8]\n"));
  EXPECT_NEAR(start.at(0.55, 0.05), 20 * 0.75, 1e-12);
  EXPECT_NEAR(start.at(0.55, 0.75), 20 * 0.05, 1e-12);
}

TEST(ColumnPressure, OfADropThatFallsIsZeroAndAddsNothingToThePoolBelow) {
  const Start start(pool_tank + region_with("upper = [1.6, 0.4]\n") +
                    region_with("lower = [0.6, 0.6]\nupper = [1, 1]\n"));
  EXPECT_EQ(start.at(0.75, 0.65), 0);
  EXPECT_NEAR(start.at(0.75, 0.05), 20 * 0.35, 1e-12);
}

TEST(ColumnPressure, ReachesUnderABodyWithTheDepthBesideIt) {
  const Start start(pool_tank + region_with("upper = [1.6, 0.8]\n") + box_at(0.8, 0.4, 0.6, 0.2));
  EXPECT_NEAR(start.at(0.75, 0.05), 20 * 0.75, 1e-12);
  EXPECT_NEAR(start.at(0.75, 0.75), 20 * 0.05, 1e-12);
}

// Below a lid on which a column stands: a chamber from which nothing leads to the water above.
TEST(ColumnPressure, OfWhatABodyClosesOffIsItsOwnWeight) {
  const Start start(pool_tank + region_with("upper = [1.6, 0.8]\n") + box_at(0.8, 0.4, 1.8, 0.2));
  EXPECT_NEAR(start.at(0.75, 0.05), 20 * 0.25, 1e-12);
  EXPECT_NEAR(start.at(0.75, 0.55), 20 * 0.25, 1e-12);
}

// A plate thinner than a tenth of a cell, wherever it stands between the centres of two rows.
TEST(ColumnPressure, OfWhatAThinPlateClosesOffIsItsOwnWeight) {
  for (const double height : {0.41, 0.42, 0.445, 0.46, 0.49}) {
    const Start start(pool_tank + region_with("upper = [1.6, 0.8]\n") + box_at(0.8, height, 1.8, 0.008));
    EXPECT_LT(start.at(0.75, 0.05), 20 * 0.46) << height;
  }
}

// A plate at 45 degrees, thinner than the diagonal of a cell, passes between cells that touch by their corners.
TEST(ColumnPressure, OfAPoolBelowASlantedPlateIsItsOwnWeight) {
  const Start start(pool_tank + region_with("where = \"min(0.5 - y, 1.4 - x - y)\"\n") +
                    region_with("where = \"min(1.1 - y, x + y - 1.4)\"\n") +
                    box_at(0.8, 0.6, 0.12, 4, "rotation = [45]\n"));
  EXPECT_NEAR(start.at(0.45, 0.05), 9, 1e-9);
  EXPECT_NEAR(start.at(0.95, 0.05), 9, 2);  // a cell
}

// Air above a shallow pool is no body: the column beside it presses on none of it.
TEST(ColumnPressure, OfAShallowPoolBesideAColumnIsItsOwnWeight) {
  const Start start(pool_tank + region_with("upper = [0.6, 0.9]\n") +
                    region_with("lower = [0.6, 0]\nupper = [1.6, 0.2]\n") + box_at(1.4, 0.7, 0.2, 0.2));
  EXPECT_NEAR(start.at(0.95, 0.05), 20 * 0.15, 1e-12);
  EXPECT_NEAR(start.at(0.25, 0.05), 20 * 0.85, 1e-12);
}

// How many of the particles are at rest, of how many.
struct AtRest {
  std::size_t some = 0, of = 0;
};
AtRest at_rest(const std::string& text) {
  const LoadedCase loaded = load_text(text);
  const std::vector<std::uint8_t> rests = particles_at_rest(loaded.scene);
  return {static_cast<std::size_t>(std::count(rests.begin(), rests.end(), 1)), loaded.scene.particles.size()};
}
void expect_all_at_rest(const std::string& text) {
  const AtRest found = at_rest(text);
  EXPECT_EQ(found.some, found.of);
}

TEST(ParticlesAtRest, AreThoseBelowALevelSurface) {
  expect_all_at_rest(pool_tank + region_with("upper = [1.6, 0.8]\n"));
  expect_all_at_rest(pool_tank + region_with("upper = [1.6, 0.8]\n") +
                     box_at(0.83, 0.37, 0.51, 0.29, "rotation = 31\n"));
  expect_all_at_rest(pool_tank + region_with("upper = [1.6, 0.8]\n") + box_at(0.8, 0.4, 1.8, 0.2));
}

TEST(ParticlesAtRest, AreNotThoseThatCanFlowOrMove) {
  EXPECT_EQ(at_rest(pool_tank + region_with("upper = [0.6, 0.8]\n")).some, 0U);
  EXPECT_EQ(at_rest(pool_tank + region_with("where = \"0.6 + 0.2*x - y\"\n")).some, 0U);
  EXPECT_EQ(at_rest(pool_tank + region_with("upper = [1.6, 0.8]\nvelocity = [\"0.1\", \"0\"]\n")).some, 0U);
  const std::string still = pool_tank + region_with("upper = [1.6, 0.8]\n");
  EXPECT_EQ(at_rest(replaced(still, "right = \"free-slip\"", "right = \"open\"")).some, 0U);
}

TEST(ParticlesAtRest, AreThoseOfThePoolAlonePutBelowADrop) {
  const AtRest found =
      at_rest(pool_tank + region_with("upper = [1.6, 0.4]\n") + region_with("lower = [0.6, 0.6]\nupper = [1, 1]\n"));
  EXPECT_EQ(found.some, 64U);
  EXPECT_EQ(found.of, 80U);
}

}  // namespace
}  // namespace spume::test
