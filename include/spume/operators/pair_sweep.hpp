// SPDX-License-Identifier: MIT
// The loop under every particle sweep. A sweep packs what it reads per neighbour into interleaved records (one
// streaming pass), then visits each particle's list eight or sixteen neighbours at a time.
//
// A record is `dimensions` float coordinates followed by the payload, padded to a multiple of four floats;
// records are numbered as the points of the neighbour list: particles, images, sentinel.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "spume/core/array.hpp"
#include "spume/core/kernel.hpp"
#include "spume/core/kernel_kind.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/simd.hpp"
#include "spume/core/unrolled.hpp"
#include "spume/neighbours/neighbour_list.hpp"

namespace spume {

struct WallStencils;

constexpr int record_width(int dimensions, int payload) {
  return (dimensions + payload + 3) / 4 * 4;
}

// What all sweeps of a step share: the lists, the resolution, and the images' relation to particles.
struct SweepContext {
  const NeighbourList* list = nullptr;
  const Images* images = nullptr;
  const WallStencils* walls = nullptr;  // of the wall points among the images; null: there are none
  // Per image: what the pressure there has beside that of its source, as behind walls that are accelerated. Null:
  // nothing.
  const double* image_pressure = nullptr;
  int dimensions = 3;
  KernelKind kernel = KernelKind::wendland_c2;
  double smoothing_length = 0;
  double volume = 0;  // of every particle
  // Of the kernel gradients, beside the kernel's own. With dimensions / LatticeConstants::divergence_of_position their
  // sums over a lattice are exact for linear fields and, of Laplacians, quadratic ones: 1.027 in 2-D, 1.02 in 3-D at
  // h / dr = 1.3.
  double gradient_scale = 1;
  // Particles of different sizes: h_i / smoothing_length and V_i / volume, per particle, in two and three dimensions.
  // Both or neither; null: all alike.
  const float* length_ratio = nullptr;
  const float* volume_ratio = nullptr;
};

// A kernel under which particles differ in size: sweeps take h_i of the centre and the volume V_j of each neighbour,
// which is one more float of payload, the last. With a plain kernel nothing of this is compiled.
template <class Kernel>
struct VariableH : Kernel {};
template <class Kernel>
inline constexpr bool is_variable_h = false;
template <class Kernel>
inline constexpr bool is_variable_h<VariableH<Kernel>> = true;
template <class Kernel>
inline constexpr int volume_slots = is_variable_h<Kernel> ? 1 : 0;

// Kernel factors with the particle volume folded in, in the precision of the pair loop.
template <int dimensions, class Kernel>
struct KernelScale {
  float inverse_h;
  float value;     // V sigma / h^d:      V W      = value * w(q)
  float gradient;  // V sigma / h^(d+2):  V grad W = gradient * F(q) (r_i - r_j)

  explicit KernelScale(const SweepContext& context) {
    const double h = context.smoothing_length;
    const double h_d = dimensions == 3 ? h * h * h : h * h;
    const double scale = context.volume * Kernel::normalisation(dimensions) / h_d;
    inverse_h = static_cast<float>(1 / h);
    value = static_cast<float>(scale);
    gradient = static_cast<float>(context.gradient_scale * scale / (h * h));
  }

