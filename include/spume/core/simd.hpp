// SPDX-License-Identifier: MIT
// Vectors for loops over neighbours, on the compiler's vector types: the same text compiles to AVX-512, AVX2 or SSE.
// A particle's position and payload lie in one interleaved record of 4 (or 8, 12) floats; as many records as there are
// lanes are fetched by 128-bit loads and transposed, which was measured faster than gathers from separate arrays (1.26
// against 2.0 ns per pair on the pressure operator).
//
// f32x8 is for what comes in eights everywhere. f32n, of pair_lanes floats, fills the registers of the machine: pair
// sweeps take sixteen neighbours at a time where there is AVX-512 (pressure operator on Zen 5: 0.39 ns a pair, 0.53
// with eight).
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>

#include "spume/core/unrolled.hpp"

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace spume::simd {

using f32x4 = float __attribute__((vector_size(16)));
using f32x8 = float __attribute__((vector_size(32)));
using i32x8 = std::int32_t __attribute__((vector_size(32)));
using f64x4 = double __attribute__((vector_size(32)));

inline constexpr int lanes = 8;

#if defined(__AVX512F__) && defined(__AVX512DQ__)
inline constexpr int pair_lanes = 16;
using f32x16 = float __attribute__((vector_size(64)));
using f64x8 = double __attribute__((vector_size(64)));
using f32n = f32x16;
using f64n = f64x8;  // half as many as f32n
#else
inline constexpr int pair_lanes = lanes;
using f32n = f32x8;
using f64n = f64x4;
#endif

template <class V>
concept FloatVector = std::same_as<V, f32x8> || std::same_as<V, f32n>;

template <FloatVector V = f32x8>
[[gnu::always_inline]] inline V splat(float value) {
  if constexpr (sizeof(V) == 32)
    return V{value, value, value, value, value, value, value, value};
  else
    return V{value, value, value, value, value, value, value, value,
             value, value, value, value, value, value, value, value};
}

template <FloatVector V = f32x8>
[[gnu::always_inline]] inline V load(const float* p) {
  V v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

[[gnu::always_inline]] inline void store(float* p, f32x8 v) {
  std::memcpy(p, &v, sizeof v);
}

[[gnu::always_inline]] inline f32x4 load4(const float* p) {
  f32x4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

[[gnu::always_inline]] inline f32x8 sqrt(f32x8 v) {
#if defined(__AVX__)
  return f32x8(_mm256_sqrt_ps(__m256(v)));
#else
  f32x8 r{};
  for (int l = 0; l < lanes; ++l) r[l] = std::sqrt(v[l]);
  return r;
#endif
}

[[gnu::always_inline]] inline f32x8 max(f32x8 a, f32x8 b) {
#if defined(__AVX__)
  return f32x8(_mm256_max_ps(__m256(a), __m256(b)));
#else
  return a > b ? a : b;
#endif
}

[[gnu::always_inline]] inline f32x8 min(f32x8 a, f32x8 b) {
#if defined(__AVX__)
  return f32x8(_mm256_min_ps(__m256(a), __m256(b)));
#else
  return a < b ? a : b;
#endif
}

// Bit l tells whether a < b in lane l.
[[gnu::always_inline]] inline unsigned less_bits(f32x8 a, f32x8 b) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(__m256(a), __m256(b), _CMP_LT_OQ)));
#else
  unsigned bits = 0;
  for (int l = 0; l < lanes; ++l) bits |= (a[l] < b[l] ? 1U : 0U) << l;
  return bits;
#endif
}

// Sum over the lanes in a fixed order: pairs of halves, then pairs of pairs.
[[gnu::always_inline]] inline float sum(f32x8 v) {
  const f32x4 low = __builtin_shufflevector(v, v, 0, 1, 2, 3);
  const f32x4 high = __builtin_shufflevector(v, v, 4, 5, 6, 7);
  const f32x4 s = low + high;
  return (s[0] + s[2]) + (s[1] + s[3]);
}

