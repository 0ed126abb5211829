// SPDX-License-Identifier: MIT
// What the rows of all generalised finite differences share.
#pragma once

#include <cmath>
#include <stdexcept>

#include "spume/operators/gfd_moments.hpp"
#include "spume/operators/image_values.hpp"
#include "symmetric_matrix.hpp"

namespace spume {

// Calls body.template operator()<dimensions, Kernel>().
template <class Body>
void with_gfd_kernel(const SweepContext& context, Body&& body) {
  if (context.length_ratio != nullptr)
    throw std::logic_error("generalised finite differences take particles of one size");
  with_plain_kernel(context.dimensions, context.kernel, body);
}

inline float inverse_width(const SweepContext& context) {
  return static_cast<float>(1 / context.smoothing_length);
}

// Scalars less a reference into the payload that starts at `out`; with `pressure` what accelerated walls add to their
// images.
template <int width>
void pack_from_reference(const SweepContext& context, float* out, const double* values, double reference,
                         bool pressure = false) {
  const std::size_t n = context.list->particles();
  parallel_for(n, [=](std::size_t i) { out[i * width] = static_cast<float>(values[i] - reference); });
  for_each_image_pressure(context, values, pressure, [=](std::size_t k, double value) {
    out[(n + k) * width] = static_cast<float>(value - reference);
  });
}

template <int dimensions>
std::array<float, dimensions> own_vector(const std::array<const float*, 3>& field, std::size_t i) {
  std::array<float, dimensions> v;
  for (int axis = 0; axis < dimensions; ++axis) v[axis] = field[axis][i];
  return v;
}

// 1 - r_ij . o_i of a batch.
template <std::size_t dimensions, class Batch>
[[gnu::always_inline]] inline simd::f32n offset_factor(const Batch& batch, const std::array<float, dimensions>& o) {
  simd::f32n factor = simd::splat<simd::f32n>(1);
  for (std::size_t axis = 0; axis < dimensions; ++axis) factor = factor + o[axis] * batch.d[axis];
  return factor;
}

// Root mean square entry per row of B times the mean of the diagonal of the sum, 1 in the bulk. Jittered by a quarter
// of a spacing, with supports of 2.5 to 2.7 spacings, particles reach 1.2 inside, 1.5 at planes and 1.8 at edges and
// corners; beyond three times as much the neighbours lie nearly in a plane or on a line and B would amplify noise.
inline constexpr double largest_correction = 6;

// Of the determinant, over the mean of the diagonal to the power of the dimensions: what passes the bound above has
// 0.2 (2-D) or 0.05 (3-D) at least, so that this only keeps rounding from being divided by.
inline constexpr double singular = 1e-6;

// The sum m = sum W d (x) d, over the mean of its diagonal, becomes its inverse b: B = scale b. Where that is singular
// or amplifies too much b is the identity.
struct InverseScale {
  double trace, scale;
  bool isotropic;
};
template <int dimensions>
InverseScale normalised_inverse(std::array<double, 6>& m, std::array<double, 6>& b) {
  double trace = 0;
  for (int a = 0; a < dimensions; ++a) trace += m[symmetric_index<dimensions>(a, a)];
  const double scale = trace > 0 ? dimensions / trace : 0;
  for (double& entry : m) entry *= scale;
  double squares = 0;
  if (invert_symmetric(m, dimensions, singular, b, squares) &&
      squares < dimensions * largest_correction * largest_correction)
    return {trace, scale, false};
  b = {};
  for (int a = 0; a < dimensions; ++a) b[symmetric_index<dimensions>(a, a)] = 1;
  return {trace, scale, true};
}

// Least divisor of a mean, a float far below any viscosity: 0 / 0 becomes 0.
inline constexpr float no_property = 1e-30F;

// 2 a b / (a + b), of properties that are not negative.
[[gnu::always_inline]] inline simd::f32n harmonic_mean(simd::f32n a, simd::f32n b) {
  return 2.0F * a * b / simd::max(a + b, simd::splat<simd::f32n>(no_property));
}

}  // namespace spume
