// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <vector>

#include "reference/matching.hpp"
#include "spume/core/random.hpp"
#include "spume/physics/point_particles/overlap.hpp"
#include "spume/physics/point_particles/particles.hpp"

namespace spume::test {
namespace {

struct Bed {
  std::array<double, 3> lower{-1, 0, 2}, length{1, 1.5, 2};
  std::array<Array<double>, 3> position;
  Array<double> diameters;
  Array<std::int64_t> identifier;
  double largest = 0;
  bool polydisperse;

  // Random places; diameters of one size, or up to 4 times apart; volume fraction alpha. `gathering` above 1 draws them
  // towards the middle of the box.
  Bed(std::size_t n, double alpha, bool poly, std::uint64_t seed = 1, double gathering = 1)
      : diameters(n), identifier(n), polydisperse(poly) {
    for (auto& x : position) x.resize(n);
    double volume = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const auto r = random_uniform(seed, RandomPurpose::test, i, 0, 0);
      for (int c = 0; c < 3; ++c) {
        const double from_middle = 2 * r[c] - 1;
        const double gathered = std::copysign(std::pow(std::abs(from_middle), gathering), from_middle);
        position[c][i] = lower[c] + length[c] * 0.5 * (1 + gathered);
      }
      diameters[i] = poly ? 0.25 + 0.75 * r[3] * r[3] : 1;
      identifier[i] = static_cast<std::int64_t>((i * 7919) % n);
      volume += sphere_volume(diameters[i]);
    }
    const double scale = std::cbrt(alpha * length[0] * length[1] * length[2] / volume);
    for (double& d : diameters) {
      d *= scale;
      largest = std::max(largest, d);
    }
  }
  std::size_t size() const { return diameters.size(); }
  Spheres spheres() {
    Spheres s;
    for (int c = 0; c < 3; ++c) s.position[c] = position[c].data();
    if (polydisperse) s.diameter = diameters.data();
    s.common_diameter = largest;
    s.identifier = identifier.data();
    s.size = size();
    return s;
  }
  Exclusion exclusion() const { return {lower, length, largest}; }
  double distance(std::size_t i, std::size_t j) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += std::pow(nearest_image(position[c][i] - position[c][j], length[c]), 2);
    return std::sqrt(sum);
  }
};

struct Setting {
  std::size_t n;
  double alpha;
  bool polydisperse;
  double gathering = 1;

  friend std::ostream& operator<<(std::ostream& out, const Setting& s) {
    return out << s.n << (s.polydisperse ? " of many sizes" : " of one size") << ", alpha " << s.alpha << ", gathered "
               << s.gathering;
  }
};

class Matching : public testing::TestWithParam<Setting> {};

TEST_P(Matching, RoundsAndSortingTakeThePairsOfTheDirectSearch) {
  Bed bed(GetParam().n, GetParam().alpha, GetParam().polydisperse, 1, GetParam().gathering);
  const auto direct = greedy_matching(bed.spheres(), bed.length);
  for (const auto method : {MatchingMethod::rounds, MatchingMethod::sorting}) {
    Exclusion exclusion = bed.exclusion();
    const ExclusionReport report = exclusion.match(bed.spheres(), method);
    std::size_t matched = 0;
    for (std::size_t i = 0; i < bed.size(); ++i) {
      ASSERT_EQ(exclusion.partner()[i], direct[i]) << i;
      matched += direct[i] >= 0 ? 1 : 0;
    }
    EXPECT_EQ(2 * report.pairs, matched);
    EXPECT_GE(report.overlapping, matched);
  }
}

// The gathered ones have up to 90 in a cell; the last ones fewer than three cells along some sides.
INSTANTIATE_TEST_SUITE_P(Beds, Matching,
                         testing::Values(Setting{4000, 0.035, false}, Setting{4000, 0.3, false},
                                         Setting{3000, 2.0, false}, Setting{4000, 0.3, true},
                                         Setting{4000, 0.02, false, 1.6}, Setting{4000, 0.02, true, 1.6},
                                         Setting{150, 0.2, false}, Setting{150, 0.2, true}, Setting{25, 0.1, false},
                                         Setting{60, 0.9, false}, Setting{2, 0.02, false}));

