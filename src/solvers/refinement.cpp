// SPDX-License-Identifier: MIT
#include "spume/solvers/refinement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "vector_kernels.hpp"

namespace spume {

namespace {

using detail::fused_sums;

// The inner recurrence stops a little early of the outer target, lest rounding leave the residual just above it.
constexpr double safety = 0.7;

}  // namespace

RefinementResult solve_refined(LinearOperator<double>& exact, LinearOperator<float>& fast, Preconditioner<float>& m,
                               std::span<const double> b, std::span<double> x, const RefinementOptions& options,
                               RefinementWorkspace& work) {
  const std::size_t n = b.size();
  if (x.size() != n || exact.size() != n || fast.size() != n ||
      (!options.weights.empty() && options.weights.size() != n))
    throw std::invalid_argument("solve_refined: operators, right-hand side, solution and weights must have one length");
  Array<double>& r = work.residual;
  r.resize(n);
  work.right_hand_side.resize(n);
  work.correction.resize(n);
  work.weights.resize(options.weights.size());
  parallel_for(options.weights.size(),
               [&](std::size_t i) { work.weights[i] = static_cast<float>(options.weights[i]); });
  const auto weight = [&](std::size_t i) { return options.weights.empty() ? 1.0 : options.weights[i]; };
  const double total_weight =
      options.remove_mean ? fused_sums<1>(n, [&](std::size_t i) { return std::array{weight(i)}; })[0] : 1.0;
  // r -= w sum(r) / sum(w) when the mean is removed; the norm of what remains.
  const auto project = [&](double sum) {
    const double share = options.remove_mean ? sum / total_weight : 0.0;
    return std::sqrt(fused_sums<1>(n, [&](std::size_t i) {
      const double value = options.remove_mean ? r[i] - weight(i) * share : r[i];
      r[i] = value;
      return std::array{value * value};
    })[0]);
  };

  RefinementResult result;
  const double sum_b = fused_sums<1>(n, [&](std::size_t i) {
    r[i] = b[i];
    return std::array{b[i]};
  })[0];
  const double norm_b = project(sum_b);
  if (!std::isfinite(norm_b)) {
    result.relative_residual = norm_b;
    result.breakdown = true;
    return result;
  }
  if (norm_b == 0) {
    parallel_for(n, [&](std::size_t i) { x[i] = 0; });
    result.converged = true;
    return result;
  }
  const auto measure = [&] {
    exact.apply(x, r);
    ++result.double_applications;
    return project(fused_sums<1>(n, [&](std::size_t i) {
      r[i] = b[i] - r[i];
      return std::array{r[i]};
    })[0]);
  };
  double norm_r = norm_b;
  if (options.zero_guess)
    parallel_for(n, [&](std::size_t i) { x[i] = 0; });
  else
    norm_r = measure();

  KrylovOptions<float> inner;
  inner.zero_guess = true;
  inner.confirm = false;
  inner.remove_mean = options.remove_mean;
  inner.weights = work.weights;
  while (std::isfinite(norm_r) && norm_r > options.tolerance * norm_b && result.iterations < options.max_iterations) {
    // Unit norm: residuals of small volumes would underflow in float.
    const double scale = 1 / norm_r;
    parallel_for(n, [&](std::size_t i) { work.right_hand_side[i] = static_cast<float>(scale * r[i]); });
    inner.tolerance = std::clamp(safety * options.tolerance * norm_b / norm_r, options.inner_tolerance, 0.5);
    inner.max_iterations = options.max_iterations - result.iterations;
    const std::span<const float> rhs = work.right_hand_side;
    const std::span<float> e = work.correction;
    const KrylovResult solved = options.method == KrylovMethod::bicgstab
                                    ? bicgstab<float>(fast, m, rhs, e, inner, work.krylov)
                                    : conjugate_gradients<float>(fast, m, rhs, e, inner, work.krylov);
    result.iterations += solved.iterations;
    result.applications += solved.applications;
    parallel_for(n, [&](std::size_t i) { x[i] += norm_r * static_cast<double>(e[i]); });
    const double before = norm_r;
    norm_r = measure();
    if (!(norm_r < 0.5 * before) && norm_r > options.tolerance * norm_b) {
      result.breakdown = result.iterations < options.max_iterations;
      break;
    }
  }
  result.breakdown = result.breakdown || !std::isfinite(norm_r);
  result.relative_residual = norm_r / norm_b;
  result.converged = norm_r <= options.tolerance * norm_b;
  if (options.remove_mean && !result.breakdown) {
    const double mean = fused_sums<1>(n, [&](std::size_t i) { return std::array{weight(i) * x[i]}; })[0] / total_weight;
    parallel_for(n, [&](std::size_t i) { x[i] -= mean; });
  }
  return result;
}

}  // namespace spume
