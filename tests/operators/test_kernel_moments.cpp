// SPDX-License-Identifier: MIT
// The kernel moments sweep against its slow twin, and what it gives on lattices and in degenerate arrangements.
#include <gtest/gtest.h>

#include "operators/sph_arrangement.hpp"

namespace spume::test {
namespace {

// The root mean square row of L beyond which the sweep uses the identity.
constexpr double largest_correction = 6;

TEST(KernelMoments, AgreesWithTheSlowTwinOnEveryArrangement) {
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const Moments fast(a);
    Comparison kernel("kernel sum"), trace("div r"), laplacian_diagonal("coupling"),
        concentration("concentration gradient"), normal("normal");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double rounding = a.twin.tolerance(i);
      kernel.add(fast.kernel_sum[i], a.twin.kernel_sum(i), rounding, i);
      trace.add(fast.divergence_of_position[i], a.twin.divergence_of_position(i), rounding, i);
      laplacian_diagonal.add(fast.laplacian_diagonal[i], a.twin.laplacian_diagonal(i), rounding, i);
      const auto c = a.twin.concentration_gradient(i, a.setup.spacing);
      const auto n = a.twin.normal(i);
      for (int axis = 0; axis < a.dimensions(); ++axis) {
        concentration.add(fast.concentration_gradient[axis][i], c[axis], rounding, i);
        normal.add(fast.normal[axis][i], n[axis], rounding, i);
      }
    }
  }
}

// |dL| <= |L|^2 |dM| to first order. Where |L| |dM| is not small, or the choice of the fallback hangs on rounding, only
// the choice itself is left open.
TEST(KernelMoments, CorrectionIsTheInverseOfTheMomentsOrTheIdentity) {
  std::size_t fallbacks = 0, inverses = 0;
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const Moments fast(a);
    Comparison correction("gradient correction");
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto slow = a.twin.correction(i, largest_correction);
      const auto moments = a.twin.moments(i);
      double moment_error = 0;
      for (const auto& row : moments)
        for (const Sum& m : row) moment_error += std::pow(m.magnitude * a.twin.tolerance(i), 2);
      moment_error = std::sqrt(moment_error);
      const double norm2 = a.dimensions() * slow.mean_square;
      const bool near_choice =
          std::abs(std::sqrt(slow.mean_square) / largest_correction - 1) < 2 * std::sqrt(norm2) * moment_error ||
          slow.determinant < 1e-6;
      if (near_choice) continue;
      EXPECT_EQ(fast.uncorrected[i], slow.corrected ? 0 : 1) << i;
      ++(slow.corrected ? inverses : fallbacks);
      const double bound = slow.corrected ? 2 * norm2 * moment_error + 1e-6 * std::sqrt(norm2) : 1e-12;
      const auto matrix = fast.correction_of(i, a.dimensions());
      for (int r = 0; r < a.dimensions(); ++r)
        for (int c = 0; c < a.dimensions(); ++c)
          correction.add_error(std::abs(matrix[r][c] - slow.inverse[r][c]), bound, matrix[r][c], slow.inverse[r][c], i);
    }
  }
  EXPECT_GT(inverses, 1000U);
  EXPECT_GT(fallbacks, 10U);
}

TEST(KernelMoments, TheInteriorWeightRisesOverItsWidth) {
  const InteriorWeight weight{1.5, 0.32};
  EXPECT_EQ(weight(1.49), 0);
  EXPECT_EQ(weight(1.82), 1);
  EXPECT_NEAR(weight(1.66), 0.5, 1e-6);
  EXPECT_NEAR(weight(1.5 + 0.08) + weight(1.82 - 0.08), 1, 1e-6);
  EXPECT_EQ(InteriorWeight{}(0), 1);
  EXPECT_EQ((InteriorWeight{1.5, 0}(1.5)), 1);
}

