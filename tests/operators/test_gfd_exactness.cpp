// SPDX-License-Identifier: MIT
// What generalised finite differences give exactly, up to rounding: constants, linear and quadratic fields, limits of
// one operator in another, bits; and how fast they converge on Franke's function.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>

#include "operators/franke.hpp"
#include "operators/gfd_arrangement.hpp"
#include "spume/operators/gfd_gradient.hpp"
#include "spume/operators/gfd_laplacian.hpp"
#include "spume/operators/gfd_pressure.hpp"
#include "spume/operators/sph_diffusion.hpp"

namespace spume::test {
namespace {

// Images do not continue a polynomial: only particles that see none are asked.
bool sees_image(const Arrangement& a, std::size_t i) {
  const auto listed = a.hood.list.of(i);
  return std::any_of(listed.begin(), listed.end(),
                     [&](std::int32_t j) { return static_cast<std::size_t>(j) >= a.size(); });
}

// The rounding of sums of differences and, to first order, that of the stencil they meet.
double exactness_bound(double slope_bound, const Sum& slow, double tolerance) {
  return slope_bound + tolerance * slow.magnitude;
}

TEST(GfdExactness, GradientOfALinearFieldIsExactAndItsLaplacianZero) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils stencils(a);
    const GfdSums& twin = gfd_twin(a);
    const int d = a.dimensions();
    const reference::Vector slope{2, -3, 1.5};
    const auto f = a.sample([&](const Point& p) {
      double sum = 5;
      for (int axis = 0; axis < d; ++axis) sum += slope[axis] * (p[axis] - 0.5);
      return sum;
    });
    Array<float> laplacian(a.size());
    VectorArrays<float> gradient(a.size(), d);
    gfd_laplacian_sweep(a.context, a.packed, f.data(), 5, stencils.read(), {laplacian.data(), gradient.write()});
    const GfdSums::AtPoint value = [&](const GfdSums::SphPoint& p) { return f[p.source] - 5; };
    Comparison gradients("gradient of a linear field"), laplacians("Laplacian of a linear field");
    std::size_t asked = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (stencils.fallback[i] != GfdFallback::none || sees_image(a, i)) continue;
      const auto bound = twin.stencil(i, 6, 0.1).bound;
      const auto m = twin.moments(i);
      const auto slow = twin.gradient(i, value, GfdSums::one, stencils.of(i).correction);
      // dB times the sum, which is B^-1 times the slope; do on sum W (f_j - f_i) r.
      double sums_of_offset = 0;
      for (int r = 0; r < d; ++r) {
        double of_stencil = 0;
        for (int c = 0; c < d; ++c)
          for (int e = 0; e < d; ++e) {
            of_stencil += bound.correction[r][c] * std::abs(m.second[c][e].value * slope[e]);
            sums_of_offset += bound.offset[c] / d * std::abs(m.second[c][e].value * slope[e]);
          }
        gradients.add_error(std::abs(gradient[r][i] - slope[r]),
                            exactness_bound(of_stencil, slow[r], twin.tolerance(i)), gradient[r][i], slope[r], i);
      }
      const Sum sum = twin.laplacian(i, value, GfdSums::one, stencils.of(i));
      laplacians.add_error(std::abs(laplacian[i]),
                           exactness_bound(stencils.laplacian_factor[i] * sums_of_offset, sum, twin.tolerance(i)),
                           laplacian[i], 0, i);
      ++asked;
    }
    EXPECT_TRUE(asked > 0 || a.setup.boundaries.sides[0][0] != BoundaryKind::open);
  });
}

