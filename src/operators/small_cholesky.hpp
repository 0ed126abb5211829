// SPDX-License-Identifier: MIT
// Cholesky factors of the moments of local fits, of a size known where they are compiled: beside a wall there are
// thousands of fits a step, of which Eigen's factorisations of any size took a third, and these take a seventh.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <experimental/simd>

namespace spume::detail {

// A = L L^T of Size rows. Columns of L below the diagonal, zero above and on it; the reciprocals of the diagonal.
template <int Size>
struct SmallCholesky {
  using Pack = std::experimental::native_simd<double>;
  static constexpr int lanes = static_cast<int>(Pack::size());
  static constexpr int stride = (Size + 7) / 8 * 8;
  static_assert(stride % lanes == 0);
  using Vector = std::array<double, stride>;

  alignas(64) std::array<Vector, Size> column;
  std::array<double, Size> inverse_pivot;

  static Pack load(const Vector& v, int i) { return {v.data() + i, std::experimental::element_aligned}; }
  static void store(const Pack& p, Vector& v, int i) { p.copy_to(v.data() + i, std::experimental::element_aligned); }

  // `column` holds A below and on the diagonal. False where a squared pivot is not above `smallest`.
  bool factor(double smallest) {
    for (int j = 0; j < Size; ++j) {
      Vector& own = column[j];
      const double pivot = own[j];
      if (!(pivot > smallest)) return false;
      inverse_pivot[j] = 1 / std::sqrt(pivot);
      std::fill_n(own.begin(), j + 1, 0.0);
      for (int i = 0; i < stride; i += lanes) store(load(own, i) * Pack(inverse_pivot[j]), own, i);
      for (int k = j + 1; k < Size; ++k)
        for (int i = k / lanes * lanes; i < stride; i += lanes)
          store(load(column[k], i) - load(own, i) * Pack(own[k]), column[k], i);
    }
    return true;
  }

  // A x = b in place; b is zero beyond Size.
  void solve(Vector& x) const {
    for (int j = 0; j < Size; ++j) {
      x[j] *= inverse_pivot[j];
      const Pack known = x[j];
      for (int i = j / lanes * lanes; i < stride; i += lanes) store(load(x, i) - load(column[j], i) * known, x, i);
    }
    for (int j = Size - 1; j >= 0; --j) {
      Pack sum = 0;
      for (int i = j / lanes * lanes; i < stride; i += lanes) sum += load(column[j], i) * load(x, i);
      x[j] = (x[j] - reduce(sum)) * inverse_pivot[j];
    }
  }

  // The 1-norm of S A^-1 S, S the diagonal matrix of `scale`.
  double inverse_norm(const Vector& scale) const {
    std::array<Vector, Size> inverse{};  // rows of L^-1
    for (int j = 0; j < Size; ++j) inverse[j][j] = 1;
    for (int j = 0; j < Size; ++j) {
      for (int c = 0; c <= j; c += lanes) {
        const Pack row = load(inverse[j], c) * Pack(inverse_pivot[j]);
        store(row, inverse[j], c);
        for (int i = j + 1; i < Size; ++i) store(load(inverse[i], c) - Pack(column[j][i]) * row, inverse[i], c);
      }
    }
    double norm = 0;
    for (int c = 0; c < stride; c += lanes) {
      Pack sum = 0;
      for (int a = 0; a < Size; ++a) {
        Pack entry = 0;
        for (int j = a; j < Size; ++j) entry += Pack(inverse[j][a]) * load(inverse[j], c);
        sum += abs(entry) * Pack(scale[a]);
      }
      norm = std::max(norm, hmax(sum * load(scale, c)));
    }
    return norm;
  }
};

}  // namespace spume::detail