// The least of the lanes and the largest: halves, then halves of halves.
[[gnu::always_inline]] inline float least(f32x8 v) {
  const f32x8 four = min(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
  const f32x8 two = min(four, __builtin_shufflevector(four, four, 2, 3, 0, 1, 6, 7, 4, 5));
  return two[1] < two[0] ? two[1] : two[0];
}
[[gnu::always_inline]] inline float largest(f32x8 v) {
  const f32x8 four = max(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
  const f32x8 two = max(four, __builtin_shufflevector(four, four, 2, 3, 0, 1, 6, 7, 4, 5));
  return two[0] < two[1] ? two[1] : two[0];
}

[[gnu::always_inline]] inline f64x4 to_f64_low(f32x8 v) {
  return __builtin_convertvector(__builtin_shufflevector(v, v, 0, 1, 2, 3), f64x4);
}
[[gnu::always_inline]] inline f64x4 to_f64_high(f32x8 v) {
  return __builtin_convertvector(__builtin_shufflevector(v, v, 4, 5, 6, 7), f64x4);
}
[[gnu::always_inline]] inline double sum(f64x4 v) {
  return (v[0] + v[2]) + (v[1] + v[3]);
}

// The second is inserted straight from memory; shuffled, it would be loaded first.
[[gnu::always_inline]] inline f32x8 side_by_side(f32x4 low, f32x4 high) {
#if defined(__AVX__)
  return f32x8(_mm256_insertf128_ps(_mm256_castps128_ps256(__m128(low)), __m128(high), 1));
#else
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}

// Where a record of `width` floats begins: an entry is four times its number, one of 16 bits its number.
template <int width>
[[gnu::always_inline]] inline std::int64_t record_offset(std::int32_t entry) {
  return static_cast<std::int64_t>(entry) * (width / 4);
}
template <int width>
[[gnu::always_inline]] inline std::int64_t record_offset(std::uint16_t number) {
  return static_cast<std::int64_t>(number) * width;
}

#if defined(__AVX512F__) && defined(__AVX512DQ__)
// With a mask of all lanes: the forms without one read a register that the compiler thinks undefined (GCC 12).
inline constexpr __mmask16 all_lanes = 0xffff;
[[gnu::always_inline]] inline f32x16 sqrt(f32x16 v) {
  return f32x16(_mm512_maskz_sqrt_ps(all_lanes, __m512(v)));
}
[[gnu::always_inline]] inline unsigned less_bits(f32x16 a, f32x16 b) {
  return _mm512_cmp_ps_mask(__m512(a), __m512(b), _CMP_LT_OQ);
}
[[gnu::always_inline]] inline f32x16 max(f32x16 a, f32x16 b) {
  return f32x16(_mm512_maskz_max_ps(all_lanes, __m512(a), __m512(b)));
}
[[gnu::always_inline]] inline f32x16 min(f32x16 a, f32x16 b) {
  return f32x16(_mm512_maskz_min_ps(all_lanes, __m512(a), __m512(b)));
}
[[gnu::always_inline]] inline f32x8 low_half(f32x16 v) {
  return __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7);
}
[[gnu::always_inline]] inline f32x8 high_half(f32x16 v) {
  return __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15);
}
[[gnu::always_inline]] inline float sum(f32x16 v) {
  return sum(low_half(v) + high_half(v));
}
[[gnu::always_inline]] inline float least(f32x16 v) {
  return least(min(low_half(v), high_half(v)));
}
[[gnu::always_inline]] inline float largest(f32x16 v) {
  return largest(max(low_half(v), high_half(v)));
}
[[gnu::always_inline]] inline f64x8 to_f64_low(f32x16 v) {
  return __builtin_convertvector(low_half(v), f64x8);
}
[[gnu::always_inline]] inline f64x8 to_f64_high(f32x16 v) {
  return __builtin_convertvector(high_half(v), f64x8);
}
[[gnu::always_inline]] inline double sum(f64x8 v) {
  return sum(__builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7));
}

// As below, of sixteen records.
template <int width, class Entry>
[[gnu::always_inline]] inline void load_records(const float* records, const Entry* entry, int block, f32x16 out[4]) {
  const float* base = records + 4 * block;
  const auto at = [&](int l) __attribute__((always_inline)) {
    return load4(base + record_offset<width>(entry[l]));
  };
  // Records l, l + 4, l + 8 and l + 12 side by side; what follows stays within these quarters.
  const auto four = [&](int l) __attribute__((always_inline)) {
    const f32x8 low = side_by_side(at(l), at(l + 4)), high = side_by_side(at(l + 8), at(l + 12));
    return _mm512_maskz_insertf32x8(all_lanes, _mm512_castps256_ps512(__m256(low)), __m256(high), 1);
  };
  const auto low_pairs = [](__m512 x, __m512 y) { return _mm512_maskz_unpacklo_ps(all_lanes, x, y); };
  const auto high_pairs = [](__m512 x, __m512 y) { return _mm512_maskz_unpackhi_ps(all_lanes, x, y); };
  const auto first_halves = [](__m512 x, __m512 y) { return f32x16(_mm512_maskz_shuffle_ps(all_lanes, x, y, 0x44)); };
  const auto second_halves = [](__m512 x, __m512 y) { return f32x16(_mm512_maskz_shuffle_ps(all_lanes, x, y, 0xee)); };
  const __m512 a = four(0), b = four(1), c = four(2), d = four(3);
  const __m512 ab_low = low_pairs(a, b), ab_high = high_pairs(a, b), cd_low = low_pairs(c, d),
               cd_high = high_pairs(c, d);
  out[0] = first_halves(ab_low, cd_low);
  out[1] = second_halves(ab_low, cd_low);
  out[2] = first_halves(ab_high, cd_high);
  out[3] = second_halves(ab_high, cd_high);
}

