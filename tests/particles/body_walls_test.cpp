// SPDX-License-Identifier: MIT
#include "spume/particles/body_walls.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <string>

#include "particles/walled.hpp"
#include "spume/operators/pressure_operator.hpp"
#include "spume/operators/sph_operators.hpp"
#include "spume/particles/surface_pieces.hpp"

namespace spume::test {
namespace {

std::size_t axis_of(int a) {
  return static_cast<std::size_t>(a);
}

}  // namespace

TEST(WallPoints, StandInLayersOfAsManyAsTheyHaveVolumeFor) {
  const double spacing = 0.02, radius = 0.4;
  for (const bool inside : {true, false}) {
    const LoadedCase loaded = load_text(scene_text(
        square, spacing,
        "[[body]]\nshape = \"cylinder\"\nradius = 0.4\ninside = " + std::string(inside ? "true\n" : "false\n")));
    const Resolution resolution(2, spacing, KernelKind::wendland_c2, 1.3);
    const double volume = loaded.scene.particles.volume, step = std::sqrt(volume);
    std::array<int, 3> count{};
    const std::vector<WallPoint> points = make_wall_points(loaded.scene.walls, loaded.scene.domain, resolution, volume);
    for (const WallPoint& point : points) {
      const double depth = length(subtract(point.position, point.foot));
      EXPECT_NEAR(std::fmod(depth, step), 0.5 * step, 1e-6 * step);
      EXPECT_NEAR(length(point.foot), radius, 1e-9);
      EXPECT_NEAR(length(subtract(add(point.position, point.mirror), multiply(2, point.foot))), 0, 1e-12);
      ++count[static_cast<std::size_t>(depth / step)];
    }
    for (int layer = 0; layer < 3; ++layer) {
      const double middle = radius + (inside ? -1 : 1) * (layer + 0.5) * step;
      const double wanted = 2 * std::numbers::pi * middle * step / volume;
      // Shares of cells count a shell to the square of a cell over the radius, and then to half a point at either end.
      EXPECT_NEAR(count[static_cast<std::size_t>(layer)], wanted, 0.005 * wanted + 1) << "layer " << layer;
    }
    // Evened out: none near another.
    for (const WallPoint& a : points)
      for (const WallPoint& b : points)
        if (&a != &b) {
          EXPECT_GT(length(subtract(a.position, b.position)), 0.6 * step);
        }
  }
}

// A hull in mm around a tank in m: facets a thousand times the domain are cut where they are near it alone.
TEST(SurfacePieces, FarFromTheDomainStayWhole) {
  const double spacing = 0.1;
  const LoadedCase loaded =
      load_text(scene_text(cube, spacing,
                           "[[body]]\nshape = \"box\"\nsize = [2000, 2000, 2000]\nposition = [0, 0, -1000.4]\n"
                           "wall = \"no-slip\"\n"));
  const std::vector<SurfacePiece> pieces = surface_pieces(loaded.scene.domain, loaded.scene.bodies[0], spacing);
  // The domain and its diagonal on either side: 5.4 wide, in pieces of at least an eighth of spacing^2 each, and those
  // that the cuts on the way to it leave.
  EXPECT_LT(pieces.size(), 30000U);
  double area = 0, above = 0;
  for (const SurfacePiece& piece : pieces) {
    area += length(piece.area);
    above +=
        piece.area[2] > 0 && std::abs(piece.middle[0]) < 0.6 && std::abs(piece.middle[1]) < 0.6 ? piece.area[2] : 0;
  }
  EXPECT_NEAR(above, 1.44, 0.15);
  EXPECT_NEAR(area, 6 * 2000.0 * 2000, 1e-6 * 6 * 2000 * 2000);
}

TEST(BodyWalls, MirrorValuesAsFitsOverAllParticlesDo) {
  for (const Layout& layout : wall_layouts()) {
    SCOPED_TRACE(layout.name);
    const Walled walled(layout.text);
    const reference::WallSums twin = walled.twin(smooth);
    const WallStencils& stencils = walled.boundary.bodies()->stencils();
    const WallPointView wet = walled.boundary.bodies()->wet();
    ASSERT_GT(wet.size, 30U);
    const std::vector<WallPoint> all =
        make_wall_points(walled.scene().walls, walled.scene().domain, walled.resolution, walled.particles.volume);
    Array<double> scalar(walled.particles.size());
    for (std::size_t i = 0; i < scalar.size(); ++i) scalar[i] = smooth(walled.place(i)).scalar;
    for (std::size_t g = 0; g < wet.size; ++g) {
      Vec3 place{};
      for (int axis = 0; axis < walled.particles.dimensions; ++axis) place[axis] = wet.position[axis][g];
      const auto point = std::find_if(all.begin(), all.end(), [&](const WallPoint& p) { return p.position == place; });
      ASSERT_NE(point, all.end());
      double sum = 0;
      for (std::int64_t k = stencils.first[g]; k < stencils.first[g + 1]; ++k) sum += stencils.coefficient[k];
      EXPECT_NEAR(sum, 1, 1e-14);
      // Normal equations square the condition number, at most 5e3 for a fit of this order.
      EXPECT_NEAR(stencils.mirrored(g, scalar.data()), twin.fit(*point).scalar, 1e-8);
    }
  }
}

// Velocities that are a cubic through that of the surface go on behind it, as far as the liquid bears cubics.
TEST(BodyWalls, ContinueCubicsThroughSurfacesThatHoldTheLiquid) {
  for (const double bend : {0.0, -1.2}) {
    const Walled walled(scene_text("lower = [0, 0]\nupper = [1, 1]\nx = \"periodic\"\n", 0.05,
                                   "[[body]]\nshape = \"half-space\"\nposition = [0, 0.3]\nnormal = [0, 1]\nwall = "
                                   "\"no-slip\"\nvelocity = [\"0.7\", \"0\"]\n"));
    const auto profile = [&](double s) { return 0.7 + s + bend * s * s + 0.5 * s * s * s; };
    std::array<Array<double>, 3> velocity;
    for (auto& component : velocity) component = Array<double>(walled.particles.size(), 0.0);
    for (std::size_t i = 0; i < walled.particles.size(); ++i) velocity[0][i] = profile(walled.place(i)[1] - 0.3);
    const WallPointView wet = walled.boundary.bodies()->wet();
    ASSERT_GT(wet.size, 30U);
    for (std::size_t g = 0; g < wet.size; ++g) {
      const auto u = walled.boundary.bodies()->stencils().velocity(
          g, 2, {velocity[0].data(), velocity[1].data(), nullptr}, true, true, false);
      // Velocities of surfaces are kept in single precision.
      EXPECT_NEAR(u[0], profile(wet.position[1][g] - 0.3), 2e-7);
      EXPECT_NEAR(u[1], 0, 1e-12);
    }
  }
}

TEST(BodyWalls, SweepsSeeWallPointsAndTheirImages) {
  for (const Layout& layout : wall_layouts()) {
    SCOPED_TRACE(layout.name);
    Walled walled(layout.text);
    const int d = walled.particles.dimensions;
    const std::size_t n = walled.particles.size();
    const reference::WallSums twin = walled.twin(smooth);
    const auto [points, carried] = walled.wet_points(twin);
    Array<double> scalar(n);
    std::array<Array<double>, 3> velocity;
    for (auto& component : velocity) component.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      scalar[i] = twin.value[i].scalar;
      for (std::size_t axis = 0; axis < 3; ++axis) velocity[axis][i] = twin.value[i].velocity[axis];
    }
    // Without correction, so that the sums themselves are compared.
    std::array<Array<float>, 6> identity;
    std::array<const float*, 6> correction{};
    for (std::size_t k = 0; k < 6; ++k) {
      const bool diagonal = d == 2 ? k == 0 || k == 2 : k == 0 || k == 3 || k == 5;
      identity[k] = Array<float>(n, diagonal ? 1.0F : 0.0F);
      correction[k] = identity[k].data();
    }
    std::array<Array<float>, 3> gradient, viscous;
    std::array<float*, 3> gradient_out{}, viscous_out{};
    for (int axis = 0; axis < d; ++axis) {
      gradient[axis].resize(n);
      viscous[axis].resize(n);
      gradient_out[axis] = gradient[axis].data();
      viscous_out[axis] = viscous[axis].data();
    }
    Array<double> divergence(n);
    const Array<float> kappa(n, 1.0F);
    std::array<const double*, 3> u{velocity[0].data(), velocity[1].data(), d == 3 ? velocity[2].data() : nullptr};
    gradient_sweep(walled.arrangement.context, walled.arrangement.packed, scalar.data(), 0, correction, gradient_out);
    divergence_sweep(walled.arrangement.context, walled.arrangement.packed, u, walled.boundary.volume_rule(),
                     correction, nullptr, divergence.data(), nullptr);
    viscous_sweep(walled.arrangement.context, walled.arrangement.packed, u, walled.boundary.velocity_rule(),
                  kappa.data(), viscous_out, false);
    const Array<float> no_shift(n, 0.0F);
    PressureOperator matrix;
    matrix.bind(walled.arrangement.context, walled.arrangement.packed, {no_shift.data(), nullptr});
    Array<float> x(n), y(n);
    Array<double> zero(n, 0.0), residual(n);
    for (std::size_t i = 0; i < n; ++i) x[i] = static_cast<float>(scalar[i]);
    matrix.apply(x, y, x);
    matrix.residual(scalar, zero, residual);
    // Of a sum of the size s over 20 (2-D) or 80 neighbours in float, with values of size 1.
    const double h = walled.resolution.smoothing_length, tolerance = d == 2 ? 4e-6 : 8e-6;
    for (std::size_t i = 0; i < n; ++i) {
      Vec3 of_gradient{}, of_viscous{};
      double of_divergence = 0, of_laplacian = 0;
      twin.sum(i, points, carried[0], false, [&](const Vec3& way, double r, const reference::Carried& other) {
        const double g = twin.g(r);
        of_laplacian += 2 * g * (twin.value[i].scalar - other.scalar);
        for (int axis = 0; axis < d; ++axis) {
          of_gradient[axis] += g * (other.scalar - twin.value[i].scalar) * way[axis];
          of_divergence += g * (other.velocity[axis] - twin.value[i].velocity[axis]) * way[axis];
        }
      });
      twin.sum(i, points, carried[1], true, [&](const Vec3&, double r, const reference::Carried& other) {
        for (int axis = 0; axis < d; ++axis)
          of_viscous[axis] += 2 * twin.g(r) * (other.velocity[axis] - twin.value[i].velocity[axis]);
      });
      EXPECT_NEAR(divergence[i], of_divergence, tolerance / h * 10);
      for (int axis = 0; axis < d; ++axis) {
        EXPECT_NEAR(gradient[axis][i], of_gradient[axis], tolerance / h * 10);
        EXPECT_NEAR(viscous[axis][i], of_viscous[axis], tolerance / (h * h) * 10);
      }
      EXPECT_NEAR(y[i] / walled.particles.volume, of_laplacian, tolerance / (h * h) * 10);
      EXPECT_NEAR(-residual[i] / walled.particles.volume, of_laplacian, tolerance / (h * h) * 10);
    }
  }
}

