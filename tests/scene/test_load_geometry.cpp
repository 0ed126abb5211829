// SPDX-License-Identifier: MIT
// What the reader says about domains, sides, walls, solids, regions and probes that cannot be.
#include <gmock/gmock.h>

#include <cmath>

#include "helpers.hpp"

namespace spume {
namespace {

using test::load_text;
using test::problems_of;
using test::replaced;
using test::small_case;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(LoadGeometry, GeometryThatCannotWorkIsRefusedWithTheFix) {
  EXPECT_THAT(problems_of(replaced(small_case(), "upper = [1, 1]", "upper = [1, -1]")),
              ElementsAre("4:9 domain.upper must lie above domain.lower: y runs from 0 to -1"));
  EXPECT_THAT(problems_of(replaced(small_case(), "upper = [1, 1]", "upper = [1, 1, 1]")),
              ElementsAre("4:9 domain.upper must have 2 entries in a 2-D domain, found 3"));
  EXPECT_THAT(problems_of(replaced(small_case(), "lower = [0, 0]", "lower = [0]")),
              ElementsAre("3:9 domain.lower must have 2 entries (2-D) or 3 (3-D), found 1"));
  EXPECT_THAT(problems_of(replaced(small_case(), "0.1", "1.5")),
              ElementsAre("8:11 resolution.spacing = 1.5 is larger than the domain, which is 1 long in x; set spacing "
                          "<= 0.1"));
  // 2 * 2.6 + 1 = 6.2 spacings.
  EXPECT_THAT(
      problems_of(replaced(small_case(), "upper = [1, 1]", "upper = [1, 0.6]")),
      ElementsAre("8:11 the periodic length in y, 0.6, is shorter than two kernel supports and a spacing, 0.62; "
                  "set spacing <= 0.0967 or lengthen the domain to 0.62"));
  EXPECT_THAT(
      problems_of(small_case(), {"resolution.kernel = quintic-spline", "resolution.smoothing_ratio=1.6"}),
      ElementsAre(HasSubstr("8:11 the periodic length in x, 1, is shorter than two kernel supports and a spacing, "
                            "1.06; set"),
                  HasSubstr("8:11 the periodic length in y")));
  const std::string walls = replaced(
      replaced(small_case(), "y = \"periodic\"", "bottom = \"no-slip\"\ntop = \"no-slip\""), "[1, 1]", "[1, 0.6]");
  EXPECT_THAT(problems_of(walls),
              ElementsAre(HasSubstr("the distance between the walls bottom and top, 0.6, is shorter")));
}

TEST(LoadGeometry, SidesMustExistAndNotContradictEachOther) {
  EXPECT_THAT(
      problems_of(replaced(small_case(), "y = \"periodic\"", "y = \"periodic\"\ntop = \"no-slip\"\nback = \"open\"")),
      ElementsAre("7:1 domain.top is a side of the periodic direction y; remove one of the two",
                  "8:1 domain.back is a side of a 3-D domain; a 2-D one has left, right, bottom, top"));
  EXPECT_THAT(problems_of(replaced(small_case(), "y = \"periodic\"", "y = \"periodic\"\nz = \"periodic\"")),
              ElementsAre(HasSubstr("7:1 domain.z names a direction that a 2-D domain does not have")));
  EXPECT_THAT(problems_of(replaced(small_case(), "y = \"periodic\"", "top = \"periodic\"")),
              ElementsAre(HasSubstr("6:7 domain.top is one side; a periodic direction is written by its axis")));
}

TEST(LoadGeometry, WallVelocityNeedsAWallAndOneExpressionPerDirection) {
  const std::string lid = replaced(small_case(), "y = \"periodic\"", "bottom = \"no-slip\"\ntop = \"no-slip\"") +
                          "[domain.wall_velocity]\n";
  EXPECT_THAT(problems_of(lid + "top = [\"1\"]\n"),
              ElementsAre("16:7 domain.wall_velocity.top must have 2 entries in a 2-D domain, found 1"));
  EXPECT_THAT(problems_of(lid + "left = [1, 0]\nfront = [1, 0]\n"),
              ElementsAre("16:1 domain.wall_velocity.left moves a side that is not a wall; add  left = \"no-slip\"  to "
                          "[domain]",
                          "17:1 domain.wall_velocity.front: a 2-D domain has left, right, bottom, top"));
  const LoadedCase loaded = load_text(lid + "top = [\"sin(t)\", 0]\nbottom = [0, 0]\n");
  const Side& top = loaded.scene.domain.sides[1][1];
  ASSERT_TRUE(top.velocity.has_value());
  EXPECT_DOUBLE_EQ((*top.velocity)({0, 0, 0}, 0.5)[0], std::sin(0.5));
  EXPECT_EQ(top.velocity->component[1], nullptr);
  EXPECT_FALSE(loaded.scene.domain.sides[1][0].velocity.has_value());
}

TEST(LoadGeometry, SolidsRegionsAndProbesMustLieInTheDomain) {
  EXPECT_THAT(problems_of(small_case("lower = [0, 0]\nupper = [1, 1.2]\n")),
              ElementsAre("13:1 liquid.0 reaches outside the domain: y from 0 to 1.2, the domain's y from 0 to 1"));
  // Half of a ball on a side, a quarter in a corner: its images are the rest, but not across a periodic side.
  const std::string periodic = small_case("radius = 0.4\ncentre = "),
                    ball = replaced(replaced(periodic, "x = \"periodic\"", "left = \"free-slip\""), "y = \"periodic\"",
                                    "bottom = \"free-slip\"");
  EXPECT_THAT(problems_of(ball + "[0, 0.5]\n"), IsEmpty());
  EXPECT_THAT(problems_of(ball + "[1, 0]\n"), IsEmpty());
  EXPECT_THAT(problems_of(ball + "[0.1, 0.5]\n"),
              ElementsAre("13:1 liquid.0 reaches outside the domain: x from -0.3 to 0.5, the domain's x from 0 to 1; a "
                          "ball lies inside, or its centre on a side that is not periodic"));
  EXPECT_THAT(problems_of(periodic + "[0, 0.5]\n"),
              ElementsAre(HasSubstr("reaches outside the domain: x from -0.4 to 0.4")));
  EXPECT_THAT(problems_of(small_case("centre = [0.5, 0.5]\n[[liquid]]\nradius = 0.1\n")),
              ElementsAre(HasSubstr("13:1 missing key 'radius'"), HasSubstr("15:1 missing key 'centre'")));
  EXPECT_THAT(problems_of(small_case("conform = true\n")),
              ElementsAre(HasSubstr("14:11 liquid.0.conform needs the surface")));
  EXPECT_THAT(problems_of(small_case("[[solid]]\nlower = [2, 0]\nupper = [3, 1]\n")),
              ElementsAre("14:1 solid.0 lies outside the domain: x from 2 to 3, the domain's x from 0 to 1"));
  EXPECT_THAT(
      problems_of(small_case("[[solid]]\nlower = [0.1, 0]\nupper = [0.7, 1]\n")),
      ElementsAre("14:1 solid.0 is 0.1 away from a periodic side in x, within the kernel support 0.26, and its mirror "
                  "images would end there; move the sides of the domain, or let the box span it"));
  EXPECT_THAT(problems_of(small_case("[[solid]]\nlower = [0.3, 0]\nupper = [0.31, 1]\n")), testing::IsEmpty());
  EXPECT_THAT(problems_of(small_case("[[probe]]\nname = \"a\"\nposition = [0.5, 3]\n"
                                     "[[probe]]\nname = \"a\"\nkind = \"front\"\naxis = \"y\"\n"
                                     "[[probe]]\nname = \"c\"\nkind = \"line\"\nposition = [0, 0]\n")),
              ElementsAre("16:12 probe.0.position lies outside the domain: y = 3, the domain's y from 0 to 1",
                          "18:8 another probe has the name 'a' already", "20:8 probe.1.axis must be horizontal: x",
                          "21:1 missing key 'end' in [[probe]]; add  end = [<x>, <y>]  # length"));
}

TEST(LoadGeometry, EveryProbeHasItsOwnColumns) {
  const std::string at = "position = [0.5, 0.5]\n";
  EXPECT_THAT(problems_of(small_case("[[probe]]\nname = \"t\"\nkind = \"elevation\"\n" + at)),
              ElementsAre("15:8 its column 't' of probes.csv is that of the time already; choose another name"));
  const std::string point = "[[probe]]\nname = \"pt\"\n" + at;
  for (const std::string name : {"pt_pressure", "pt_velocity_x", "pt_velocity_y"}) {
    const std::string other = "[[probe]]\nname = \"" + name + "\"\nkind = \"front\"\n";
    EXPECT_THAT(
        problems_of(small_case(point + other)),
        ElementsAre("18:8 its column '" + name + "' of probes.csv is that of probe 'pt' already; choose another name"));
    EXPECT_THAT(problems_of(small_case(other + point)), testing::SizeIs(1));
  }
  // A point called t has no column t, and no z in two dimensions.
  EXPECT_THAT(problems_of(small_case("[[probe]]\nname = \"t\"\n" + at +
                                     "[[probe]]\nname = \"t_velocity_z\"\nkind = \"front\"\n")),
              IsEmpty());
}

TEST(LoadGeometry, SidesOfAThreeDimensionalDomainAreNamedAfterTheirAxis) {
  const LoadedCase loaded = load_text(
      "method = \"les-sph\"\n[domain]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\nleft = \"free-slip\"\n"
      "back = \"no-slip\"\ntop = \"no-slip\"\n[domain.wall_velocity]\nback = [\"z\", 0, 0]\n"
      "[resolution]\nspacing = 0.1\n[time]\nend = 1\n[fluid]\nfroude = 2\n[[liquid]]\n");
  const auto& sides = loaded.scene.domain.sides;
  EXPECT_EQ(sides[0][0].kind, BoundaryKind::free_slip);
  EXPECT_EQ(sides[0][1].kind, BoundaryKind::open);
  EXPECT_EQ(sides[1][0].kind, BoundaryKind::open);
  EXPECT_EQ(sides[1][1].kind, BoundaryKind::no_slip);
  EXPECT_EQ(sides[2][0].kind, BoundaryKind::open);
  EXPECT_EQ(sides[2][1].kind, BoundaryKind::no_slip);
  EXPECT_EQ((*sides[1][1].velocity)({0, 0, 0.5}, 0), (Vec3{0.5, 0, 0}));
  EXPECT_EQ(loaded.scene.fluid.gravity, (Vec3{0, 0, -0.25}));
}

}  // namespace
}  // namespace spume
