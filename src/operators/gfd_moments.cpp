// SPDX-License-Identifier: MIT
#include "spume/operators/gfd_moments.hpp"

#include "gfd_row.hpp"
#include "spume/core/joined_lanes.hpp"
#include "tensile_gradient.hpp"

namespace spume {
namespace {

using simd::f32n;

// sum |d|^2 W (1 + d . o) over sum |d|^2 W: 1 in the bulk, 0.9 and more when jittered as above; 0.19 and more at
// planes, 0 at corners of a lattice (its edges in 2-D), where the second derivatives of one-sided differences cancel.
constexpr double least_denominator = 0.1;

// The stencils of a block of particles from their sums W d (x) d, W d and W |d|^2 d. A vector of particles at a time:
// one by one they take a quarter of the sweep.
template <int dimensions>
class StencilBlock {
 public:
  static constexpr int entries = symmetric_entries<dimensions>, sums = entries + 2 * dimensions;

  void keep(std::size_t k, const float* sum) {
    for (int c = 0; c < sums; ++c) sum_[c][k] = sum[c];
  }
  void find(std::size_t count) {
    constexpr double most_squares = dimensions * largest_correction * largest_correction;
    for (std::size_t k = 0; k < count; ++k) {
      double m[entries], inverse[entries], o[dimensions], trace = 0, squares;
      for (int a = 0; a < dimensions; ++a) trace += double{sum_[symmetric_index<dimensions>(a, a)][k]};
      const double scale = trace > 0 ? dimensions / trace : 0;
      for (int c = 0; c < entries; ++c) m[c] = scale * double{sum_[c][k]};
      const double determinant = inverse_of<dimensions>(m, inverse, squares);
      const bool whole = (determinant > singular) & (squares < most_squares);
      for (int c = 0; c < entries; ++c) inverse[c] = scale * (whole ? inverse[c] : identity(c));
      double along = 0;  // sum |d|^2 W d . o
      for (int a = 0; a < dimensions; ++a) {
        o[a] = 0;
        for (int c = 0; c < dimensions; ++c)
          o[a] -= inverse[symmetric_index<dimensions>(a, c)] * double{sum_[entries + c][k]};
        along += o[a] * double{sum_[entries + dimensions + a][k]};
      }
      const bool offset = whole & (trace + along > least_denominator * trace);
      const double denominator = trace + (offset ? along : 0);
      for (int c = 0; c < entries; ++c) correction_[c][k] = static_cast<float>(inverse[c]);
      for (int a = 0; a < dimensions; ++a) offset_[a][k] = static_cast<float>(offset ? o[a] : 0);
      factor_[k] = static_cast<float>(denominator > 0 ? 2 * dimensions / denominator : 0);
      fallback_[k] = whole ? (offset ? 0 : 1) : 2;
    }
  }
  // Entry k is that of particle(k).
  template <class Particle>
  void store(std::size_t count, const GfdMoments& out, Particle&& particle) const {
    const auto copy = [&](const float* from, float* to) {
      if (to == nullptr) return;
      for (std::size_t k = 0; k < count; ++k) to[particle(k)] = from[k];
    };
    for (int c = 0; c < entries; ++c) copy(correction_[c], out.correction[c]);
    for (int a = 0; a < dimensions; ++a) copy(offset_[a], out.offset[a]);
    copy(factor_, out.laplacian_factor);
    if (out.fallback != nullptr)
      for (std::size_t k = 0; k < count; ++k) out.fallback[particle(k)] = static_cast<GfdFallback>(fallback_[k]);
  }

 private:
  static constexpr double identity(int c) {
    for (int a = 0; a < dimensions; ++a)
      if (c == symmetric_index<dimensions>(a, a)) return 1;
    return 0;
  }
  alignas(64) float sum_[sums][sweep_block];
  alignas(64) float correction_[entries][sweep_block], offset_[dimensions][sweep_block], factor_[sweep_block];
  std::int64_t fallback_[sweep_block];  // as wide as what it follows from
};

// Of all particles, or of a subset. with_kernel: sums of the kernel and its gradient beside.
template <int dimensions, class Kernel, bool with_kernel>
void moments(const SweepContext& context, PackedNeighbours& packed, const std::span<const std::int32_t>* subset,
             const GfdMoments& out) {
  using Block = StencilBlock<dimensions>;
  constexpr int first = Block::entries, third = first + dimensions;
  const NeighbourList& list = *context.list;
  const float* records = packed.prepare(context, 0);
  const KernelScale<dimensions, Kernel> scale(context);
  const auto centre = static_cast<float>(Kernel::w(0.0));
  const TensileGradient<Kernel> tensile(context, out.spacing);
  const auto particle = [=](std::size_t s) { return subset == nullptr ? s : static_cast<std::size_t>((*subset)[s]); };
  sweep_blocks(subset == nullptr ? list.particles() : subset->size(), [&](std::size_t from, std::size_t to) {
    Block stencils;
    for (std::size_t s = from; s < to; ++s) {
      const std::size_t i = particle(s);
      std::array<f32n, Block::sums> sum{};
      std::array<f32n, with_kernel ? dimensions + 1 : 0> of_kernel{};
      for_each_batch<dimensions, 0>(list, records, i, scale.inverse_h, [&](const auto& b) {
        const f32n w = Kernel::w(b.q);
        f32n r2{};
        for (int a = 0; a < dimensions; ++a) r2 = r2 + b.d[a] * b.d[a];
        int slot = 0;
        for (int a = 0; a < dimensions; ++a) {
          const f32n wd = w * b.d[a];
          sum[first + a] = sum[first + a] + wd;
          sum[third + a] = sum[third + a] + r2 * wd;
          for (int c = a; c < dimensions; ++c) sum[slot] = sum[slot] + wd * b.d[c], ++slot;
        }
        if constexpr (with_kernel) {
          const f32n gradient = tensile(-scale.gradient * Kernel::f(b.q), w);
          for (int a = 0; a < dimensions; ++a) of_kernel[a] = of_kernel[a] + gradient * b.d[a];
          of_kernel[dimensions] = of_kernel[dimensions] + w;
        }
      });
      const auto total = simd::sums_of(sum, of_kernel);
      stencils.keep(s - from, total.data());
      if constexpr (with_kernel) {
        for (int a = 0; a < dimensions && out.concentration_gradient[0] != nullptr; ++a)
          out.concentration_gradient[a][i] = total[Block::sums + a];
        out.kernel_sum[i] = scale.value * (centre + total[Block::sums + dimensions]);
      }
    }
    stencils.find(to - from);
    stencils.store(to - from, out, [&](std::size_t k) { return particle(from + k); });
  });
}

}  // namespace

void gfd_moment_sweep(const SweepContext& context, PackedNeighbours& packed, const GfdMoments& out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    if (out.kernel_sum != nullptr)
      moments<dimensions, Kernel, true>(context, packed, nullptr, out);
    else
      moments<dimensions, Kernel, false>(context, packed, nullptr, out);
  });
}

void gfd_moment_subset(const SweepContext& context, PackedNeighbours& packed, std::span<const std::int32_t> subset,
                       const GfdMoments& out) {
  with_gfd_kernel(context, [&]<int dimensions, class Kernel>() {
    moments<dimensions, Kernel, false>(context, packed, &subset, out);
  });
}

}  // namespace spume
