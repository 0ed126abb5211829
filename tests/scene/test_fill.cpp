// SPDX-License-Identifier: MIT
// Where the particles of the start are.
#include <gmock/gmock.h>
#include <omp.h>
#include <sys/resource.h>

#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

#include "helpers.hpp"
#include "spume/physics/turbulence/options.hpp"

namespace spume {
namespace {

using test::load_text;
using test::plunging_breaker;
using test::problems_of;
using test::small_case;
using testing::ElementsAre;
using testing::HasSubstr;

// A 2-D tank, walls on all sides but the top, with what follows.
std::string tank(const std::string& rest) {
  return "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [2, 1]\n"
         "left = \"no-slip\"\nright = \"free-slip\"\nbottom = \"free-slip\"\n"
         "[resolution]\nspacing = 0.05\n[time]\nend = 1\n" +
         rest;
}

bool same_bits(const Array<double>& a, const Array<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

TEST(Fill, PeriodicBoxHoldsACellCentreLattice) {
  const LoadedCase loaded = load_text(small_case());
  const InitialParticles& particles = loaded.scene.particles;
  ASSERT_EQ(particles.size(), 100u);
  EXPECT_TRUE(particles.position[2].empty());
  EXPECT_DOUBLE_EQ(particles.volume, 0.01);
  EXPECT_FALSE(loaded.scene.free_surface);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_NEAR(particles.position[0][i], (static_cast<double>(i / 10) + 0.5) * 0.1, 1e-15);
    EXPECT_NEAR(particles.position[1][i], (static_cast<double>(i % 10) + 0.5) * 0.1, 1e-15);
  }
}

TEST(Fill, LengthThatIsNoMultipleUsesTheNearestCountAndKeepsTheVolume) {
  const LoadedCase loaded = load_text(small_case(), {"resolution.spacing=0.097"});
  EXPECT_EQ(loaded.scene.particles.size(), 100u);
  EXPECT_NEAR(loaded.scene.particles.volume * 100, 1.0, 1e-14);
  EXPECT_EQ(loaded.options.groups.at("effective spacing"), "x 0.1, y 0.1");
  EXPECT_DOUBLE_EQ(loaded.scene.spacing, 0.097);
}

TEST(Fill, LatticeHangsFromTheUpperWallWhenTheLowerSideIsOpen) {
  const std::string text =
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [1, 1]\ntop = \"no-slip\"\n"
      "[resolution]\nspacing = 0.07\n[time]\nend = 1\n[[liquid]]\nwhere = \"1\"\n";
  const InitialParticles& particles = load_text(text).scene.particles;
  double highest = 0, leftmost = 1;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    highest = std::max(highest, particles.position[1][i]);
    leftmost = std::min(leftmost, particles.position[0][i]);
  }
  EXPECT_NEAR(highest, 1 - 0.035, 1e-14);
  EXPECT_NEAR(leftmost, 0.035, 1e-14);
}

TEST(Fill, BoxInATankHasTheCountOfItsAreaAndAFreeSurface) {
  const LoadedCase loaded = load_text(tank("[[liquid]]\nlower = [0, 0]\nupper = [0.5, 0.6]\n"));
  EXPECT_EQ(loaded.scene.particles.size(), 10u * 12u);
  EXPECT_TRUE(loaded.scene.free_surface);
  EXPECT_EQ(loaded.scene.domain.sides[0][0].kind, BoundaryKind::no_slip);
  EXPECT_EQ(loaded.scene.domain.sides[0][1].kind, BoundaryKind::free_slip);
  EXPECT_EQ(loaded.scene.domain.sides[1][1].kind, BoundaryKind::open);
}

// The volume of the particles is that of their regions, whatever the spacing.
TEST(Fill, MassIsThatOfTheRegion) {
  const auto volume_of = [](const LoadedCase& loaded) {
    return static_cast<double>(loaded.scene.particles.size()) * loaded.scene.particles.volume;
  };
  const LoadedCase shallow =
      load_text(tank("[[liquid]]\nlower = [0, 0]\nupper = [2, 0.093]\n"), {"resolution.spacing=0.006"});
  EXPECT_NEAR(volume_of(shallow), 2 * 0.093, 1e-12);
  ASSERT_EQ(shallow.scene.fills.size(), 1U);
  EXPECT_NEAR(shallow.scene.fills[0].asked, 2 * 0.093, 1e-12);
  EXPECT_NEAR(shallow.scene.fills[0].got, 2 * 0.093, 1e-12);
  EXPECT_THAT(shallow.options.groups.at("mass"), HasSubstr("asked"));
  const std::string open =
      "method = \"les-sph\"\n[domain]\nlower = [-1, -1]\nupper = [1, 1]\n[time]\nend = 1\n[resolution]\nspacing = ";
  for (const std::string spacing : {"0.03", "0.041", "0.05", "0.07"}) {
    EXPECT_NEAR(volume_of(load_text(open + spacing + "\n[[liquid]]\nlower = [-0.5, -0.5]\nupper = [0.5, 0.5]\n")), 1,
                1e-12);
    // By 256 samples of a cell, of which a line along an axis parts 3 at most otherwise than by its place: all around.
    EXPECT_NEAR(volume_of(load_text(open + spacing + "\n[[liquid]]\nwhere = \"0.5 - max(abs(x), abs(y))\"\n")), 1,
                4 * std::stod(spacing) * 3 / 256);
    // A line through the middle of cells parts them in halves: here along their diagonal.
    const double cells = 2 / std::stod(spacing);
    if (cells == std::round(cells)) {
      EXPECT_NEAR(volume_of(load_text(open + spacing + "\n[[liquid]]\nwhere = \"-x - y\"\n")), 2, 1e-12);
    }
  }
  // Around a solid, which takes its share, from a surface given by an expression too.
  EXPECT_NEAR(volume_of(load_text(tank("[[solid]]\nlower = [0.3, 0]\nupper = [0.8, 0.3]\n"
                                       "[[liquid]]\nwhere = \"0.7 - y\"\nconform = true\n"))),
              1.4 - 0.5 * 0.3, 1e-12);
  EXPECT_NEAR(volume_of(load_text(tank("[[solid]]\nlower = [0.31, 0.13]\nupper = [0.77, 0.31]\n"
                                       "[[liquid]]\nlower = [0, 0]\nupper = [2, 0.7]\n"))),
              1.4 - 0.46 * 0.18, 1e-12);
}

// Beside every wetted face the nearest particles stand half a spacing away, to the third that whole numbers of cells
// between two faces can ask for.
// A lone drop: the cell of its lattice is the volume of its particles. Beside a wall the sites stay where they are.
TEST(Fill, TheLatticeOfALoneDropHasTheVolumeOfItsParticles) {
  const auto distance_to_next = [](const std::string& centre) {
    const LoadedCase loaded = load_text(tank("[[liquid]]\ncentre = " + centre + "\nradius = 0.22\n"));
    const InitialParticles& particles = loaded.scene.particles;
    EXPECT_GT(std::abs(particles.volume / (0.05 * 0.05) - 1), 1e-3);
    // Areas are counted in squares of a quarter spacing: the edge cuts some 110, each of which errs by up to one half.
    EXPECT_NEAR(particles.volume * static_cast<double>(particles.size()), std::numbers::pi * 0.22 * 0.22,
                3 * std::sqrt(110.0 / 12) * 0.0125 * 0.0125);
    double nearest = 1;
    for (std::size_t i = 1; i < particles.size(); ++i)
      nearest = std::min(nearest, std::hypot(particles.position[0][i] - particles.position[0][0],
                                             particles.position[1][i] - particles.position[1][0]));
    return std::pair{nearest, std::sqrt(particles.volume)};
  };
  const auto [alone, side] = distance_to_next("[1, 0.5]");
  EXPECT_NEAR(alone, side, 1e-12);
  EXPECT_NEAR(distance_to_next("[1, 0.22]").first, 0.05, 1e-12);
}

TEST(Fill, ParticlesStartHalfASpacingFromEveryFace) {
  const LoadedCase loaded =
      load_text(tank("[[solid]]\nlower = [0.309, 0]\nupper = [1.213, 0.331]\n"
                     "[[liquid]]\nlower = [0, 0]\nupper = [2, 0.81]\n"));
  const InitialParticles& particles = loaded.scene.particles;
  double left = 1, right = 1, above = 1, surface = 1;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double x = particles.position[0][i], y = particles.position[1][i];
    if (y < 0.331 && x < 0.309) left = std::min(left, 0.309 - x);
    if (y < 0.331 && x > 1.213) right = std::min(right, x - 1.213);
    if (x > 0.309 && x < 1.213) above = std::min(above, y - 0.331);
    surface = std::min(surface, 0.81 - y);
  }
  for (const double distance : {left, right, above, surface}) EXPECT_NEAR(distance, 0.025, 0.025 / 3);
}

