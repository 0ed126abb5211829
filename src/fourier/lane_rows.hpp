// SPDX-License-Identifier: MIT
// Rows in memory to lanes of registers and back, for transforms along the rows. Two real rows travel as the real and
// the imaginary part of one complex line: half the transforms, all of the same kind.
#pragma once

#include "lane_passes.hpp"

namespace spume::fourier {

// Modes a, b of two real rows (n modes each, below the Nyquist wavenumber) to one lane of a line of 2 n modes: a + i b
// at k, and conj(a) + i conj(b), which stands at -k. positive, negative: n blocks of numbers.
template <class T>
inline void rows_to_lane(const std::complex<T>* a, const std::complex<T>* b, std::size_t n, std::size_t lane,
                         std::complex<T>* positive, std::complex<T>* negative) {
  constexpr std::size_t width = lanes<T>;
  using V = Vector<T>;
  positive += lane, negative += lane;
  const std::complex<T> mean(a[0].real(), b[0].real());  // real parts alone: no rounding leaks from one to the other
  for (std::size_t k = 0; k < n; k += vector_width<T>) {
    const V at_a = load(a + k), at_b = load(b + k);
    const V plus = at_a + times_i<T>(at_b), minus = conjugate<T>(at_a) + times_i<T>(conjugate<T>(at_b));
    for (std::size_t e = 0; e < vector_width<T> && k + e < n; ++e) {
      store_element<T>(positive + (k + e) * width, plus, e);
      store_element<T>(negative + (k + e) * width, minus, e);
    }
  }
  positive[0] = mean;
}

// Back: the modes P of a line of 2 n values, parts apart, to the first n of two rows each; A_k = (P_k + conj P_-k) / 2,
// B_k = (P_k - conj P_-k) / 2i. Lanes beyond `first_rows` and `second_rows` are left out.
template <class T>
inline void lanes_to_rows(const T* modes, std::size_t n, std::complex<T>* first, std::size_t first_rows,
                          std::complex<T>* second, std::size_t second_rows, std::size_t row) {
  using V = typename Lanes<T>::V;
  for (std::size_t k = 0; k < n; ++k) {
    const T *const positive = modes + k * Lanes<T>::block, *const negative =
                                                               modes + (k == 0 ? 0 : 2 * n - k) * Lanes<T>::block;
    alignas(64) std::complex<T> a[lanes<T>], b[lanes<T>];
    for (std::size_t q = 0; q < Lanes<T>::block; q += Lanes<T>::piece_step) {
      V pr, pi, mr, mi;
      Lanes<T>::get_parts(positive + q, pr, pi);
      Lanes<T>::get_parts(negative + q, mr, mi);
      Lanes<T>::put_numbers(reinterpret_cast<T*>(a) + q, T(0.5) * (pr + mr), T(0.5) * (pi - mi));
      Lanes<T>::put_numbers(reinterpret_cast<T*>(b) + q, T(0.5) * (pi + mi), T(0.5) * (mr - pr));
    }
    for (std::size_t l = 0; l < first_rows; ++l) first[l * row + k] = a[l];
    for (std::size_t l = 0; l < second_rows; ++l) second[l * row + k] = b[l];
  }
}

// Element i of register j becomes element j of register i.
template <class T>
[[gnu::always_inline]] inline void transpose(typename Lanes<T>::V* rows) {
  constexpr std::size_t width = Lanes<T>::width;
  using V = typename Lanes<T>::V;
  const auto exchange = [&]<std::size_t step>(std::integral_constant<std::size_t, step>) {
#pragma GCC unroll 16
    for (std::size_t j = 0; j < width; ++j) {
      if (j & step) continue;
      const V a = rows[j], b = rows[j + step];
      [&]<std::size_t... i>(std::index_sequence<i...>) {
        rows[j] = __builtin_shufflevector(a, b, (i & step ? width + i - step : i)...);
        rows[j + step] = __builtin_shufflevector(a, b, (i & step ? width + i : i + step)...);
      }
      (std::make_index_sequence<width>{});
    }
  };
  exchange(std::integral_constant<std::size_t, 1>{});
  if constexpr (width > 2) exchange(std::integral_constant<std::size_t, 2>{});
  if constexpr (width > 4) exchange(std::integral_constant<std::size_t, 4>{});
  if constexpr (width > 8) exchange(std::integral_constant<std::size_t, 8>{});
}

// Calls each(j, piece) for squares of values j to j + width - 1 of the rows whose lanes stand in a piece.
template <class T, class Each>
inline void each_square(std::size_t values, const Each& each) {
  constexpr std::size_t width = Lanes<T>::width;
  for (std::size_t j = 0; j + width <= values; j += width)
    for (std::size_t piece = 0; piece < Lanes<T>::pieces; ++piece) each(j, piece);
}

// Real values of lanes<T> rows to the real (imaginary: 0 or 1) parts of a line of blocks, parts apart; `row` values lie
// between the rows.
template <class T>
inline void reals_to_lanes(const T* rows, std::size_t row, std::size_t values, std::size_t imaginary, T* line) {
  using L = Lanes<T>;
  each_square<T>(values, [&](std::size_t j, std::size_t piece) {
    typename L::V square[L::width];
#pragma GCC unroll 16
    for (std::size_t i = 0; i < L::width; ++i) square[i] = L::get(rows + (piece * L::width + L::number(i)) * row + j);
    transpose<T>(square);
#pragma GCC unroll 16
    for (std::size_t i = 0; i < L::width; ++i)
      L::put(line + (j + i) * L::block + piece * L::piece_step + imaginary * L::width, square[i]);
  });
  for (std::size_t j = values / L::width * L::width; j < values; ++j)
    for (std::size_t piece = 0; piece < L::pieces; ++piece)
      for (std::size_t i = 0; i < L::width; ++i)
        line[j * L::block + piece * L::piece_step + imaginary * L::width + i] =
            rows[(piece * L::width + L::number(i)) * row + j];
}

// And back.
template <class T>
inline void lanes_to_reals(const T* line, std::size_t imaginary, std::size_t values, T* rows, std::size_t row) {
  using L = Lanes<T>;
  each_square<T>(values, [&](std::size_t j, std::size_t piece) {
    typename L::V square[L::width];
#pragma GCC unroll 16
    for (std::size_t i = 0; i < L::width; ++i)
      square[i] = L::get(line + (j + i) * L::block + piece * L::piece_step + imaginary * L::width);
    transpose<T>(square);
#pragma GCC unroll 16
    for (std::size_t i = 0; i < L::width; ++i) L::put(rows + (piece * L::width + L::number(i)) * row + j, square[i]);
  });
  for (std::size_t j = values / L::width * L::width; j < values; ++j)
    for (std::size_t piece = 0; piece < L::pieces; ++piece)
      for (std::size_t i = 0; i < L::width; ++i)
        rows[(piece * L::width + L::number(i)) * row + j] =
            line[j * L::block + piece * L::piece_step + imaginary * L::width + i];
}

}  // namespace spume::fourier
