// SPDX-License-Identifier: MIT
// The stress that parts particles from walls against its formula, over all sides and bodies.
#include "spume/particles/wall_parting.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "particles/walled.hpp"
#include "reference/sph_sums.hpp"

namespace spume::test {
namespace {

// A ball that moves beside one that stands, before sides of three kinds.
const std::string between_sides = scene_text(
    "lower = [0, 0]\nupper = [1, 1]\nleft = \"no-slip\"\nright = \"open\"\nbottom = \"free-slip\"\n", 1.0 / 16,
    "[[body]]\nshape = \"ball\"\nradius = 0.15\nposition = [0.3, 0.4]\ndisplacement = [\"0.1*sin(t)\", "
    "\"0\"]\n[[body]]\nshape = \"ball\"\nradius = 0.12\nposition = [0.7, 0.5]\n",
    "upper = [1, 0.8]\n");

TEST(WallParting, IsTheStressOfTheFormulaAndBodiesTakeTheirs) {
  Walled walled(between_sides, 0.9);
  const std::size_t n = walled.particles.size();
  const double dr = walled.scene().spacing, h = walled.resolution.smoothing_length, scale = 1.02;
  const double speed = 1.7;
  const std::vector<PhaseLaw> laws{{.density = 1000, .sound_speed = 10}, {.density = 2, .sound_speed = 20}};
  Array<std::int64_t> phase(n);
  Array<float> volume(n);
  std::array<Array<float>, 3> force;
  for (auto& component : force) component = Array<float>(n, 0.0F);
  for (std::size_t i = 0; i < n; ++i) {
    const auto random = uniform(i, 21);
    phase[i] = random[0] > 0.5;
    volume[i] = static_cast<float>(1 + 0.1 * (random[2] - 0.5));
  }
  const WallParting parting(walled.scene(), walled.boundary, walled.resolution, walled.particles.volume, speed);
  const WallParting::Liquid liquid{
      .law = {laws, phase}, .place = read(walled.particles.position), .volume = volume.data(), .gradient_scale = scale};
  parting.add_forces(n, liquid, {force[0].data(), force[1].data(), nullptr});
  std::vector<SurfaceForce> taken(2);
  parting.add_to_bodies(n, liquid, taken);

  const reference::PlainKernel kernel{KernelKind::wendland_c2, 2};
  const auto w = [&](double r) { return kernel.w(r / h); };
  int beside_sides = 0, beside_bodies = 0;
  Vec3 lost{};
  double torque = 0, moduli = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 r = walled.place(i);
    Vec3 expected{};
    double modulus = 0;
    const auto add_wall = [&](double distance, const Vec3& normal) {
      const double reference = laws[static_cast<std::size_t>(phase[i])].density * speed * speed;
      const double stress = 0.2 * reference * (std::pow(w(2 * distance) / w(dr), 4) - 1);
      const double slope =
          scale * walled.particles.volume * kernel.normalisation() * kernel.f(2 * distance / h) / std::pow(h, 4);
      const Vec3 of_wall = multiply(-slope / volume[i] * stress * 2 * distance, normal);
      expected = add(expected, of_wall);
      modulus += length(of_wall);
      return of_wall;
    };
    for (const auto& [distance, normal] : {std::pair{r[0], Vec3{1, 0, 0}}, {r[1], Vec3{0, 1, 0}}})
      if (distance < dr / 2) {
        add_wall(distance, normal);
        ++beside_sides;
      }
    const Vec3 from_ball = subtract(r, {0.3, 0.4, 0});
    if (length(from_ball) < 0.15 + dr / 2) {
      const Vec3 of_ball = add_wall(length(from_ball) - 0.15, unit(from_ball, 2));
      const Vec3 taken_of_it = multiply(-walled.particles.volume * double{volume[i]}, of_ball);
      const Vec3 foot = add({0.3, 0.4, 0}, multiply(0.15, unit(from_ball, 2)));
      lost = add(lost, taken_of_it);
      torque += cross(foot, taken_of_it)[2];
      moduli += length(taken_of_it);
      ++beside_bodies;
    }
    // Floats hold the sums.
    for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(force[axis][i], expected[axis], 3e-7 * modulus) << i;
  }
  EXPECT_GT(beside_sides, 10);
  EXPECT_GT(beside_bodies, 3);
  // Distances from the ball are those of its shape, to rounding.
  for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(taken[0].pressure[axis], lost[axis], 1e-9 * moduli);
  EXPECT_NEAR(taken[0].pressure_torque[2], torque, 1e-9 * moduli);
  EXPECT_EQ(length(taken[1].pressure), 0);  // it stands still
}

}  // namespace
}  // namespace spume::test
