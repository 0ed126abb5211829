// SPDX-License-Identifier: MIT
// The smoothing kernels that a case can choose; core/kernel.hpp has them as compile-time policies.
#pragma once

namespace spume {

enum class KernelKind { wendland_c2, quintic_spline };

}  // namespace spume
