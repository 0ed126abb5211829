// SPDX-License-Identifier: MIT
// Sixteen lanes on every machine: one register with AVX-512, two of eight lanes elsewhere (the compiler takes vectors
// apart, number by number, that are longer than its registers). For searches, which compare, choose and put down.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "spume/core/simd.hpp"

namespace spume::simd {

using bits16 = std::uint16_t;  // one for every lane

#if defined(__AVX512F__) && defined(__AVX512DQ__)

using i32x16 = std::int32_t __attribute__((vector_size(64)));

[[gnu::always_inline]] inline i32x16 splat16(std::int32_t v) {
  return i32x16{v, v, v, v, v, v, v, v, v, v, v, v, v, v, v, v};
}
[[gnu::always_inline]] inline f32x16 splat16(float v) {
  return splat<f32x16>(v);
}
[[gnu::always_inline]] inline f32x16 load16(const float* p) {
  return load<f32x16>(p);
}
template <class V, class Number>
[[gnu::always_inline]] inline void store16(Number* p, V v) {
  std::memcpy(p, &v, sizeof v);
}
[[gnu::always_inline]] inline f32x16 to_float(i32x16 v) {
  return __builtin_convertvector(v, f32x16);
}
[[gnu::always_inline]] inline f32x16 same_bits(i32x16 v) {
  return f32x16(v);
}
[[gnu::always_inline]] inline f32x16 smaller(f32x16 a, f32x16 b) {
  return min(a, b);
}
[[gnu::always_inline]] inline f32x16 larger(f32x16 a, f32x16 b) {
  return max(a, b);
}
[[gnu::always_inline]] inline f32x16 square_root(f32x16 v) {
  return sqrt(v);
}
// Bit l tells whether a < b, or a == b, in lane l.
[[gnu::always_inline]] inline bits16 bits_less(i32x16 a, i32x16 b) {
  return _mm512_cmplt_epi32_mask(__m512i(a), __m512i(b));
}
[[gnu::always_inline]] inline bits16 bits_less(f32x16 a, f32x16 b) {
  return _mm512_cmp_ps_mask(__m512(a), __m512(b), _CMP_LT_OQ);
}
[[gnu::always_inline]] inline bits16 bits_equal(i32x16 a, i32x16 b) {
  return _mm512_cmpeq_epi32_mask(__m512i(a), __m512i(b));
}
[[gnu::always_inline]] inline bits16 bits_equal(f32x16 a, f32x16 b) {
  return _mm512_cmp_ps_mask(__m512(a), __m512(b), _CMP_EQ_OQ);
}
// a in the lanes of the set bits, b in the others.
template <class V>
[[gnu::always_inline]] inline V chosen(bits16 bits, V a, V b) {
  return V(_mm512_mask_blend_epi32(bits, __m512i(b), __m512i(a)));
}
// Every number four times over, a quarter after a quarter.
[[gnu::always_inline]] inline i32x16 four_times(const std::int32_t v[4]) {
  const std::int32_t quarter __attribute__((vector_size(16))) = {v[0], v[1], v[2], v[3]};
  return i32x16(_mm512_maskz_broadcast_i32x4(all_lanes, __m128i(quarter)));
}
// The number of every lane's quarter.
[[gnu::always_inline]] inline i32x16 quarters() {
  return i32x16{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
}
[[gnu::always_inline]] inline float least(f32x16 v) {
  const f32x8 eight = min(low_half(v), high_half(v));
  const f32x8 four = min(eight, __builtin_shufflevector(eight, eight, 4, 5, 6, 7, 0, 1, 2, 3));
  const f32x8 two = min(four, __builtin_shufflevector(four, four, 2, 3, 0, 1, 6, 7, 4, 5));
  return std::min(two[0], two[1]);
}

#else

struct f32x16 {
  f32x8 low, high;
  [[gnu::always_inline]] friend f32x16 operator+(f32x16 a, f32x16 b) { return {a.low + b.low, a.high + b.high}; }
  [[gnu::always_inline]] friend f32x16 operator-(f32x16 a, f32x16 b) { return {a.low - b.low, a.high - b.high}; }
  [[gnu::always_inline]] friend f32x16 operator*(f32x16 a, f32x16 b) { return {a.low * b.low, a.high * b.high}; }
};
struct i32x16 {
  i32x8 low, high;
  [[gnu::always_inline]] friend i32x16 operator+(i32x16 a, i32x16 b) { return {a.low + b.low, a.high + b.high}; }
  [[gnu::always_inline]] friend i32x16 operator-(i32x16 a, i32x16 b) { return {a.low - b.low, a.high - b.high}; }
};

[[gnu::always_inline]] inline i32x16 splat16(std::int32_t v) {
  const i32x8 half{v, v, v, v, v, v, v, v};
  return {half, half};
}
[[gnu::always_inline]] inline f32x16 splat16(float v) {
  return {splat(v), splat(v)};
}
[[gnu::always_inline]] inline f32x16 load16(const float* p) {
  return {load(p), load(p + 8)};
}
template <class V, class Number>
[[gnu::always_inline]] inline void store16(Number* p, V v) {
  std::memcpy(p, &v.low, sizeof v.low);
  std::memcpy(p + 8, &v.high, sizeof v.high);
}
[[gnu::always_inline]] inline f32x16 to_float(i32x16 v) {
  return {__builtin_convertvector(v.low, f32x8), __builtin_convertvector(v.high, f32x8)};
}
[[gnu::always_inline]] inline f32x16 same_bits(i32x16 v) {
  return {f32x8(v.low), f32x8(v.high)};
}
[[gnu::always_inline]] inline f32x16 smaller(f32x16 a, f32x16 b) {
  return {min(a.low, b.low), min(a.high, b.high)};
}
[[gnu::always_inline]] inline f32x16 larger(f32x16 a, f32x16 b) {
  return {max(a.low, b.low), max(a.high, b.high)};
}
[[gnu::always_inline]] inline f32x16 square_root(f32x16 v) {
  return {sqrt(v.low), sqrt(v.high)};
}
namespace detail {
// Of a comparison: all bits of a lane are set, or none.
[[gnu::always_inline]] inline unsigned bits_of(i32x8 lanes) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps(__m256(lanes)));
#else
  unsigned bits = 0;
  for (int l = 0; l < simd::lanes; ++l) bits |= static_cast<unsigned>(lanes[l]) >> 31 << l;
  return bits;
#endif
}
[[gnu::always_inline]] inline i32x8 lanes_of(unsigned bits) {
  const i32x8 bit{1, 2, 4, 8, 16, 32, 64, 128};
  const auto v = static_cast<std::int32_t>(bits & 0xffU);
  return (i32x8{v, v, v, v, v, v, v, v} & bit) == bit;
}
}  // namespace detail
template <class V>
[[gnu::always_inline]] inline bits16 bits_less(V a, V b) {
  return static_cast<bits16>(detail::bits_of(a.low < b.low) | detail::bits_of(a.high < b.high) << 8);
}
template <class V>
[[gnu::always_inline]] inline bits16 bits_equal(V a, V b) {
  return static_cast<bits16>(detail::bits_of(a.low == b.low) | detail::bits_of(a.high == b.high) << 8);
}
template <class V>
[[gnu::always_inline]] inline V chosen(bits16 bits, V a, V b) {
  using Half = decltype(V::low);
  const auto of_half = [](i32x8 lanes, Half p, Half q) { return Half((lanes & i32x8(p)) | (~lanes & i32x8(q))); };
  return {of_half(detail::lanes_of(bits), a.low, b.low), of_half(detail::lanes_of(bits >> 8U), a.high, b.high)};
}
[[gnu::always_inline]] inline i32x16 four_times(const std::int32_t v[4]) {
  const i32x8 half{v[0], v[1], v[2], v[3], v[0], v[1], v[2], v[3]};
  return {half, half};
}
[[gnu::always_inline]] inline i32x16 quarters() {
  return {i32x8{0, 0, 0, 0, 1, 1, 1, 1}, i32x8{2, 2, 2, 2, 3, 3, 3, 3}};
}
[[gnu::always_inline]] inline float least(f32x16 v) {
  const f32x8 eight = min(v.low, v.high);
  const f32x8 four = min(eight, __builtin_shufflevector(eight, eight, 4, 5, 6, 7, 0, 1, 2, 3));
  const f32x8 two = min(four, __builtin_shufflevector(four, four, 2, 3, 0, 1, 6, 7, 4, 5));
  return std::min(two[0], two[1]);
}

