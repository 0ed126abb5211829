// SPDX-License-Identifier: MIT
// Runs of wcsph with its own steps.
#pragma once

#include "methods/method_run.hpp"
#include "spume/methods/wcsph/wcsph.hpp"

namespace spume::test {

using WcsphRun = MethodRun<wcsph::Wcsph>;

inline void until(WcsphRun& run, double end) {
  while (run.method.time() < end - 1e-12) run.steps(1, std::min(run.method.step_limit().dt, end - run.method.time()));
}

}  // namespace spume::test