TEST(Fill, ThreeDimensionalBoxAndBallCountTheirVolume) {
  const std::string domain =
      "method = \"les-sph\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\n[resolution]\nspacing = 0.04\n"
      "[time]\nend = 1\n[[liquid]]\n";
  const LoadedCase ball = load_text(domain + "centre = [0.5, 0.5, 0.5]\nradius = 0.4\n");
  const double volume = 4.0 / 3 * std::numbers::pi * 0.4 * 0.4 * 0.4;
  // A lattice counts a ball to a fraction of its surface layer: here well below a fifth of it.
  const double layer = 4 * std::numbers::pi * 0.4 * 0.4 * 0.04;
  EXPECT_NEAR(static_cast<double>(ball.scene.particles.size()) * ball.scene.particles.volume, volume, 0.2 * layer);
  EXPECT_EQ(load_text(domain + "lower = [0, 0, 0]\nupper = [0.4, 0.8, 0.2]\n").scene.particles.size(), 10u * 20 * 5);
}

TEST(Fill, RegionIsTheIntersectionOfAllThatIsGiven) {
  const InitialParticles particles =
      load_text(tank("[[liquid]]\nwhere = \"x - 0.2\"\nlower = [0, 0]\nupper = [1, 0.5]\ncentre = [0.5, 0.25]\n"
                     "radius = 0.24\n"))
          .scene.particles;
  std::size_t expected = 0;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 20; ++j) {
      const double x = (i + 0.5) * 0.05, y = (j + 0.5) * 0.05;
      expected += x > 0.2 && x < 1 && y < 0.5 && std::hypot(x - 0.5, y - 0.25) < 0.24;
    }
  }
  EXPECT_EQ(particles.size(), expected);
  EXPECT_GT(expected, 50u);
}