TEST(YouOnlyCollideOnce, SeesThroughBothSidesOfABoxOfTwoCells) {
  Bed bed(150, 0.2, false);
  const auto direct = greedy_matching(bed.spheres(), bed.length);
  Exclusion exclusion = bed.exclusion();
  exclusion.match(bed.spheres());
  ASSERT_EQ(exclusion.cells().count[0], 2);
  for (std::size_t i = 0; i < bed.size(); ++i) ASSERT_EQ(exclusion.partner()[i], direct[i]) << i;
}

TEST(YouOnlyCollideOnce, AGiantDoesNotHideWhatSmallOnesOverlap) {
  // Cells of two of its diameters would hold five hundred.
  Bed bed(12000, 0.02, true);
  bed.largest = bed.diameters[0] = 0.22 * *std::min_element(bed.length.begin(), bed.length.end());
  const auto direct = greedy_matching(bed.spheres(), bed.length);
  Exclusion exclusion = bed.exclusion();
  exclusion.match(bed.spheres());
  for (std::size_t i = 0; i < bed.size(); ++i) ASSERT_EQ(exclusion.partner()[i], direct[i]) << i;
}

TEST(YouOnlyCollideOnce, TiesGoByIdentifier) {
  // Equal distances along x and z, exact in binary: a row at the lower end of the box and one inside, and a lattice
  // whose members overlap four others by one amount and four by another.
  struct Lattice {
    double z;
    int rows, columns;
  };
  for (const Lattice& lattice : {Lattice{2, 1, 4}, Lattice{3, 1, 4}, Lattice{3, 7, 7}}) {
    Bed bed(static_cast<std::size_t>(lattice.rows * lattice.columns), 0.01, false);
    for (std::size_t i = 0; i < bed.size(); ++i) {
      bed.position[0][i] = -0.75 + 0.0625 * static_cast<double>(static_cast<int>(i) / lattice.columns);
      bed.position[1][i] = 0.5;
      bed.position[2][i] = lattice.z + 0.0625 * static_cast<double>(static_cast<int>(i) % lattice.columns);
    }
    bed.largest = 0.1;
    const auto direct = greedy_matching(bed.spheres(), bed.length);
    Exclusion exclusion = bed.exclusion();
    exclusion.match(bed.spheres());
    for (std::size_t i = 0; i < bed.size(); ++i) EXPECT_EQ(exclusion.partner()[i], direct[i]) << bed.size();
  }
}

// Pairs far from each other, as large as the box allows and a hundredth of that; the one size by itself as well.
TEST(YouOnlyCollideOnce, PairsThatWereMovedApartAreNoPairs) {
  for (const bool polydisperse : {false, true}) {
    Bed bed(2000, 0.01, polydisperse);
    bed.largest = 0.02;
    for (std::size_t i = 0; i < bed.size(); ++i) {
      bed.diameters[i] = polydisperse && i % 20 > 1 ? 0.0002 : 0.02;
      const auto pair = static_cast<int>(i / 2);
      const double place[3] = {pair % 10 + 0.5, pair / 10 % 10 + 0.5, pair / 100 + 0.5};
      const auto r = random_uniform(3, RandomPurpose::test, i, 0, 0);
      for (int c = 0; c < 3; ++c)
        bed.position[c][i] = bed.lower[c] + bed.length[c] * place[c] / 10 + 0.5 * bed.diameters[i] * (r[c] - 0.5);
    }
    Exclusion exclusion = bed.exclusion();
    ASSERT_EQ(exclusion.match(bed.spheres()).pairs, 1000U);
    exclusion.separate(bed.spheres());
    EXPECT_EQ(exclusion.match(bed.spheres()).pairs, 0U) << polydisperse;
  }
}

TEST(YouOnlyCollideOnce, APositionThatIsNotFiniteHurtsNoOther) {
  for (const bool polydisperse : {false, true}) {
    Bed bed(500, 0.3, polydisperse);
    bed.position[0][7] = std::nan("");
    bed.position[2][8] = HUGE_VAL;
    for (const auto method : {MatchingMethod::rounds, MatchingMethod::sorting}) {
      Exclusion exclusion = bed.exclusion();
      EXPECT_GT(exclusion.match(bed.spheres(), method).pairs, 10U);
      EXPECT_EQ(exclusion.partner()[7], -1);
      EXPECT_EQ(exclusion.partner()[8], -1);
    }
  }
}

