// SPDX-License-Identifier: MIT
// Sixteen lanes on every machine: one register with AVX-512, two or four elsewhere (the compiler takes vectors apart,
// number by number, that are longer than its registers). For searches, which compare, choose and put down.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "spume/core/simd.hpp"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

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
// a - b, wrapped around at 2^31.
[[gnu::always_inline]] inline i32x16 wrapped_difference(i32x16 a, i32x16 b) {
  using u32x16 = std::uint32_t __attribute__((vector_size(64)));
  return i32x16(u32x16(a) - u32x16(b));
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

#else

namespace detail {
#if defined(__AVX2__)
using f32p = f32x8;
using i32p = i32x8;
[[gnu::always_inline]] inline f32p square_root(f32p v) {
  return sqrt(v);
}
[[gnu::always_inline]] inline f32p smaller(f32p a, f32p b) {
  return min(a, b);
}
[[gnu::always_inline]] inline f32p larger(f32p a, f32p b) {
  return max(a, b);
}
// Of a comparison: all bits of a lane are set, or none.
[[gnu::always_inline]] inline unsigned bits_of(i32p lanes) {
  return static_cast<unsigned>(_mm256_movemask_ps(__m256(lanes)));
}
#else
using f32p = f32x4;
using i32p = std::int32_t __attribute__((vector_size(16)));
#if defined(__SSE2__)
[[gnu::always_inline]] inline f32p square_root(f32p v) {
  return f32p(_mm_sqrt_ps(__m128(v)));
}
[[gnu::always_inline]] inline f32p smaller(f32p a, f32p b) {
  return f32p(_mm_min_ps(__m128(a), __m128(b)));
}
[[gnu::always_inline]] inline f32p larger(f32p a, f32p b) {
  return f32p(_mm_max_ps(__m128(a), __m128(b)));
}
[[gnu::always_inline]] inline unsigned bits_of(i32p lanes) {
  return static_cast<unsigned>(_mm_movemask_ps(__m128(lanes)));
}
#else
[[gnu::always_inline]] inline f32p square_root(f32p v) {
  return {std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3])};
}
[[gnu::always_inline]] inline f32p smaller(f32p a, f32p b) {
  return a < b ? a : b;
}
[[gnu::always_inline]] inline f32p larger(f32p a, f32p b) {
  return a > b ? a : b;
}
[[gnu::always_inline]] inline unsigned bits_of(i32p lanes) {
  unsigned bits = 0;
  for (int l = 0; l < 4; ++l) bits |= static_cast<unsigned>(lanes[l]) >> 31U << l;
  return bits;
}
#endif
#endif

inline constexpr int piece_lanes = sizeof(f32p) / sizeof(float), pieces = 16 / piece_lanes;

template <class Piece>
struct Sixteen {
  Piece piece[pieces];
  friend Sixteen operator+(Sixteen a, Sixteen b) {
    return of_pieces([&](int p) { return a.piece[p] + b.piece[p]; });
  }
  friend Sixteen operator-(Sixteen a, Sixteen b) {
    return of_pieces([&](int p) { return a.piece[p] - b.piece[p]; });
  }
  friend Sixteen operator*(Sixteen a, Sixteen b) {
    return of_pieces([&](int p) { return a.piece[p] * b.piece[p]; });
  }
  template <class Of>
  [[gnu::always_inline]] static Sixteen of_pieces(Of&& of) {
    Sixteen out;
    for (int p = 0; p < pieces; ++p) out.piece[p] = of(p);
    return out;
  }
};
template <class Of>
[[gnu::always_inline]] inline bits16 bits_of_pieces(Of&& of) {
  unsigned bits = 0;
  for (int p = 0; p < pieces; ++p) bits |= bits_of(of(p)) << p * piece_lanes;
  return static_cast<bits16>(bits);
}
}  // namespace detail

using f32x16 = detail::Sixteen<detail::f32p>;
using i32x16 = detail::Sixteen<detail::i32p>;

