// SPDX-License-Identifier: MIT
// Streams past obstacles with edges at a high Reynolds number: behind an edge the liquid parts from the wall, and what
// opens there must close without a jet.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "methods/gfd_run.hpp"

namespace spume::test {
namespace {

// Between free-slip walls, Re = 3e4 with the height of the box. Where voids behind edges close as slowly as elsewhere
// the energy grows by 69 % in 70 steps and the run fails.
TEST(GfdStreams, PassASolidBox) {
  GfdRun run(R"toml(method = "gfd"
[domain]
lower = [0, 0]
upper = [60, 30]
x = "periodic"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 1
[[phase]]
name = "liquid"
density = 1
viscosity = 0.01
[[region]]
phase = "liquid"
velocity = ["30", "0"]
[[solid]]
lower = [20, 10]
upper = [29, 20]
[time]
end = 2
)toml");
  const auto energy = [&] {
    double sum = 0;
    for (std::size_t i = 0; i < run.flow().size(); ++i) sum += squared_norm(run.flow().particles.velocity, 2, i);
    return sum;
  };
  const double start = energy();
  double largest = 0;
  for (int step = 0; step < 150; ++step) {
    run.method.step(std::min(0.004, run.method.step_limit().dt), run.ledger);
    largest = std::max(largest, energy() / start);
  }
  EXPECT_LT(largest, 1);
  EXPECT_GT(run.method.time(), 0.4);
}

}  // namespace
}  // namespace spume::test
