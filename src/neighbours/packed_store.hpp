// SPDX-License-Identifier: MIT
// Packed stores: the lanes of a vector that a mask names, side by side.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "spume/core/simd.hpp"

namespace spume {

using simd::f32n;
using simd::f32x8;
using simd::i32x8;
using simd::pair_lanes;

// For each 8-bit mask the lanes that are set, in order, one byte each.
constexpr std::array<std::uint64_t, 256> make_lane_table() {
  std::array<std::uint64_t, 256> table{};
  for (unsigned mask = 0; mask < 256; ++mask) {
    std::uint64_t packed = 0;
    int slot = 0;
    for (unsigned lane = 0; lane < 8; ++lane)
      if (mask >> lane & 1U) packed |= std::uint64_t{lane} << (8 * slot++);
    table[mask] = packed;
  }
  return table;
}
inline constexpr auto lane_table = make_lane_table();

// Packs the lanes of v that are set in the mask to the front.
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
using Packing = __mmask16;
using i32n = std::int32_t __attribute__((vector_size(64)));
[[gnu::always_inline]] inline Packing packing_of(unsigned mask) {
  return static_cast<__mmask16>(mask);
}
[[gnu::always_inline]] inline i32n packed(i32n v, Packing packing) {
  return i32n(_mm512_maskz_compress_epi32(packing, __m512i(v)));
}
[[gnu::always_inline]] inline void store_packed(i32n v, Packing packing, std::int32_t* out) {
  _mm512_storeu_si512(out, __m512i(packed(v, packing)));
}
[[gnu::always_inline]] inline void store_packed(f32n v, Packing packing, float* out) {
  _mm512_storeu_ps(out, _mm512_maskz_compress_ps(packing, __m512(v)));
}
[[gnu::always_inline]] inline void store_packed(i32x8 v, Packing packing, std::int32_t* out) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                      _mm256_maskz_compress_epi32(static_cast<__mmask8>(packing), __m256i(v)));
}
[[gnu::always_inline]] inline void store_packed(f32x8 v, Packing packing, float* out) {
  _mm256_storeu_ps(out, _mm256_maskz_compress_ps(static_cast<__mmask8>(packing), __m256(v)));
}
#elif defined(__AVX2__)
using Packing = __m256i;
using i32n = i32x8;
[[gnu::always_inline]] inline Packing packing_of(unsigned mask) {
  return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(lane_table[mask])));
}
[[gnu::always_inline]] inline i32n packed(i32n v, Packing packing) {
  return i32n(_mm256_permutevar8x32_epi32(__m256i(v), packing));
}
[[gnu::always_inline]] inline void store_packed(i32x8 v, Packing packing, std::int32_t* out) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), __m256i(packed(v, packing)));
}
[[gnu::always_inline]] inline void store_packed(f32x8 v, Packing packing, float* out) {
  _mm256_storeu_ps(out, _mm256_permutevar8x32_ps(__m256(v), packing));
}
#else
using Packing = std::uint64_t;
using i32n = i32x8;
[[gnu::always_inline]] inline Packing packing_of(unsigned mask) {
  return lane_table[mask];
}
[[gnu::always_inline]] inline i32n packed(i32n v, Packing packing) {
  i32n out{};
  for (int k = 0; k < 8; ++k, packing >>= 8) out[k] = v[packing & 7U];
  return out;
}
template <class V, class T>
[[gnu::always_inline]] inline void store_packed(V v, Packing packing, T* out) {
  for (int k = 0; k < 8; ++k, packing >>= 8) out[k] = v[packing & 7U];
}
#endif

// Numbers of 16 bits in the lanes of a vector.
using Codes = std::uint16_t __attribute__((vector_size(2 * pair_lanes)));
#if defined(__AVX2__) && !(defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__))
// The same lanes as in lane_table, two bytes each.
constexpr std::array<std::array<std::uint8_t, 16>, 256> make_code_table() {
  std::array<std::array<std::uint8_t, 16>, 256> table{};
  for (unsigned mask = 0; mask < 256; ++mask)
    for (unsigned slot = 0; slot < 8; ++slot)
      for (unsigned half = 0; half < 2; ++half)
        table[mask][2 * slot + half] = static_cast<std::uint8_t>(2 * (lane_table[mask] >> (8 * slot) & 0xFFU) + half);
  return table;
}
alignas(16) inline constexpr auto code_table = make_code_table();
#endif
[[gnu::always_inline]] inline void store_packed(Codes v, unsigned mask, std::uint16_t* out) {
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
  const Codes lanes = __builtin_convertvector(packed(__builtin_convertvector(v, i32n), packing_of(mask)), Codes);
#elif defined(__AVX2__)
  const auto order = _mm_load_si128(reinterpret_cast<const __m128i*>(code_table[mask].data()));
  const Codes lanes = Codes(_mm_shuffle_epi8(__m128i(v), order));
#else
  Codes lanes{};
  Packing packing = packing_of(mask);
  for (int k = 0; k < 8; ++k, packing >>= 8) lanes[k] = v[packing & 7U];
#endif
  std::memcpy(out, &lanes, sizeof lanes);
}
[[gnu::always_inline]] inline void store_packed(i32n v, unsigned mask, std::int32_t* out) {
  store_packed(v, packing_of(mask), out);
}

[[gnu::always_inline]] inline unsigned mask_of(i32x8 lanes) {
#if defined(__AVX__)
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(__m256i(lanes))));
#else
  unsigned mask = 0;
  for (int l = 0; l < 8; ++l) mask |= static_cast<unsigned>(lanes[l] != 0) << l;
  return mask;
#endif
}

static_assert(sizeof(i32n) == sizeof(f32n));

// Numbers from `first` on.
[[gnu::always_inline]] inline i32n numbers_from(std::int32_t first) {
  i32n lane;
  for (int l = 0; l < pair_lanes; ++l) lane[l] = l;
  return lane + first;
}

// One bit for each of the first `count` lanes, of all if there are fewer.
[[gnu::always_inline]] inline unsigned first_lanes(std::int32_t count) {
  return count < pair_lanes ? (1U << count) - 1U : (2U << (pair_lanes - 1)) - 1U;
}

template <class V = i32x8>
[[gnu::always_inline]] inline V load_int(const std::int32_t* p) {
  V v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

// The least and the largest of the lanes.
[[gnu::always_inline]] inline std::int32_t least_lane(i32n v) {
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
  return _mm512_mask_reduce_min_epi32(0xFFFF, __m512i(v));
#else
  std::int32_t least = v[0];
  for (int l = 1; l < pair_lanes; ++l) least = v[l] < least ? v[l] : least;
  return least;
#endif
}
[[gnu::always_inline]] inline std::int32_t largest_lane(i32n v) {
  return ~least_lane(~v);
}

[[gnu::always_inline]] inline void store_int(std::int32_t* p, i32x8 v) {
  std::memcpy(p, &v, sizeof v);
}

}  // namespace spume