  // The factors at particle i.
  KernelScale at([[maybe_unused]] const SweepContext& context, [[maybe_unused]] std::size_t i) const {
    if constexpr (is_variable_h<Kernel>) {
      KernelScale own = *this;
      const float inverse = 1 / context.length_ratio[i];
      const float inverse2 = inverse * inverse;
      const float inverse_d = dimensions == 3 ? inverse2 * inverse : inverse2;
      own.inverse_h *= inverse;
      own.value *= inverse_d;
      own.gradient *= inverse_d * inverse2;
      return own;
    } else {
      return *this;
    }
  }
};

// x times the volumes of a batch of neighbours, over the volume that the kernel factors hold.
template <class Kernel, class Batch>
[[gnu::always_inline]] inline simd::f32n times_volume(simd::f32n x, [[maybe_unused]] const Batch& batch) {
  if constexpr (is_variable_h<Kernel>)
    return x * batch.payload.back();
  else
    return x;
}
// The same of the particle itself.
template <class Kernel>
[[gnu::always_inline]] inline float own_volume([[maybe_unused]] const SweepContext& context,
                                               [[maybe_unused]] std::size_t i) {
  if constexpr (is_variable_h<Kernel>)
    return context.volume_ratio[i];
  else
    return 1;
}

// pair_lanes neighbours of one particle: q = r / h, d = r_j - r_i, and their payloads.
template <int dimensions, int payload_floats>
struct Batch {
  simd::f32n q;
  std::array<simd::f32n, dimensions> d;
  std::array<simd::f32n, payload_floats> payload;
};

// q where the lanes of a batch of a narrow list hold a neighbour. Others repeat the first: they are put where every
// kernel vanishes.
inline constexpr float beyond_kernels = 1e6F;
[[gnu::always_inline]] inline simd::f32n q_of_neighbours(const std::uint16_t* code, simd::f32n q) {
#if defined(__AVX512BW__) && defined(__AVX512VL__)
  const __mmask16 repeated =
      _mm256_mask_cmpeq_epi16_mask(0xFFFE, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(code)),
                                   _mm256_set1_epi16(static_cast<short>(code[0])));
  return simd::f32n(_mm512_mask_blend_ps(repeated, __m512(q), _mm512_set1_ps(beyond_kernels)));
#else
  // What is left of a batch is its end, and few have any.
  if (code[simd::pair_lanes - 1] != code[0]) [[likely]]
    return q;
  using Codes = std::int16_t __attribute__((vector_size(2 * simd::pair_lanes)));
  using Lanes = std::int32_t __attribute__((vector_size(4 * simd::pair_lanes)));
  Codes codes;
  std::memcpy(&codes, code, sizeof codes);
  Lanes repeated = __builtin_convertvector(codes == codes[0], Lanes);
  repeated[0] = 0;
  return repeated ? simd::splat<simd::f32n>(beyond_kernels) : q;
#endif
}

// Bytes of lists asked for ahead of a sweep, seven particles: pressure operator 1.2 times faster (bench/README.md).
inline constexpr std::size_t list_ahead = 2048;

// body(batch) of the records `value` of neighbours, the particle at `centre`; those of a narrow list have codes.
template <int dimensions, int payload, class Body>
[[gnu::always_inline]] inline void visit_batch(const std::array<simd::f32n, dimensions>& centre,
                                               const simd::f32n* value, float inverse_h, const std::uint16_t* code,
                                               Body& body) {
  Batch<dimensions, payload> batch;
  simd::f32n r2;
  unrolled<dimensions>([&](auto axis) __attribute__((always_inline)) {
    batch.d[axis] = value[axis] - centre[axis];
    if constexpr (axis == 0)
      r2 = batch.d[axis] * batch.d[axis];
    else
      r2 = r2 + batch.d[axis] * batch.d[axis];
  });
  batch.q = simd::sqrt(r2) * inverse_h;
  if (code != nullptr) batch.q = q_of_neighbours(code, batch.q);
  unrolled<payload>([&](auto p) __attribute__((always_inline)) { batch.payload[p] = value[dimensions + p]; });
  body(batch);
}