// On a lattice o = 0 and sum W d_a d_b = 0, a != b: any quadratic field gives its Laplacian.
TEST(GfdExactness, LaplacianOfAQuadraticFieldOnALatticeIsExact) {
  for (const int d : {2, 3})
    for (const KernelKind kernel : {KernelKind::wendland_c2, KernelKind::quintic_spline}) {
      ArrangementSetup setup;
      setup.dimensions = d;
      setup.kernel = kernel;
      setup.spacing = 1.0 / 16;  // a power of two: the lattice is one in floats
      setup.points = lattice_points(16, d, 0);
      Arrangement a(setup);
      const Stencils stencils(a);
      const GfdSums twin(a.twin);
      const auto f = a.sample([&](const Point& p) {
        return 2 * p[0] * p[0] - 0.5 * p[1] * p[1] + p[2] * p[2] + 3 * p[0] * p[1] - p[1] * p[2] + p[0] - 1;
      });
      const double exact = d == 2 ? 3 : 5;
      Array<float> laplacian(a.size());
      gfd_laplacian_sweep(a.context, a.packed, f.data(), 0, stencils.read(), {laplacian.data(), {}});
      Comparison comparison("Laplacian of a quadratic field");
      const GfdSums::AtPoint value = [&](const GfdSums::SphPoint& p) { return f[p.source]; };
      std::size_t asked = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        const Point p{a.hood.x[i], a.hood.y[i], a.hood.z[i]};
        bool inside = true;
        for (int axis = 0; axis < d; ++axis)
          inside = inside && std::abs(p[axis] - 0.5) + a.setup.rules().support_radius < 0.5;
        if (!inside) continue;
        ++asked;
        const Sum slow = twin.laplacian(i, value, GfdSums::one, stencils.of(i));
        const auto bound = twin.stencil(i, 6, 0.1).bound;
        // Of the factor. The worst rounding of the sum is its part of 1 / spacing^2 times the field.
        const double of_stencil = bound.laplacian_factor / stencils.laplacian_factor[i] * exact;
        comparison.add_error(std::abs(laplacian[i] - exact), of_stencil + twin.tolerance(i) * slow.magnitude,
                             laplacian[i], exact, i);
        // The bound can tell.
        EXPECT_LT(of_stencil + twin.tolerance(i) * slow.magnitude, 0.1 * exact);
      }
      EXPECT_GT(asked, 0U);
    }
}

// Every difference of a constant is zero, and of a velocity that walls share.
TEST(GfdExactness, ConstantsGiveExactlyZero) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils stencils(a);
    const int d = a.dimensions();
    const Array<double> values(a.size(), 1.0 / 3);
    const RandomProperty density(a, 151);
    Array<float> laplacian(a.size());
    VectorArrays<float> gradient(a.size(), d), weighted(a.size(), d), force(a.size(), d);
    gfd_laplacian_sweep(a.context, a.packed, values.data(), 0.1, stencils.read(), {laplacian.data(), gradient.write()});
    gfd_gradient_over_density_sweep(a.context, a.packed, values.data(), 0.1, density.read(), stencils.read().correction,
                                    weighted.write());
    VectorArrays<double> rest(a.size(), d);
    gfd_stress_sweep(a.context, a.packed, rest.read(), {a.rule.sign, {}}, stencils.read(), MomentumDiffusion::split,
                     {density.read(), nullptr, weighted.read()}, force.write());
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_EQ(laplacian[i], 0);
      for (int axis = 0; axis < d; ++axis) {
        ASSERT_EQ(gradient[axis][i], 0);
        ASSERT_EQ(weighted[axis][i], 0);
        ASSERT_EQ(force[axis][i], 0);
      }
    }
  });
}

// With equal volumes (13) is the div-grad of the SPH operators; with a uniform viscosity all forms are mu <lap u>.
TEST(GfdExactness, OperatorsAgreeWhereTheirFormsDo) {
  for_every_equal_arrangement([&](Arrangement& a) {
    const Stencils stencils(a);
    const GfdSums& twin = gfd_twin(a);
    const int d = a.dimensions();
    const auto u = random_velocity(a, 161);
    const RandomProperty viscosity(a, 164);
    const Array<std::uint8_t> everywhere(a.size(), 1);
    const Array<float> volume(a.size(), static_cast<float>(a.context.volume)), uniform_viscosity(a.size(), 0.1F),
        no_gradient(a.size(), 0.0F);
    VectorArrays<float> hu_adams(a.size(), d), sph(a.size(), d), plain(a.size(), d), split(a.size(), d);
    hu_adams_sweep(a.context, a.packed, u.read(), a.rule, volume.data(),
                   {{viscosity.value.data(), everywhere.data()}, nullptr, {}}, hu_adams.write());
    viscous_sweep(a.context, a.packed, u.read(), a.rule, viscosity.value.data(), sph.write());
    const std::array<const float*, 3> zero{no_gradient.data(), no_gradient.data(), no_gradient.data()};
    gfd_stress_sweep(a.context, a.packed, u.read(), a.rule, stencils.read(), MomentumDiffusion::laplacian,
                     {{uniform_viscosity.data(), nullptr}, nullptr, {}}, plain.write());
    Comparison diffusion("Hu and Adams"), forms("uniform viscosity");
    for (const auto form : {MomentumDiffusion::split, MomentumDiffusion::printed, MomentumDiffusion::mu_laplacian}) {
      gfd_stress_sweep(a.context, a.packed, u.read(), a.rule, stencils.read(), form,
                       {{uniform_viscosity.data(), everywhere.data()}, nullptr, zero}, split.write());
      for (std::size_t i = 0; i < a.size(); ++i) {
        const auto slow = twin.stress(i, form, u, uniform_viscosity, 1, false, {}, stencils.of(i));
        for (int axis = 0; axis < d; ++axis)
          forms.add(split[axis][i], {plain[axis][i], 2 * slow[axis].magnitude}, twin.tolerance(i), i);
      }
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto slow = twin.hu_adams(i, u, viscosity.value, volume, 1, true);
      for (int axis = 0; axis < d; ++axis)
        diffusion.add(hu_adams[axis][i], {sph[axis][i], 2 * slow[axis].magnitude}, twin.tolerance(i), i);
    }
  });
}

