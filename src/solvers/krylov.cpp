// SPDX-License-Identifier: MIT
#include "spume/solvers/krylov.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "vector_kernels.hpp"

namespace spume {

namespace {

using detail::fused_sums;

// Restarts that leave more than half of the residual before a solve is given up. Restarts are rare: with 1 and 10
// vortices, a collapsing column and a cavity around a solid have the same bits.
constexpr int most_fruitless_restarts = 3;
constexpr double fruitful = 0.5;
// An inner product this small against the norms of its factors carries no digits: the sum of its terms in double is
// exact to 1e-16 of them. With 1e-16 the same scenes have the same bits;
// with 1e-10 the cavity around a solid, whose solves are the hardest, has not.
constexpr double vanishing = 1e-14;

template <class Real>
double squared_norm(std::span<const Real> x) {
  return fused_sums<1>(x.size(), [&](std::size_t i) {
    const double v = static_cast<double>(x[i]);
    return std::array{v * v};
  })[0];
}

// What both solvers share: the start, the mean, the measured residual and when to stop.
template <class Real>
class Solve {
 public:
  Solve(LinearOperator<Real>& a, std::span<const Real> b, std::span<Real> x, const KrylovOptions<Real>& options,
        KrylovWorkspace<Real>& work)
      : a_(a), b_(b), x_(x), options_(options), work_(work), n_(b.size()) {
    if (x.size() != n_ || a.size() != n_ || (!options.weights.empty() && options.weights.size() != n_))
      throw std::invalid_argument(
          "Krylov solver: operator, right-hand side, solution and weights must have one length");
    for (Array<Real>* vector : {&work.residual, &work.shadow, &work.direction, &work.preconditioned, &work.image,
                                &work.second_image, &work.second_preconditioned})
      vector->resize(n_);
    if (options.remove_mean && options.parts == nullptr)
      total_weight_ = options.weights.empty() ? static_cast<double>(n_) : fused_sums<1>(n_, [&](std::size_t i) {
        return std::array{static_cast<double>(options_.weights[i])};
      })[0];
  }

  KrylovResult result;
  double norm_b = 0;
  double norm_r = 0;

  // Computes the first residual. True when there is nothing (more) to do.
  bool begin() {
    if (projected()) {
      std::copy(b_.begin(), b_.end(), work_.residual.begin());
      project(work_.residual);
      norm_b = std::sqrt(squared_norm<Real>(work_.residual));
    } else {
      norm_b = std::sqrt(squared_norm<Real>(b_));
    }
    if (!std::isfinite(norm_b)) {
      result.breakdown = true;
      result.relative_residual = norm_b;
      return true;
    }
    if (norm_b == 0) {
      parallel_for(n_, [&](std::size_t i) { x_[i] = 0; });
      result.converged = true;
      return true;
    }
    if (options_.zero_guess) {
      parallel_for(n_, [&](std::size_t i) {
        x_[i] = 0;
        work_.residual[i] = b_[i];
      });
      if (projected()) project(work_.residual);
      norm_r = norm_b;
      measured_ = true;
    } else {
      measure();
    }
    return stop();
  }

  // True when the solve ends here: converged (measured if asked), out of iterations, or broken down.
  bool stop() {
    if (!std::isfinite(norm_r)) {
      result.breakdown = true;
      return true;
    }
    if (norm_r <= options_.tolerance * norm_b) {
      if (options_.confirm && !measured_) {
        measure();
        restart_needed = true;
        if (!std::isfinite(norm_r)) {
          result.breakdown = true;
          return true;
        }
        if (norm_r > options_.tolerance * norm_b) return result.iterations >= options_.max_iterations || fruitless();
      }
      result.converged = true;
      return true;
    }
    return result.iterations >= options_.max_iterations;
  }

  // Counts a restart; true when restarts have ceased to help.
  bool fruitless() {
    if (norm_r < fruitful * best_restart_) {
      best_restart_ = norm_r;
      fruitless_ = 0;
      return false;
    }
    if (++fruitless_ < most_fruitless_restarts) return false;
    result.breakdown = true;
    return true;
  }

  void updated(double norm) {
    norm_r = norm;
    measured_ = false;
  }

