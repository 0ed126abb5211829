// SPDX-License-Identifier: MIT
#include "spume/solvers/implicit_diffusion.hpp"

#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

// Residual over the norm of b. A drop of 100 times the viscosity (viscous_drop, 8 across, 30 times the explicit limit)
// sinks as fast, to 1e-4, with 1e-6.
constexpr double residual_of_change = 1e-4;
constexpr int most_iterations = 500;

}  // namespace

// y = x - dt M x.
struct ImplicitDiffusion::Operator final : LinearOperator<float> {
  Operator(const DiffusionStep& step, const VelocityImageRule& rule, ScratchPool& scratch)
      : step_(step),
        rule_(rule),
        n_(step.context.list->particles()),
        dimensions_(step.context.dimensions),
        scratch_(scratch) {
    scratch_.lease(velocity_, dimensions_, n_);
  }
  Operator(const Operator&) = delete;
  Operator& operator=(const Operator&) = delete;
  ~Operator() override { scratch_.release(velocity_); }

  std::size_t size() const override { return n_ * static_cast<std::size_t>(dimensions_); }
  void apply(std::span<const float> x, std::span<float> y) override {
    std::array<float*, 3> out{};
    for (int axis = 0; axis < dimensions_; ++axis) {
      const float* from = x.data() + static_cast<std::size_t>(axis) * n_;
      double* to = velocity_[axis].data();
      parallel_for(n_, [=](std::size_t i) { to[i] = from[i]; });
      out[axis] = y.data() + static_cast<std::size_t>(axis) * n_;
    }
    gfd_stress_sweep(step_.context, step_.packed, velocity(), rule_, step_.stencils, MomentumDiffusion::mu_laplacian,
                     step_.properties, out);
    const auto dt = static_cast<float>(step_.dt);
    parallel_for(size(), [&](std::size_t k) { y[k] = x[k] - dt * y[k]; });
  }

 private:
  std::array<const double*, 3> velocity() const {
    std::array<const double*, 3> u{};
    for (int axis = 0; axis < dimensions_; ++axis) u[axis] = velocity_[axis].data();
    return u;
  }
  const DiffusionStep& step_;
  const VelocityImageRule& rule_;
  std::size_t n_;
  int dimensions_;
  ScratchPool& scratch_;
  std::array<Array<double>, 3> velocity_;
};

void ImplicitDiffusion::solve(const DiffusionStep& step, ScratchPool& scratch) {
  Array<float>& b = change_;
  const std::size_t n = step.context.list->particles(), size = b.size();
  homogeneous_.sign = step.rule.sign;
  homogeneous_.friction = step.rule.friction;
  homogeneous_.moving = false;
  homogeneous_.bends = false;
  diagonal_.resize(size);
  gfd_diffusion_diagonal(step.context, step.packed, step.stencils, step.properties, diagonal_.data());
  const auto dt = static_cast<float>(step.dt);
  parallel_for(n, [&](std::size_t i) {
    diagonal_[i] = 1 + dt * diagonal_[i];
    for (std::size_t k = i + n; k < size; k += n) diagonal_[k] = diagonal_[i];
  });
  // In float, scaled to order one: the range holds for any units.
  const double norm = std::sqrt(parallel_sum(size, [&](std::size_t k) { return double{b[k]} * b[k]; }));
  report_ = {.converged = std::isfinite(norm)};
  if (!(norm > 0) || !report_.converged) return;
  const auto scale = static_cast<float>(norm);
  parallel_for(size, [&](std::size_t k) { b[k] /= scale; });
  solution_.resize(size);
  Operator matrix(step, homogeneous_, scratch);
  JacobiPreconditioner<float> jacobi(diagonal_);
  KrylovOptions<float> options;
  options.tolerance = residual_of_change;
  options.max_iterations = most_iterations;
  options.zero_guess = true;
  options.confirm = false;
  report_ = bicgstab<float>(matrix, jacobi, b, solution_, options, work_);
  parallel_for(size, [&](std::size_t k) { b[k] = scale * (solution_[k] - b[k]); });
}

}  // namespace spume