[[gnu::always_inline]] inline i32x16 splat16(std::int32_t v) {
  return i32x16::of_pieces([&](int) { return detail::i32p{} + v; });
}
[[gnu::always_inline]] inline f32x16 splat16(float v) {
  return f32x16::of_pieces([&](int) { return detail::f32p{} + v; });
}
[[gnu::always_inline]] inline f32x16 load16(const float* p) {
  f32x16 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <class V, class Number>
[[gnu::always_inline]] inline void store16(Number* p, V v) {
  std::memcpy(p, &v, sizeof v);
}
[[gnu::always_inline]] inline f32x16 to_float(i32x16 v) {
  return f32x16::of_pieces([&](int p) { return __builtin_convertvector(v.piece[p], detail::f32p); });
}
[[gnu::always_inline]] inline i32x16 wrapped_difference(i32x16 a, i32x16 b) {
  using u32p = std::uint32_t __attribute__((vector_size(sizeof(detail::i32p))));
  return i32x16::of_pieces([&](int p) { return detail::i32p(u32p(a.piece[p]) - u32p(b.piece[p])); });
}
[[gnu::always_inline]] inline f32x16 same_bits(i32x16 v) {
  return f32x16::of_pieces([&](int p) { return detail::f32p(v.piece[p]); });
}
[[gnu::always_inline]] inline f32x16 smaller(f32x16 a, f32x16 b) {
  return f32x16::of_pieces([&](int p) { return detail::smaller(a.piece[p], b.piece[p]); });
}
[[gnu::always_inline]] inline f32x16 larger(f32x16 a, f32x16 b) {
  return f32x16::of_pieces([&](int p) { return detail::larger(a.piece[p], b.piece[p]); });
}
[[gnu::always_inline]] inline f32x16 square_root(f32x16 v) {
  return f32x16::of_pieces([&](int p) { return detail::square_root(v.piece[p]); });
}
template <class V>
[[gnu::always_inline]] inline bits16 bits_less(V a, V b) {
  return detail::bits_of_pieces([&](int p) { return a.piece[p] < b.piece[p]; });
}
template <class V>
[[gnu::always_inline]] inline bits16 bits_equal(V a, V b) {
  return detail::bits_of_pieces([&](int p) { return a.piece[p] == b.piece[p]; });
}
template <class V>
[[gnu::always_inline]] inline V chosen(bits16 bits, V a, V b) {
  using detail::i32p;
  return V::of_pieces([&](int p) {
#if defined(__AVX2__)
    const i32p bit{1, 2, 4, 8, 16, 32, 64, 128};
#else
    const i32p bit{1, 2, 4, 8};
#endif
    const i32p lanes = ((i32p{} + (bits >> p * detail::piece_lanes)) & bit) == bit;
    return decltype(a.piece[p] + a.piece[p])((lanes & i32p(a.piece[p])) | (~lanes & i32p(b.piece[p])));
  });
}
[[gnu::always_inline]] inline i32x16 four_times(const std::int32_t v[4]) {
#if defined(__AVX2__)
  return i32x16::of_pieces([&](int) { return i32x8{v[0], v[1], v[2], v[3], v[0], v[1], v[2], v[3]}; });
#else
  return i32x16::of_pieces([&](int) { return detail::i32p{v[0], v[1], v[2], v[3]}; });
#endif
}
[[gnu::always_inline]] inline i32x16 quarters() {
#if defined(__AVX2__)
  return i32x16::of_pieces([&](int p) { return i32x8{0, 0, 0, 0, 1, 1, 1, 1} + 2 * p; });
#else
  return i32x16::of_pieces([&](int p) { return detail::i32p{} + p; });
#endif
}
[[gnu::always_inline]] inline float least(f32x16 v) {
  detail::f32p all = v.piece[0];
  for (int p = 1; p < detail::pieces; ++p) all = detail::smaller(all, v.piece[p]);
#if defined(__AVX2__)
  all = min(all, __builtin_shufflevector(all, all, 4, 5, 6, 7, 0, 1, 2, 3));
#endif
  return std::min(std::min(all[0], all[1]), std::min(all[2], all[3]));
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
#elif defined(__AVX2__)
  // load_records() takes eight: two of every row.
  const auto half = [&](int p) {
    std::int32_t entry[8];
    for (int l = 0; l < 8; ++l) entry[l] = 4 * (begin[l % 4] + 2 * p + l / 4);
    f32x8 v[4];
    load_records<4>(reinterpret_cast<const float*>(records), entry, 0, v);
    for (int c = 0; c < 4; ++c) out[c].piece[p] = i32x8(v[c]);
  };
  half(0);
  half(1);
#else
  for (int p = 0; p < 4; ++p) {
    detail::i32p row[4];
    for (int r = 0; r < 4; ++r)
      std::memcpy(&row[r], records + 4 * (static_cast<std::int64_t>(begin[r]) + p), sizeof row[r]);
    const detail::i32p ab_low = __builtin_shufflevector(row[0], row[1], 0, 4, 1, 5),
                       ab_high = __builtin_shufflevector(row[0], row[1], 2, 6, 3, 7),
                       cd_low = __builtin_shufflevector(row[2], row[3], 0, 4, 1, 5),
                       cd_high = __builtin_shufflevector(row[2], row[3], 2, 6, 3, 7);
    out[0].piece[p] = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
    out[1].piece[p] = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
    out[2].piece[p] = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
    out[3].piece[p] = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
  }
#endif
}

}  // namespace spume::simd