TEST(Fill, TouchingRegionsShareNothingAndKeepTheirOrder) {
  const LoadedCase loaded =
      load_text(tank("[[liquid]]\nlower = [1, 0]\nupper = [2, 0.5]\n[[liquid]]\nlower = [0, 0]\nupper = [1, 0.5]\n"
                     "velocity = [\"y\", \"-x\"]\n"));
  const InitialParticles& particles = loaded.scene.particles;
  ASSERT_EQ(particles.size(), 400u);
  for (std::size_t i = 0; i < 400; ++i) {
    EXPECT_EQ(particles.region[i], i < 200 ? 0 : 1);
    EXPECT_EQ(particles.velocity[0][i], i < 200 ? 0.0 : particles.position[1][i]);
    EXPECT_EQ(particles.velocity[1][i], i < 200 ? 0.0 : -particles.position[0][i]);
  }
}

// Where no surface is, boxes are bodies for les-sph.
TEST(Fill, ClosedBoxAroundASolidHasNoFreeSurface) {
  const std::string closed =
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [2, 2]\nleft = \"no-slip\"\nright = \"no-slip\"\n"
      "bottom = \"no-slip\"\ntop = \"no-slip\"\n[resolution]\nspacing = 0.1\n[time]\nend = 1\n"
      "[[solid]]\nlower = [0.7, 0.7]\nupper = [1.3, 1.3]\nwall = \"no-slip\"\n[[liquid]]\n";
  const LoadedCase full = load_text(closed);
  EXPECT_EQ(full.scene.particles.size(), 400u - 36u);
  EXPECT_FALSE(full.scene.free_surface);
  EXPECT_TRUE(full.scene.domain.boxes.empty());
  EXPECT_EQ(full.scene.bodies.at(0).wall, BoundaryKind::no_slip);
  EXPECT_NEAR(full.scene.bodies.at(0).solid->distance({0.6, 1, 0}), 0.1, 1e-12);
  EXPECT_NEAR(full.scene.walls.distance({0.6, 1, 0}), 0.1, 1e-12);
  const LoadedCase open = load_text(closed + "upper = [2, 1.5]\nlower = [0, 0]\n");
  EXPECT_TRUE(open.scene.free_surface);
  EXPECT_EQ(open.scene.domain.boxes.at(0).kind, BoundaryKind::no_slip);
  EXPECT_TRUE(open.scene.bodies.empty());
  EXPECT_TRUE(load_text(closed, {"solid.0.upper=[0.79, 1.3]"}).scene.bodies.empty());  // thinner than a spacing
}

