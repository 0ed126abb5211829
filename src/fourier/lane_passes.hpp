// SPDX-License-Identifier: MIT
// Fourier transforms of lanes<T> complex lines side by side, one line per lane of the vector registers (Stockham's
// form, decimation in frequency, radices 2, 3, 4, 5, 6 and 8). Real and imaginary parts stand in registers of their
// own, so that nothing is shuffled; the inverse is the forward transform with the two exchanged, which costs nothing.
// What a caller does to each value before or after a transform is done where the first pass loads it and the last
// stores it: a line then goes through the first cache once less on each side.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <complex>
#include <cstring>
#include <numbers>
#include <utility>

#include "lane_plan.hpp"
#include "spume/fourier/lane_vector.hpp"
#include "spume/fourier/mode_layout.hpp"

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace spume::fourier {

// The widest registers of the machine; without any, those of x86-64.
#if defined(__AVX512F__)
inline constexpr std::size_t register_bytes = 64;
#elif defined(__AVX__)
inline constexpr std::size_t register_bytes = 32;
#else
inline constexpr std::size_t register_bytes = 16;
#endif

template <class T>
struct Register;
template <>
struct Register<double> {
  using Type = double __attribute__((vector_size(register_bytes)));
};
template <>
struct Register<float> {
  using Type = float __attribute__((vector_size(register_bytes)));
};

// A block of lanes<T> complex numbers lies in memory as complex numbers or *apart*: for each piece of `width` numbers
// their real parts and then their imaginary parts, in an order of lanes that differs from that of the numbers (part()).
// Piece p of a block begins p * piece_step values of T after the block, in either form.
template <class T>
struct Lanes {
  using V = typename Register<T>::Type;
  static constexpr std::size_t width = sizeof(V) / sizeof(T);
  static constexpr std::size_t piece_step = 2 * width;
  static constexpr std::size_t block = 2 * lanes<T>;  // values of T
  static constexpr std::size_t pieces = lanes<T> / width;
  // Which number of a piece stands at element i of the registers of its parts.
  static constexpr std::size_t number(std::size_t i) {
    if constexpr (sizeof(T) == 8) return i % 2 ? (width + i - 1) / 2 : i / 2;
    return (i % 4 < 2 ? i / 4 * 4 + i % 2 * 2 : width + i / 4 * 4 + i % 2 * 2) / 2;
  }

  // Two registers of interleaved complex numbers to one of real and one of imaginary parts, and back. Lanes of 16 bytes
  // stay apart, so that each is one instruction; which line stands where does not matter in between.
  template <bool high>
  [[gnu::always_inline]] static V part(V a, V b) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) {
      if constexpr (sizeof(T) == 8)
        return __builtin_shufflevector(a, b, (i % 2 ? width + i - 1 + high : i + high)...);
      else
        return __builtin_shufflevector(
            a, b, (i % 4 < 2 ? i / 4 * 4 + i % 2 * 2 + high : width + i / 4 * 4 + i % 2 * 2 + high)...);
    }
    (std::make_index_sequence<width>{});
  }
  template <bool high>
  [[gnu::always_inline]] static V joined(V real, V imaginary) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) {
      if constexpr (sizeof(T) == 8)
        return __builtin_shufflevector(real, imaginary, (i % 2 ? width + i - 1 + high : i + high)...);
      else
        return __builtin_shufflevector(real, imaginary, ((i % 2 ? width : 0) + i / 4 * 4 + i % 4 / 2 + 2 * high)...);
    }
    (std::make_index_sequence<width>{});
  }
  // A piece: complex numbers in memory, parts in registers.
  [[gnu::always_inline]] static void get_numbers(const T* p, V& real, V& imaginary) {
    const V a = get(p), b = get(p + width);
    real = part<false>(a, b), imaginary = part<true>(a, b);
  }
  [[gnu::always_inline]] static void put_numbers(T* p, V real, V imaginary) {
    put(p, joined<false>(real, imaginary)), put(p + width, joined<true>(real, imaginary));
  }
  // Parts in both.
  [[gnu::always_inline]] static void get_parts(const T* p, V& real, V& imaginary) {
    real = get(p), imaginary = get(p + width);
  }
  [[gnu::always_inline]] static void put_parts(T* p, V real, V imaginary) { put(p, real), put(p + width, imaginary); }
  // Past the caches; release_streams() before others read it.
  [[gnu::always_inline]] static void stream_parts(T* p, V real, V imaginary) {
    put_past_cache(p, real), put_past_cache(p + width, imaginary);
  }
  [[gnu::always_inline]] static V get(const T* p) {
    V v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  [[gnu::always_inline]] static void put(T* p, V v) { std::memcpy(p, &v, sizeof v); }
  [[gnu::always_inline]] static void put_past_cache(T* p, V v) {
#if defined(__AVX512F__)
    _mm512_stream_si512(reinterpret_cast<__m512i*>(p), std::bit_cast<__m512i>(v));
#elif defined(__AVX__)
    _mm256_stream_si256(reinterpret_cast<__m256i*>(p), std::bit_cast<__m256i>(v));
#else
    put(p, v);
#endif
  }
};

