// SPDX-License-Identifier: MIT
// Forces on bodies so near to a wall that no particle fits between them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "methods/gfd_run.hpp"
#include "methods/les_sph_simulation.hpp"
#include "methods/wcsph_run.hpp"

namespace spume::test {
namespace {

constexpr double row = 0.04, rod = 0.2, box_width = 0.3, box_height = 0.5;

std::string deep_tank(const std::string& method, const std::string& liquid) {
  return "method = \"" + method +
         "\"\n[domain]\nlower = [0, 0]\nupper = [1.6, 1.3]\nleft = \"free-slip\"\nright = \"free-slip\"\nbottom = "
         "\"free-slip\"\n[resolution]\nspacing = 0.04\n[fluid]\ngravity = 1\n" +
         liquid + "[time]\nend = 1\nmax_step = 0.02\n";
}

// A rod and a box that stands on its edge, each so many spacings from the floor.
std::string rod_and_box(double gap) {
  const double turn = 23 * std::numbers::pi / 180;
  const double reach = (box_width * std::sin(turn) + box_height * std::cos(turn)) / 2;
  return "[[body]]\nshape = \"ball\"\nradius = 0.2\nposition = [0.4, " + std::to_string(rod + gap * row) +
         "]\n[[body]]\nshape = \"box\"\nsize = [0.3, 0.5]\nrotation = [-23]\nposition = [1.1, " +
         std::to_string(reach + gap * row) + "]\n";
}

// Per body: the force by pressure over the weight of what it displaces, and across.
template <class Run>
std::vector<std::array<double, 2>> buoyancy(Run& run) {
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  const double displaced[] = {std::numbers::pi * rod * rod, box_width * box_height};
  std::vector<std::array<double, 2>> found;
  for (std::size_t b = 0; b < 2; ++b) {
    const double* const of_body = rows.data() + b * rows.size() / 2;
    found.push_back({of_body[2] / displaced[b], of_body[3] / displaced[b]});
  }
  return found;
}

}  // namespace

// The wedge below the rod is six spacings wide in which no particle stands: without its pressure the rod had 0.11 of
// its buoyancy, the box 0.68. Elements of a spacing and fits beside the wedge err by a hundredth.
TEST(GapForces, AreThoseOfArchimedesByLesSph) {
  for (const double gap : {0.05, 0.15, 0.5, 0.8, 1.0, 1.3}) {
    SCOPED_TRACE(gap);
    Simulation run(deep_tank("les-sph", "density = 1\n[[liquid]]\nupper = [1.6, 1.1]\n") + rod_and_box(gap));
    run.steps(3, 0.02);
    for (const auto& [across, up] : buoyancy(run)) {
      EXPECT_NEAR(up, 1, 0.02);
      EXPECT_NEAR(across, 0, 0.02);
    }
  }
}

TEST(GapForces, AreThoseOfArchimedesByGfd) {
  for (const double gap : {0.15, 0.5, 1.0}) {
    SCOPED_TRACE(gap);
    GfdRun run(replaced(deep_tank("gfd",
                                  "[[phase]]\nname = \"water\"\ndensity = 1\nviscosity = 0.01\n[[region]]\nphase = "
                                  "\"water\"\nupper = [1.6, 1.3]\n"),
                        "bottom =", "top = \"free-slip\"\nbottom =") +
               rod_and_box(gap));
    run.steps(3, 0.02);
    for (const auto& [across, up] : buoyancy(run)) {
      EXPECT_NEAR(up, 1, 0.02);
      EXPECT_NEAR(across, 0, 0.02);
    }
  }
}

// Adds up pairs of particles, of bodies with gaps it integrates: with the pairs 0.33 and 0.68.
TEST(GapForces, AreThoseOfArchimedesByWcsph) {
  for (const double gap : {0.05, 0.15}) {
    SCOPED_TRACE(gap);
    WcsphRun run(deep_tank("wcsph",
                           "[[phase]]\nname = \"water\"\ndensity = 1\nviscosity = 0.001\n[[region]]\nphase = "
                           "\"water\"\nupper = [1.6, 1.1]\n") +
                 rod_and_box(gap));
    run.steps(20, 5e-4);
    for (const auto& [across, up] : buoyancy(run)) {
      EXPECT_NEAR(up, 1, 0.02);
      EXPECT_NEAR(across, 0, 0.02);
    }
  }
}

// What is before the middle of its bottom comes along that from its wet sides, not from its dry deck above, which is
// nearer: the force was 0.70 of this.
TEST(GapForces, ComeAlongTheSurface) {
  const std::string shallow = deep_tank("les-sph", "density = 1\n[[liquid]]\nwhere = \"0.28 - y\"\n");
  Simulation barge(shallow + "[[body]]\nshape = \"box\"\nsize = [0.9, 0.3]\nposition = [0.8, 0.158]\n");
  barge.steps(3, 0.02);
  std::vector<double> rows;
  barge.method.table_rows("bodies", rows);
  const double displaced = 0.9 * (0.28 - 0.008);
  EXPECT_NEAR(rows[3], displaced, 0.02 * displaced);
}

// From a flat bottom the water comes around edges of any angle: below the walls of 30 degrees the force was -7.9 times
// that of Archimedes.
TEST(GapForces, ComeAroundSharpEdges) {
  for (const double degrees : {30.0, 45.0, 75.0}) {
    SCOPED_TRACE(degrees);
    const double height = 0.2, top = 0.45 - height / std::tan(degrees * std::numbers::pi / 180);
    std::string text = deep_tank("les-sph", "density = 1\n[[liquid]]\nupper = [1.6, 1.1]\n");
    text += "[[body]]\nshape = \"outline\"\nposition = [0.8, 0.006]\npoints = [[-0.45, 0], [0.45, 0], [" +
            std::to_string(top) + ", 0.2], [" + std::to_string(-top) + ", 0.2]]\n";
    Simulation run(text);
    run.steps(3, 0.02);
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
    const double displaced = (0.45 + top) * height;
    EXPECT_NEAR(rows[3], displaced, 0.02 * displaced);
  }
}

// The sole of a hull, an entry of its own, of one row of elements on its sides: these begin at the floor, which takes a
// quarter of what is before them, and counted as dry. The force was -0.9 times that of Archimedes.
TEST(GapForces, ComeToASoleOfItsOwn) {
  for (const double sole : {0.02, 0.04}) {
    SCOPED_TRACE(sole);
    const auto box = [](double height, double bottom) {
      return "[[body]]\nshape = \"box\"\nsize = [0.9, " + std::to_string(height) + "]\nposition = [0.8, " +
             std::to_string(bottom + height / 2) + "]\n";
    };
    Simulation run(deep_tank("les-sph", "density = 1\n[[liquid]]\nupper = [1.6, 1.1]\n") + box(sole, 0.006) +
                   box(0.3 - sole, 0.006 + sole));
    run.steps(3, 0.02);
    std::vector<double> rows;
    run.method.table_rows("bodies", rows);
    EXPECT_NEAR(rows[3] + rows[rows.size() / 2 + 3], 0.27, 0.02 * 0.27);
  }
}

// Torques are those about the body where it is whole.
TEST(GapForces, DoNotTurnABodyAcrossAPeriodicSide) {
  const std::string water = replaced(deep_tank("les-sph", "density = 1\n[[liquid]]\nwhere = \"1.1 - y\"\n"),
                                     "left = \"free-slip\"\nright = \"free-slip\"", "x = \"periodic\"");
  Simulation run(water +
                 "[[body]]\nshape = \"box\"\nsize = [0.4, 0.4]\nposition = [0.02, 0.206]\nfree = [\"x\", \"y\", "
                 "\"turn\"]\ndensity = 0.5\n");
  run.steps(5, 0.02);
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  // It turned at 11.5 degrees per time.
  EXPECT_NEAR(rows[10], 0, 0.01);
}

// What touches a wall along a face has no liquid below it: the water presses it down.
TEST(GapForces, ABodyThatStandsOnTheFloorIsPressedDown) {
  Simulation run(deep_tank("les-sph", "density = 1\n[[liquid]]\nupper = [1.6, 1.1]\n") +
                 "[[body]]\nshape = \"box\"\nsize = [0.32, 0.4]\nposition = [0.8, 0.2]\n");
  run.steps(3, 0.02);
  std::vector<double> rows;
  run.method.table_rows("bodies", rows);
  EXPECT_NEAR(rows[3], -0.32 * (1.1 - 0.4), 0.02 * 0.32);
}

// One lands on what it has caught below it, under the other the water comes back. What is caught there had no surface:
// both were thrown out of the tank. They start nearer to the floor than a spacing and keep that clearance. A step takes
// nothing into it by more than a tenth, and goes along tangents, off circles by r turn^2 / 2. Where corners that stand
// higher were free to come down within a step, the first dived through the floor by 0.7 spacings and spilled particles.
TEST(GapForces, HeavyBoxesStayDown) {
  const std::string water = deep_tank("les-sph", "density = 1\nviscosity = 1e-4\n[[liquid]]\nupper = [1.6, 0.95]\n");
  const struct {
    const char *spacing, *body;
    double start, width, height, turn;
  } boxes[] = {{"0.035",
                "[[body]]\nshape = \"box\"\nposition = [0.8, 0.1256]\nsize = [0.3653, 0.2118]\nrotation = "
                "[5.24]\ndensity = 3\n",
                0.1256, 0.3653, 0.2118, 5.24},
               {"0.05",
                "[[body]]\nshape = \"box\"\nposition = [0.5, 0.26827]\nsize = [0.4444, 0.3954]\nrotation = "
                "[-11.58]\ndensity = 8\n",
                0.26827, 0.4444, 0.3954, -11.58}};
  for (const auto& box : boxes) {
    Simulation run(replaced(replaced(water, "spacing = 0.04", "spacing = " + std::string(box.spacing)) + box.body,
                            "max_step = 0.02", "max_step = 0.1"));
    const double spacing = std::stod(box.spacing), radius = std::hypot(box.width, box.height) / 2;
    const auto lowest = [&](double y, double degrees) {
      const double turn = degrees * std::numbers::pi / 180;
      return y - (box.width * std::abs(std::sin(turn)) + box.height * std::abs(std::cos(turn))) / 2;
    };
    const double clearance = std::min(spacing, lowest(box.start, box.turn));
    const std::size_t particles = run.method.flow().size();
    double fastest_turn = 0;
    int refused = 0;
    while (run.method.time() < 3) {
      double dt = run.method.step_limit().dt;
      for (bool taken = false; !taken;) {  // as a run does with one that is refused
        try {
          run.steps(1, dt);
          taken = true;
        } catch (const StepFailure&) {
          dt /= 2;
          ASSERT_LT(++refused, 5);
        }
      }
      std::vector<double> rows;
      run.method.table_rows("bodies", rows);
      fastest_turn = std::max(fastest_turn, dt * std::abs(rows[13]) * std::numbers::pi / 180);
      ASSERT_LT(rows[9], box.start + 0.01) << run.method.time();
      ASSERT_GT(lowest(rows[9], box.turn + rows[10]),
                0.9 * clearance - 1e-3 * spacing - radius * fastest_turn * fastest_turn / 2)
          << run.method.time();
      ASSERT_EQ(run.method.flow().size(), particles) << run.method.time();
    }
  }
}

// The heavy one lies there with the force of what it displaces; it was thrown up again and again. The light one leaves
// the floor, to which the water above had pressed it.
TEST(GapForces, ABallOnTheFloorStaysOrRisesByItsWeight) {
  const std::string water = deep_tank("les-sph", "density = 1\n[[liquid]]\nupper = [1.6, 1.1]\n");
  const std::string ball =
      "[[body]]\nshape = \"ball\"\nradius = 0.2\nposition = [0.8, 0.206]\nfree = [\"y\"]\ndensity = ";
  const double displaced = std::numbers::pi * rod * rod;
  std::vector<double> rows;
  Simulation heavy(replaced(water, "max_step = 0.02", "max_step = 0.1") + ball + "2\n");
  while (heavy.method.time() < 1) {
    heavy.steps(1, heavy.method.step_limit().dt);
    rows.clear();
    heavy.method.table_rows("bodies", rows);
    EXPECT_NEAR(rows[9], 0.206, 0.05 * row);
  }
  EXPECT_NEAR(rows[3], displaced, 0.02 * displaced);
  // Its own mass, and beside a wall at least that of an unbounded liquid: (1 - 1/2) / (1/2 + 1) of gravity at most.
  Simulation light(replaced(water, "max_step = 0.02", "max_step = 0.1") + ball + "0.5\n");
  while (light.method.time() < 0.4) light.steps(1, light.method.step_limit().dt);
  rows.clear();
  light.method.table_rows("bodies", rows);
  const double way = 0.5 * (0.5 / 1.5) * light.method.time() * light.method.time();
  EXPECT_GT(rows[9] - 0.206, way / 2);
  EXPECT_LT(rows[9] - 0.206, 1.1 * way);
}

}  // namespace spume::test
