// SPDX-License-Identifier: MIT
// Symmetric matrices of two or three rows, stored as their upper triangle: xx, xy, yy or xx, xy, xz, yy, yz, zz.
#pragma once

#include <array>
#include <cstddef>

namespace spume {

template <int dimensions>
inline constexpr int symmetric_entries = dimensions*(dimensions + 1) / 2;

// Row a, column c.
template <int dimensions>
constexpr int symmetric_index(int a, int c) {
  const int low = a < c ? a : c, high = a < c ? c : a;
  return dimensions == 2 ? low + high : (low == 0 ? high : low + high + 1);
}

// The product M v of particle i. A call of it takes 3 % of a sweep.
template <int dimensions>
[[gnu::always_inline]] inline std::array<float, dimensions> symmetric_product(const std::array<const float*, 6>& matrix,
                                                                              std::size_t i,
                                                                              const std::array<float, dimensions>& v) {
  std::array<float, dimensions> result{};
  for (int a = 0; a < dimensions; ++a)
    for (int c = 0; c < dimensions; ++c) result[a] += matrix[symmetric_index<dimensions>(a, c)][i] * v[c];
  return result;
}

// The inverse and the sum of the squares of its entries; returns the determinant. Without a branch, so that a loop over
// matrices takes several at a time: of singular ones it makes what is of no use.
template <int dimensions>
[[gnu::always_inline]] inline double inverse_of(const double* m, double* inverse, double& squares) {
  if constexpr (dimensions == 2) {
    const double det = m[0] * m[2] - m[1] * m[1];
    inverse[0] = m[2] / det;
    inverse[1] = -m[1] / det;
    inverse[2] = m[0] / det;
    squares = inverse[0] * inverse[0] + 2 * inverse[1] * inverse[1] + inverse[2] * inverse[2];
    return det;
  } else {
    const double c00 = m[3] * m[5] - m[4] * m[4];
    const double c01 = m[2] * m[4] - m[1] * m[5];
    const double c02 = m[1] * m[4] - m[2] * m[3];
    const double det = m[0] * c00 + m[1] * c01 + m[2] * c02;
    inverse[0] = c00 / det;
    inverse[1] = c01 / det;
    inverse[2] = c02 / det;
    inverse[3] = (m[0] * m[5] - m[2] * m[2]) / det;
    inverse[4] = (m[1] * m[2] - m[0] * m[4]) / det;
    inverse[5] = (m[0] * m[3] - m[1] * m[1]) / det;
    squares = inverse[0] * inverse[0] + inverse[3] * inverse[3] + inverse[5] * inverse[5] +
              2 * (inverse[1] * inverse[1] + inverse[2] * inverse[2] + inverse[4] * inverse[4]);
    return det;
  }
}

// The same, where the determinant exceeds `singular`; else false.
inline bool invert_symmetric(const std::array<double, 6>& m, int dimensions, double singular,
                             std::array<double, 6>& inverse, double& squares) {
  return (dimensions == 2 ? inverse_of<2>(m.data(), inverse.data(), squares)
                          : inverse_of<3>(m.data(), inverse.data(), squares)) > singular;
}

}  // namespace spume
