// SPDX-License-Identifier: MIT
// Sweeps of generalised finite differences beside wall points of bodies, against sums over all particles, wall points
// and their images.
#include <gtest/gtest.h>

#include "particles/walled.hpp"
#include "spume/operators/gfd_gradient.hpp"
#include "spume/operators/gfd_pressure.hpp"
#include "spume/operators/gfd_stress.hpp"
#include "spume/operators/interface_bands.hpp"
#include "spume/operators/interface_jump.hpp"

namespace spume::test {
namespace {

// A positive property that jumps tenfold from particle to particle.
double property(const Vec3& r, double frequency) {
  return std::pow(10.0, std::sin(frequency * r[0]) * std::cos(frequency * r[1]));
}

struct Vectors {
  std::array<Array<float>, 3> component;
  std::array<float*, 3> out{};
  Vectors(std::size_t n, int d) {
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(d); ++axis) {
      component[axis].resize(n);
      out[axis] = component[axis].data();
    }
  }
  std::array<const float*, 3> in() const { return {out[0], out[1], out[2]}; }
};

// Moments of all particles, as the sweeps read them.
struct WalledStencils {
  std::array<Array<float>, 6> correction;
  Array<float> laplacian_factor;
  Vectors offset;
  GfdStencils read;
  WalledStencils(const SweepContext& context, PackedNeighbours& packed, std::size_t n, int d)
      : laplacian_factor(n), offset(n, d) {
    GfdMoments moments;
    for (std::size_t k = 0; k < static_cast<std::size_t>(d * (d + 1) / 2); ++k) {
      correction[k].resize(n);
      read.correction[k] = moments.correction[k] = correction[k].data();
    }
    moments.offset = offset.out;
    read.offset = offset.in();
    read.laplacian_factor = moments.laplacian_factor = laplacian_factor.data();
    gfd_moment_sweep(context, packed, moments);
  }
};

// The particle nearest to the mirrored place of a wall point, over all particles before its tangent plane and their
// periodic copies.
std::size_t nearest_particle(const Walled& walled, const WallPoint& point) {
  std::size_t best = 0;
  double least = INFINITY;
  for (std::size_t j = 0; j < walled.particles.size(); ++j) {
    Vec3 way = subtract(walled.place(j), point.mirror);
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(walled.particles.dimensions); ++axis)
      if (walled.scene().domain.periodic(static_cast<int>(axis))) {
        const double period = walled.scene().domain.upper[axis] - walled.scene().domain.lower[axis];
        way[axis] -= period * std::round(way[axis] / period);
      }
    if (dot(add(way, subtract(point.mirror, point.foot)), point.normal) < 0) continue;
    if (const double distance = length(way); distance < least) {
      least = distance;
      best = j;
    }
  }
  return best;
}

}  // namespace

