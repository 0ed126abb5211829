// SPDX-License-Identifier: MIT
// Sums of weakly compressible SPH beside walls of bodies against their slow twin, and what bodies take from the liquid.
#include <gtest/gtest.h>

#include <cmath>

#include "particles/walled.hpp"
#include "reference/wcsph_wall_sums.hpp"
#include "spume/operators/wall_averages.hpp"
#include "spume/operators/wcsph_sums.hpp"

namespace spume::test {
namespace {

const std::vector<Layout>& wcsph_layouts() {
  static const std::vector<Layout> layouts{
      {"a no-slip disc that turns, periodic",
       scene_text("lower = [0, 0]\nupper = [1, 1]\nx = \"periodic\"\ny = \"periodic\"\n", 1.0 / 16,
                  "[[body]]\nshape = \"ball\"\nradius = 0.22\nposition = [0.48, 0.93]\nwall = \"no-slip\"\nangle = "
                  "\"30*sin(3*t)\"\ndisplacement = [\"0.1*sin(2*t)\", \"0\"]\n")},
      {"a wedge and a box that touch each other and sides of both kinds",
       scene_text("lower = [0, 0]\nupper = [1, 1]\nleft = \"no-slip\"\nright = \"free-slip\"\nbottom = "
                  "\"free-slip\"\ntop = \"no-slip\"\n",
                  1.0 / 16,
                  "[[body]]\nshape = \"outline\"\npoints = [[0.2, -0.3], [0.47, 0.4], [0.75, -0.3]]\n[[body]]\nshape = "
                  "\"box\"\nsize = [0.35, 0.4]\nposition = [0.8, 0.1]\nwall = \"no-slip\"\n")},
      {"a surface in the open",
       scene_text("lower = [0, 0]\nupper = [1, 1]\nleft = \"open\"\nright = \"open\"\nbottom = \"open\"\ntop = "
                  "\"open\"\n",
                  1.0 / 16, "[[body]]\nshape = \"half-space\"\nposition = [0.5, 0.4]\nnormal = [0.2, 1]\n",
                  "upper = [0.7, 0.8]\n")},
      {"a ball before a side, in three dimensions",
       scene_text("lower = [0, 0, 0]\nupper = [1, 1, 1]\nx = \"periodic\"\ny = \"periodic\"\nbottom = "
                  "\"free-slip\"\ntop = \"no-slip\"\n",
                  1.0 / 8, "[[body]]\nshape = \"ball\"\nradius = 0.27\nposition = [0.9, 0.5, 0.3]\n")}};
  return layouts;
}

// Three phases dispersed among each other, with random fields, beside wall points as wcsph takes them.
struct WalledLiquid {
  Walled walled;
  WallAverages averages;
  Array<float> volume, excess, phase, density, viscosity, pressure;
  Array<double> wall_pressure, wall_density;
  std::array<Array<double>, 3> velocity;
  std::vector<std::int32_t> body;
  VelocityImageRule mirror;
  reference::WcsphWallSums twin;

  WalledLiquid(const Layout& layout, double jitter, const Vec3& gravity)
      : walled(layout.text, jitter),
        twin{
            walled.scene().domain, walled.resolution.smoothing_length, walled.particles.volume, gravity, 0.08, {}, {}} {
    const std::size_t n = walled.particles.size();
    for (auto* array : {&volume, &excess, &phase, &density, &viscosity}) array->resize(n);
    pressure.resize(n);
    for (auto& component : velocity) component.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const auto a = uniform(i, 11), b = uniform(i, 12);
      volume[i] = static_cast<float>(1 + 0.1 * (a[0] - 0.5));
      excess[i] = static_cast<float>(a[1] - 0.5);
      pressure[i] = static_cast<float>(a[2] - 0.3);
      phase[i] = static_cast<float>(i % 3);
      density[i] = i % 3 == 0 ? 1000.0F : i % 3 == 1 ? 1.0F : 800.0F;
      viscosity[i] = i % 3 == 0 ? 1.0F : i % 3 == 1 ? 0.018F : 0.0F;
      reference::WallSumPoint point{.position = walled.place(i),
                                    .volume = volume[i],
                                    .pressure = pressure[i],
                                    .excess = excess[i],
                                    .density = density[i],
                                    .viscosity = viscosity[i],
                                    .phase = static_cast<int>(i % 3)};
      for (int axis = 0; axis < walled.particles.dimensions; ++axis)
        velocity[axis][i] = point.velocity[axis] = b[static_cast<std::size_t>(axis)] - 0.5;
      twin.particles.push_back(point);
    }
    take_points();
    twin.fill_walls();
  }