// The sums, less their share of what they make of the linear velocity that the corrected gradient has.
TEST(BodyWalls, ViscosityTakesOffWhatItMakesOfLinearVelocities) {
  for (const Layout& layout : wall_layouts()) {
    SCOPED_TRACE(layout.name);
    Walled walled(layout.text);
    const int d = walled.particles.dimensions;
    const std::size_t n = walled.particles.size();
    const reference::WallSums twin = walled.twin(smooth);
    const auto [points, carried] = walled.wet_points(twin);
    std::array<Array<double>, 3> velocity;
    std::array<Array<float>, 3> viscous;
    std::array<const double*, 3> u{};
    std::array<float*, 3> out{};
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(d); ++axis) {
      velocity[axis].resize(n);
      viscous[axis].resize(n);
      for (std::size_t i = 0; i < n; ++i) velocity[axis][i] = twin.value[i].velocity[axis];
      u[axis] = velocity[axis].data();
      out[axis] = viscous[axis].data();
    }
    Array<float> share(n), kappa(n);
    std::array<Array<float>, 6> correction;
    for (auto& entry : correction) entry.resize(n);
    std::vector<std::array<Vec3, 3>> inverse(n);
    for (std::size_t i = 0; i < n; ++i) {
      share[i] = i % 12 == 0 ? 0.0F : static_cast<float>(uniform(i, 11)[0]);
      kappa[i] = 1;
      // Any symmetric matrix will do.
      for (int a = 0; a < d; ++a)
        for (int b = a; b < d; ++b) {
          const auto entry = static_cast<float>((a == b ? 1 : 0.1) + 0.1 * uniform(i, 12)[static_cast<std::size_t>(a)]);
          inverse[i][a][b] = inverse[i][b][a] = entry;
          correction[static_cast<std::size_t>(d == 2 ? a + b : (a == 0 ? b : a + b + 1))][i] = entry;
        }
    }
    std::array<const float*, 6> read{};
    for (std::size_t k = 0; k < 6; ++k) read[k] = correction[k].data();
    for (const bool stress : {false, true}) {
      SCOPED_TRACE(stress ? "stress" : "Laplacian");
      viscous_sweep(walled.arrangement.context, walled.arrangement.packed, u, walled.boundary.velocity_rule(),
                    kappa.data(), out, stress, {share.data(), read});
      const double h = walled.resolution.smoothing_length, tolerance = (d == 2 ? 4e-6 : 8e-6) * (stress ? d + 2 : 1);
      for (std::size_t i = 0; i < n; i += 4) {
        std::array<Vec3, 3> sums{}, gradient{};
        twin.sum(i, points, carried[1], true, [&](const Vec3& way, double r, const reference::Carried& other) {
          for (int a = 0; a < d; ++a)
            for (int b = 0; b < d; ++b)
              sums[a][b] += twin.g(r) * (other.velocity[axis_of(a)] - twin.value[i].velocity[axis_of(a)]) * way[b];
        });
        for (int a = 0; a < d; ++a)
          for (int b = 0; b < d; ++b)
            for (int c = 0; c < d; ++c) gradient[a][b] += share[i] * inverse[i][b][c] * sums[a][c];
        Vec3 wanted{};
        twin.sum(i, points, carried[1], true, [&](const Vec3& way, double r, const reference::Carried& other) {
          Vec3 difference{};
          for (int a = 0; a < d; ++a) {
            difference[a] = other.velocity[axis_of(a)] - twin.value[i].velocity[axis_of(a)];
            for (int b = 0; b < d; ++b) difference[a] -= gradient[a][b] * way[b];
          }
          for (int a = 0; a < d; ++a)
            wanted[a] +=
                2 * twin.g(r) *
                (stress ? (d + 2) * dot(difference, way) / std::max(r * r, 1e-8 * h * h) * way[a] : difference[a]);
        });
        for (int a = 0; a < d; ++a) EXPECT_NEAR(viscous[axis_of(a)][i], wanted[a], tolerance / (h * h) * 20);
      }
    }
  }
}

