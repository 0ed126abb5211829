// SPDX-License-Identifier: MIT
#include "spume/cli/terminal.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace spume {
namespace {

TEST(Terminal, TheProgressLineGivesStepTimeLimitRateAndRest) {
  Progress progress{1200, 0.412, 1, 3.4e-4, "courant", 2.9e6, 151};
  EXPECT_EQ(progress_line(progress), "step 1200  t 0.412/1.000  dt 3.4e-4 (courant)  2.9 Mp-steps/s  ETA 02:31");
  // Decimals of the time show a thousandth of the run.
  progress.time = 41.2, progress.end = 1000, progress.dt = 1.25e-12;
  progress.remaining_seconds = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(progress_line(progress), "step 1200  t 41/1000  dt 1.2e-12 (courant)  2.9 Mp-steps/s  ETA --:--");
}

}  // namespace
}  // namespace spume