  BodyWalls& walls() { return *walled.boundary.bodies(); }
  const SweepContext& context() const { return walled.arrangement.context; }

  void take_points() {
    Arrangement& arrangement = walled.arrangement;
    walls().take_all_points(0);
    walled.boundary.make_images(arrangement, walled.particles, walled.particles.position, 1, {}, false);
    arrangement.find_neighbours(walled.particles, walled.particles.position, {});
    averages.find_entries(context(), walled.boundary.reflection(), walls().stencils(), true);
    averages.weigh(context(), walls().stencils());
    wall_pressure.resize(walls().stencils().size());
    wall_density.resize(walls().stencils().size());
    averages.extrapolate(context(), walls().stencils(),
                         {.pressure = pressure.data(),
                          .density = density.data(),
                          .gravity = twin.gravity,
                          .wall_acceleration = read(walls().acceleration())},
                         wall_pressure.data(), wall_density.data());
    for (std::size_t g = 0; g < walls().points(); ++g) {
      const WallPoint& at = walls().all_points()[g];
      body.push_back(walls().body_of_wet(g));
      reference::WallSumPoint point{.position = at.position, .normal = at.normal, .body = body.back()};
      point.no_slip = walls().bodies()[static_cast<std::size_t>(body.back())].wall == BoundaryKind::no_slip;
      for (int axis = 0; axis < walled.particles.dimensions; ++axis) {
        point.velocity[axis] = walls().stencils().wall_velocity[axis][g];
        if (!walls().acceleration()[axis].empty()) point.acceleration[axis] = walls().acceleration()[axis][g];
      }
      twin.walls.push_back(point);
    }
    mirror.sign = walled.boundary.reflection();
    mirror.friction = false;
  }
};

// Places are floats relative to the middle of the domain: what the rounding of one side length changes in a kernel
// gradient over a smoothing length, and that of a sum of `terms`.
double float_rounding(const WalledLiquid& liquid, double terms) {
  return std::ldexp(16 / liquid.twin.h + terms + 16, -24);
}

// What the sums below have in common.
ContinuityFields continuity_fields(const WalledLiquid& liquid, bool weighted) {
  return {.velocity = read(liquid.velocity),
          .mirror = &liquid.mirror,
          .volume = liquid.volume.data(),
          .excess = liquid.excess.data(),
          .phase = weighted ? liquid.density.data() : liquid.phase.data(),
          .weighted = weighted};
}
PressureFields pressure_fields(WalledLiquid& liquid, bool weighted) {
  return {.pressure = liquid.pressure.data(),
          .volume = liquid.volume.data(),
          .density = liquid.density.data(),
          .several = true,
          .weighted = weighted,
          .position = read(liquid.walled.particles.position),
          .wall_pressure = liquid.wall_pressure.data(),
          .wall_density = liquid.wall_density.data(),
          .wall_position = liquid.walls().wet().position};
}

// Rates of density with walls that move in it, and the pressure force, without gravity.
struct WallSums {
  Array<float> rate;
  std::array<Array<float>, 3> force;

