// SPDX-License-Identifier: MIT
#include "spume/operators/pressure_operator.hpp"

#include <stdexcept>

#include "spume/operators/image_values.hpp"

namespace spume {
namespace {

using simd::f32n;
using simd::f64n;

// Rows handled at a time by one thread, as in sweep(). Dot products add up block by block, whoever worked on it.
constexpr std::size_t block = 256;

template <int dimensions, class Kernel>
void apply_rows(const SweepContext& context, const float* records, const PressureMatrix& matrix,
                [[maybe_unused]] const float* x, [[maybe_unused]] const float* weight_sum, const float* w, float* y,
                Dots* partial) {
  constexpr int width = record_width(dimensions, 1);
  const NeighbourList& list = *context.list;
  const KernelScale<dimensions, Kernel> common(context);
  const auto volume = static_cast<float>(context.volume);
  const float common_factor = -2 * common.gradient * volume;
  parallel_blocks(list.particles(), block, [&](std::size_t b, std::size_t first, std::size_t last) {
    Dots dots;
    for (std::size_t i = first; i < last; ++i) {
      if (matrix.masked != nullptr && matrix.masked[i] != 0) {
        y[i] = 0;
        continue;
      }
      float value = 0;
      if constexpr (is_variable_h<Kernel>) {
        const KernelScale<dimensions, Kernel> scale = common.at(context, i);
        f32n sum{};
        for_each_batch<dimensions, 1>(list, records, i, scale.inverse_h,
                                      [&](const auto& batch) { sum = sum + Kernel::f(batch.q) * batch.payload[0]; });
        const float factor = -2 * scale.gradient * volume * matrix.row[i];
        value = factor * (weight_sum[i] * x[i] - simd::sum(sum)) + volume * matrix.diagonal_shift[i] * x[i];
      } else {
        const float own_value = records[i * width + dimensions];
        const f32n own = simd::splat<f32n>(own_value);
        f32n sum{};
        for_each_batch<dimensions, 1>(list, records, i, common.inverse_h, [&](const auto& batch) {
          sum = sum + Kernel::f(batch.q) * (own - batch.payload[0]);
        });
        value = common_factor * simd::sum(sum) + volume * matrix.diagonal_shift[i] * own_value;
      }
      y[i] = value;
      dots.wy += double{w[i]} * value;
      dots.yy += double{value} * value;
    }
    partial[b] = dots;
  });
}

// Calls row(i, V sum_j 2 g_ij (q_i - q_j)) for the rows without mask, with float coefficients and all else in double.
// The payload is q, as one float or as the two floats of a double.
template <int dimensions, class Kernel, bool two_floats, class Row>
void double_rows(const SweepContext& context, const float* records, const PressureMatrix& matrix, Row&& row) {
  constexpr int payload = (two_floats ? 2 : 1) + volume_slots<Kernel>;
  constexpr int width = record_width(dimensions, payload);
  const NeighbourList& list = *context.list;
  const KernelScale<dimensions, Kernel> common(context);
  const auto volume = static_cast<float>(context.volume);
  sweep(list.particles(), [&](std::size_t i) {
    if (matrix.masked != nullptr && matrix.masked[i] != 0) return;
    const KernelScale<dimensions, Kernel> scale = common.at(context, i);
    float factor = -2 * scale.gradient * volume;
    if constexpr (is_variable_h<Kernel>) factor *= matrix.row[i];
    const float* own = records + i * width + dimensions;
    const f64n high = simd::to_f64_low(simd::splat<f32n>(own[0]));
    f64n sum_low{}, sum_high{};
    for_each_batch<dimensions, payload>(list, records, i, scale.inverse_h, [&](const auto& batch) {
      const f32n f = times_volume<Kernel>(Kernel::f(batch.q), batch);
      // The leading parts are subtracted in double: near a zero of q they differ by more than a factor of two, and
      // a float difference would round.
      f64n low_difference = high - simd::to_f64_low(batch.payload[0]);
      f64n high_difference = high - simd::to_f64_high(batch.payload[0]);
      if constexpr (two_floats) {
        const f32n fine = own[1] - batch.payload[1];
        low_difference = low_difference + simd::to_f64_low(fine);
        high_difference = high_difference + simd::to_f64_high(fine);
      }
      sum_low = sum_low + simd::to_f64_low(f) * low_difference;
      sum_high = sum_high + simd::to_f64_high(f) * high_difference;
    });
    row(i, double{factor} * simd::sum(sum_low + sum_high));
  });
}

// sum_j F(q) weight_j of every row; the payload of the records is the weight.
template <int dimensions, class Kernel>
void sum_weights(const SweepContext& context, const float* records, float* sum) {
  const KernelScale<dimensions, Kernel> common(context);
  sweep(context.list->particles(), [&](std::size_t i) {
    f32n total{};
    for_each_batch<dimensions, 1>(*context.list, records, i, common.at(context, i).inverse_h,
                                  [&](const auto& batch) { total = total + Kernel::f(batch.q) * batch.payload[0]; });
    sum[i] = simd::sum(total);
  });
}

}  // namespace

void PressureOperator::bind(const SweepContext& context, PackedNeighbours& packed, const PressureMatrix& matrix) {
  if ((matrix.weight != nullptr) != (context.length_ratio != nullptr) ||
      (matrix.weight != nullptr) != (matrix.row != nullptr))
    throw std::logic_error("a pressure matrix has weights and rows exactly where particles differ in size");
  context_ = context;
  packed_ = &packed;
  matrix_ = matrix;
  partial_.resize(block_count(context.list->particles(), block));
  if (matrix.weight == nullptr) return;
  weight_sum_.resize(size());
  float* values = packed.prepare(context, 1);
  pack_scalar(context, values, record_width(context.dimensions, 1), 0, matrix.weight);
  with_kernel(context, [&]<int dimensions, class Kernel>() {
    if constexpr (is_variable_h<Kernel>) sum_weights<dimensions, Kernel>(context, values, weight_sum_.data());
  });
}

Dots PressureOperator::apply(std::span<const float> x, std::span<float> y, std::span<const float> w) {
  float* records = packed_->prepare(context_, 1);
  const std::size_t n = size();
  // x twice, the diagonal shift, w and y; the mask; weights, rows and their sums.
  packed_->count(static_cast<double>(n) * (20 + mask_and_sizes(12)));
  const auto width = static_cast<std::size_t>(record_width(context_.dimensions, 1));
  const std::int32_t* source = context_.images->source();
  float* out = records + context_.dimensions;
  if (const float* weight = matrix_.weight; weight != nullptr) {
    parallel_for(n, [&, out, width](std::size_t i) { out[i * width] = weight[i] * x[i]; });
    if (context_.walls == nullptr) {
      parallel_for(context_.images->size(),
                   [&, out, width, n](std::size_t k) { out[(n + k) * width] = weight[source[k]] * x[source[k]]; });
    } else {
      // At wall points both are fits, as residual() has them.
      for_each_image_pressure(context_, x.data(), false, [out, width, n](std::size_t k, double value) {
        out[(n + k) * width] = static_cast<float>(value);
      });
      for_each_image_value(context_, weight, [out, width, n](std::size_t k, double value) {
        out[(n + k) * width] *= static_cast<float>(value);
      });
    }
  } else {
    parallel_for(n, [&, out, width](std::size_t i) { out[i * width] = x[i]; });
    for_each_image_pressure(context_, x.data(), false, [out, width, n](std::size_t k, double value) {
      out[(n + k) * width] = static_cast<float>(value);
    });
  }
  with_kernel(context_, [&]<int dimensions, class Kernel>() {
    apply_rows<dimensions, Kernel>(context_, records, matrix_, x.data(), weight_sum_.data(), w.data(), y.data(),
                                   partial_.data());
  });
  Dots total;
  for (const auto& part : partial_) {
    total.wy += part.wy;
    total.yy += part.yy;
  }
  return total;
}

double PressureOperator::mask_and_sizes(double sizes) const {
  return (matrix_.masked != nullptr ? 1 : 0) + (matrix_.weight != nullptr ? sizes + 4 : 0);  // and h_i
}

void PressureOperator::residual(std::span<const double> q, std::span<const double> b, std::span<double> r, bool given) {
  const int payload = matrix_.weight != nullptr ? 3 : 2;
  float* records = packed_->prepare(context_, payload);
  const std::size_t n = size();
  // q twice, r zeroed and written, b, the diagonal shift; the mask; weights and rows.
  packed_->count(static_cast<double>(n) * (44 + mask_and_sizes(8)));
  const auto width = static_cast<std::size_t>(record_width(context_.dimensions, payload));
  if (matrix_.weight != nullptr) pack_scalar(context_, records, static_cast<int>(width), 2, matrix_.weight);
  float* out = records + context_.dimensions;
  const auto split = [=](float* record, double value) {
    record[0] = static_cast<float>(value);
    record[1] = static_cast<float>(value - double{record[0]});
  };
  parallel_for(n, [&, out, width](std::size_t i) { split(out + i * width, q[i]); });
  for_each_image_pressure(context_, q.data(), given,
                          [&, out, width, n](std::size_t k, double value) { split(out + (n + k) * width, value); });
  const auto volume = static_cast<float>(context_.volume);
  parallel_for(n, [&](std::size_t i) { r[i] = 0; });
  with_kernel(context_, [&]<int dimensions, class Kernel>() {
    double_rows<dimensions, Kernel, true>(context_, records, matrix_, [&](std::size_t i, double pairs) {
      r[i] = b[i] - (pairs + double{volume * matrix_.diagonal_shift[i]} * q[i]);
    });
  });
}

void PressureOperator::subtract_product(double scale, std::span<const float> x, std::span<double> r) {
  const bool weighted = matrix_.weight != nullptr;
  float* records = packed_->prepare(context_, weighted ? 2 : 1);
  const int width = record_width(context_.dimensions, weighted ? 2 : 1);
  pack_pressure_change(context_, records, width, 0, x.data());
  // x twice, r read and written, the diagonal shift; the mask; weights and rows.
  packed_->count(static_cast<double>(size()) * (28 + mask_and_sizes(8)));
  if (weighted) pack_scalar(context_, records, width, 1, matrix_.weight);
  const auto volume = static_cast<float>(context_.volume);
  with_kernel(context_, [&]<int dimensions, class Kernel>() {
    double_rows<dimensions, Kernel, false>(context_, records, matrix_, [&](std::size_t i, double pairs) {
      r[i] -= scale * (pairs + double{volume * matrix_.diagonal_shift[i]} * x[i]);
    });
  });
}

}  // namespace spume