// b L + (1 - b) I, from the L, div r and normals of a sweep that does not fade: none in the bulk, all of it at an edge.
TEST(KernelMoments, CorrectionFadesWhereNeighboursAreMissingOnOneSide) {
  std::size_t whole = 0, between = 0, gone = 0, stretched = 0;
  for (Arrangement& a : all_arrangements()) {
    SCOPED_TRACE(a.setup.name);
    const int d = a.dimensions();
    const InteriorWeight weight{0.75 * d, 0.16 * d};
    const CorrectionFading fading = correction_fading(d, KernelKind::wendland_c2, 1.3, weight);
    const Moments plain(a), faded(a, true, true, fading);
    for (std::size_t i = 0; i < a.size(); ++i) {
      double squares = 0;
      for (int axis = 0; axis < d; ++axis) squares += std::pow(double{plain.normal[axis][i]}, 2);
      const double trace = plain.divergence_of_position[i];
      const double b = weight(std::max(trace, fading.bulk - fading.missing * std::sqrt(squares)));
      ++(b == 1 ? whole : b == 0 ? gone : between);
      stretched += b == 1 && weight(trace) < 1;
      const auto l = plain.correction_of(i, d), f = faded.correction_of(i, d);
      for (int r = 0; r < d; ++r)
        for (int c = 0; c < d; ++c) {
          const double expected = (r == c ? 1 - b : 0.0) + b * l[r][c];
          // Rounding of div r, to float, over the width of the weight, and of L.
          EXPECT_NEAR(f[r][c], expected, 1e-5 * (1 + std::abs(l[r][c]))) << i;
        }
    }
  }
  for (const std::size_t count : {whole, between, gone}) EXPECT_GT(count, 50U);
  EXPECT_GT(stretched, 0U);
}

// Upper layers of lattices: div r and h |m| agree by construction.
TEST(KernelMoments, FadingKnowsThePlaneSurface) {
  for (const int d : {2, 3}) {
    const CorrectionFading fading = correction_fading(d, KernelKind::wendland_c2, 1.3, {1.5, 0.32});
    const SurfaceLayer upper = lattice_surface(d, KernelKind::wendland_c2, 1.3)[0];
    EXPECT_NEAR(fading.bulk - fading.missing * upper.normal, upper.divergence_of_position, 1e-12);
    EXPECT_NEAR(fading.missing, d == 2 ? 1.19 : 1.51, 0.005);
  }
}

ArrangementSetup lattice_setup(int dimensions, int across, BoundaryKind last) {
  ArrangementSetup setup;
  setup.dimensions = dimensions;
  setup.spacing = 1.0 / across;
  setup.points = lattice_points(across, dimensions, 0);
  for (int axis = 0; axis + 1 < dimensions; ++axis) setup.set_sides(axis, BoundaryKind::periodic);
  setup.set_sides(dimensions - 1, last);
  return setup;
}

// The figures of the physics guide for the Wendland kernel at h / dr = 1.3.
TEST(KernelMoments, DivergenceOfPositionOnALatticeHasItsKnownValues) {
  EXPECT_NEAR(lattice_constants(3, KernelKind::wendland_c2, 1.3).divergence_of_position, 2.94, 0.005);
  Arrangement a(lattice_setup(3, 8, BoundaryKind::open));
  const Moments fast(a);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double layer = std::floor(std::min(a.hood.z[i], 1 - a.hood.z[i]) / a.setup.spacing);
    const double expected = layer == 0 ? 2.03 : layer == 1 ? 2.88 : 2.94;
    EXPECT_NEAR(fast.divergence_of_position[i], expected, 0.005) << "layer " << layer;
  }
}