TEST(BodyWalls, KeepLiquidOutside) {
  const Walled walled(scene_text(square, 0.05, disc + pipe));
  const BodyWalls& bodies = *walled.boundary.bodies();
  for (std::size_t k = 0; k < 2000; ++k) {
    const auto random = uniform(k, 5);
    Vec3 place{2 * random[0] - 1, 2 * random[1] - 1, 0}, velocity{random[2] - 0.5, random[0] - 0.5, 0};
    const bool was_outside = walled.scene().walls.distance(place) > 1e-4;
    const Vec3 before = place, speed = velocity;
    bodies.keep_outside(place, &velocity, 1e-4);
    EXPECT_GE(walled.scene().walls.distance(place), 0.99e-4);
    if (was_outside) {
      EXPECT_EQ(place, before);
      EXPECT_EQ(velocity, speed);
    } else {
      EXPECT_LE(length(velocity), length(speed) * (1 + 1e-12));
    }
    // The cells that say how far the walls are at least know the side.
    EXPECT_GT(bodies.distance(place), 0);
  }
}

// Cells tell which of many moving bodies a place asks: answers are those of all bodies asked in turn.
// A box that a tank has taken along beyond where its right side stood lost its wall points there, and water went
// through it.
TEST(BodyWalls, TakePartAsFarAsTheSidesAreNow) {
  const LoadedCase loaded =
      load_text(scene_text("lower = [-1, -1]\nupper = [1, 1]\nleft = \"free-slip\"\nright = \"free-slip\"\n", 0.05,
                           "[[body]]\nshape = \"box\"\nsize = [0.4, 0.4]\ndensity = 0.5\n"));
  const Scene& scene = loaded.scene;
  const Resolution resolution(2, scene.spacing, KernelKind::wendland_c2, 1.3);
  BodyWalls walls(scene, resolution, scene.particles.volume);
  const auto all = static_cast<double>(walls.points());
  RigidPlace place = walls.moving(0).place;
  const auto points_at = [&](double x, double side) {
    place.position[0] = x;
    walls.set_sides({{{-1, side}, {-1, 1}, {0, 0}}});
    walls.set_place(0, place, place, place);
    walls.move_to(0);
    return static_cast<double>(walls.points());
  };
  const double column = 0.4 / 0.05;
  EXPECT_EQ(points_at(1.5, 2), all);
  EXPECT_NEAR(points_at(1.5, 1.5), all / 2, column);
  EXPECT_EQ(points_at(1.5, 1), 0);
  EXPECT_NEAR(points_at(-0.5, -0.5), all / 2, column);
}