TEST(YouOnlyCollideOnce, APositionOutsideTheBoxIsAnError) {
  Bed bed(400, 0.005, false);
  bed.position[0][1] = bed.lower[0] + 0.4;
  bed.position[0][0] = bed.position[0][1] + bed.length[0];
  for (int c = 1; c < 3; ++c) bed.position[c][0] = bed.position[c][1];
  Exclusion exclusion = bed.exclusion();
  EXPECT_THROW(exclusion.match(bed.spheres()), std::logic_error);
}

// A heap of more than fit into a cell, inside the box: each looks only at those near it in the order of the cell.
TEST(YouOnlyCollideOnce, InACrowdLooksAtThoseNearInItsOrder) {
  Bed bed(3000, 0.02, false);
  for (std::size_t i = 0; i < 1000; ++i)
    for (int c = 0; c < 3; ++c) bed.position[c][i] = bed.lower[c] + bed.length[c] * (0.45 + 1e-4 * bed.position[c][i]);
  std::vector<std::int32_t> partners[2];
  for (const auto method : {MatchingMethod::rounds, MatchingMethod::sorting}) {
    Exclusion exclusion = bed.exclusion();
    exclusion.match(bed.spheres(), method);
    auto& partner = partners[method == MatchingMethod::rounds ? 0 : 1];
    partner.assign(exclusion.partner().begin(), exclusion.partner().end());
    std::vector<std::int32_t> rank(bed.size());
    for (std::size_t k = 0; k < bed.size(); ++k) rank[exclusion.index_of(k)] = static_cast<std::int32_t>(k);
    int matched = 0;
    for (std::size_t i = 0; i < 1000; ++i) {
      if (partner[i] < 0 || partner[i] >= 1000) continue;
      ++matched;
      EXPECT_LE(std::abs(rank[i] - rank[static_cast<std::size_t>(partner[i])]), 64);
    }
    EXPECT_GT(matched, 900);
  }
  EXPECT_EQ(partners[0], partners[1]);
}

TEST(YouOnlyCollideOnce, PairsTouchAfterwardsAndKeepTheirCentre) {
  for (const bool polydisperse : {false, true}) {
    Bed bed(3000, 0.3, polydisperse);
    const auto before = bed.position;
    Exclusion exclusion = bed.exclusion();
    ASSERT_GT(exclusion.match(bed.spheres()).pairs, 100U);
    exclusion.separate(bed.spheres());
    for (std::size_t i = 0; i < bed.size(); ++i) {
      if (exclusion.partner()[i] < 0) {
        ASSERT_EQ(bed.position[1][i], before[1][i]);
        continue;
      }
      const auto j = static_cast<std::size_t>(exclusion.partner()[i]);
      const double di = polydisperse ? bed.diameters[i] : bed.largest;
      const double dj = polydisperse ? bed.diameters[j] : bed.largest;
      ASSERT_NEAR(bed.distance(i, j), 0.5 * (di + dj), 1e-14);
      for (int c = 0; c < 3; ++c) {
        const double own = nearest_image(bed.position[c][i] - before[c][i], bed.length[c]);
        const double other = nearest_image(bed.position[c][j] - before[c][j], bed.length[c]);
        ASSERT_NEAR(own * di * di * di + other * dj * dj * dj, 0, 1e-14 * (di * di * di + dj * dj * dj));
      }
    }
  }
}

TEST(YouOnlyCollideOnce, IsTheSameForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  for (const bool polydisperse : {false, true})
    for (const double gathering : {1.0, 2.5}) {
      Bed one(20000, 0.3, polydisperse, 1, gathering), three(20000, 0.3, polydisperse, 1, gathering);
      for (auto* bed : {&one, &three}) {
        omp_set_num_threads(bed == &one ? 1 : 3);
        Exclusion exclusion = bed->exclusion();
        for (int step = 0; step < 5; ++step) {
          exclusion.match(bed->spheres());
          exclusion.separate(bed->spheres());
        }
      }
      omp_set_num_threads(before);
      for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one.position[c][i], three.position[c][i]);
    }
}