template <class T>
struct Butterflies {
  using V = typename Register<T>::Type;
  // r, i: `radix` values; their transform sum_j x_j exp(-2 pi i j k / radix) in their place.
  [[gnu::always_inline]] static void two(V& ar, V& ai, V& br, V& bi) {
    const V r = ar - br, i = ai - bi;
    ar += br, ai += bi;
    br = r, bi = i;
  }
  [[gnu::always_inline]] static void three(V& ar, V& ai, V& br, V& bi, V& cr, V& ci) {
    const T sine = static_cast<T>(std::numbers::sqrt3 / 2);
    const V sr = br + cr, si = bi + ci, dr = sine * (bi - ci), di = sine * (cr - br);
    const V mr = ar - T(0.5) * sr, mi = ai - T(0.5) * si;
    ar += sr, ai += si;
    br = mr + dr, bi = mi + di;
    cr = mr - dr, ci = mi - di;
  }
  [[gnu::always_inline]] static void four(V& ar, V& ai, V& br, V& bi, V& cr, V& ci, V& dr, V& di) {
    const V pr = ar + cr, pi = ai + ci, mr = ar - cr, mi = ai - ci;
    const V qr = br + dr, qi = bi + di, nr = bi - di, ni = dr - br;
    ar = pr + qr, ai = pi + qi;
    br = mr + nr, bi = mi + ni;
    cr = pr - qr, ci = pi - qi;
    dr = mr - nr, di = mi - ni;
  }
  [[gnu::always_inline]] static void five(V* r, V* i) {
    // cos and sin of 72 and 144 degrees
    const T c1 = T(0.30901699437494742410), c2 = T(-0.80901699437494742410);
    const T s1 = T(0.95105651629515357212), s2 = T(0.58778525229247312917);
    const V ar = r[1] + r[4], ai = i[1] + i[4], br = r[2] + r[3], bi = i[2] + i[3];
    const V cr = r[1] - r[4], ci = i[1] - i[4], dr = r[2] - r[3], di = i[2] - i[3];
    const V mr = r[0] + c1 * ar + c2 * br, mi = i[0] + c1 * ai + c2 * bi;
    const V nr = r[0] + c2 * ar + c1 * br, ni = i[0] + c2 * ai + c1 * bi;
    const V xr = s1 * ci + s2 * di, xi = s1 * cr + s2 * dr;
    const V yr = s2 * ci - s1 * di, yi = s2 * cr - s1 * dr;
    r[0] += ar + br, i[0] += ai + bi;
    r[1] = mr + xr, i[1] = mi - xi;
    r[4] = mr - xr, i[4] = mi + xi;
    r[2] = nr + yr, i[2] = ni - yi;
    r[3] = nr - yr, i[3] = ni + yi;
  }
  // As 2 x 3 without twiddles (the indices of the remainders): x_j with j = 3 a + 2 b mod 6.
  [[gnu::always_inline]] static void six(V* r, V* i) {
    three(r[0], i[0], r[2], i[2], r[4], i[4]);
    three(r[3], i[3], r[5], i[5], r[1], i[1]);
    two(r[0], i[0], r[3], i[3]);
    two(r[2], i[2], r[5], i[5]);
    two(r[4], i[4], r[1], i[1]);
    // What stands at j is the value of k = -j.
    std::swap(r[1], r[5]), std::swap(i[1], i[5]);
    std::swap(r[2], r[4]), std::swap(i[2], i[4]);
  }
  [[gnu::always_inline]] static void eight(V* r, V* i) {
    const T h = static_cast<T>(std::numbers::sqrt2 / 2);
    four(r[0], i[0], r[2], i[2], r[4], i[4], r[6], i[6]);
    four(r[1], i[1], r[3], i[3], r[5], i[5], r[7], i[7]);
    // Times exp(-2 pi i k / 8), k = 1, 2, 3.
    const V ar = h * (r[3] + i[3]), ai = h * (i[3] - r[3]);
    const V br = i[5], bi = -r[5];
    const V cr = h * (i[7] - r[7]), ci = -h * (r[7] + i[7]);
    const V er = r[1], ei = i[1];
    const V x0r = r[0], x0i = i[0], x1r = r[2], x1i = i[2], x2r = r[4], x2i = i[4], x3r = r[6], x3i = i[6];
    r[0] = x0r + er, i[0] = x0i + ei, r[4] = x0r - er, i[4] = x0i - ei;
    r[1] = x1r + ar, i[1] = x1i + ai, r[5] = x1r - ar, i[5] = x1i - ai;
    r[2] = x2r + br, i[2] = x2i + bi, r[6] = x2r - br, i[6] = x2i - bi;
    r[3] = x3r + cr, i[3] = x3i + ci, r[7] = x3r - cr, i[7] = x3i - ci;
  }
  template <int radix>
  [[gnu::always_inline]] static void run(V* r, V* i) {
    if constexpr (radix == 2) two(r[0], i[0], r[1], i[1]);
    if constexpr (radix == 3) three(r[0], i[0], r[1], i[1], r[2], i[2]);
    if constexpr (radix == 4) four(r[0], i[0], r[1], i[1], r[2], i[2], r[3], i[3]);
    if constexpr (radix == 5) five(r, i);
    if constexpr (radix == 6) six(r, i);
    if constexpr (radix == 8) eight(r, i);
  }
};

