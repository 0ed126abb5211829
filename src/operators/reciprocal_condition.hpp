// SPDX-License-Identifier: MIT
#pragma once

namespace spume::detail {

// Estimate for a symmetric matrix of at most 10 by 10, all of it given.
double reciprocal_condition(const double* matrix, int size);

}  // namespace spume::detail