  WallSums(WalledLiquid& liquid, bool weighted) {
    PackedNeighbours& packed = liquid.walled.arrangement.packed;
    const std::size_t n = liquid.twin.particles.size();
    Array<float> diffusion(n);
    Array<double> flow(liquid.walls().stencils().size());
    rate.resize(n);
    for (auto& component : force) component.resize(n);
    ContinuityFields fields = continuity_fields(liquid, weighted);
    fields.walls_move = true;
    continuity_sweep(liquid.context(), packed, fields, {rate.data(), diffusion.data()});
    liquid.averages.add_rates(liquid.context(), liquid.walls().stencils(), read(liquid.velocity), liquid.volume.data(),
                              flow.data(), rate.data());
    pressure_force_sweep(liquid.context(), packed, pressure_fields(liquid, weighted),
                         {force[0].data(), force[1].data(), force[2].data()});
  }
};

TEST(WcsphWalls, AveragesAtWallPointsAgreeWithTheSlowTwin) {
  for (const Layout& layout : wcsph_layouts())
    for (const double jitter : {0.2, 0.9}) {
      SCOPED_TRACE(layout.name);
      WalledLiquid liquid(layout, jitter, {});
      const WallStencils& stencils = liquid.walls().stencils();
      ASSERT_GT(stencils.size(), 10);
      for (std::size_t g = 0; g < stencils.size(); ++g) {
        const reference::WallSumPoint& wall = liquid.twin.walls[g];
        std::vector<double> share(liquid.twin.particles.size());
        double total = 0;
        for (std::int64_t k = stencils.first[g]; k < stencils.first[g + 1]; ++k) {
          share[static_cast<std::size_t>(stencils.source[k])] += stencils.coefficient[k];
          total += stencils.coefficient[k];
        }
        // Far kernel values lose digits to the rounding of places before a mean of a few of them.
        const std::vector<double> wanted = liquid.twin.shares(g);
        double kernel_sum = 0;
        for (const auto& particle : liquid.twin.particles)
          liquid.twin.each_copy(particle, [&](const auto& copy) {
            if (!copy.mirrored) kernel_sum += WendlandC2::w(liquid.twin.q(wall.position, copy.position));
          });
        if (kernel_sum < 1e-3) continue;
        EXPECT_NEAR(total, 1, 1e-12);
        const double rounding = float_rounding(liquid, 0) / kernel_sum;
        double largest = 0;
        for (std::size_t j = 0; j < share.size(); ++j) {
          EXPECT_NEAR(share[j], wanted[j], rounding);
          if (wanted[j] > 0) largest = std::max(largest, double{liquid.density[j]});
        }
        const double entries = static_cast<double>(stencils.first[g + 1] - stencils.first[g]);
        EXPECT_NEAR(liquid.wall_density[g], wall.density, entries * rounding * largest);
        EXPECT_NEAR(liquid.wall_pressure[g], wall.pressure,
                    entries * rounding *
                        (1 + largest * 2 * liquid.walled.resolution.support_radius *
                                 std::sqrt(dot(wall.acceleration, wall.acceleration))));
      }
    }
}

// A viscosity of all particles is that of each.
TEST(WcsphWalls, OneViscosityGivesTheForcesOfAsManyAsParticles) {
  for (const Layout& layout : wcsph_layouts())
    for (const bool friction : {false, true}) {
      SCOPED_TRACE(layout.name);
      WalledLiquid liquid(layout, 0.2, {});
      const std::size_t n = liquid.twin.particles.size();
      const int d = liquid.context().dimensions;
      constexpr float viscosity = 0.3F;
      Array<float> of_each(n), rate(n), diffusion(n);
      of_each.fill(viscosity);
      std::array<Array<float>, 3> viscous, wanted;
      for (auto* vector : {&viscous, &wanted})
        for (auto& component : *vector) component.resize(n);
      ContinuityFields fields = continuity_fields(liquid, false);
      fields.friction = friction ? &liquid.walled.boundary.velocity_rule() : nullptr;
      fields.viscosity = of_each.data();
      PackedNeighbours& packed = liquid.walled.arrangement.packed;
      continuity_sweep(liquid.context(), packed, fields,
                       {rate.data(), diffusion.data(), {wanted[0].data(), wanted[1].data(), wanted[2].data()}});
      fields.viscosity = nullptr;
      fields.common_viscosity = viscosity;
      continuity_sweep(liquid.context(), packed, fields,
                       {rate.data(), diffusion.data(), {viscous[0].data(), viscous[1].data(), viscous[2].data()}});
      double largest = 0;
      for (std::size_t i = 0; i < n; ++i)
        for (int axis = 0; axis < d; ++axis) largest = std::max(largest, double{std::abs(wanted[axis][i])});
      ASSERT_GT(largest, 0);
      // Of a hundred terms in single precision.
      for (std::size_t i = 0; i < n; ++i)
        for (int axis = 0; axis < d; ++axis) EXPECT_NEAR(viscous[axis][i], wanted[axis][i], 100 * 6e-8 * largest);
    }
}

TEST(WcsphWalls, SumsAndForcesAgreeWithTheSlowTwin) {
  for (const Layout& layout : wcsph_layouts())
    for (const auto& [jitter, weighted] : {std::pair{0.2, false}, {0.2, true}, {0.9, false}, {0.9, true}}) {
      SCOPED_TRACE(layout.name);
      const LoadedCase& loaded = Walled(layout.text).loaded;
      const int d = loaded.scene.domain.dimensions;
      Vec3 gravity{};
      if (!loaded.scene.domain.periodic(d - 1)) gravity[static_cast<std::size_t>(d - 1)] = -2e-3;
      WalledLiquid liquid(layout, jitter, gravity);
      liquid.twin.weighted = weighted;
      if (jitter > 0.5) liquid.twin.left_out = multiply(0.7, gravity);
      PackedNeighbours& packed = liquid.walled.arrangement.packed;
      const Boundary& boundary = liquid.walled.boundary;
      const std::size_t n = liquid.twin.particles.size();
      Array<float> rate(n), diffusion(n);
      std::array<Array<float>, 3> viscous, force;
      for (auto* vector : {&viscous, &force})
        for (auto& component : *vector) component.resize(n);
      const std::array<float*, 3> viscous_out{viscous[0].data(), viscous[1].data(), viscous[2].data()};
      const std::array<float*, 3> force_out{force[0].data(), force[1].data(), force[2].data()};
      ContinuityFields rates = continuity_fields(liquid, weighted);
      rates.friction = &boundary.velocity_rule();
      rates.viscosity = liquid.viscosity.data();
      continuity_sweep(liquid.context(), packed, rates, {rate.data(), diffusion.data(), viscous_out});
      PressureFields pressures = pressure_fields(liquid, weighted);
      pressures.repulsion = 0.08F;
      pressures.gravity = gravity;
      pressures.left_out = liquid.twin.left_out;
      pressure_force_sweep(liquid.context(), packed, pressures, force_out);
      Vec3 lost{};
      double modulus = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const auto s = liquid.twin.sums(i);
        const double rounding = float_rounding(liquid, s.count);
        EXPECT_NEAR(rate[i], s.rate, rounding * s.rate_modulus);
        EXPECT_NEAR(diffusion[i], s.diffusion, rounding * s.diffusion_modulus);
        for (int axis = 0; axis < d; ++axis) {
          EXPECT_NEAR(viscous[axis][i], s.viscous[axis], rounding * s.viscous_modulus);
          EXPECT_NEAR(force[axis][i], s.pressure[axis], rounding * s.pressure_modulus);
          lost[axis] -= liquid.twin.particle_volume * liquid.volume[i] * (force[axis][i] + viscous[axis][i]);
        }
        modulus += rounding * liquid.twin.particle_volume * (s.pressure_modulus + s.viscous_modulus);
      }
      const WallForceFields to_walls = {.velocity = read(liquid.velocity),
                                        .pressure = liquid.pressure.data(),
                                        .volume = liquid.volume.data(),
                                        .viscosity = liquid.viscosity.data(),
                                        .friction = true,
                                        .gravity = gravity,
                                        .left_out = liquid.twin.left_out,
                                        .reflection = &boundary.reflection(),
                                        .held = &boundary.velocity_rule().sign,
                                        .wall_pressure = liquid.wall_pressure.data(),
                                        .wall_density = liquid.wall_density.data(),
                                        .wall_position = liquid.walls().wet().position,
                                        .arm = liquid.walls().wet().position,
                                        .body = liquid.body.data()};
      const std::vector<SurfaceForce> forces = wall_forces(liquid.context(), to_walls, liquid.walls().bodies().size());
      // The same sums from the particles alone that are known to be near walls.
      WallForceFields near_walls = to_walls;
      near_walls.near = &liquid.averages.near();
      const std::vector<SurfaceForce> of_near = wall_forces(liquid.context(), near_walls, forces.size());
      for (std::size_t b = 0; b < forces.size(); ++b) {
        EXPECT_EQ(of_near[b].pressure, forces[b].pressure);
        EXPECT_EQ(of_near[b].viscous_torque, forces[b].viscous_torque);
      }
      Vec3 taken{};
      for (std::size_t b = 0; b < forces.size(); ++b) {
        const auto wanted = liquid.twin.force(static_cast<int>(b));
        const double rounding = float_rounding(liquid, 0);
        for (int axis = 0; axis < d; ++axis) {
          EXPECT_NEAR(forces[b].pressure[axis], wanted.pressure[axis], rounding * wanted.modulus);
          EXPECT_NEAR(forces[b].viscous[axis], wanted.viscous[axis], rounding * wanted.viscous_modulus);
          taken[axis] += forces[b].pressure[axis] + forces[b].viscous[axis];
        }
        EXPECT_NEAR(forces[b].pressure_torque[2], wanted.torque, 2 * rounding * wanted.modulus);
      }
      // Without other walls bodies take what the liquid loses.
      for (int axis = 0; axis < d; ++axis)
        if (&layout == &wcsph_layouts()[0]) {
          EXPECT_NEAR(taken[axis], lost[axis], modulus);
        }
    }
}