TEST(GfdExactness, BitsDoNotDependOnTheNumberOfThreads) {
  ArrangementSetup setup;
  setup.dimensions = 3;
  setup.spacing = 1.0 / 16;
  setup.points = lattice_points(16, 3, 0.4);
  for (int axis = 0; axis < 3; ++axis) setup.set_sides(axis, BoundaryKind::periodic);
  Arrangement a(setup);
  const auto u = random_velocity(a, 171);
  const RandomProperty viscosity(a, 174);
  const auto x = to_float(a.random(175));
  const int threads = omp_get_max_threads();
  struct Results {
    VectorArrays<float> force;
    Array<float> product;
    Dots dots;
  };
  const auto run = [&](int count) {
    omp_set_num_threads(count);
    const Stencils stencils(a);
    Results results{VectorArrays<float>(a.size(), 3), Array<float>(a.size()), {}};
    gfd_stress_sweep(a.context, a.packed, u.read(), a.rule, stencils.read(), MomentumDiffusion::split,
                     {viscosity.read(), nullptr, stencils.offset.read()}, results.force.write());
    GfdPressureOperator pressure;
    pressure.bind(a.context, a.packed, {stencils.read(), viscosity.read(), nullptr, nullptr});
    results.dots = pressure.apply(x, results.product, x);
    return results;
  };
  const Results one = run(1), three = run(3);
  omp_set_num_threads(threads);
  EXPECT_EQ(one.dots.wy, three.dots.wy);
  EXPECT_EQ(one.dots.yy, three.dots.yy);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_TRUE(std::equal(one.force[axis].begin(), one.force[axis].end(), three.force[axis].begin()));
  EXPECT_TRUE(std::equal(one.product.begin(), one.product.end(), three.product.begin()));
}

// Joubert et al., section 3.1: n by n points of the unit square and more around them, displaced by up to c spacings;
// the quintic spline with a support of 2.5 + 2 c spacings. Normalised root mean squares (27) over the unit square.
struct FrankeErrors {
  double laplacian, gradient, sph;
  double scaled_laplacian, gfd_means;  // of eta lap f, eta = 1 + x / 2 + y / 2: by eta <lap f>, by <eta lap f>
};

FrankeErrors franke_errors(int n, double c) {
  ArrangementSetup setup;
  setup.kernel = KernelKind::quintic_spline;
  setup.spacing = 1.0 / (n - 1);
  setup.smoothing_ratio = (2.5 + 2 * c) / 3;
  const int around = 3;
  for (int j = -around; j < n + around; ++j)
    for (int i = -around; i < n + around; ++i) {
      const Point r = uniform(setup.points.size(), 5);
      setup.points.push_back({(i + c * (2 * r[0] - 1)) * setup.spacing, (j + c * (2 * r[1] - 1)) * setup.spacing, 0});
    }
  Arrangement a(setup);
  const Stencils stencils(a);
  VectorArrays<double> f(a.size(), 2);
  f[0] = a.sample([](const Point& p) { return Franke(p[0], p[1]).value; });
  const auto eta = to_float(a.sample([](const Point& p) { return 1 + p[0] / 2 + p[1] / 2; }));
  const Array<float> one(a.size(), 1.0F), volume(a.size(), static_cast<float>(a.context.volume));
  const Array<std::uint8_t> everywhere(a.size(), 1);
  Array<float> laplacian(a.size());
  VectorArrays<float> gradient(a.size(), 2), sph(a.size(), 2), means(a.size(), 2);
  gfd_laplacian_sweep(a.context, a.packed, f[0].data(), 0.5, stencils.read(), {laplacian.data(), gradient.write()});
  hu_adams_sweep(a.context, a.packed, f.read(), a.rule, volume.data(), {{one.data(), nullptr}, nullptr, {}},
                 sph.write());
  gfd_stress_sweep(a.context, a.packed, f.read(), a.rule, stencils.read(), MomentumDiffusion::mu_laplacian,
                   {{eta.data(), everywhere.data()}, nullptr, {}}, means.write());
  struct Error {
    double error = 0, size = 0;
    void add(double value, double exact) {
      error += (value - exact) * (value - exact);
      size += exact * exact;
    }
    double relative() const { return std::sqrt(error / size); }
  } of_laplacian, of_gradient, of_sph, of_scaled, of_means;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = a.hood.x[i], y = a.hood.y[i], outside = 0.4 * setup.spacing;
    if (std::min(x, y) < -outside || std::max(x, y) > 1 + outside) continue;
    const Franke exact(x, y);
    of_laplacian.add(laplacian[i], exact.laplacian);
    for (int axis = 0; axis < 2; ++axis) of_gradient.add(gradient[axis][i], exact.gradient[axis]);
    of_sph.add(sph[0][i], exact.laplacian);
    of_scaled.add(eta[i] * laplacian[i], eta[i] * exact.laplacian);
    of_means.add(means[0][i], eta[i] * exact.laplacian);
  }
  return {of_laplacian.relative(), of_gradient.relative(), of_sph.relative(), of_scaled.relative(),
          of_means.relative()};
}

