// SPDX-License-Identifier: MIT
// Complex arithmetic on a block of lanes<T> interleaved complex numbers (128 bytes) on the compiler's vector types.
#pragma once

#include <complex>
#include <cstring>

#include "spume/fourier/mode_layout.hpp"

namespace spume::fourier {

// 32 bytes: 2 complex doubles or 4 complex floats, re im re im ...
template <class T>
struct VectorOf;
template <>
struct VectorOf<double> {
  using Type = double __attribute__((vector_size(32)));
  using Mask = long long __attribute__((vector_size(32)));
  static constexpr Mask swap{1, 0, 3, 2};
  static constexpr Type imaginary{-1, 1, -1, 1};
  static constexpr Type conjugate{1, -1, 1, -1};
  static Type splat(double v) { return Type{v, v, v, v}; }
};
template <>
struct VectorOf<float> {
  using Type = float __attribute__((vector_size(32)));
  using Mask = int __attribute__((vector_size(32)));
  static constexpr Mask swap{1, 0, 3, 2, 5, 4, 7, 6};
  static constexpr Type imaginary{-1, 1, -1, 1, -1, 1, -1, 1};
  static constexpr Type conjugate{1, -1, 1, -1, 1, -1, 1, -1};
  static Type splat(float v) { return Type{v, v, v, v, v, v, v, v}; }
};

inline constexpr int vectors_per_block = 4;

// A complex factor that is the same for all lanes, ready for times().
template <class T>
struct Factor {
  typename VectorOf<T>::Type real, imaginary;  // the second with alternating sign
  explicit Factor(std::complex<T> f)
      : real(VectorOf<T>::splat(f.real())), imaginary(VectorOf<T>::splat(f.imag()) * VectorOf<T>::imaginary) {}
};

template <class T>
struct Block {
  using V = typename VectorOf<T>::Type;
  V v[vectors_per_block];

  [[gnu::always_inline]] static Block load(const std::complex<T>* p) {
    Block b;
    std::memcpy(b.v, p, sizeof b.v);
    return b;
  }
  [[gnu::always_inline]] void store(std::complex<T>* p) const { std::memcpy(p, v, sizeof v); }
  [[gnu::always_inline]] static Block zero() {
    Block b;
    for (auto& x : b.v) x = V{};
    return b;
  }
};

template <class T>
[[gnu::always_inline]] inline Block<T> operator+(Block<T> a, const Block<T>& b) {
  for (int i = 0; i < vectors_per_block; ++i) a.v[i] += b.v[i];
  return a;
}
template <class T>
[[gnu::always_inline]] inline Block<T> operator-(Block<T> a, const Block<T>& b) {
  for (int i = 0; i < vectors_per_block; ++i) a.v[i] -= b.v[i];
  return a;
}
// Real factors per lane (both entries of a lane equal), or one for all.
template <class T>
[[gnu::always_inline]] inline Block<T> operator*(const Block<T>& f, Block<T> a) {
  for (int i = 0; i < vectors_per_block; ++i) a.v[i] *= f.v[i];
  return a;
}
template <class T>
[[gnu::always_inline]] inline Block<T> operator*(T f, Block<T> a) {
  for (int i = 0; i < vectors_per_block; ++i) a.v[i] *= f;
  return a;
}
template <class T>
[[gnu::always_inline]] inline Block<T> swap(Block<T> a) {
  for (int i = 0; i < vectors_per_block; ++i) a.v[i] = __builtin_shuffle(a.v[i], VectorOf<T>::swap);
  return a;
}
template <class T>
[[gnu::always_inline]] inline Block<T> times_i(Block<T> a) {
  for (int i = 0; i < vectors_per_block; ++i)
    a.v[i] = __builtin_shuffle(a.v[i], VectorOf<T>::swap) * VectorOf<T>::imaginary;
  return a;
}
template <class T>
[[gnu::always_inline]] inline Block<T> conjugate(Block<T> a) {
  for (int i = 0; i < vectors_per_block; ++i) a.v[i] *= VectorOf<T>::conjugate;
  return a;
}
template <class T>
[[gnu::always_inline]] inline Block<T> times(const Factor<T>& f, Block<T> a) {
  for (int i = 0; i < vectors_per_block; ++i)
    a.v[i] = f.real * a.v[i] + f.imaginary * __builtin_shuffle(a.v[i], VectorOf<T>::swap);
  return a;
}

}  // namespace spume::fourier
