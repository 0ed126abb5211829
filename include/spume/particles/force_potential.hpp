// SPDX-License-Identifier: MIT
// The potential of a body force f that has one, f = -grad phi at every time, by Gauss-Legendre quadrature along the
// straight line from the centre c of the domain:
//
//   phi(r, t) = -int_0^1 f(c + s (r - c), t) . (r - c) ds.
//
// As part of the pressure unknown it leaves the solver what the force does beyond a static pressure. Where it is left
// to the divergence of the velocity, div f dt has to be removed anew in every step, and the rows beside a surface,
// which are exact for linear pressures only, leave a part of it: a drop in a central force field then grows by 5 % of
// its area in two periods at 1/25 and courant 0.3.
#pragma once

#include <optional>
#include <vector>

#include "spume/scene/scene.hpp"

namespace spume {

class ForcePotential {
 public:
  // None when the force has no potential that as many points as are tried follow: the differences of phi over a spacing
  // must be the integrals of f there, and phi the same on both sides of a periodic axis, to 1e-6 of the largest force.
  // Sampled at places in the domain and at times up to `end`.
  static std::optional<ForcePotential> find(const VectorExpression& force, const Domain& domain, double spacing,
                                            double end);

  // phi(r, t). `force`: that of find(), a clone of it in each thread.
  double operator()(const VectorExpression& force, const Vec3& r, double t) const;

  std::size_t points() const { return node_.size(); }

 private:
  explicit ForcePotential(const Domain& domain, int points);
  bool follows(const VectorExpression& force, const Domain& domain, double spacing, double end) const;

  Vec3 centre_{};
  std::vector<double> node_, weight_;  // of the quadrature over [0, 1]
};

}  // namespace spume
