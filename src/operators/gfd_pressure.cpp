// SPDX-License-Identifier: MIT
#include "spume/operators/gfd_pressure.hpp"

#include "gfd_row.hpp"
#include "spume/operators/image_values.hpp"

namespace spume {
namespace {

using simd::f32n;
using simd::f64n;

// Rows handled at a time by one thread, as in sweep(). Dot products add up block by block, whoever worked on it.
constexpr std::size_t block = 256;

// Lists are padded to a multiple of this.
constexpr std::uint32_t list_padding = simd::lanes;

// The rows of a matrix for one kernel.
template <int dimensions, class Kernel>
struct Rows {
  const SweepContext& context;
  const GfdPressureMatrix& matrix;
  const std::uint32_t* first_coefficient;
  const float* coefficient;

  bool masked(std::size_t i) const { return matrix.masked != nullptr && matrix.masked[i] != 0; }
  bool varies(std::size_t i) const { return matrix.density.varies != nullptr && matrix.density.varies[i] != 0; }
  float shift(std::size_t i) const { return matrix.diagonal_shift != nullptr ? matrix.diagonal_shift[i] : 0; }
  float volume() const { return static_cast<float>(context.volume); }

  // Calls add(W (1 + d . o) / rho_ij, batch) for row i, with 1 / rho_i in the factor that it returns where the density
  // does not vary. If it varies somewhere all rows take coefficients, those of one density the same ones: rows of two
  // kinds in turn took 1.2 times as long as rows with coefficients, as the branch between them is guessed wrongly.
  template <int payload, bool somewhere, class Add>
  [[gnu::always_inline]] float visit(const float* records, std::size_t i, Add&& add) const {
    const auto o = own_vector<dimensions>(matrix.stencils.offset, i);
    const float factor = volume() * matrix.stencils.laplacian_factor[i];
    [[maybe_unused]] const float* next = nullptr;
    [[maybe_unused]] std::size_t step = 0;
    if constexpr (somewhere) {
      next = coefficient + std::size_t{list_padding} * first_coefficient[i];
      step = varies(i) ? simd::pair_lanes : 0;
    }
    for_each_batch<dimensions, payload>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
      f32n weight = Kernel::w(b.q) * offset_factor(b, o);
      if constexpr (somewhere) {
        weight = weight * simd::load<f32n>(next);
        next += step;
      }
      add(weight, b);
    });
    return somewhere && step != 0 ? factor : factor / matrix.density.value[i];
  }
  template <int payload, class Add>
  [[gnu::always_inline]] float visit_any(const float* records, std::size_t i, Add&& add) const {
    return matrix.density.varies != nullptr ? visit<payload, true>(records, i, add)
                                            : visit<payload, false>(records, i, add);
  }

  // V <-lap x / rho> of row i, whose records hold x.
  template <bool density_varies>
  float in_float(const float* records, std::size_t i) const {
    const f32n own = simd::splat<f32n>(records[i * record_width(dimensions, 1) + dimensions]);
    f32n sum{};
    const float factor = visit<1, density_varies>(
        records, i, [&](f32n weight, const auto& b) { sum = sum + weight * (own - b.payload[0]); });
    return factor * simd::sum(sum);
  }

  // V <-lap q / rho> of row i in double from float weights. The payload is q, as one float or as the two of a double.
  template <int payload>
  double in_double(const float* records, std::size_t i) const {
    const float* own = records + i * record_width(dimensions, payload) + dimensions;
    const f64n high = simd::to_f64_low(simd::splat<f32n>(own[0]));
    f64n sum_low{}, sum_high{};
    const float factor = visit_any<payload>(records, i, [&](f32n weight, const auto& b) {
      // The leading parts are subtracted in double: near a zero of q a float difference would round.
      f64n low_difference = high - simd::to_f64_low(b.payload[0]);
      f64n high_difference = high - simd::to_f64_high(b.payload[0]);
      if constexpr (payload == 2) {
        const f32n fine = own[1] - b.payload[1];
        low_difference = low_difference + simd::to_f64_low(fine);
        high_difference = high_difference + simd::to_f64_high(fine);
      }
      sum_low = sum_low + simd::to_f64_low(weight) * low_difference;
      sum_high = sum_high + simd::to_f64_high(weight) * high_difference;
    });
    return double{factor} * simd::sum(sum_low + sum_high);
  }
};

}  // namespace

void GfdPressureOperator::bind(const SweepContext& context, PackedNeighbours& packed, const GfdPressureMatrix& matrix) {
  with_gfd_kernel(context, []<int dimensions, class Kernel>() {});  // refuses sizes
  context_ = context;
  packed_ = &packed;
  matrix_ = matrix;
  partial_.resize(block_count(size(), block));
  if (matrix.density.varies != nullptr) find_coefficients();
}

