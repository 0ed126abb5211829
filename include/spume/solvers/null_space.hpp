// SPDX-License-Identifier: MIT
// The null space of a small matrix.
#pragma once

#include <vector>

namespace spume {

// An orthonormal basis of the x with M x = 0, for rows of M of `columns` entries. `negligible`: entries of M below it
// are zeros; of a row, and of a unit vector, what is left of it that counts as nothing. By the method of Gram and
// Schmidt applied twice: for some tens of columns.
std::vector<std::vector<double>> null_space(std::vector<std::vector<double>> rows, std::size_t columns,
                                            double negligible);

}  // namespace spume