// Rows of f, f_x, f_y and the Laplacian by computer algebra.
TEST(GfdConvergence, FrankesFunctionIsThatOfTheTable) {
  const Franke origin(0, 0), other(0, 0.4);
  EXPECT_NEAR(origin.value, 0.766420591285, 1e-12);
  EXPECT_NEAR(origin.gradient[0], 0.669265191439, 1e-12);
  EXPECT_NEAR(origin.gradient[1], 0.315089577179, 1e-12);
  EXPECT_NEAR(origin.laplacian, 6.65190193611, 1e-10);
  EXPECT_NEAR(other.value, 0.609385377372, 1e-12);
  EXPECT_NEAR(other.gradient[0], 1.1390225958, 1e-10);
  EXPECT_NEAR(other.gradient[1], -1.46500647541, 1e-10);
  EXPECT_NEAR(other.laplacian, 6.44860611252, 1e-10);
}

// Errors that an independent script found on these lattices in double. Differences of floats add rounding of
// 2^-24 4 / spacing^2 = 6e-3 of 50 at 161 points, 1e-4 in quadrature with 9e-4.
TEST(GfdConvergence, OnLatticesIsOfSecondOrderAndSphSaturates) {
  const int points[] = {21, 41, 81, 161};
  const double laplacian[] = {0.052828274, 0.013909881, 0.003525227, 0.00088439755};
  // With the positions in floats the last one of SPH is a lattice only within 1e-4 spacings.
  const double sph[] = {0.058536948, 0.01860992, 0.0083435313};
  double gradient = 0;
  for (int k = 0; k < 4; ++k) {
    const FrankeErrors errors = franke_errors(points[k], 0);
    EXPECT_NEAR(errors.laplacian, laplacian[k], 0.01 * laplacian[k]);
    if (k < 3) {
      EXPECT_NEAR(errors.sph, sph[k], 0.01 * sph[k]);
    } else {
      EXPECT_GT(errors.sph, 0.5 * sph[2]);
    }
    if (k > 0) {
      const double order = std::log2(gradient / errors.gradient);
      EXPECT_GT(order, 1.9);
      EXPECT_LT(order, 2.1);
    }
    gradient = errors.gradient;
  }
}

// With points displaced at random the gradient is of first order at least, the Laplacian has a floor of 0.03 and that
// of SPH grows as 1 / spacing. eta <lap f> is closer to eta lap f than <eta lap f>, which stands for div(eta grad f).
TEST(GfdConvergence, OnDisplacedPointsTheLaplacianHasAFloorAndThatOfSphGrows) {
  const FrankeErrors coarse = franke_errors(41, 0.1), middle = franke_errors(81, 0.1), fine = franke_errors(161, 0.1);
  EXPECT_GT(std::log2(coarse.gradient / middle.gradient), 1);
  EXPECT_GT(std::log2(middle.gradient / fine.gradient), 1);
  EXPECT_NEAR(middle.laplacian, 0.029, 0.001);
  EXPECT_NEAR(fine.laplacian, 0.029, 0.001);
  EXPECT_NEAR(middle.sph / coarse.sph, 2, 0.2);
  EXPECT_NEAR(fine.sph / middle.sph, 2, 0.1);
  for (const FrankeErrors& errors : {coarse, middle, fine}) EXPECT_LT(errors.scaled_laplacian, errors.gfd_means);
}

}  // namespace
}  // namespace spume::test