// The rate of density beside walls of bodies is adjoint to the pressure force, also where images of wall points in
// sides and periodic copies take part: without gravity, and beside walls at rest, pressure and flow exchange energy and
// neither is made. Accelerations of walls are left out of the pressure, as gravity is.
TEST(WcsphWalls, RateAndPressureForceAreAdjoint) {
  for (const Layout& layout : wcsph_layouts())
    for (const auto& [jitter, weighted] : {std::pair{0.2, false}, {0.2, true}, {0.9, false}}) {
      SCOPED_TRACE(layout.name);
      WalledLiquid liquid(layout, jitter, {});
      const std::size_t n = liquid.twin.particles.size();
      const int d = liquid.walled.particles.dimensions;
      WallStencils& stencils = liquid.walls().stencils();
      for (int axis = 0; axis < d; ++axis) stencils.wall_velocity[axis].fill(0.0F);
      liquid.averages.extrapolate(liquid.context(), stencils,
                                  {.pressure = liquid.pressure.data(), .density = liquid.density.data()},
                                  liquid.wall_pressure.data(), liquid.wall_density.data());
      const WallSums sums(liquid, weighted);
      double work = 0, gain = 0, modulus = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const double volume = liquid.volume[i];
        const auto slow = liquid.twin.sums(i);
        gain += volume * double{liquid.pressure[i]} * double{sums.rate[i]};
        modulus += volume * std::abs(double{liquid.pressure[i]}) * slow.rate_modulus;
        for (int axis = 0; axis < d; ++axis) {
          work += volume * liquid.velocity[axis][i] * double{sums.force[axis][i]};
          modulus += volume * std::abs(liquid.velocity[axis][i]) * slow.pressure_modulus;
        }
      }
      EXPECT_NEAR(work, -gain, float_rounding(liquid, 64) * modulus);
    }
}