// A pass over lines of radix * m blocks that lie `s` blocks apart. load(j, at, real, imaginary) gives the piece that
// begins `at` values after the start of block j, store() takes it.
template <int radix, bool last, class T, class Load, class Store>
[[gnu::always_inline]] inline void run_pass(const LanePass<T>& pass, const Load& load, const Store& store) {
  using V = typename Register<T>::Type;
  const std::size_t m = pass.rest, s = pass.apart;
  const T* turns = pass.turns.data();
  for (std::size_t p = 0; p < m; ++p, turns += 2 * (radix - 1))
    for (std::size_t q = 0; q < s; ++q)
      for (std::size_t at = 0; at < Lanes<T>::block; at += Lanes<T>::piece_step) {
        V r[radix], i[radix];
#pragma GCC unroll 8
        for (std::size_t k = 0; k < radix; ++k) load(q + s * (p + m * k), at, r[k], i[k]);
        Butterflies<T>::template run<radix>(r, i);
#pragma GCC unroll 8
        for (std::size_t k = 0; k < radix; ++k) {
          V real = r[k], imaginary = i[k];
          if (!last && k > 0) {
            const T c = turns[2 * (k - 1)], sine = turns[2 * (k - 1) + 1];
            real = r[k] * c + i[k] * sine;
            imaginary = i[k] * c - r[k] * sine;
          }
          store(q + s * (radix * p + k), at, real, imaginary);
        }
      }
}

template <bool last, class T, class Load, class Store>
[[gnu::always_inline]] inline void run_pass(const LanePass<T>& pass, const Load& load, const Store& store) {
  switch (pass.radix) {
    case 1:
      return run_pass<1, last>(pass, load, store);
    case 2:
      return run_pass<2, last>(pass, load, store);
    case 3:
      return run_pass<3, last>(pass, load, store);
    case 4:
      return run_pass<4, last>(pass, load, store);
    case 5:
      return run_pass<5, last>(pass, load, store);
    case 6:
      return run_pass<6, last>(pass, load, store);
    default:
      return run_pass<8, last>(pass, load, store);
  }
}

// Between passes: parts in `work`.
template <class T>
struct WorkLoad {
  const T* work;
  using V = typename Register<T>::Type;
  [[gnu::always_inline]] void operator()(std::size_t j, std::size_t at, V& real, V& imaginary) const {
    Lanes<T>::get_parts(work + j * Lanes<T>::block + at, real, imaginary);
  }
};
template <class T>
struct WorkStore {
  T* work;
  using V = typename Register<T>::Type;
  [[gnu::always_inline]] void operator()(std::size_t j, std::size_t at, V real, V imaginary) const {
    Lanes<T>::put_parts(work + j * Lanes<T>::block + at, real, imaginary);
  }
};

template <class T>
void run_middle_pass(const LanePass<T>& pass, const T* in, T* out) {
  run_pass<false>(pass, WorkLoad<T>{in}, WorkStore<T>{out});
}

// Unscaled transform of a plan's lines; `work`: plan.work_size() complex numbers. All values are loaded, each once,
// before the first is stored.
template <bool inverse, class T, class Load, class Store>
inline void transform(const LanePlan<T>& plan, const Load& load, const Store& store, std::complex<T>* work) {
  using V = typename Register<T>::Type;
  T* first = reinterpret_cast<T*>(work);
  if (plan.passes.empty()) {
    for (std::size_t j = 0; j < plan.n; ++j)
      for (std::size_t at = 0; at < Lanes<T>::block; at += Lanes<T>::piece_step) {
        V real, imaginary;
        load(j, at, real, imaginary);
        Lanes<T>::put_numbers(first + j * Lanes<T>::block + at, real, imaginary);
      }
    plan.execute_fftw(inverse, work);
    for (std::size_t j = 0; j < plan.n; ++j)
      for (std::size_t at = 0; at < Lanes<T>::block; at += Lanes<T>::piece_step) {
        V real, imaginary;
        Lanes<T>::get_numbers(first + j * Lanes<T>::block + at, real, imaginary);
        store(j, at, real, imaginary);
      }
    return;
  }
  T* second = first + plan.n * Lanes<T>::block;
  const std::size_t count = plan.passes.size();
  run_pass<false>(
      plan.passes.front(),
      [&](std::size_t j, std::size_t at, V & real, V & imaginary)
          __attribute__((always_inline)) { load(j, at, inverse ? imaginary : real, inverse ? real : imaginary); },
      WorkStore<T>{first});
  for (std::size_t i = 1; i + 1 < count; ++i, std::swap(first, second)) run_middle_pass(plan.passes[i], first, second);
  run_pass<true>(
      plan.passes.back(),
      WorkLoad<T>{first}, [&](std::size_t j, std::size_t at, V real, V imaginary) __attribute__((always_inline)) {
        store(j, at, inverse ? imaginary : real, inverse ? real : imaginary);
      });
}

}  // namespace spume::fourier