TEST(Fill, ConformingColumnsEndOnTheSurfaceAndStandOnTheBottom) {
  const LoadedCase loaded = load_text(plunging_breaker, {"resolution.spacing=0.02"});
  const InitialParticles& particles = loaded.scene.particles;
  const auto surface = [](double x) {
    const double chi = 0.55, k = 2 * std::numbers::pi;
    return (chi * std::cos(k * x) + chi * chi / 2 * std::cos(2 * k * x) +
            3.0 / 8 * chi * chi * chi * std::cos(3 * k * x)) /
           k;
  };
  std::map<std::pair<double, double>, std::vector<double>> columns;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    columns[{particles.position[0][i], particles.position[1][i]}].push_back(particles.position[2][i]);
  }
  EXPECT_EQ(columns.size(), 50u * 13u);  // 0.25 / 0.02 = 12.5: 13 columns of 0.0192
  for (const auto& [foot, heights] : columns) {
    const double top = surface(foot.first);
    const double distance = heights[1] - heights[0];
    ASSERT_NEAR(heights.back(), top - distance / 2, 1e-13);
    ASSERT_NEAR(heights.front() + 0.5, distance / 2, 1e-13);
    // With n particles for a depth D, |D/n - spacing| is the least among n - 1, n, n + 1.
    const double n = static_cast<double>(heights.size()), depth = top + 0.5;
    ASSERT_NEAR(distance, depth / n, 1e-13);
    ASSERT_LE(std::abs(distance - 0.02), std::abs(depth / (n - 1) - 0.02));
    ASSERT_LE(std::abs(distance - 0.02), std::abs(depth / (n + 1) - 0.02));
  }
}

// Paper A, chi = 0.55 at 1/100 and width 0.25: 126,300 particles there, whose columns end on the surface with a
// particle; here they end on it with their liquid, half a particle less in each of 2,500 columns.
TEST(Fill, PlungingBreakerOfTheDesignHasHalfAParticleLessInAColumn) {
  const LoadedCase loaded = load_text(plunging_breaker);
  EXPECT_NEAR(static_cast<double>(loaded.scene.particles.size()), 126300 - 2500 / 2.0, 100);
  EXPECT_TRUE(loaded.scene.free_surface);
  EXPECT_DOUBLE_EQ(loaded.scene.fluid.kinematic_viscosity, 1 / 4e4);
  EXPECT_DOUBLE_EQ(loaded.scene.fluid.sound_speed, 20);
  EXPECT_EQ(loaded.scene.fluid.gravity, (Vec3{0, 0, -1}));
  EXPECT_EQ(loaded.options.get<TurbulenceOptions>().model, TurbulenceModel::mixed_scale);
}

TEST(Fill, ConformingLayerAboveARootStandsHalfASpacingAboveIt) {
  const LoadedCase loaded = load_text(tank("[[liquid]]\nwhere = \"(y - 0.31)*(0.72 - y)\"\nconform = true\n"));
  double lowest = 1, highest = 0;
  const Array<double>& y = loaded.scene.particles.position[1];
  for (std::size_t i = 0; i < y.size(); ++i) {
    lowest = std::min(lowest, y[i]);
    highest = std::max(highest, y[i]);
  }
  ASSERT_EQ(y.size(), 40u * 8u);  // 0.41 / 8 = 0.0513, 0.41 / 9 = 0.0456
  EXPECT_NEAR(highest, 0.72 - 0.41 / 16, 1e-14);
  EXPECT_NEAR(lowest, 0.31 + 0.41 / 16, 1e-14);
}

