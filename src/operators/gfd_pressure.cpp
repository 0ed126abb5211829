// SPDX-License-Identifier: MIT
#include "spume/operators/gfd_pressure.hpp"

#include <algorithm>
#include <cstring>

#include "gfd_row.hpp"
#include "spume/operators/image_values.hpp"

namespace spume {
namespace {

using simd::f32n;
using simd::f64n;

// Rows handled at a time by one thread, as in sweep(). Dot products add up block by block, whoever worked on it.
constexpr std::size_t block = 256;

// The rows of a matrix for one kernel.
template <int dimensions, class Kernel>
struct Rows {
  const SweepContext& context;
  const GfdPressureMatrix& matrix;
  const std::uint32_t* first_weight;
  const float* weight;

  bool masked(std::size_t i) const { return matrix.masked != nullptr && matrix.masked[i] != 0; }
  bool varies(std::size_t i) const { return matrix.density.varies != nullptr && matrix.density.varies[i] != 0; }
  float shift(std::size_t i) const { return matrix.diagonal_shift != nullptr ? matrix.diagonal_shift[i] : 0; }
  float volume() const { return static_cast<float>(context.volume); }

  // Calls add(W (1 + d . o) / rho_ij, batch) for row i, with 1 / rho_i in the factor that it returns where the density
  // does not vary.
  template <int payload, bool stored, class Add>
  [[gnu::always_inline]] float visit(const float* records, std::size_t i, Add&& add) const {
    const float factor = volume() * matrix.stencils.laplacian_factor[i];
    if constexpr (stored) {
      const float* next = weight + std::size_t{simd::pair_lanes} * first_weight[i];
      for_each_batch<dimensions, payload>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
        add(simd::load<f32n>(next), b);
        next += simd::pair_lanes;
      });
      return factor;
    } else {
      const auto o = own_vector<dimensions>(matrix.stencils.offset, i);
      for_each_batch<dimensions, payload>(*context.list, records, i, inverse_width(context),
                                          [&](const auto& b) { add(Kernel::w(b.q) * offset_factor(b, o), b); });
      return factor / matrix.density.value[i];
    }
  }
  template <int payload, class Add>
  [[gnu::always_inline]] float visit_any(const float* records, std::size_t i, Add&& add) const {
    return varies(i) ? visit<payload, true>(records, i, add) : visit<payload, false>(records, i, add);
  }

  // Stores W (1 + d . o) / rho_ij of row i, whose records hold rho, and gives their sum.
  float store_weights(const float* records, std::size_t i, float* out) const {
    const auto o = own_vector<dimensions>(matrix.stencils.offset, i);
    const f32n own = simd::splat<f32n>(matrix.density.value[i]);
    f32n sum{};
    for_each_batch<dimensions, 1>(*context.list, records, i, inverse_width(context), [&](const auto& b) {
      const f32n product = Kernel::w(b.q) * offset_factor(b, o) * (2.0F / (own + b.payload[0]));
      std::memcpy(out, &product, sizeof product);
      out += simd::pair_lanes;
      sum = sum + product;
    });
    return simd::sum(sum);
  }
  // The sum of W (1 + d . o) of row i over its density.
  template <int payload>
  float weight_sum(const float* records, std::size_t i) const {
    f32n sum{};
    const float factor = visit<payload, false>(records, i, [&](f32n weight, const auto&) { sum = sum + weight; });
    return factor * simd::sum(sum);
  }

  // V <-lap x / rho> of row i, whose records hold x.
  template <bool stored>
  float in_float(const float* records, std::size_t i) const {
    const f32n own = simd::splat<f32n>(records[i * record_width(dimensions, 1) + dimensions]);
    f32n sum{};
    const float factor =
        visit<1, stored>(records, i, [&](f32n weight, const auto& b) { sum = sum + weight * (own - b.payload[0]); });
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

void GfdPressureOperator::bind(const SweepContext& context, PackedNeighbours& packed, const GfdPressureMatrix& matrix,
                               std::span<float> diagonal) {
  with_gfd_kernel(context, []<int dimensions, class Kernel>() {});  // refuses sizes
  context_ = context;
  packed_ = &packed;
  matrix_ = matrix;
  partial_.resize(block_count(size(), block));
  if (matrix.density.varies != nullptr) place_weights();
  if (matrix.density.varies != nullptr || !diagonal.empty()) find_weights(diagonal);
}

// Where the weights of each block of rows and of each row begin.
void GfdPressureOperator::place_weights() {
  const std::uint8_t* varies = matrix_.density.varies;
  const std::size_t n = size();
  first_weight_.resize(n);
  block_start_.resize(block_count(n, block) + 1);
  block_start_[0] = 0;
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    std::uint32_t sum = 0;
    for (std::size_t i = first; i < last; ++i) {
      first_weight_[i] = sum;  // within the block
      if (varies[i] != 0) sum += static_cast<std::uint32_t>(block_count(context_.list->of(i).size(), simd::pair_lanes));
    }
    block_start_[b + 1] = sum;
  });
  for (std::size_t b = 0; b + 1 < block_start_.size(); ++b) block_start_[b + 1] += block_start_[b];
  weight_.resize(std::size_t{simd::pair_lanes} * block_start_[block_start_.size() - 1]);
  parallel_blocks(n, block, [&](std::size_t b, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) first_weight_[i] += block_start_[b];
  });
}

