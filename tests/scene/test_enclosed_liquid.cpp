// SPDX-License-Identifier: MIT
// Incompressible liquid that solids enclose has a pressure constant of its own, which factors of the matrix do not
// find.
#include <gmock/gmock.h>

#include "helpers.hpp"
#include "spume/scene/enclosed_liquid.hpp"

namespace spume {
namespace {

using test::load_text;
using test::problems_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A tank 2 wide; between the pillars and below the lid lies a chamber of 0.6 x 0.2 on its floor.
std::string chambered(const std::string& liquid, bool lid = true) {
  return "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [2, 1]\nleft = \"free-slip\"\nright = \"free-slip\"\n"
         "bottom = \"free-slip\"\n[resolution]\nspacing = 0.05\n[time]\nend = 1\n[fluid]\nreynolds = 100\nfroude = "
         "1\n" +
         liquid + "[[solid]]\nlower = [0.8, 0]\nupper = [0.9, 0.3]\n[[solid]]\nlower = [1.5, 0]\nupper = [1.6, 0.3]\n" +
         (lid ? "[[solid]]\nlower = [0.9, 0.2]\nupper = [1.5, 0.3]\n" : "");
}
const std::string half_full = "[[liquid]]\nupper = [2, 0.5]\n";

const std::string direct = "pressure.solver=\"direct\"";

TEST(EnclosedLiquid, IsRefusedByTheDirectSolverWithoutASoundSpeed) {
  EXPECT_THAT(problems_of(chambered(half_full)), IsEmpty());
  EXPECT_THAT(problems_of(chambered(half_full), {direct}),
              ElementsAre(AllOf(HasSubstr("the liquid at (1.2, 0.1), which solids enclose"), HasSubstr("bicgstab"))));
  EXPECT_THAT(problems_of(chambered(half_full), {direct, "fluid.mach=0.05"}), IsEmpty());
}

TEST(EnclosedLiquid, IsNoneBelowAirOrBesideAGap) {
  EXPECT_THAT(problems_of(chambered(half_full, false), {direct}), IsEmpty());
  // A chamber that holds a layer less than it could, none, or that has a hole.
  EXPECT_THAT(problems_of(chambered("[[liquid]]\nupper = [2, 0.15]\n"), {direct}), IsEmpty());
  EXPECT_THAT(problems_of(chambered("[[liquid]]\nupper = [0.8, 0.5]\n"), {direct}), IsEmpty());
  EXPECT_THAT(problems_of(chambered(half_full), {direct, "solid.2.upper=[1.4, 0.3]"}), IsEmpty());
  EXPECT_FALSE(enclosed_liquid(load_text(chambered(half_full, false)).scene).has_value());
}

// One tank that liquid fills is what the solve is made for; two beside each other are not.
TEST(EnclosedLiquid, OfAFullTankIsOneOfTwo) {
  const std::string full =
      "method = \"les-sph\"\n[domain]\nlower = [0, 0]\nupper = [2, 1]\nleft = \"free-slip\"\nright = \"free-slip\"\n"
      "bottom = \"free-slip\"\ntop = \"free-slip\"\n[resolution]\nspacing = 0.05\n[time]\nend = 1\n[fluid]\nreynolds = "
      "100\n"
      "[[liquid]]\n";
  const std::string pillar = "[[solid]]\nlower = [0.9, 0]\nupper = [1.1, 0.5]\n";
  EXPECT_THAT(problems_of(full + pillar, {direct}), IsEmpty());
  EXPECT_THAT(problems_of(full + pillar, {direct, "solid.0.upper=[1.1, 1]"}),
              ElementsAre(HasSubstr("which solids enclose")));
}

}  // namespace
}  // namespace spume