TEST(YouOnlyCollideOnce, DissolvesAHeapOfAllParticlesAtOnePoint) {
  Bed bed(3000, 0.1, false);
  for (int c = 0; c < 3; ++c) bed.position[c].fill(bed.lower[c] + 0.3 * bed.length[c]);
  Exclusion exclusion = bed.exclusion();
  const ExclusionReport first = exclusion.match(bed.spheres());
  // All but a few of the edges of the windows find a partner, in rounds that grow as the logarithm of the number.
  EXPECT_GT(first.pairs, 1400U);
  EXPECT_LT(first.rounds, 60);
  for (int step = 0; step < 100; ++step) {
    exclusion.match(bed.spheres());
    exclusion.separate(bed.spheres());
  }
  const SampledValue left = overlap_ratio(exclusion, bed.spheres(), 20000, 1, 0);
  // Without overlaps the ball has a radius of 9 diameters; a walk of 100 steps reaches about 10.
  EXPECT_LT(left.value, 0.6);
}

TEST(YouOnlyCollideOnce, EmptiesADenseRandomBedOfOverlaps) {
  Bed bed(5000, 0.3, false);
  Exclusion exclusion = bed.exclusion();
  const double before = overlap_ratio(exclusion, bed.spheres(), 50000, 1, 0).value;
  for (int step = 0; step < 200; ++step) {
    exclusion.match(bed.spheres());
    exclusion.separate(bed.spheres());
  }
  const double after = overlap_ratio(exclusion, bed.spheres(), 50000, 1, 1).value;
  EXPECT_GT(before, 0.12);
  EXPECT_LT(after, 0.001);
}

TEST(YouOnlyCollideOnce, WithoutParticlesDoesNothing) {
  Bed bed(0, 0, false);
  Exclusion exclusion(bed.lower, bed.length, 0.1);
  EXPECT_EQ(exclusion.match(bed.spheres()).pairs, 0U);
  exclusion.separate(bed.spheres());
  EXPECT_EQ(overlap_ratio(exclusion, bed.spheres(), 100, 1, 0).value, 0);
}

TEST(YouOnlyCollideOnce, RefusesSpheresThatDoNotFitTheBox) {
  EXPECT_THROW(Exclusion({0, 0, 0}, {1, 2, 3}, 0.5), std::invalid_argument);
  EXPECT_THROW(Exclusion({0, 0, 0}, {1, 2, 3}, 0), std::invalid_argument);
}

// Spheres placed at random: 1 - (1 - exp(-alpha)) / alpha. n finite spheres leave (1 - v)^n in place of exp(-alpha), a
// difference of alpha / 2n relative. The bed itself scatters too, by about 1 / sqrt(n).
TEST(OverlapRatio, OfRandomSpheresIsExact) {
  for (const double alpha : {0.035, 0.3, 1.0})
    for (const bool polydisperse : {false, true}) {
      double sum = 0, error_2 = 0;
      constexpr int beds = 8;
      for (int b = 0; b < beds; ++b) {
        Bed bed(6000, alpha, polydisperse, static_cast<std::uint64_t>(10 + b));
        Exclusion exclusion = bed.exclusion();
        const SampledValue ratio = overlap_ratio(exclusion, bed.spheres(), 20000, 1, 0);
        sum += ratio.value / beds;
        error_2 += (ratio.standard_error * ratio.standard_error + alpha * alpha / 6000.0 * 0.25) / beds / beds;
      }
      const double exact = 1 - (1 - std::exp(-alpha)) / alpha;
      EXPECT_NEAR(sum, exact, 4 * std::sqrt(error_2)) << alpha << polydisperse;
      EXPECT_LT(std::sqrt(error_2), 0.03 * exact + 0.001);
    }
}

TEST(OverlapRatio, OfSpheresApartIsZero) {
  Bed bed(8, 0.01, false);
  for (std::size_t i = 0; i < 8; ++i)
    for (int c = 0; c < 3; ++c)
      bed.position[c][i] = bed.lower[c] + 0.5 * bed.length[c] * static_cast<double>(i >> c & 1U);
  Exclusion exclusion = bed.exclusion();
  const SampledValue ratio = overlap_ratio(exclusion, bed.spheres(), 5000, 1, 0);
  EXPECT_NEAR(ratio.value, 0, 1e-14);
}

}  // namespace
}  // namespace spume::test