// Blocks `block` and `block` + 1 of sixteen records at once: half as many loads, three quarters of the shuffles.
template <int width, class Entry>
[[gnu::always_inline]] inline void load_two_blocks(const float* records, const Entry* entry, int block, f32x16 out[8]) {
  const float* base = records + 4 * block;
  const auto at = [&](int l) __attribute__((always_inline)) {
    return load<f32x8>(base + record_offset<width>(entry[l]));
  };
  // Records l and l + 4 side by side, two quarters each; of such four one component: four records in each quarter.
  const auto two = [&](int l) __attribute__((always_inline)) {
    return _mm512_maskz_insertf32x8(all_lanes, _mm512_castps256_ps512(__m256(at(l))), __m256(at(l + 4)), 1);
  };
  const auto low_pairs = [](__m512 x, __m512 y) { return _mm512_maskz_unpacklo_ps(all_lanes, x, y); };
  const auto high_pairs = [](__m512 x, __m512 y) { return _mm512_maskz_unpackhi_ps(all_lanes, x, y); };
  const auto eight = [&](int l, __m512 c[4]) __attribute__((always_inline)) {
    const __m512 a = two(l), b = two(l + 1), d = two(l + 2), e = two(l + 3);
    const __m512 ab_low = low_pairs(a, b), ab_high = high_pairs(a, b), de_low = low_pairs(d, e),
                 de_high = high_pairs(d, e);
    c[0] = _mm512_maskz_shuffle_ps(all_lanes, ab_low, de_low, 0x44);
    c[1] = _mm512_maskz_shuffle_ps(all_lanes, ab_low, de_low, 0xee);
    c[2] = _mm512_maskz_shuffle_ps(all_lanes, ab_high, de_high, 0x44);
    c[3] = _mm512_maskz_shuffle_ps(all_lanes, ab_high, de_high, 0xee);
  };
  __m512 first[4], second[4];
  eight(0, first);
  eight(8, second);
  for (int c = 0; c < 4; ++c) {
    out[c] = f32x16(_mm512_maskz_shuffle_f32x4(all_lanes, first[c], second[c], 0x88));      // even quarters
    out[4 + c] = f32x16(_mm512_maskz_shuffle_f32x4(all_lanes, first[c], second[c], 0xdd));  // odd quarters
  }
}
#endif

// Fetches floats [4 block, 4 block + 4) of eight records of `width` floats each, transposed: out[c] holds component c
// of all eight. entry[l] tells record l.
template <int width, class Entry>
[[gnu::always_inline]] inline void load_records(const float* records, const Entry* entry, int block, f32x8 out[4]) {
  const float* base = records + 4 * block;
  const auto at = [&](int l) { return load4(base + record_offset<width>(entry[l])); };
  const f32x8 a = side_by_side(at(0), at(4));
  const f32x8 b = side_by_side(at(1), at(5));
  const f32x8 c = side_by_side(at(2), at(6));
  const f32x8 d = side_by_side(at(3), at(7));
  const f32x8 ab_low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const f32x8 ab_high = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const f32x8 cd_low = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const f32x8 cd_high = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  out[0] = __builtin_shufflevector(ab_low, cd_low, 0, 1, 8, 9, 4, 5, 12, 13);
  out[1] = __builtin_shufflevector(ab_low, cd_low, 2, 3, 10, 11, 6, 7, 14, 15);
  out[2] = __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 4, 5, 12, 13);
  out[3] = __builtin_shufflevector(ab_high, cd_high, 2, 3, 10, 11, 6, 7, 14, 15);
}
template <int width, class Entry>
[[gnu::always_inline]] inline void load_two_blocks(const float* records, const Entry* entry, int block, f32x8 out[8]) {
  load_records<width>(records, entry, block, out);
  load_records<width>(records, entry, block + 1, out + 4);
}
// All floats of the records.
template <int width, class Entry, FloatVector V>
[[gnu::always_inline]] inline void load_whole_records(const float* records, const Entry* entry, V out[width]) {
  unrolled<width / 8>([&](auto pair) __attribute__((always_inline)) {
    load_two_blocks<width>(records, entry, 2 * pair, out + 8 * pair);
  });
  if constexpr (width % 8 != 0) load_records<width>(records, entry, width / 4 - 1, out + width - 4);
}

}  // namespace spume::simd