TEST(BodyWalls, OfManyAnswerAsAllAskedInTurn) {
  for (const bool space : {false, true}) {
    SCOPED_TRACE(space ? "3-D" : "2-D");
    std::string bodies = space ? ball : disc;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto vector = [&](double scale) {
      std::string text = "[";
      for (int axis = 0; axis < (space ? 3 : 2); ++axis)
        text += (axis > 0 ? ", " : "") + std::to_string(scale * uniform(random));
      return text + "]";
    };
    for (int body = 0; body < 9; ++body)
      bodies += std::string("[[body]]\nshape = \"ellipsoid\"\nsemi_axes = ") +
                (space ? "[0.06, 0.09, 0.04]" : "[0.06, 0.09]") + "\nposition = " + vector(space ? 0.5 : 0.9) +
                "\ndisplacement = [\"0.1*t\", \"-0.2*t\"" +
                (space ? ", \"0\"]\naxis = [1, 2, 3]\nangle = \"40*t\"\n" : "]\nangle = \"40*t\"\n");
    const LoadedCase loaded = load_text(scene_text(space ? cube : square, 0.05, bodies));
    const Resolution resolution(space ? 3 : 2, 0.05, KernelKind::wendland_c2, 1.3);
    BodyWalls walls(loaded.scene, resolution, loaded.scene.particles.volume);
    walls.move_to(0.7);
    ASSERT_EQ(walls.parts(), 10U);
    int named_by_cells = 0;
    for (std::size_t k = 1; k < walls.parts(); ++k) {
      const Bounds bounds = walls.part(k).bounds_now();
      for (int axis = 0; axis < (space ? 3 : 2); ++axis) {
        EXPECT_GE(bounds.upper[axis] - bounds.lower[axis], 0.08);
        EXPECT_LE(bounds.upper[axis] - bounds.lower[axis], 0.3);
      }
    }
    for (int n = 0; n < 3000; ++n) {
      Vec3 point{};
      for (int axis = 0; axis < (space ? 3 : 2); ++axis) point[axis] = 1.1 * uniform(random);
      double least = infinite;
      bool farther = true;
      std::size_t best = 0;
      const double gap = (n % 3 + 0.5) * 0.05;
      for (std::size_t k = 0; k < walls.parts(); ++k) {
        const double own = walls.part(k).distance(point);
        if (own < least) {
          least = own;
          best = k;
        }
        farther = farther && walls.part(k).surely_farther(point, gap);
      }
      EXPECT_EQ(walls.distance(point), least);
      EXPECT_EQ(walls.surely_farther(point, gap), farther);
      if (least < 0.1) {
        EXPECT_EQ(walls.nearest_wall(point).body, best);
      }
      named_by_cells += farther ? 0 : 1;
    }
    EXPECT_GT(named_by_cells, 100);
  }
}

