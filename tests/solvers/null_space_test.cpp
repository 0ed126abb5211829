// SPDX-License-Identifier: MIT
#include "spume/solvers/null_space.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace spume {
namespace {

using Vector = std::vector<double>;

double product(const Vector& a, const Vector& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void expect_orthonormal(const std::vector<Vector>& basis) {
  for (std::size_t a = 0; a < basis.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) EXPECT_NEAR(product(basis[a], basis[b]), a == b ? 1 : 0, 1e-14);
}

// Two bodies, five parts, of which one pushes neither: the rank is 2.
TEST(NullSpace, IsOrthogonalToEveryRow) {
  const std::vector<Vector> rows{{1, -0.5, 0, 0.25, 0}, {0, 0.5, -1, 0, 0}, {2, -0.5, -1, 0.5, 0}};
  const std::vector<Vector> found = null_space(rows, 5, 1e-4);
  ASSERT_EQ(found.size(), 3U);
  expect_orthonormal(found);
  for (const Vector& one : found)
    for (const Vector& row : rows) EXPECT_NEAR(product(one, row), 0, 1e-14);
}

TEST(NullSpace, IsAllWithoutRowsAndNothingForARegularMatrix) {
  EXPECT_EQ(null_space({}, 3, 1e-4).size(), 3U);
  EXPECT_TRUE(null_space({{1, 2}, {2, 1}}, 2, 1e-4).empty());
}

// What edges of the liquid leave of the push of a part that surrounds a body.
TEST(NullSpace, TakesEntriesBelowWhatIsNegligibleForZero) {
  EXPECT_EQ(null_space({{1e-5, -2e-5}}, 2, 1e-4).size(), 2U);
  EXPECT_EQ(null_space({{1e-3, -2e-5}}, 2, 1e-4).size(), 1U);
}

}  // namespace
}  // namespace spume