TEST(GfdWalls, SweepsSeeWallPointsAndTheirImages) {
  for (const Layout& layout : wall_layouts()) {
    SCOPED_TRACE(layout.name);
    Walled walled(layout.text);
    const SweepContext& context = walled.arrangement.context;
    PackedNeighbours& packed = walled.arrangement.packed;
    const int d = walled.particles.dimensions;
    const std::size_t n = walled.particles.size();
    const reference::WallSums twin = walled.twin(smooth);
    const auto [points, carried] = walled.wet_points(twin);
    // Density and viscosity, which wall points have from the particle nearest to what they mirror.
    std::vector<double> density(n), viscosity(n);
    std::vector<reference::Carried> density_at_walls, viscosity_at_walls;
    for (std::size_t i = 0; i < n; ++i) {
      density[i] = property(walled.place(i), 90);
      viscosity[i] = property(walled.place(i), 70);
    }
    for (const WallPoint& point : points) {
      const std::size_t j = nearest_particle(walled, point);
      density_at_walls.push_back({.scalar = density[j]});
      viscosity_at_walls.push_back({.scalar = viscosity[j]});
    }
    const auto of_property = [&](const std::vector<double>& values) {
      reference::WallSums sums = twin;
      for (std::size_t i = 0; i < n; ++i) sums.value[i] = {.scalar = values[i]};
      return sums;
    };
    const reference::WallSums densities = of_property(density), viscosities = of_property(viscosity);

    Array<double> q(n), zero(n, 0.0), residual(n), divergence(n);
    Array<float> rho(n), mu(n), x(n), y(n);
    Array<std::uint8_t> varies(n, std::uint8_t{1});
    std::array<Array<double>, 3> velocity;
    for (auto& component : velocity) component.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = twin.value[i].scalar;
      x[i] = static_cast<float>(q[i]);
      rho[i] = static_cast<float>(density[i]);
      mu[i] = static_cast<float>(viscosity[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) velocity[axis][i] = twin.value[i].velocity[axis];
    }
    const std::array<const double*, 3> u{velocity[0].data(), velocity[1].data(), d == 3 ? velocity[2].data() : nullptr};
    Vectors gradient(n, d), viscous(n, d), slope(n, d);
    const WalledStencils of_all(context, packed, n, d);
    const GfdStencils& stencils = of_all.read;
    for (int axis = 0; axis < d; ++axis)
      for (std::size_t i = 0; i < n; ++i) slope.component[axis][i] = static_cast<float>(property(walled.place(i), 50));

    gfd_gradient_over_density_sweep(context, packed, q.data(), 0, {rho.data(), varies.data()}, stencils.correction,
                                    gradient.out);
    gfd_divergence_sweep(context, packed, u, walled.boundary.volume_rule(), stencils.correction, divergence.data());
    gfd_stress_sweep(context, packed, u, walled.boundary.velocity_rule(), stencils, MomentumDiffusion::split,
                     {{mu.data(), varies.data()}, nullptr, slope.in()}, viscous.out);
    GfdPressureOperator matrix;
    matrix.bind(context, packed, {stencils, {rho.data(), varies.data()}});
    matrix.apply(x, y, x);
    matrix.residual(q, zero, residual);

    // Relative to the sum of the magnitudes. Coordinates are floats of up to ten (3-D) or twenty spacings, 1e-6 of a
    // spacing; near the end of the support the logarithm of W changes by up to 50 over a spacing.
    constexpr double rounding = 5e-5;
    for (std::size_t i = 0; i < n; i += d == 3 ? 20 : 5) {
      const std::size_t dims = static_cast<std::size_t>(d);
      std::vector<double> rho_ij, mu_ij;
      densities.sum(i, points, density_at_walls, false, [&](const Vec3&, double, const reference::Carried& other) {
        rho_ij.push_back((density[i] + other.scalar) / 2);
      });
      viscosities.sum(i, points, viscosity_at_walls, false, [&](const Vec3&, double, const reference::Carried& other) {
        mu_ij.push_back(2 * viscosity[i] * other.scalar / (viscosity[i] + other.scalar));
      });
      const auto b = [&](std::size_t row, std::size_t column) {
        const std::size_t low = std::min(row, column), high = std::max(row, column);
        return double{of_all.correction[low * dims - low * (low + 1) / 2 + high][i]};
      };
      std::array<Vec3, 3> second{}, strain{}, strain_size{};
      Vec3 of_gradient{}, gradient_size{};
      double of_laplacian = 0, laplacian_size = 0, divergence_size = 0, of_divergence = 0, largest_b = 0;
      std::array<Vec3, 3> held{};
      std::size_t pair = 0;
      twin.sum(i, points, carried[0], false, [&](const Vec3& way, double r, const reference::Carried& other) {
        const double w = WendlandC2::w(r / twin.smoothing_length), difference = other.scalar - twin.value[i].scalar;
        double factor = 1;
        for (std::size_t a = 0; a < dims; ++a) factor += way[a] * of_all.offset.component[a][i];
        const double row = w * factor * difference / rho_ij[pair];
        of_laplacian += row;
        laplacian_size +=
            w * std::abs(factor) * (std::abs(other.scalar) + std::abs(twin.value[i].scalar)) / rho_ij[pair];
        for (std::size_t a = 0; a < dims; ++a) {
          of_gradient[a] += w * way[a] * difference / rho_ij[pair];
          gradient_size[a] += w * r * (std::abs(other.scalar) + std::abs(twin.value[i].scalar)) / rho_ij[pair];
          for (std::size_t c = 0; c < dims; ++c) {
            second[a][c] += w * way[a] * way[c];
            held[a][c] += w * way[c] * (other.velocity[a] - twin.value[i].velocity[a]);
            strain_size[a][c] += w * r * (std::abs(other.velocity[a]) + std::abs(twin.value[i].velocity[a]));
          }
        }
        ++pair;
      });
      for (std::size_t a = 0; a < dims; ++a)
        for (std::size_t c = 0; c < dims; ++c) {
          double unit = 0;
          for (std::size_t e = 0; e < dims; ++e) unit += b(a, e) * second[e][c];
          EXPECT_NEAR(unit, a == c ? 1 : 0, 1e-4);
          largest_b = std::max(largest_b, std::abs(b(a, c)));
          of_divergence += b(a, c) * held[a][c];
          divergence_size += std::abs(b(a, c)) * strain_size[a][c];
        }
      EXPECT_NEAR(divergence[i], of_divergence, rounding * divergence_size);
      const double f = of_all.laplacian_factor[i];
      EXPECT_NEAR(-residual[i] / context.volume, -f * of_laplacian, rounding * f * laplacian_size);
      EXPECT_NEAR(y[i] / context.volume, -f * of_laplacian, rounding * f * laplacian_size);
      for (std::size_t a = 0; a < dims; ++a) {
        double sum = 0, size = 0;
        for (std::size_t c = 0; c < dims; ++c) {
          sum += b(a, c) * of_gradient[c];
          size += largest_b * gradient_size[c];
        }
        EXPECT_NEAR(gradient.component[a][i], sum, rounding * size);
      }
      // With friction.
      Vec3 of_stress{}, stress_size{};
      pair = 0;
      twin.sum(i, points, carried[1], true, [&](const Vec3& way, double r, const reference::Carried& other) {
        const double w = WendlandC2::w(r / twin.smoothing_length);
        double factor = 1;
        for (std::size_t a = 0; a < dims; ++a) factor += way[a] * of_all.offset.component[a][i];
        for (std::size_t a = 0; a < dims; ++a) {
          const double difference = other.velocity[a] - twin.value[i].velocity[a];
          const double size = std::abs(other.velocity[a]) + std::abs(twin.value[i].velocity[a]);
          of_stress[a] += f * w * factor * mu_ij[pair] * difference;
          stress_size[a] += f * w * std::abs(factor) * mu_ij[pair] * size;
          for (std::size_t c = 0; c < dims; ++c) strain[a][c] += w * way[c] * difference;
        }
        ++pair;
      });
      for (std::size_t a = 0; a < dims; ++a) {
        for (std::size_t c = 0; c < dims; ++c)
          for (std::size_t e = 0; e < dims; ++e) {
            of_stress[a] += b(a, e) * strain[c][e] * slope.component[c][i];
            stress_size[a] += largest_b * strain_size[c][e] * slope.component[c][i];
          }
        EXPECT_NEAR(viscous.component[a][i], of_stress[a], rounding * stress_size[a]);
      }
    }
  }
}

