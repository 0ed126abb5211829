// SPDX-License-Identifier: MIT
// What the Krylov solvers know of a linear system: y = A x and z = M r on vectors of `size()` entries.
#pragma once

#include <cstddef>
#include <span>

#include "spume/core/parallel.hpp"
#include "spume/operators/dots.hpp"

namespace spume {

template <class Real>
struct LinearOperator {
  virtual ~LinearOperator() = default;

  virtual std::size_t size() const = 0;

  // y = A x. The spans do not overlap.
  virtual void apply(std::span<const Real> x, std::span<Real> y) = 0;

  // y = A x, returning <w, y> and <y, y> accumulated in double. `w` may be `x`. An operator that overrides
  // this with a fused sweep saves one pass over the vectors; its sums must not depend on the thread count.
  virtual Dots apply_with_dots(std::span<const Real> x, std::span<Real> y, std::span<const Real> w) {
    apply(x, y);
    return parallel_reduce(
        y.size(), Dots{},
        [&](std::size_t first, std::size_t last) {
          constexpr std::size_t lanes = 16;
          double wy[lanes] = {}, yy[lanes] = {};
          std::size_t i = first;
          for (; i + lanes <= last; i += lanes) {
#pragma omp simd
            for (std::size_t l = 0; l < lanes; ++l) {
              const double value = static_cast<double>(y[i + l]);
              wy[l] += static_cast<double>(w[i + l]) * value;
              yy[l] += value * value;
            }
          }
          Dots sum;
          for (; i < last; ++i) {
            const double value = static_cast<double>(y[i]);
            sum += Dots{static_cast<double>(w[i]) * value, value * value};
          }
          for (std::size_t l = 0; l < lanes; ++l) sum += Dots{wy[l], yy[l]};
          return sum;
        },
        [](Dots a, const Dots& b) { return a += b; });
  }
};

template <class Real>
struct Preconditioner {
  virtual ~Preconditioner() = default;

  // z = M r, with M close to the inverse of A. The spans do not overlap.
  virtual void apply(std::span<const Real> r, std::span<Real> z) = 0;
};

// M = D^-1. A zero or non-finite diagonal entry gives z_i = 0.
template <class Real>
class JacobiPreconditioner final : public Preconditioner<Real> {
 public:
  explicit JacobiPreconditioner(std::span<const Real> diagonal) : diagonal_(diagonal) {}

  void apply(std::span<const Real> r, std::span<Real> z) override {
    parallel_for(r.size(), [&](std::size_t i) { z[i] = diagonal_[i] > Real(0) ? r[i] / diagonal_[i] : Real(0); });
  }

 private:
  std::span<const Real> diagonal_;
};

}  // namespace spume