TEST(Fill, JitterIsBoundedReproducibleAndFollowsTheSeed) {
  const std::vector<std::string> jittered{"initial.jitter=0.2"};
  const InitialParticles a = load_text(small_case(), jittered).scene.particles;
  const InitialParticles b = load_text(small_case(), jittered).scene.particles;
  const InitialParticles c = load_text(small_case(), {"initial.jitter=0.2", "seed=7"}).scene.particles;
  const InitialParticles rest = load_text(small_case()).scene.particles;
  ASSERT_EQ(a.size(), 100u);
  EXPECT_TRUE(same_bits(a.position[0], b.position[0]) && same_bits(a.position[1], b.position[1]));
  EXPECT_FALSE(same_bits(a.position[0], c.position[0]));
  double largest = 0, mean = 0;
  for (std::size_t i = 0; i < 100; ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      const double moved = a.position[axis][i] - rest.position[axis][i];
      largest = std::max(largest, std::abs(moved));
      mean += moved / 200;
    }
  }
  EXPECT_LE(largest, 0.02);
  EXPECT_GT(largest, 0.018);                             // the largest of 200 uniform numbers
  EXPECT_LT(std::abs(mean), 4 * 0.02 / std::sqrt(600));  // four standard errors of a uniform mean
}

TEST(Fill, IsTheSameForAnyThreadCount) {
  const int before = omp_get_max_threads();
  const std::vector<std::string> settings{"resolution.spacing=0.02", "initial.jitter=0.1"};
  omp_set_num_threads(1);
  const InitialParticles one = load_text(plunging_breaker, settings).scene.particles;
  omp_set_num_threads(3);
  const InitialParticles three = load_text(plunging_breaker, settings).scene.particles;
  omp_set_num_threads(before);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(same_bits(one.position[axis], three.position[axis]));
    EXPECT_TRUE(same_bits(one.velocity[axis], three.velocity[axis]));
  }
}

TEST(Fill, EmptyAndOverlappingRegionsAreErrorsInWords) {
  EXPECT_THAT(problems_of(tank("[[liquid]]\nlower = [0, 0]\nupper = [1, 0.5]\n"
                               "[[liquid]]\nlower = [0.9, 0]\nupper = [1.5, 0.2]\n"
                               "[[liquid]]\nwhere = \"-1\"\n")),
              ElementsAre("15:1 liquid.1 overlaps liquid.0: 8 particles lie in both, the first at (0.925, 0.025); "
                          "change one so that they only touch",
                          "18:1 liquid.2 is empty: it holds no particle; check its limits against the domain and the "
                          "spacing 0.05"));
  EXPECT_THAT(problems_of(tank("[[solid]]\nlower = [0, 0]\nupper = [1, 0.5]\n[[liquid]]\nlower = [0.2, 0.1]\n"
                               "upper = [0.8, 0.3]\n")),
              ElementsAre(HasSubstr("liquid.0 is empty: all of its particles lie inside solids")));
  EXPECT_THAT(problems_of(tank("[[liquid]]\nwhere = \"sqrt(x - 1)\"\n")),
              ElementsAre(HasSubstr("liquid.0.where is not finite at (0.025, 0.025)")));
  for (const std::string where : {"1/0 - y", "-1/0", "y + 1/(x - 0.025)"})
    EXPECT_THAT(problems_of(tank("[[liquid]]\nwhere = \"" + where + "\"\n")),
                ElementsAre(HasSubstr("liquid.0.where is not finite at (0.025, 0.025)")))
        << where;
  // A region without an expression reports nothing of another's, and what is nowhere overlaps nothing.
  EXPECT_THAT(problems_of(tank("[[liquid]]\nwhere = \"1/0\"\n[[liquid]]\ncentre = [0.5, 0.5]\nradius = 0.2\n")),
              ElementsAre(HasSubstr("13:9 liquid.0.where is not finite at (0.025, 0.025)")));
  EXPECT_THAT(problems_of(tank("[[liquid]]\nupper = [1, 0.5]\nlower = [0, 0]\nvelocity = [\"1/(x - 0.125)\", 0]\n")),
              ElementsAre(HasSubstr("liquid.0.velocity is not finite at (0.125, 0.025)")));
  EXPECT_THAT(problems_of(tank("[[liquid]]\nwhere = \"1.2 - y\"\nconform = true\n")),
              ElementsAre(HasSubstr("liquid.0.where is still positive at the top, at (0.025, 1)")));
}