// Calls body(batch) for the padded list of particle i. Where a batch holds two of the eights that lists are padded to,
// a last one alone is filled up with the sentinel. The two ways of reading are loops of their own: a choice in every
// batch costs a tenth of the instructions of the sums of wcsph.
template <int dimensions, int payload, class Body>
[[gnu::always_inline]] inline void for_each_batch(const NeighbourList& list, const float* records, std::size_t i,
                                                  float inverse_h, Body&& body) {
  using simd::f32n, simd::pair_lanes;
  constexpr int width = record_width(dimensions, payload);
  std::array<f32n, dimensions> centre;
  for (int axis = 0; axis < dimensions; ++axis) centre[axis] = simd::splat<f32n>(records[i * width + axis]);
  std::array<f32n, width> value;
  if (list.narrow()) {
    const NarrowBatches batches = list.batches(i);
    const std::uint16_t* code = batches.code;
    for (std::size_t b = 0; b < batches.size; ++b, code += pair_lanes) {
      __builtin_prefetch(code + list_ahead / sizeof *code);
      simd::load_whole_records<width>(records + simd::record_offset<width>(batches.base[b]), code, value.data());
      visit_batch<dimensions, payload>(centre, value.data(), inverse_h, code, body);
    }
    return;
  }
  const std::int32_t* const end = list.padded_end(i);
  alignas(64) std::int32_t filled[pair_lanes];
  for (const std::int32_t* next = list.begin(i); next < end; next += pair_lanes) {
    __builtin_prefetch(next + list_ahead / sizeof *next);
    const std::int32_t* entry = next;
    if constexpr (pair_lanes > simd::lanes) {
      if (end - next < pair_lanes) {
        std::copy_n(entry, simd::lanes, filled);
        std::fill_n(filled + simd::lanes, pair_lanes - simd::lanes, entry_scale * list.sentinel());
        entry = filled;
      }
    }
    simd::load_whole_records<width>(records, entry, value.data());
    visit_batch<dimensions, payload>(centre, value.data(), inverse_h, nullptr, body);
  }
}

// Sweeps all particles in parallel: body(first, last) of blocks of at most so many.
inline constexpr std::size_t sweep_block = 256;
template <class Body>
void sweep_blocks(std::size_t particles, Body&& body) {
  parallel_blocks(particles, sweep_block, [&](std::size_t, std::size_t first, std::size_t last) { body(first, last); });
}

// The same one by one: body(i).
template <class Body>
void sweep(std::size_t particles, Body&& body) {
  sweep_blocks(particles, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) body(i);
  });
}

// Calls body.template operator()<dimensions, Kernel>().
template <class Body>
void with_plain_kernel(int dimensions, KernelKind kernel, Body&& body) {
  const bool wendland = kernel == KernelKind::wendland_c2;
  if (dimensions == 2) {
    if (wendland)
      body.template operator()<2, WendlandC2>();
    else
      body.template operator()<2, QuinticSpline>();
  } else {
    if (wendland)
      body.template operator()<3, WendlandC2>();
    else
      body.template operator()<3, QuinticSpline>();
  }
}

// The same for the context's dimension and kernel, which is VariableH<Kernel> where particles differ in size.
template <class Body>
void with_kernel(const SweepContext& context, Body&& body) {
  with_plain_kernel(context.dimensions, context.kernel, [&]<int dimensions, class Kernel>() {
    if (context.length_ratio != nullptr)
      body.template operator()<dimensions, VariableH<Kernel>>();
    else
      body.template operator()<dimensions, Kernel>();
  });
}

// Record storage, sized for the widest sweep and reused by all. `coordinates_width` tells for which width the
// coordinates in it are valid, so that consecutive sweeps of one width rewrite only the payload.
class PackedNeighbours {
 public:
  // Prepares records of the given payload: coordinates of all points written, sentinel payload zero.
  float* prepare(const SweepContext& context, int payload);
  // Positions changed: coordinates must be written again.
  void invalidate() { coordinates_width_ = 0; }
  double bytes() const { return 4.0 * static_cast<double>(storage_.capacity()); }

  // Compulsory traffic (core/ledger.hpp) since the last call, in bytes. Every prepare() counts the sweep that follows:
  // the lists, the records as they are packed and as they are gathered from. What a sweep reads and writes per particle
  // its caller adds: here by count(), or where the stage is timed.
  double take_traffic() { return std::exchange(traffic_, 0.0); }
  void count(double bytes) { traffic_ += bytes; }

 private:
  double traffic_ = 0;
  Array<float> storage_;
  int coordinates_width_ = 0;
};

}  // namespace spume
