// SPDX-License-Identifier: MIT
// What the operators give exactly, up to rounding: linear fields, constants, conservation, invariance, bits.
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>

#include "operators/sph_arrangement.hpp"
#include "spume/operators/pressure_operator.hpp"

namespace spume::test {
namespace {

// L M = 1 in rounded arithmetic: |L| |dM| on the slope, plus the rounding of the sum itself.
double linear_bound(const Arrangement& a, const Geometry& geometry, std::size_t i, double slope) {
  const auto l = geometry.correction_of(i, a.dimensions());
  const auto m = a.twin.moments(i);
  double norm_l = 0, norm_m = 0;
  for (int r = 0; r < a.dimensions(); ++r)
    for (int c = 0; c < a.dimensions(); ++c) {
      norm_l += l[r][c] * l[r][c];
      norm_m += m[r][c].magnitude * m[r][c].magnitude;
    }
  return 3 * std::sqrt(norm_l * norm_m) * reference::tolerance(a.twin.neighbours(i)) * slope;
}

TEST(SphExactness, CorrectedGradientOfALinearFieldIsExactAlsoAtSurfaces) {
  for (Arrangement& a : all_arrangements()) {
    // Images do not continue a linear field: only particles that see none are asked.
    SCOPED_TRACE(a.setup.name);
    const Geometry geometry(a);
    const int d = a.dimensions();
    const reference::Vector slope{2, -3, 1.5};
    auto values = a.sample([&](const Point& p) {
      double sum = 5;
      for (int axis = 0; axis < d; ++axis) sum += slope[axis] * (p[axis] - 0.5);
      return sum;
    });
    VectorArrays<float> fast(a.size(), d);
    gradient_sweep(a.context, a.records, values.data(), 5, geometry.read_correction(), fast.write());
    Comparison comparison("gradient of a linear field");
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (geometry.uncorrected[i] != 0) continue;
      bool sees_image = false;
      for (const std::int32_t j : a.hood.list.of(i)) sees_image = sees_image || static_cast<std::size_t>(j) >= a.size();
      if (sees_image) continue;
      const auto slow = a.twin.gradient(i, values, 5, geometry.correction_of(i, d));
      for (int axis = 0; axis < d; ++axis) {
        const double bound =
            linear_bound(a, geometry, i, 4) + reference::tolerance(a.twin.neighbours(i)) * slow[axis].magnitude;
        comparison.add_error(std::abs(fast[axis][i] - slope[axis]), bound, fast[axis][i], slope[axis], i);
      }
    }
  }
}

TEST(SphExactness, ConstantFieldsGiveExactlyZero) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const Geometry geometry(a);
    const int d = a.dimensions();
    const Array<double> values(a.size(), 1.0 / 3);
    Array<float> kappa(a.size(), 0.1F), laplacian(a.size());
    VectorArrays<float> gradient(a.size(), d);
    gradient_sweep(a.context, a.records, values.data(), 0.1, geometry.read_correction(), gradient.write());
    Array<double> divergence(a.size());
    VectorArrays<double> rest(a.size(), d);
    divergence_sweep(a.context, a.records, rest.read(), {a.rule.sign, {}}, geometry.read_correction(), values.data(),
                     divergence.data(), laplacian.data());
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (int axis = 0; axis < d; ++axis) ASSERT_EQ(gradient[axis][i], 0);
      ASSERT_EQ(laplacian[i], 0);
      ASSERT_EQ(divergence[i], 0);
    }
    // A Shepard filter keeps a constant to the rounding of its weights.
    const Array<float> constant(a.size(), 0.7F);
    Array<float> filtered(a.size());
    const std::array<const float*, 1> in{constant.data()};
    const std::array<float*, 1> out{filtered.data()};
    filter_scalars(a.context, a.records, in, out);
    for (std::size_t i = 0; i < a.size(); ++i)
      ASSERT_NEAR(filtered[i], 0.7F, reference::tolerance(a.twin.neighbours(i)));
  }
}

// A solid body that the walls follow has no strain: images of a uniform velocity at walls moving with it are uniform.
TEST(SphExactness, WallsThatMoveWithTheLiquidExertNothing) {
  for (const int d : {2, 3}) {
    ArrangementSetup setup;
    setup.dimensions = d;
    setup.spacing = d == 2 ? 1.0 / 16 : 1.0 / 7;
    setup.points = lattice_points(d == 2 ? 16 : 7, d, 0.5);
    const Vec3 velocity{0.5, -0.25, d == 3 ? 0.125 : 0};
    for (int axis = 0; axis < d; ++axis) {
      setup.set_sides(axis, axis == 1 ? BoundaryKind::free_slip : BoundaryKind::no_slip);
      setup.boundaries.wall[axis] = {velocity, velocity};
    }
    Arrangement a(setup);
    const Geometry geometry(a);
    VectorArrays<double> u(a.size(), d);
    for (int axis = 0; axis < d; ++axis) u[axis].fill(velocity[axis]);
    const Array<float> kappa(a.size(), 1.0F);
    VectorArrays<float> force(a.size(), d);
    viscous_sweep(a.context, a.records, u.read(), a.rule, kappa.data(), force.write());
    Array<double> divergence(a.size());
    divergence_sweep(a.context, a.records, u.read(), a.rule, geometry.read_correction(), nullptr, divergence.data(),
                     nullptr);
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(divergence[i], 0);
      for (int axis = 0; axis < d; ++axis) ASSERT_EQ(force[axis][i], 0);
    }
  }
}