void GfdPressureOperator::find_coefficients() {
  const NeighbourList& list = *context_.list;
  const std::uint8_t* varies = matrix_.density.varies;
  const float* density = matrix_.density.value;
  const auto length = [&](std::size_t i) -> std::uint32_t {
    return varies[i] != 0 ? static_cast<std::uint32_t>(list.padded_end(i) - list.begin(i)) / list_padding : 0;
  };
  const std::size_t n = size();
  first_coefficient_.resize(n);
  block_start_.resize(block_count(n, block) + 1);
  constexpr std::uint32_t ones = simd::pair_lanes / list_padding;
  block_start_[0] = ones;  // of rows of one density
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::uint32_t sum = 0;
    for (std::size_t i = first; i < last; ++i) sum += length(i);
    block_start_[b + 1] = sum;
  });
  for (std::size_t b = 0; b + 1 < block_start_.size(); ++b) block_start_[b + 1] += block_start_[b];
  // The last batch can read past its row.
  coefficient_.resize(std::size_t{list_padding} * block_start_[block_start_.size() - 1] + simd::pair_lanes);
  for (std::size_t k = 1; k <= simd::pair_lanes; ++k) coefficient_[coefficient_.size() - k] = 0;
  for (std::size_t k = 0; k < simd::pair_lanes; ++k) coefficient_[k] = 1;
  const std::int32_t* source = context_.images->source();
  const auto particles = static_cast<std::int32_t>(n);
  parallel_blocks_dynamic(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::uint32_t start = block_start_[b];
    for (std::size_t i = first; i < last; ++i) {
      first_coefficient_[i] = varies[i] != 0 ? start : 0;
      if (varies[i] == 0) continue;
      float* out = coefficient_.data() + std::size_t{list_padding} * start;
      for (const std::int32_t j : list.of(i))
        *out++ = 2 / (density[i] + density[j < particles ? j : source[j - particles]]);
      start += length(i);
      // Of the sentinel, whose weight is zero.
      for (float* const end = coefficient_.data() + std::size_t{list_padding} * start; out < end; ++out) *out = 0;
    }
  });
}

Dots GfdPressureOperator::apply(std::span<const float> x, std::span<float> y, std::span<const float> w) {
  float* records = packed_->prepare(context_, 1);
  const int width = record_width(context_.dimensions, 1);
  pack_scalar(context_, records, width, 0, x.data());
  // x, offset, factor, density, shift, w, y and what tells whether the density varies.
  packed_->count(static_cast<double>(size()) * (24 + 4 * context_.dimensions));
  with_gfd_kernel(context_, [&]<int dimensions, class Kernel>() {
    const Rows<dimensions, Kernel> rows{context_, matrix_, first_coefficient_.data(), coefficient_.data()};
    parallel_blocks_dynamic(size(), block, [&](std::size_t b, std::size_t first, std::size_t last) {
      // Rows of one density first: taken in turn, wrong guesses of the branch made a third of them 1.3 times as slow.
      Dots dots;
      const auto add_row = [&]<bool density_varies>(std::size_t i) {
        if (rows.masked(i)) {
          y[i] = 0;
          return;
        }
        const float value = rows.template in_float<density_varies>(records, i) + rows.volume() * rows.shift(i) * x[i];
        y[i] = value;
        dots.wy += double{w[i]} * value;
        dots.yy += double{value} * value;
      };
      if (matrix_.density.varies != nullptr)
        for (std::size_t i = first; i < last; ++i) add_row.template operator()<true>(i);
      else
        for (std::size_t i = first; i < last; ++i) add_row.template operator()<false>(i);
      partial_[b] = dots;
    });
  });
  Dots total;
  for (const Dots& part : partial_) total += part;
  return total;
}

void GfdPressureOperator::diagonal(std::span<float> out) {
  const float* records = packed_->prepare(context_, 0);
  with_gfd_kernel(context_, [&]<int dimensions, class Kernel>() {
    const Rows<dimensions, Kernel> rows{context_, matrix_, first_coefficient_.data(), coefficient_.data()};
    sweep(size(), [&](std::size_t i) {
      f32n sum{};
      const float factor =
          rows.template visit_any<0>(records, i, [&](f32n weight, const auto&) { sum = sum + weight; });
      out[i] = rows.masked(i) ? 1 : factor * simd::sum(sum) + rows.volume() * rows.shift(i);
    });
  });
}

void GfdPressureOperator::residual(std::span<const double> q, std::span<const double> b, std::span<double> r) {
  float* records = packed_->prepare(context_, 2);
  const auto width = static_cast<std::size_t>(record_width(context_.dimensions, 2));
  const std::size_t n = size();
  const std::int32_t* source = context_.images->source();
  float* out = records + context_.dimensions;
  const auto split = [=](float* record, double value) {
    record[0] = static_cast<float>(value);
    record[1] = static_cast<float>(value - double{record[0]});
  };
  parallel_for(n, [&](std::size_t i) { split(out + i * width, q[i]); });
  parallel_for(context_.images->size(), [&](std::size_t k) { split(out + (n + k) * width, q[source[k]]); });
  packed_->count(static_cast<double>(n) * (40 + 4 * context_.dimensions));
  with_gfd_kernel(context_, [&]<int dimensions, class Kernel>() {
    const Rows<dimensions, Kernel> rows{context_, matrix_, first_coefficient_.data(), coefficient_.data()};
    sweep(n, [&](std::size_t i) {
      r[i] = rows.masked(i)
                 ? 0
                 : b[i] - (rows.template in_double<2>(records, i) + double{rows.volume() * rows.shift(i)} * q[i]);
    });
  });
}

void GfdPressureOperator::subtract_product(double scale, std::span<const float> x, std::span<double> r) {
  float* records = packed_->prepare(context_, 1);
  pack_scalar(context_, records, record_width(context_.dimensions, 1), 0, x.data());
  packed_->count(static_cast<double>(size()) * (32 + 4 * context_.dimensions));
  with_gfd_kernel(context_, [&]<int dimensions, class Kernel>() {
    const Rows<dimensions, Kernel> rows{context_, matrix_, first_coefficient_.data(), coefficient_.data()};
    sweep(size(), [&](std::size_t i) {
      if (rows.masked(i)) return;
      r[i] -= scale * (rows.template in_double<1>(records, i) + double{rows.volume() * rows.shift(i)} * x[i]);
    });
  });
}

}  // namespace spume