  // r = b - A x
  void measure() {
    Array<Real>& r = work_.residual;
    a_.apply(x_, r);
    ++result.applications;
    if (projected()) {
      parallel_for(n_, [&](std::size_t i) { r[i] = b_[i] - r[i]; });
      project(r);
      norm_r = std::sqrt(squared_norm<Real>(r));
    } else {
      norm_r = std::sqrt(fused_sums<1>(n_, [&](std::size_t i) {
        const Real value = b_[i] - r[i];
        r[i] = value;
        return std::array{static_cast<double>(value) * static_cast<double>(value)};
      })[0]);
    }
    measured_ = true;
  }

  KrylovResult finish() {
    if (norm_b > 0 && std::isfinite(norm_b)) result.relative_residual = norm_r / norm_b;
    if (options_.parts != nullptr && !result.breakdown) {
      options_.parts->remove(x_);
    } else if (options_.remove_mean && !result.breakdown) {
      const double mean =
          fused_sums<1>(n_, [&](std::size_t i) { return std::array{weight(i) * static_cast<double>(x_[i])}; })[0] /
          total_weight_;
      parallel_for(n_, [&](std::size_t i) { x_[i] -= static_cast<Real>(mean); });
    }
    return result;
  }

  bool restart_needed = true;

 private:
  double weight(std::size_t i) const {
    return options_.weights.empty() ? 1.0 : static_cast<double>(options_.weights[i]);
  }

  bool projected() const { return options_.remove_mean || options_.parts != nullptr; }

  // r -= w sum(r) / sum(w): the constant's component of a residual, in the weights of the rows.
  void project(Array<Real>& r) {
    if (options_.parts != nullptr) {
      options_.parts->remove(std::span<Real>(r.data(), n_));
      return;
    }
    const double share =
        fused_sums<1>(n_, [&](std::size_t i) { return std::array{static_cast<double>(r[i])}; })[0] / total_weight_;
    parallel_for(n_, [&](std::size_t i) { r[i] -= static_cast<Real>(weight(i) * share); });
  }