void GfdPressureOperator::find_weights(std::span<float> diagonal) {
  with_gfd_kernel(context_, [&]<int dimensions, class Kernel>() {
    constexpr int width = record_width(dimensions, 1);
    float* records = packed_->prepare(context_, 1);
    pack_coefficient(context_, records, width, 0, matrix_.density.value);
    const Rows<dimensions, Kernel> rows{context_, matrix_, first_weight_.data(), weight_.data()};
    sweep(size(), [&](std::size_t i) {
      float sum = 0;
      if (rows.varies(i)) {
        sum = rows.volume() * matrix_.stencils.laplacian_factor[i] *
              rows.store_weights(records, i, weight_.data() + std::size_t{simd::pair_lanes} * first_weight_[i]);
      } else if (!diagonal.empty()) {
        sum = rows.template weight_sum<1>(records, i);
      }
      if (!diagonal.empty()) diagonal[i] = rows.masked(i) ? 1 : sum + rows.volume() * rows.shift(i);
    });
  });
}

// Without tied rows x itself.
template <class T>
const T* GfdPressureOperator::extended(std::span<const T> x, bool given, Array<T>& room) const {
  if (matrix_.tied == nullptr) return x.data();
  room.resize(x.size());
  parallel_for(x.size(), [&](std::size_t i) { room[i] = x[i]; });
  matrix_.tied->extend(room.data(), given);
  return room.data();
}

Dots GfdPressureOperator::apply(std::span<const float> x, std::span<float> y, std::span<const float> w) {
  float* records = packed_->prepare(context_, 1);
  const int width = record_width(context_.dimensions, 1);
  pack_scalar(context_, records, width, 0, extended(x, false, extended_));
  // x, offset, factor, density, shift, w, y and what tells whether the density varies.
  packed_->count(static_cast<double>(size()) * (24 + 4 * context_.dimensions));
  with_gfd_kernel(context_, [&]<int dimensions, class Kernel>() {
    const Rows<dimensions, Kernel> rows{context_, matrix_, first_weight_.data(), weight_.data()};
    parallel_blocks(size(), block, [&](std::size_t b, std::size_t first, std::size_t last) {
      Dots dots;
      const auto add_row = [&]<bool stored>(std::size_t i) {
        if (rows.masked(i)) {
          y[i] = 0;
          return;
        }
        const float value = rows.template in_float<stored>(records, i) + rows.volume() * rows.shift(i) * x[i];
        y[i] = value;
        dots.wy += double{w[i]} * value;
        dots.yy += double{value} * value;
      };
      for (std::size_t i = first; i < last; ++i)
        rows.varies(i) ? add_row.template operator()<true>(i) : add_row.template operator()<false>(i);
      partial_[b] = dots;
    });
  });
  Dots total;
  for (const Dots& part : partial_) total += part;
  return total;
}

void GfdPressureOperator::residual(std::span<const double> q, std::span<const double> b, std::span<double> r,
                                   bool given) {
  float* records = packed_->prepare(context_, 2);
  const auto width = static_cast<std::size_t>(record_width(context_.dimensions, 2));
  const std::size_t n = size();
  float* out = records + context_.dimensions;
  const auto split = [=](float* record, double value) {
    record[0] = static_cast<float>(value);
    record[1] = static_cast<float>(value - double{record[0]});
  };
  const double* all = extended(q, given, extended_double_);
  parallel_for(n, [&](std::size_t i) { split(out + i * width, all[i]); });
  for_each_image_pressure(context_, all, given,
                          [&](std::size_t k, double value) { split(out + (n + k) * width, value); });
  packed_->count(static_cast<double>(n) * (40 + 4 * context_.dimensions));
  with_gfd_kernel(context_, [&]<int dimensions, class Kernel>() {
    const Rows<dimensions, Kernel> rows{context_, matrix_, first_weight_.data(), weight_.data()};
    sweep(n, [&](std::size_t i) {
      r[i] = rows.masked(i)
                 ? 0
                 : b[i] - (rows.template in_double<2>(records, i) + double{rows.volume() * rows.shift(i)} * q[i]);
    });
  });
}

void GfdPressureOperator::subtract_product(double scale, std::span<const float> x, std::span<double> r) {
  float* records = packed_->prepare(context_, 1);
  pack_scalar(context_, records, record_width(context_.dimensions, 1), 0, extended(x, false, extended_));
  packed_->count(static_cast<double>(size()) * (32 + 4 * context_.dimensions));
  with_gfd_kernel(context_, [&]<int dimensions, class Kernel>() {
    const Rows<dimensions, Kernel> rows{context_, matrix_, first_weight_.data(), weight_.data()};
    sweep(size(), [&](std::size_t i) {
      if (rows.masked(i)) return;
      r[i] -= scale * (rows.template in_double<1>(records, i) + double{rows.volume() * rows.shift(i)} * x[i]);
    });
  });
}

}  // namespace spume