TEST(BodyWalls, WithoutLiquidNearTakeNoPart) {
  const Walled walled(scene_text(square, 0.05, "upper = [1, -0.5]\n" + disc));
  EXPECT_EQ(walled.boundary.bodies()->wet().size, 0U);
  EXPECT_EQ(walled.arrangement.context.walls, nullptr);
  EXPECT_GT(walled.boundary.bodies()->points(), 0U);
}

// Beside bubbles particles differ in size and rows have weights: a correction in single precision must see wall points
// as the residual does, by fits of both.
TEST(BodyWalls, ThePressureOperatorOfUnequalParticlesIsTheSameInBothPrecisions) {
  Walled walled(scene_text(cube, 0.1, ball));
  const std::size_t n = walled.particles.size();
  ParticleSizes sizes;
  sizes.variable = true;
  sizes.largest_length_ratio = 1.1;
  for (Array<float>* array : {&sizes.length_ratio, &sizes.volume_ratio, &sizes.support_radius, &sizes.volume_fraction})
    array->resize(n);
  Array<float> shift(n, 0.0F), weight(n), row(n), x(n), y(n);
  Array<double> q(n), zero(n, 0.0), residual(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 r = walled.place(i);
    const auto alpha = static_cast<float>(0.85 + 0.1 * std::sin(4 * r[0] + 3 * r[2]));
    sizes.volume_fraction[i] = alpha;
    sizes.volume_ratio[i] = 1 / alpha;
    sizes.length_ratio[i] = std::cbrt(1 / alpha);
    sizes.support_radius[i] = static_cast<float>(walled.resolution.support_radius) * sizes.length_ratio[i];
    weight[i] = 1 / alpha;
    row[i] = alpha;
    x[i] = static_cast<float>(smooth(r).scalar);
    q[i] = x[i];
  }
  walled.arrangement.set_sizes(&sizes);
  walled.arrangement.find_neighbours(walled.particles, walled.particles.position, sizes);
  PressureOperator matrix;
  matrix.bind(walled.arrangement.context, walled.arrangement.packed,
              {shift.data(), nullptr, weight.data(), row.data()});
  matrix.apply(x, y, x);
  matrix.residual(q, zero, residual);
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(residual[i]));
  // Single precision of sums over 80 neighbours of values of size 1, of which the largest row keeps a tenth.
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(y[i], -residual[i], 1e-4 * largest) << i;
}

}  // namespace spume::test