// Each pair exchanges equal and opposite momentum up to rounding.
TEST(SphExactness, ViscousForcesSumToZeroInAPeriodicBox) {
  for (Arrangement& a : all_arrangements()) {
    if (a.setup.boundaries.sides[0][0] != BoundaryKind::periodic ||
        a.setup.boundaries.sides[a.dimensions() - 1][0] != BoundaryKind::periodic)
      continue;
    SCOPED_TRACE(a.setup.name);
    VectorArrays<double> u;
    for (int axis = 0; axis < a.dimensions(); ++axis) u[axis] = a.random(90 + static_cast<std::uint32_t>(axis));
    Array<float> kappa(a.size());
    const auto random = a.random(94);
    for (std::size_t i = 0; i < a.size(); ++i) kappa[i] = static_cast<float>(1.1 + random[i]);
    VectorArrays<float> force(a.size(), a.dimensions());
    viscous_sweep(a.context, a.records, u.read(), a.rule, kappa.data(), force.write());
    for (int axis = 0; axis < a.dimensions(); ++axis) {
      double sum = 0, size = 0, bound = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        sum += force[axis][i];
        size += std::abs(force[axis][i]);
        bound += reference::tolerance(a.twin.neighbours(i)) * a.twin.viscous(i, u, kappa)[axis].magnitude;
      }
      EXPECT_LE(std::abs(sum), bound);
      EXPECT_LT(bound, 1e-2 * size) << "the bound can tell";
    }
  }
}

// The same field, with a quarter turn of positions and vectors.
TEST(SphExactness, AQuarterTurnTurnsTheResults) {
  ArrangementSetup setup;
  setup.points = on_float_grid(lattice_points(16, 2, 0.5));
  ArrangementSetup turned = setup;
  for (Point& p : turned.points) p = {1 - p[1], p[0], 0};
  Arrangement a(setup), b(turned);
  // Particles are sorted by cell: found again by position.
  std::vector<std::size_t> partner(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < b.size(); ++k)
      if (b.hood.x[k] == 1 - a.hood.y[i] && b.hood.y[k] == a.hood.x[i]) partner[i] = k;
  const Geometry ga(a), gb(b);
  VectorArrays<double> u(a.size(), 2), v(b.size(), 2);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = a.hood.x[i], y = a.hood.y[i];
    u[0][i] = std::sin(3 * x) * y;
    u[1][i] = std::cos(2 * y + x);
    v[0][partner[i]] = -u[1][i];
    v[1][partner[i]] = u[0][i];
  }
  Array<double> div_a(a.size()), div_b(b.size());
  divergence_sweep(a.context, a.records, u.read(), a.rule, ga.read_correction(), nullptr, div_a.data(), nullptr);
  divergence_sweep(b.context, b.records, v.read(), b.rule, gb.read_correction(), nullptr, div_b.data(), nullptr);
  const Array<float> kappa(a.size(), 1.0F);
  VectorArrays<float> force_a(a.size(), 2), force_b(b.size(), 2);
  viscous_sweep(a.context, a.records, u.read(), a.rule, kappa.data(), force_a.write());
  viscous_sweep(b.context, b.records, v.read(), b.rule, kappa.data(), force_b.write());
  Comparison divergence("divergence"), force("viscous force"), normal("normal");
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t k = partner[i];
    const double eps = 2 * reference::tolerance(a.twin.neighbours(i));
    const auto slow = a.twin.divergence(i, u, ga.correction_of(i, 2));
    // L differs between the two by its own rounding, amplified by its norm.
    const double bound = eps * slow.magnitude + linear_bound(a, ga, i, 2 * slow.magnitude);
    divergence.add_error(std::abs(div_a[i] - div_b[k]), bound, div_b[k], div_a[i], i);
    const auto viscous = a.twin.viscous(i, u, kappa);
    force.add_error(std::abs(force_b[0][k] + force_a[1][i]), eps * viscous[1].magnitude, force_b[0][k], -force_a[1][i],
                    i);
    force.add_error(std::abs(force_b[1][k] - force_a[0][i]), eps * viscous[0].magnitude, force_b[1][k], force_a[0][i],
                    i);
    const auto n = a.twin.normal(i);
    normal.add_error(std::abs(gb.normal[0][k] + ga.normal[1][i]), eps * n[1].magnitude, gb.normal[0][k],
                     -ga.normal[1][i], i);
    normal.add_error(std::abs(gb.normal[1][k] - ga.normal[0][i]), eps * n[0].magnitude, gb.normal[1][k],
                     ga.normal[0][i], i);
  }
}

