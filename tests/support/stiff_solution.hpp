// SPDX-License-Identifier: MIT
// Ordinary differential equations by CVODE of SUNDIALS: backward differentiation, errors of 1e-11.
#pragma once

#include <functional>
#include <vector>

namespace spume::test {

using Derivative = std::function<void(const double* state, double* change)>;

// Advances `state` by `duration`. Throws std::runtime_error when CVODE fails.
void integrate_stiff(const Derivative& derivative, std::vector<double>& state, double duration);

}  // namespace spume::test