TEST(WcsphWalls, AdjointRatesAgreeWithTheSlowTwin) {
  for (const Layout& layout : wcsph_layouts())
    for (const double jitter : {0.2, 0.9}) {
      SCOPED_TRACE(layout.name);
      WalledLiquid liquid(layout, jitter, {});
      liquid.twin.adjoint = true;
      const WallSums sums(liquid, false);
      std::vector<double> added(liquid.twin.particles.size()), rounding(added.size());
      std::vector<bool> skipped(added.size());
      for (std::size_t g = 0; g < liquid.twin.walls.size(); ++g) {
        const std::vector<double> share = liquid.twin.shares(g);
        const double flow = liquid.twin.flow(g);
        double kernel_sum = 0;
        for (const auto& particle : liquid.twin.particles)
          liquid.twin.each_copy(particle, [&](const auto& copy) {
            if (!copy.mirrored)
              kernel_sum += WendlandC2::w(liquid.twin.q(liquid.twin.walls[g].position, copy.position));
          });
        for (std::size_t j = 0; j < added.size(); ++j) {
          if (share[j] == 0) continue;
          added[j] += share[j] * flow / liquid.twin.particles[j].volume;
          // Far kernel values lose digits to the rounding of places before a mean of a few of them.
          rounding[j] += float_rounding(liquid, 0) * (1 + 1 / std::max(kernel_sum, 1e-3)) * liquid.twin.flow_modulus(g);
          if (kernel_sum < 1e-3) skipped[j] = true;
        }
      }
      for (std::size_t j = 0; j < added.size(); ++j) {
        const auto slow = liquid.twin.sums(j);
        if (skipped[j]) continue;
        EXPECT_NEAR(sums.rate[j], slow.rate + added[j],
                    float_rounding(liquid, slow.count) * slow.rate_modulus + 2 * rounding[j]);
      }
    }
}

// Lists outlive small ways of bodies: their points follow, those round a periodic side too.
TEST(WcsphWalls, PointsFollowTheirBodies) {
  WalledLiquid liquid(wcsph_layouts()[0], 0.2, {});
  BodyWalls& walls = liquid.walls();
  const std::vector<WallPoint> before = walls.all_points();
  const double t = 0.01;
  const RigidPlace start = given_place(walls.motions()[0], 0), place = given_place(walls.motions()[0], t);
  walls.follow_points(t);
  for (std::size_t g = 0; g < before.size(); ++g) {
    // Points of the copy beyond the upper side turn about a pivot a period below.
    double least = INFINITY, way = 0;
    for (const double shift : {0.0, 1.0}) {
      const Vec3 wanted = subtract(place.now(start.start(add(before[g].position, {0, shift, 0}))), {0, shift, 0});
      const Vec3 off = subtract(walls.all_points()[g].position, wanted), moved = subtract(wanted, before[g].position);
      if (dot(off, off) >= least) continue;
      least = dot(off, off);
      way = std::sqrt(dot(moved, moved));
    }
    EXPECT_LT(std::sqrt(least), 1e-12);
    EXPECT_LE(way, walls.way_of_points(0, t) + 1e-12);
    EXPECT_GT(way, 0);
    EXPECT_EQ(walls.wet().position[0][g], walls.all_points()[g].position[0]);
  }
}

}  // namespace
}  // namespace spume::test
