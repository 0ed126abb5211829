// SPDX-License-Identifier: MIT
// What the stages of CrossProduct share: the memory of a thread, factors, largest values.
#pragma once

#include <algorithm>
#include <cmath>

#include "lane_passes.hpp"
#include "spume/fourier/cross_product.hpp"

namespace spume {
namespace fourier {

// A complex factor that is the same for all lanes, and numbers whose parts stand in registers of their own.
template <class T>
struct Turn {
  using V = typename fourier::Register<T>::Type;
  T cosine, sine;
  [[gnu::always_inline]] explicit Turn(std::complex<T> f) : cosine(f.real()), sine(f.imag()) {}
  [[gnu::always_inline]] V real(V r, V i) const { return cosine * r - sine * i; }
  [[gnu::always_inline]] V imaginary(V r, V i) const { return cosine * i + sine * r; }
};

template <class T>
inline T* values(Array<std::complex<T>>& array) {
  return reinterpret_cast<T*>(array.data());
}
template <class T>
inline const T* values(const Array<std::complex<T>>& array) {
  return reinterpret_cast<const T*>(array.data());
}
template <class T>
inline T* values(std::complex<T>* numbers) {
  return reinterpret_cast<T*>(numbers);
}
template <class T>
inline const T* values(const std::complex<T>* numbers) {
  return reinterpret_cast<const T*>(numbers);
}

}  // namespace fourier

// Rows of the plane that go through the z stage together: two groups of one row per lane.
template <class T>
constexpr std::size_t group_rows = 2 * lanes<T>;

template <class T>
struct CrossProduct<T>::Scratch {
  // `rows` and `turned` hold complex numbers, all others blocks with real and imaginary parts apart (fourier::Lanes).
  std::array<Array<Complex>, 5> line;        // lines along x
  std::array<Array<Complex>, 6> rows;        // of one remainder along y: half_[1] rows (rounded up) of modes along z
  std::array<Array<Complex>, 3> sum;         // of the remainders along y: ny rows
  std::array<Array<Complex>, 6> column;      // lines of the y stage
  std::array<Array<Complex>, 12> turned;     // modes of a group of rows, by mode, one row per lane
  std::array<Array<Complex>, 6> pair;        // two real fields as one complex: values along z of a group
  std::array<Array<Complex>, 3> pair_modes;  // transforms of the products, summed over the remainders along z
  Array<Complex> passes;                     // of a transform, between its passes
};

// Largest values of every lane.
template <class T>
struct CrossProduct<T>::PeakLanes {
  using V = typename fourier::Lanes<T>::V;
  std::array<T, 3> per_spacing{};
  V rate{}, square{};

  [[gnu::always_inline]] void take(V u, V v, V w) {
    const V au = u < 0 ? -u : u, av = v < 0 ? -v : v, aw = w < 0 ? -w : w;
    const V sum = au * per_spacing[0] + av * per_spacing[1] + aw * per_spacing[2], squares = u * u + v * v + w * w;
    rate = rate > sum ? rate : sum;
    square = square > squares ? square : squares;
  }

  void add_to(VelocityPeak& peak) const {
    T largest_rate = 0, largest_square = 0;
    for (std::size_t l = 0; l < sizeof(V) / sizeof(T); ++l) {
      largest_rate = rate[l] > largest_rate || rate[l] != rate[l] ? rate[l] : largest_rate;
      largest_square = square[l] > largest_square || square[l] != square[l] ? square[l] : largest_square;
    }
    peak.rate = std::max(peak.rate, static_cast<double>(largest_rate));
    peak.speed = std::max(peak.speed, std::sqrt(static_cast<double>(largest_square)));
  }
};

}  // namespace spume