TEST(Fill, AbsurdCountsAreRefusedBeforeAllocation) {
  EXPECT_THAT(problems_of(tank("[[liquid]]\n"), {"resolution.spacing=1e-6"}),
              ElementsAre(HasSubstr("liquid regions hold up to 2e+12 particles at spacing 1e-06; at most 2^31")));
  EXPECT_THAT(problems_of(tank("[[liquid]]\n"), {"resolution.spacing=1e-300"}),
              ElementsAre(HasSubstr("at most 2^31 are possible")));
}

// A limit of the process stands for a small machine.
TEST(Fill, MoreThanTheMemoryHoldsIsRefusedBeforeAllocation) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer takes more of the address space than the test leaves";
#endif
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const rlimit small{3'000'000'000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &small), 0);
  Draft flat;
  flat.dimensions = 2;
  const double most = 3e9 / registered_method("les-sph").bytes_per_particle(flat);
  const std::vector<std::string> spacing{"resolution.spacing=0.0003"};  // 2.2e7 particles in all
  const auto plain = problems_of(tank("[[liquid]]\n"), spacing);
  const auto shaped = problems_of(tank("[[liquid]]\nwhere = \"1 + x\"\n"), spacing);
  const auto fitting = problems_of(tank("[[liquid]]\nwhere = \"0.1 - y\"\n"), {"resolution.spacing=0.0009"});
  const auto grid = problems_of(
      "method = \"spectral\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\n"
      "x = \"periodic\"\ny = \"periodic\"\nz = \"periodic\"\n[resolution]\ngrid = 512\n"
      "[time]\nend = 1\n[fluid]\nreynolds = 100\n[initial]\nkind = \"taylor-green\"\n");
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  for (const auto& problems : {plain, shaped}) {
    ASSERT_EQ(problems.size(), 1u);
    const std::size_t at = problems[0].find("than the ");
    ASSERT_NE(at, std::string::npos) << problems[0];
    EXPECT_NEAR(std::stod(problems[0].substr(at + 9)), most, 0.01 * most);
  }
  EXPECT_TRUE(fitting.empty());
  EXPECT_THAT(grid, ElementsAre(HasSubstr("the grid has 1.34218e+08 points; this machine has memory for")));
}

// Nine and a half layers under an expression, on ten rows; a level of a whole number, a surface that conforms, and no
// gravity say nothing.
TEST(Fill, ALevelBetweenLayersIsTold) {
  const auto told = [](const std::string& level, const std::string& more = "",
                       const std::string& group = "froude = 1") {
    const LoadedCase loaded = test::load_text(
        "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [2, 2]\nleft = \"free-slip\"\nright = "
        "\"free-slip\"\nbottom = \"free-slip\"\n[resolution]\nspacing = 0.1\n[time]\nend = 1\n[fluid]\nreynolds = "
        "100\n" +
        group + "\n[[liquid]]\nwhere = \"" + level + " - y\"\n" + more);
    std::string text;
    for (const Problem& one : loaded.options.warnings) text += one.message("warning");
    return text;
  };
  EXPECT_THAT(told("0.97"), testing::HasSubstr("no whole number of layers of particles deep"));
  EXPECT_THAT(told("0.97"), testing::HasSubstr("3.1 % more volume"));
  for (const std::string& text : {told("1"), told("0.97", "conform = true\n"), told("0.97", "", "")})
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("whole number of layers")));
}

}  // namespace
}  // namespace spume