TEST(KernelMoments, LatticeConstantsAreTheSumsOfAPeriodicLattice) {
  for (const int d : {2, 3})
    for (const KernelKind kernel : {KernelKind::wendland_c2, KernelKind::quintic_spline})
      for (const double ratio : {1.2, 1.3, 1.5}) {
        ArrangementSetup setup = lattice_setup(d, d == 2 ? 16 : 10, BoundaryKind::periodic);
        setup.kernel = kernel;
        setup.smoothing_ratio = ratio;
        Arrangement a(setup);
        const LatticeConstants constants = lattice_constants(d, kernel, ratio);
        // The lattice itself is rounded to the grid of 2^-20: 2^-21 / spacing relative, second order in symmetric sums.
        EXPECT_NEAR(a.twin.kernel_sum(0).value, constants.kernel_sum, 1e-4);
        EXPECT_NEAR(a.twin.divergence_of_position(0).value, constants.divergence_of_position, 1e-4);
        EXPECT_NEAR(a.twin.laplacian_diagonal(0).value * setup.spacing * setup.spacing, constants.laplacian_diagonal,
                    1e-3);
      }
}

// Neighbouring columns displaced by 1 % of the spacing in opposite directions: the wave that is taken back fastest.
TEST(KernelMoments, TheLargestStableShiftTurnsTheShortestWaveOfALatticeIntoItsNegative) {
  for (const int d : {2, 3})
    for (const bool without_mean : {false, true}) {
      ArrangementSetup setup = lattice_setup(d, d == 2 ? 16 : 10, BoundaryKind::periodic);
      const double displaced = 0.01 * setup.spacing;
      const auto side = [&](double x) { return std::lround(x / setup.spacing - 0.5) % 2 == 0 ? 1.0 : -1.0; };
      for (Point& point : setup.points) point[0] += displaced * side(point[0]);
      Arrangement a(setup);
      const Moments fast(a);
      VectorArrays<float> mean(a.size(), d);
      filter_vector(a.context, a.packed,
                    {fast.concentration_gradient[0].data(), fast.concentration_gradient[1].data(),
                     fast.concentration_gradient[2].data()},
                    a.reflection, mean.write());
      const double h = setup.smoothing_length();
      const double coefficient = largest_stable_shift(d, setup.kernel, setup.smoothing_ratio, without_mean);
      EXPECT_NEAR(coefficient, d == 2 ? (without_mean ? 0.4165 : 0.3490) : (without_mean ? 0.5266 : 0.4376), 1e-3);
      for (std::size_t i = 0; i < a.size(); ++i) {
        const double gradient = fast.concentration_gradient[0][i] - (without_mean ? mean[0][i] : 0.0F);
        // Of second order in the displacement, relative: 1e-4 times the fourth derivative of the kernel.
        ASSERT_NEAR(-coefficient * h * h * gradient, -2 * displaced * side(a.hood.x[i]), 0.02 * displaced) << i;
      }
    }
}

// Layers of a lattice between two open sides, deep enough that the sides do not see each other.
TEST(KernelMoments, LayersBelowASurfaceHaveTheSumsOfALattice) {
  for (const int d : {2, 3})
    for (const KernelKind kernel : {KernelKind::wendland_c2, KernelKind::quintic_spline}) {
      const int across = kernel == KernelKind::wendland_c2 ? 14 : 16;
      ArrangementSetup setup = lattice_setup(d, across, BoundaryKind::open);
      setup.kernel = kernel;
      Arrangement a(setup);
      const Moments fast(a);
      VectorArrays<float> filtered(a.size(), d);
      filter_vector(a.context, a.packed, {fast.normal[0].data(), fast.normal[1].data(), fast.normal[2].data()},
                    a.reflection, filtered.write());
      const auto layers = lattice_surface(d, kernel, setup.smoothing_ratio);
      const Array<double>& height = d == 3 ? a.hood.z : a.hood.y;
      for (std::size_t i = 0; i < a.size(); ++i) {
        const auto layer = static_cast<std::size_t>((1 - height[i]) * across);
        if (height[i] < 0.5 || layer >= layers.size()) continue;
        const SurfaceLayer& expected = layers[layer];
        ASSERT_NEAR(fast.divergence_of_position[i], expected.divergence_of_position, 1e-3) << layer;
        ASSERT_NEAR(fast.normal[d - 1][i], expected.normal, 1e-3) << layer;
        ASSERT_NEAR(-fast.concentration_gradient[d - 1][i] * setup.spacing, expected.concentration_gradient, 1e-3);
        ASSERT_NEAR(filtered[d - 1][i], expected.smoothed_normal, 1e-3) << layer;
      }
    }
}