  LinearOperator<Real>& a_;
  std::span<const Real> b_;
  std::span<Real> x_;
  const KrylovOptions<Real>& options_;
  KrylovWorkspace<Real>& work_;
  std::size_t n_;
  double total_weight_ = 0;
  double best_restart_ = HUGE_VAL;
  int fruitless_ = 0;
  bool measured_ = false;
};

}  // namespace

template <class Real>
KrylovResult conjugate_gradients(LinearOperator<Real>& a, Preconditioner<Real>& m, std::span<const Real> b,
                                 std::span<Real> x, const KrylovOptions<Real>& options, KrylovWorkspace<Real>& work) {
  Solve<Real> solve(a, b, x, options, work);
  const std::size_t n = b.size();
  Array<Real>&r = work.residual, &p = work.direction, &z = work.preconditioned, &ap = work.image;
  double rho = 0;
  bool done = solve.begin();
  while (!done) {
    m.apply(r, z);
    const double rho_new = fused_sums<1>(
        n, [&](std::size_t i) { return std::array{static_cast<double>(r[i]) * static_cast<double>(z[i])}; })[0];
    const Real beta = solve.restart_needed ? Real(0) : static_cast<Real>(rho_new / rho);
    rho = rho_new;
    if (solve.restart_needed)
      parallel_for(n, [&](std::size_t i) { p[i] = z[i]; });
    else
      parallel_for(n, [&](std::size_t i) { p[i] = z[i] + beta * p[i]; });
    solve.restart_needed = false;
    const Dots dots = a.apply_with_dots(p, ap, p);
    ++solve.result.applications;
    // A direction of no energy, or rounding that made it negative: go on from the measured residual.
    if (!(dots.wy > 0) || !(rho > 0)) {
      solve.measure();
      solve.restart_needed = true;
      done = !std::isfinite(dots.wy) || !std::isfinite(rho);
      solve.result.breakdown = done;
      done = done || solve.fruitless() || solve.stop();
      continue;
    }
    const double alpha = rho / dots.wy;
    const Real step = static_cast<Real>(alpha);
    const double rr = fused_sums<1>(n, [&](std::size_t i) {
      x[i] += step * p[i];
      const Real value = r[i] - step * ap[i];
      r[i] = value;
      return std::array{static_cast<double>(value) * static_cast<double>(value)};
    })[0];
    ++solve.result.iterations;
    solve.updated(std::sqrt(rr));
    done = solve.stop();
  }
  return solve.finish();
}

template <class Real>
KrylovResult bicgstab(LinearOperator<Real>& a, Preconditioner<Real>& m, std::span<const Real> b, std::span<Real> x,
                      const KrylovOptions<Real>& options, KrylovWorkspace<Real>& work) {
  Solve<Real> solve(a, b, x, options, work);
  const std::size_t n = b.size();
  Array<Real>&r = work.residual, &shadow = work.shadow, &p = work.direction, &p_hat = work.preconditioned;
  Array<Real>&v = work.image, &t = work.second_image, &s_hat = work.second_preconditioned;
  double rho = 0, norm_shadow = 0;
  bool done = solve.begin();
  // Goes on from the measured residual with a new shadow; true when that has ceased to help.
  const auto restart = [&](bool finite) {
    solve.measure();
    solve.restart_needed = true;
    if (finite) return solve.fruitless() || solve.stop();
    solve.result.breakdown = true;
    return true;
  };
  while (!done) {
    if (solve.restart_needed) {
      parallel_for(n, [&](std::size_t i) {
        shadow[i] = r[i];
        p[i] = r[i];
      });
      norm_shadow = solve.norm_r;
      rho = norm_shadow * norm_shadow;
      solve.restart_needed = false;
    }
    m.apply(p, p_hat);
    const Dots first = a.apply_with_dots(p_hat, v, shadow);
    ++solve.result.applications;
    if (!(std::abs(first.wy) > vanishing * norm_shadow * std::sqrt(first.yy))) {
      done = restart(std::isfinite(first.yy));
      continue;
    }
    const double alpha = rho / first.wy;
    const Real step = static_cast<Real>(alpha);
    const double ss = fused_sums<1>(n, [&](std::size_t i) {
      const Real value = r[i] - step * v[i];
      r[i] = value;
      return std::array{static_cast<double>(value) * static_cast<double>(value)};
    })[0];
    // Half an iteration is enough at times.
    if (std::sqrt(ss) <= options.tolerance * solve.norm_b) {
      parallel_for(n, [&](std::size_t i) { x[i] += step * p_hat[i]; });
      ++solve.result.iterations;
      solve.updated(std::sqrt(ss));
      solve.restart_needed = true;
      done = solve.stop();
      continue;
    }
    m.apply(r, s_hat);
    const Dots second = a.apply_with_dots(s_hat, t, r);
    ++solve.result.applications;
    const bool degenerate = !(std::abs(second.wy) > vanishing * std::sqrt(second.yy * ss));
    const double omega = degenerate ? 0 : second.wy / second.yy;
    if (!std::isfinite(omega) || !std::isfinite(ss) || !std::isfinite(second.yy)) {
      done = restart(false);
      continue;
    }
    const Real shift = static_cast<Real>(omega);
    const auto sums = fused_sums<2>(n, [&](std::size_t i) {
      x[i] += step * p_hat[i] + shift * s_hat[i];
      const Real value = r[i] - shift * t[i];
      r[i] = value;
      const double d = static_cast<double>(value);
      return std::array{d * static_cast<double>(shadow[i]), d * d};
    });
    ++solve.result.iterations;
    solve.updated(std::sqrt(sums[1]));
    done = solve.stop();
    if (done || solve.restart_needed) continue;
    if (degenerate || !(std::abs(sums[0]) > vanishing * norm_shadow * solve.norm_r)) {
      done = restart(true);
      continue;
    }
    const Real beta = static_cast<Real>(sums[0] / rho * (alpha / omega));
    rho = sums[0];
    parallel_for(n, [&](std::size_t i) { p[i] = r[i] + beta * (p[i] - shift * v[i]); });
  }
  return solve.finish();
}

#define SPUME_INSTANTIATE(Real)                                                                                        \
  template KrylovResult conjugate_gradients<Real>(LinearOperator<Real>&, Preconditioner<Real>&, std::span<const Real>, \
                                                  std::span<Real>, const KrylovOptions<Real>&,                         \
                                                  KrylovWorkspace<Real>&);                                             \
  template KrylovResult bicgstab<Real>(LinearOperator<Real>&, Preconditioner<Real>&, std::span<const Real>,            \
                                       std::span<Real>, const KrylovOptions<Real>&, KrylovWorkspace<Real>&);
SPUME_INSTANTIATE(float)
SPUME_INSTANTIATE(double)
#undef SPUME_INSTANTIATE

}  // namespace spume
