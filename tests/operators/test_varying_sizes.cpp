// SPDX-License-Identifier: MIT
// Lists of particles of different sizes, and what the weights of their pressure matrix are for. The sweeps over them
// are compared with the slow twins beside those over equal particles.
#include <gtest/gtest.h>

#include <cmath>

#include "operators/sph_arrangement.hpp"

namespace spume::test {
namespace {

TEST(VaryingSizes, ListsHoldWhatIsWithinTheSupportOfEach) {
  for (const Arrangement& a : all_arrangements()) {
    if (!a.setup.sizes) continue;
    for (std::size_t i = 0; i < a.size(); ++i)
      ASSERT_EQ(static_cast<std::size_t>(a.hood.list.count(i)), a.twin.neighbours(i)) << a.setup.name << ", " << i;
  }
}

// The operator of King (3.17): alpha div((1/alpha) grad q) with V_j = V / alpha_j of a smooth alpha, on a lattice that
// has been stretched so that the volumes fill space. Its error falls with the square of the smoothing length.
TEST(VaryingSizes, WeightsOfTheGeometricMeanGiveTheVaryingCoefficient) {
  double error[2];
  for (const int level : {0, 1}) {
    const int cells = 12 << level;
    const double dx = 1.0 / cells, h = 1.3 * dx, amplitude = 0.2;
    // x = s + amplitude sin(2 pi s) / (2 pi): spacing dx (1 + amplitude cos) holds a volume of that ratio.
    const auto place = [&](double s) { return s + amplitude * std::sin(2 * M_PI * s) / (2 * M_PI); };
    const auto ratio = [&](double s) { return (1 + amplitude * std::cos(2 * M_PI * s)) / (1 - amplitude); };
    const double base_volume = dx * dx * dx * (1 - amplitude);
    double worst = 0;
    for (int i = 0; i < cells; ++i) {
      const double s = (i + 0.5) / cells, alpha = 1 / ratio(s), hi = h * std::cbrt(ratio(s)) * 1.2;
      double sum = 0, stretch = 0;
      for (int j = i - 8; j <= i + 8; ++j)
        for (int b = -8; b <= 8; ++b)
          for (int c = -8; c <= 8; ++c) {
            const double sj = (j + 0.5) / cells, d = place(sj) - place(s);
            const double r2 = d * d + (b * b + c * c) * dx * dx, distance = std::sqrt(r2) / hi;
            if (r2 == 0 || distance >= 2) continue;
            const double g =
                -base_volume * ratio(sj) * WendlandC2::normalisation(3) / std::pow(hi, 5) * WendlandC2::f(distance);
            const double alpha_j = 1 / ratio(sj);
            const double q = std::sin(2 * M_PI * place(sj)), qi = std::sin(2 * M_PI * place(s));
            sum += 2 * g * std::sqrt(alpha / alpha_j) * (q - qi);
            stretch += g * r2;
          }
      const double x = place(s), slope = 2 * M_PI * std::cos(2 * M_PI * x);
      // d ln alpha / dx = -(d ratio / ds) / ratio / (dx/ds), and dx/ds is (1 - amplitude) ratio.
      const double dlog =
          amplitude * 2 * M_PI * std::sin(2 * M_PI * s) / (1 - amplitude) / ratio(s) / ((1 - amplitude) * ratio(s));
      const double exact = -4 * M_PI * M_PI * std::sin(2 * M_PI * x) - dlog * slope;
      worst = std::max(worst, std::abs(sum * 3 / stretch - exact));
    }
    error[level] = worst / (4 * M_PI * M_PI);
  }
  EXPECT_LT(error[1], 0.05);
  EXPECT_GT(error[0] / error[1], 2.5);
}

}  // namespace
}  // namespace spume::test