TEST(KernelMoments, NormalsPointOutOfTheLiquidAndVanishInside) {
  Arrangement a(lattice_setup(3, 8, BoundaryKind::open));
  const Moments fast(a);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double layer = std::floor(std::min(a.hood.z[i], 1 - a.hood.z[i]) / a.setup.spacing);
    const double outward = a.hood.z[i] > 0.5 ? fast.normal[2][i] : -fast.normal[2][i];
    if (layer == 0) {
      EXPECT_GT(outward, 0.2);
    } else if (layer >= 2) {
      EXPECT_NEAR(outward, 0, 1e-5);
    }
    EXPECT_NEAR(fast.normal[0][i], 0, 1e-5);
    EXPECT_NEAR(fast.normal[1][i], 0, 1e-5);
  }
}

class FewParticles : public ::testing::TestWithParam<int> {};

TEST_P(FewParticles, OneAloneHasItsOwnKernelAndNothingElse) {
  ArrangementSetup setup;
  setup.dimensions = GetParam();
  setup.points = {{0.5, 0.5, setup.dimensions == 3 ? 0.5 : 0}};
  Arrangement a(setup);
  const Moments fast(a);
  const double centre = a.twin.kernel_sum(0).value;
  EXPECT_NEAR(fast.kernel_sum[0], centre, 1e-6 * centre);
  EXPECT_EQ(fast.divergence_of_position[0], 0);
  EXPECT_EQ(fast.laplacian_diagonal[0], 0);
  EXPECT_EQ(fast.uncorrected[0], 1);
  const auto identity = fast.correction_of(0, setup.dimensions);
  for (int r = 0; r < setup.dimensions; ++r)
    for (int c = 0; c < setup.dimensions; ++c) EXPECT_EQ(identity[r][c], r == c ? 1 : 0);
  for (int axis = 0; axis < setup.dimensions; ++axis) {
    EXPECT_EQ(fast.normal[axis][0], 0);
    EXPECT_EQ(fast.concentration_gradient[axis][0], 0);
  }
}

TEST_P(FewParticles, TwoInOnePlaceStayFinite) {
  ArrangementSetup setup;
  setup.dimensions = GetParam();
  setup.points.assign(2, {0.5, 0.5, setup.dimensions == 3 ? 0.5 : 0});
  for (const KernelKind kernel : {KernelKind::wendland_c2, KernelKind::quintic_spline}) {
    setup.kernel = kernel;
    Arrangement a(setup);
    const Moments fast(a);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(fast.kernel_sum[i], a.twin.kernel_sum(i).value, 1e-6 * a.twin.kernel_sum(i).value);
      EXPECT_NEAR(fast.laplacian_diagonal[i], a.twin.laplacian_diagonal(i).value,
                  1e-5 * a.twin.laplacian_diagonal(i).value);
      EXPECT_EQ(fast.divergence_of_position[i], 0);
      EXPECT_EQ(fast.uncorrected[i], 1);
      for (int axis = 0; axis < setup.dimensions; ++axis) EXPECT_EQ(fast.concentration_gradient[axis][i], 0);
    }
  }
}

TEST_P(FewParticles, NoneAtAllIsNoError) {
  ArrangementSetup setup;
  setup.dimensions = GetParam();
  Arrangement a(setup);
  const Moments fast(a);
  EXPECT_TRUE(fast.kernel_sum.empty());
}

INSTANTIATE_TEST_SUITE_P(Dimensions, FewParticles, ::testing::Values(2, 3));

}  // namespace
}  // namespace spume::test
