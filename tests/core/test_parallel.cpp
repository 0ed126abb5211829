// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <omp.h>

#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

class EveryThreadCount : public testing::Test {
 protected:
  ~EveryThreadCount() override { omp_set_num_threads(before_); }
  template <class Body>
  void on_each(Body&& body) {
    for (const int threads : {1, 2, 3, 5}) {
      omp_set_num_threads(threads);
      body(threads);
    }
  }

 private:
  int before_ = omp_get_max_threads();
};

// Terms of very different sizes, whose sum depends on the order of addition.
double term(std::size_t i) {
  return std::sin(static_cast<double>(i)) * std::pow(10.0, static_cast<double>(i % 17));
}

TEST_F(EveryThreadCount, SumsHaveTheSameBits) {
  for (const std::size_t n : {0U, 1U, 511U, 512U, 513U, 10000U, 200000U}) {
    double expected = 0;
    on_each([&](int threads) {
      const double sum = parallel_sum(n, term);
      if (threads == 1) expected = sum;
      EXPECT_EQ(std::bit_cast<std::uint64_t>(sum), std::bit_cast<std::uint64_t>(expected)) << n << ' ' << threads;
    });
    // Close to the serial sum: n roundings of the sum of magnitudes, at most n 1e16.
    double serial = 0;
    for (std::size_t i = 0; i < n; ++i) serial += term(i);
    EXPECT_NEAR(expected, serial, 2.3e-16 * static_cast<double>(n) * static_cast<double>(n) * 1e16);
  }
}

TEST_F(EveryThreadCount, SumOfIntegersIsExact) {
  on_each(
      [&](int) { EXPECT_EQ(parallel_sum(100001, [](std::size_t i) { return double(i); }), 100000.0 * 100001 / 2); });
}

TEST_F(EveryThreadCount, LoopsVisitEachItemOnce) {
  for (const std::size_t n : {0U, 1U, 512U, 100003U})
    on_each([&](int) {
      std::vector<int> visits(n, 0), stolen(n, 0);
      parallel_for(n, [&](std::size_t i) { ++visits[i]; });
      parallel_blocks(n, 100, [&](std::size_t b, std::size_t first, std::size_t last) {
        ASSERT_EQ(first, b * 100);
        for (std::size_t i = first; i < last; ++i) ++stolen[i];
      });
      EXPECT_EQ(visits, std::vector<int>(n, 1));
      EXPECT_EQ(stolen, std::vector<int>(n, 1));
    });
}

TEST(BlockShares, GiveOutEveryBlockOnceFromBothEnds) {
  for (const int threads : {1, 2, 3, 70}) {
    BlockShares shares(100, threads);
    std::vector<int> given(100, 0);
    std::size_t block = 0;
    for (int k = 0; shares.next(k % 2 == 0 ? 0 : threads - 1, block); ++k) ++given[block];
    EXPECT_EQ(given, std::vector<int>(100, 1)) << threads;
  }
}

TEST(BlockShares, AThreadTakesItsOwnFromTheFrontAndOthersFromTheBack) {
  BlockShares shares(8, 2);
  std::vector<std::size_t> taken;
  for (std::size_t block = 0; shares.next(1, block);) taken.push_back(block);
  EXPECT_EQ(taken, (std::vector<std::size_t>{4, 5, 6, 7, 3, 2, 1, 0}));
}

// A thread that is held up in its first block until the rest of its share is done: by another one, or never.
TEST_F(EveryThreadCount, AThreadThatIsHeldUpLosesTheRestOfItsShare) {
  omp_set_num_threads(2);
  constexpr std::size_t blocks = 64;
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> others_came = false;
  parallel_blocks(blocks, 1, [&](std::size_t b, std::size_t, std::size_t) {
    if (b == 0) {
      const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
      while (done < blocks - 1 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
      others_came = done == blocks - 1;
    }
    ++done;
  });
  EXPECT_TRUE(others_came);
  EXPECT_EQ(done, blocks);
}

TEST_F(EveryThreadCount, LargestTermIsFoundAndNotANumberKept) {
  on_each([&](int) {
    EXPECT_EQ(parallel_max(0, -3.0, [](std::size_t) { return 0.0; }), -3);
    EXPECT_EQ(parallel_max(50000, 0.0, [](std::size_t i) { return i == 40000 ? 7.0 : 1.0; }), 7);
    for (const std::size_t bad : {0U, 20000U, 49999U})
      EXPECT_TRUE(std::isnan(parallel_max(
          50000, 0.0, [=](std::size_t i) { return i == bad ? std::numeric_limits<double>::quiet_NaN() : double(i); })));
  });
}

TEST_F(EveryThreadCount, BlocksAreCombinedInOrder) {
  const std::size_t n = 100000;
  on_each([&](int) {
    std::size_t at = 0;
    struct Range {
      std::size_t first, last;
    };
    const Range whole = parallel_reduce(
        n, Range{0, 0},
        [](std::size_t first, std::size_t last) {
          return Range{first, last};
        },
        [&](Range a, Range b) {
          EXPECT_EQ(a.last, b.first);
          ++at;
          return Range{a.first, b.last};
        });
    EXPECT_EQ(whole.last, n);
    EXPECT_LE(at, max_reduction_blocks);
  });
}

TEST_F(EveryThreadCount, AnExceptionReachesTheCaller) {
  on_each([&](int) {
    const auto fail = [](std::size_t i) {
      if (i == 70000) throw std::runtime_error("at 70000");
    };
    EXPECT_THROW(parallel_for(100000, fail), std::runtime_error);
    EXPECT_THROW(parallel_blocks(100000, 10,
                                 [&](std::size_t, std::size_t first, std::size_t last) {
                                   for (std::size_t i = first; i < last; ++i) fail(i);
                                 }),
                 std::runtime_error);
  });
}

}  // namespace
}  // namespace spume