// A uniform velocity that floats represent together with the field shifts no difference.
TEST(SphExactness, AUniformVelocityChangesNoDerivative) {
  for (Arrangement& a : all_arrangements()) {
    bool walls = !a.setup.boxes.empty();
    for (int axis = 0; axis < a.dimensions(); ++axis)
      for (const BoundaryKind kind : a.setup.boundaries.sides[axis])
        walls = walls || kind == BoundaryKind::free_slip || kind == BoundaryKind::no_slip;
    if (walls) continue;
    SCOPED_TRACE(a.setup.name);
    const Geometry geometry(a);
    const int d = a.dimensions();
    VectorArrays<double> u, v;
    for (int axis = 0; axis < d; ++axis) {
      u[axis] = a.random(100 + static_cast<std::uint32_t>(axis));
      for (double& x : u[axis]) x = std::round(x * 4096) / 4096;
      v[axis] = u[axis];
      for (double& x : v[axis]) x += 8;
    }
    const Array<float> kappa(a.size(), 1.0F);
    VectorArrays<float> first(a.size(), d), second(a.size(), d);
    viscous_sweep(a.context, a.records, u.read(), a.rule, kappa.data(), first.write());
    viscous_sweep(a.context, a.records, v.read(), a.rule, kappa.data(), second.write());
    Array<double> div_u(a.size()), div_v(a.size());
    divergence_sweep(a.context, a.records, u.read(), a.rule, geometry.read_correction(), nullptr, div_u.data(),
                     nullptr);
    divergence_sweep(a.context, a.records, v.read(), a.rule, geometry.read_correction(), nullptr, div_v.data(),
                     nullptr);
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(div_u[i], div_v[i]);
      for (int axis = 0; axis < d; ++axis) ASSERT_EQ(first[axis][i], second[axis][i]);
    }
  }
}

struct AllResults {
  Geometry geometry;
  VectorArrays<float> viscous, gradient;
  Array<double> divergence, residual;
  Array<float> laplacian, product;
  Dots dots;
};

AllResults run_all(Arrangement& a) {
  const std::size_t n = a.size();
  const int d = a.dimensions();
  a.records.invalidate();
  AllResults r{Geometry(a), {n, d}, {n, d}, Array<double>(n), Array<double>(n), Array<float>(n), Array<float>(n), {}};
  VectorArrays<double> u;
  for (int axis = 0; axis < d; ++axis) u[axis] = a.random(110 + static_cast<std::uint32_t>(axis));
  const auto q = a.random(115);
  Array<float> kappa(n, 1.0F), x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = static_cast<float>(q[i]);
  viscous_sweep(a.context, a.records, u.read(), a.rule, kappa.data(), r.viscous.write());
  gradient_sweep(a.context, a.records, q.data(), 0, r.geometry.read_correction(), r.gradient.write());
  divergence_sweep(a.context, a.records, u.read(), a.rule, r.geometry.read_correction(), q.data(), r.divergence.data(),
                   r.laplacian.data());
  PressureOperator matrix;
  matrix.bind(a.context, a.records, {kappa.data(), nullptr});
  r.dots = matrix.apply(x, r.product, x);
  matrix.residual(q, u[0], r.residual);
  return r;
}

template <class T>
bool same_bits(const Array<T>& a, const Array<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

TEST(SphExactness, OneTwoAndThreeThreadsGiveTheSameBits) {
  const int threads = omp_get_max_threads();
  // Enough particles for several blocks of 256 and 512.
  for (const int d : {2, 3}) {
    ArrangementSetup setup;
    setup.dimensions = d;
    setup.spacing = d == 2 ? 1.0 / 50 : 1.0 / 14;
    setup.points = lattice_points(d == 2 ? 50 : 14, d, 0.5);
    setup.set_sides(0, BoundaryKind::periodic);
    setup.set_sides(1, BoundaryKind::no_slip);
    Arrangement a(setup);
    omp_set_num_threads(1);
    const AllResults one = run_all(a);
    for (const int count : {2, 3}) {
      omp_set_num_threads(count);
      const AllResults more = run_all(a);
      EXPECT_TRUE(same_bits(one.geometry.kernel_sum, more.geometry.kernel_sum));
      for (int k = 0; k < 6; ++k) EXPECT_TRUE(same_bits(one.geometry.correction[k], more.geometry.correction[k]));
      for (int axis = 0; axis < d; ++axis) {
        EXPECT_TRUE(same_bits(one.geometry.normal[axis], more.geometry.normal[axis]));
        EXPECT_TRUE(same_bits(one.viscous[axis], more.viscous[axis]));
        EXPECT_TRUE(same_bits(one.gradient[axis], more.gradient[axis]));
      }
      EXPECT_TRUE(same_bits(one.divergence, more.divergence));
      EXPECT_TRUE(same_bits(one.laplacian, more.laplacian));
      EXPECT_TRUE(same_bits(one.product, more.product));
      EXPECT_TRUE(same_bits(one.residual, more.residual));
      EXPECT_EQ(one.dots.wy, more.dots.wy);
      EXPECT_EQ(one.dots.yy, more.dots.yy);
    }
    omp_set_num_threads(threads);
  }
}

}  // namespace
}  // namespace spume::test