#endif

// Writes the lanes of the set bits one after the other; room for sixteen is needed in any case.
template <class Number, class V>
[[gnu::always_inline]] inline void store_chosen(Number* to, V v, bits16 bits) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  store16(to, _mm512_maskz_compress_epi32(bits, __m512i(v)));
#else
  Number all[16];
  store16(all, v);
  for (int l = 0; l < 16; ++l) {
    *to = all[l];
    to += bits >> l & 1;
  }
#endif
}
// The lane of the lowest set bit.
[[gnu::always_inline]] inline std::int32_t lane_of(i32x16 v, bits16 bits) {
  std::int32_t all[16];
  store16(all, v);
  return all[std::countr_zero(bits) & 15];
}

// Four rows of records of four numbers, from records begin[r]: out[c] holds number c of record l of row r in lane
// 4 l + r.
[[gnu::always_inline]] inline void load_four_rows(const std::int32_t* records, const std::int32_t begin[4],
                                                  i32x16 out[4]) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  using i64x8 = std::int64_t __attribute__((vector_size(64)));
  const auto row = [&](int r) {
    i32x16 v;
    std::memcpy(&v, records + 4 * static_cast<std::int64_t>(begin[r]), sizeof v);
    return v;
  };
  const auto low = [](i32x16 p, i32x16 q) {
    return i64x8(__builtin_shufflevector(p, q, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29));
  };
  const auto high = [](i32x16 p, i32x16 q) {
    return i64x8(__builtin_shufflevector(p, q, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31));
  };
  const i32x16 a = row(0), b = row(1), c = row(2), d = row(3);
  const i64x8 ab_low = low(a, b), ab_high = high(a, b), cd_low = low(c, d), cd_high = high(c, d);
  out[0] = i32x16(__builtin_shufflevector(ab_low, cd_low, 0, 8, 2, 10, 4, 12, 6, 14));
  out[1] = i32x16(__builtin_shufflevector(ab_low, cd_low, 1, 9, 3, 11, 5, 13, 7, 15));
  out[2] = i32x16(__builtin_shufflevector(ab_high, cd_high, 0, 8, 2, 10, 4, 12, 6, 14));
  out[3] = i32x16(__builtin_shufflevector(ab_high, cd_high, 1, 9, 3, 11, 5, 13, 7, 15));
#else
  // load_records() takes two records of a row at a time: its lanes are records.
  const auto half = [&](int first, f32x8 v[4]) {
    std::int32_t entry[8];
    for (int l = 0; l < 8; ++l) entry[l] = 4 * (begin[l % 4] + first + l / 4);
    load_records<4>(reinterpret_cast<const float*>(records), entry, 0, v);
  };
  f32x8 low[4], high[4];
  half(0, low);
  half(2, high);
  for (int c = 0; c < 4; ++c) out[c] = {i32x8(low[c]), i32x8(high[c])};
#endif
}

}  // namespace spume::simd
