// SPDX-License-Identifier: MIT
// Complex arithmetic on 32-byte vectors of interleaved complex numbers, on the compiler's vector types. Values are
// passed as vectors, never as structs of several: the compiler copies those through narrower registers, which stalls
// the next load (5 times slower loops with GCC 12).
#pragma once

#include <complex>
#include <cstring>

#include "spume/fourier/mode_layout.hpp"

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace spume::fourier {

// 2 complex doubles or 4 complex floats, re im re im ...
template <class T>
struct VectorTraits;
template <>
struct VectorTraits<double> {
  using Type = double __attribute__((vector_size(32)));
  using Element = double __attribute__((vector_size(16)));  // one complex number
  static constexpr Type imaginary{-1, 1, -1, 1};
  static constexpr Type conjugate{1, -1, 1, -1};
  static constexpr Type real_part{1, 0, 1, 0};
  static constexpr Type imaginary_part{0, 1, 0, 1};
};
template <>
struct VectorTraits<float> {
  using Type = float __attribute__((vector_size(32)));
  using Element = float __attribute__((vector_size(8)));
  static constexpr Type imaginary{-1, 1, -1, 1, -1, 1, -1, 1};
  static constexpr Type conjugate{1, -1, 1, -1, 1, -1, 1, -1};
  static constexpr Type real_part{1, 0, 1, 0, 1, 0, 1, 0};
  static constexpr Type imaginary_part{0, 1, 0, 1, 0, 1, 0, 1};
};

template <class T>
using Vector = typename VectorTraits<T>::Type;

// Complex numbers of a vector; lanes<T> numbers are four vectors.
template <class T>
inline constexpr std::size_t vector_width = sizeof(Vector<T>) / sizeof(std::complex<T>);
static_assert(lanes<double> == 4 * vector_width<double> && lanes<float> == 4 * vector_width<float>);

template <class T>
[[gnu::always_inline]] inline Vector<T> load(const std::complex<T>* p) {
  Vector<T> v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <class T>
[[gnu::always_inline]] inline void store(std::complex<T>* p, Vector<T> v) {
  std::memcpy(static_cast<void*>(p), &v, sizeof v);
}
// Asks for two lines of the cache, lanes<T> numbers.
template <class T>
[[gnu::always_inline]] inline void prefetch_block(const std::complex<T>* p) {
  __builtin_prefetch(p);
  __builtin_prefetch(p + lanes<T> / 2);
}
// Copies lanes<T> numbers.
template <class T>
[[gnu::always_inline]] inline void copy_block(const std::complex<T>* from, std::complex<T>* to) {
  for (std::size_t q = 0; q < lanes<T>; q += vector_width<T>) store<T>(to + q, load(from + q));
}

// Number e of a vector.
template <class T>
[[gnu::always_inline]] inline void store_element(std::complex<T>* p, Vector<T> v, std::size_t e) {
  const typename VectorTraits<T>::Element element{v[2 * e], v[2 * e + 1]};
  std::memcpy(static_cast<void*>(p), &element, sizeof element);
}

// Copies lanes<T> numbers past the cache, to 32-byte aligned memory; release_streams() before others read them.
template <class T>
[[gnu::always_inline]] inline void stream_block(const std::complex<T>* from, std::complex<T>* to) {
#if defined(__AVX__)
  for (std::size_t q = 0; q < lanes<T>; q += vector_width<T>)
    _mm256_stream_pd(reinterpret_cast<double*>(to + q), _mm256_load_pd(reinterpret_cast<const double*>(from + q)));
#else
  copy_block(from, to);
#endif
}
inline void release_streams() {
#if defined(__AVX__)
  _mm_sfence();
#endif
}

template <class T>
[[gnu::always_inline]] inline Vector<T> swap(Vector<T> v) {
  if constexpr (sizeof(T) == sizeof(double))
    return __builtin_shufflevector(v, v, 1, 0, 3, 2);
  else
    return __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6);
}
template <class T>
[[gnu::always_inline]] inline Vector<T> times_i(Vector<T> v) {
  return swap<T>(v) * VectorTraits<T>::imaginary;
}
template <class T>
[[gnu::always_inline]] inline Vector<T> conjugate(Vector<T> v) {
  return v * VectorTraits<T>::conjugate;
}

// A complex factor that is the same for all lanes.
template <class T>
struct Factor {
  Vector<T> real, imaginary;  // the second with alternating sign
  [[gnu::always_inline]] explicit Factor(std::complex<T> f)
      : real(Vector<T>{} + f.real()), imaginary((Vector<T>{} + f.imag()) * VectorTraits<T>::imaginary) {}
  [[gnu::always_inline]] Vector<T> operator*(Vector<T> v) const { return real * v + imaginary * swap<T>(v); }
};

}  // namespace spume::fourier