// Three layers at rest beside a wall of a body moved with 0.1 m/s where wall points had the colour of the nearest
// particle and the pressure of a fit.
TEST(GfdWalls, AUniformJumpIsBalancedByThePressureOfTheColour) {
  for (const Layout& layout : wall_layouts()) {
    SCOPED_TRACE(layout.name);
    Walled walled(layout.text);
    Arrangement& a = walled.arrangement;
    const int d = walled.particles.dimensions;
    const std::size_t n = walled.particles.size();
    std::vector<std::uint8_t> phase(n);
    Array<float> colour(n), density(n), potential(n);
    Array<double> pressure(n);
    potential.fill(3);
    for (std::size_t i = 0; i < n; ++i) {
      phase[i] = walled.place(i)[0] + 0.3 * walled.place(i)[1] > 0.02 ? 1 : 0;
      colour[i] = phase[i];
      density[i] = static_cast<float>(property(walled.place(i), 90));
      pressure[i] = 3 * double{colour[i]};
    }
    InterfaceBands bands;
    bands.build(a.context, a.grid, a.table, phase);
    Vectors force(n, d), gradient(n, d);
    const WalledStencils of_all(a.context, a.packed, n, d);
    const GfdStencils& stencils = of_all.read;
    for (auto& component : force.component) component.fill(0);
    interface_jump_sweep(a.context, a.packed, bands.varying(), {colour.data(), potential.data(), density.data()},
                         stencils, {force.out, nullptr});
    gfd_gradient_over_density_sweep(a.context, a.packed, pressure.data(), 0, {density.data(), bands.varies()},
                                    stencils.correction, gradient.out);
    double largest = 0, worst = 0;
    for (int axis = 0; axis < d; ++axis)
      for (std::size_t i = 0; i < n; ++i) {
        largest = std::max<double>(largest, std::abs(gradient.component[axis][i]));
        worst = std::max<double>(worst, std::abs(force.component[axis][i] - gradient.component[axis][i]));
      }
    // Sums of some hundred terms in single precision, which cancel to a tenth of the largest.
    EXPECT_LT(worst, 1e-4 * largest);
    EXPECT_GT(largest, 0);
  }
}

}  // namespace spume::test
