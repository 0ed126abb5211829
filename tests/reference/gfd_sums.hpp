// SPDX-License-Identifier: MIT
// Slow twins of generalised finite differences and of what they compute at interfaces: every sum over all pairs of
// particles and explicit images, in double, from Joubert et al., equations (5) to (19), (22) and (24), with r_ij = r_i
// - r_j as printed. Pairs, magnitudes and the bound of a float sum are those of SphSums.
#pragma once

#include <algorithm>
#include <functional>

#include "reference/sph_sums.hpp"
#include "spume/operators/gfd_stress.hpp"

namespace spume::reference {

class GfdSums {
 public:
  using SphPoint = SphSums::SphPoint;
  // B, o and 2 d / sum |r|^2 W (1 - r . o) of one particle.
  struct Stencil {
    Matrix correction{};
    Vector offset{};
    double laplacian_factor = 0;
  };
  // A value at a point, and a factor of the pair with it.
  using AtPoint = std::function<double(const SphPoint&)>;

  // Pairs are found once.
  explicit GfdSums(const SphSums& sums) : sums_(sums), d_(sums.dimensions()), pairs_(sums.size()) {
    for (std::size_t i = 0; i < sums.size(); ++i) {
      sums.each(i, [&](const SphSums::Pair& pair) {
        Vector r{};
        for (int a = 0; a < d_; ++a) r[a] = -pair.d[a];
        pairs_[i].push_back({pair.point, r, sums.kernel().w(pair.r / sums.width(i))});
      });
      tolerance_.push_back(sums.tolerance(i) + 16 * std::ldexp(1.0, -24));
    }
  }

  // That of SphSums, and 16 roundings more: 6 of 1 + d . o, 6 of a mean, 4 of densities and factors.
  double tolerance(std::size_t i) const { return tolerance_[i]; }

  // --- (10), (11) and the denominator of (9)

  // sum W r (x) r, sum W r, sum |r|^2 W r
  struct Moments {
    std::array<std::array<Sum, 3>, 3> second{};
    std::array<Sum, 3> first{}, third{};
  };
  Moments moments(
      std::size_t i, const AtPoint& included = [](const SphPoint&) { return 1.0; }) const {
    Moments m;
    each(i, [&](const SphPoint& point, const Vector& r, double w, double largest) {
      const double part = included(point), r2 = dot(r, r);
      for (int a = 0; a < d_; ++a) {
        m.first[a].add(w * part, largest * part, r[a], std::abs(r[a]));
        m.third[a].add(w * part, largest * part, r2 * r[a], r2 * std::abs(r[a]));
        for (int b = 0; b < d_; ++b) m.second[a][b].add(w * part, largest * part, r[a] * r[b], std::abs(r[a] * r[b]));
      }
    });
    return m;
  }

  // Where the root mean square row of B, over the inverse of the mean of the diagonal of the sum, exceeds
  // `largest_correction`, B is isotropic; where the denominator is a lesser part of sum |r|^2 W than
  // `least_denominator`, o is zero. Bounds are those of the rounding of float sums.
  struct Reference {
    Stencil value, bound;
    bool isotropic = false, no_offset = false;
  };
  Reference stencil(std::size_t i, double largest_correction, double least_denominator) const {
    const Moments m = moments(i);
    const double eps = tolerance(i);
    Reference result;
    double trace = 0, largest_trace = 0;
    for (int a = 0; a < d_; ++a) {
      trace += m.second[a][a].value;
      largest_trace += m.second[a][a].magnitude;
    }
    if (trace == 0) {
      result.isotropic = true;
      return result;
    }
    Matrix& b = result.value.correction;
    result.isotropic = !inverse(m.second, trace, largest_correction, b);
    if (result.isotropic)
      for (int a = 0; a < d_; ++a) b[a][a] = d_ / trace;
    // dB = -B dM B, or that of the trace.
    Matrix& db = result.bound.correction;
    for (int a = 0; a < d_; ++a)
      for (int c = 0; c < d_; ++c) {
        db[a][c] = eps * std::abs(b[a][c]);
        if (result.isotropic) db[a][c] += b[a][c] * eps * largest_trace / trace;
        for (int e = 0; e < d_ && !result.isotropic; ++e)
          for (int f = 0; f < d_; ++f)
            db[a][c] += std::abs(b[a][e]) * eps * m.second[e][f].magnitude * std::abs(b[f][c]);
      }
    double denominator = trace, bound = eps * largest_trace;
    if (!result.isotropic) {
      for (int a = 0; a < d_; ++a)
        for (int c = 0; c < d_; ++c) {
          result.value.offset[a] += b[a][c] * m.first[c].value;
          result.bound.offset[a] +=
              db[a][c] * std::abs(m.first[c].value) + std::abs(b[a][c]) * eps * m.first[c].magnitude;
        }
      for (int a = 0; a < d_; ++a) {
        denominator -= result.value.offset[a] * m.third[a].value;
        bound += std::abs(result.value.offset[a]) * eps * m.third[a].magnitude +
                 result.bound.offset[a] * std::abs(m.third[a].value);
      }
      result.no_offset = !(denominator > least_denominator * trace);
      if (result.no_offset) {
        result.value.offset = result.bound.offset = {};
        denominator = trace;
        bound = eps * largest_trace;
      }
    }
    result.value.laplacian_factor = 2 * d_ / denominator;
    result.bound.laplacian_factor = 2 * d_ / denominator * (bound / denominator + eps);
    return result;
  }

  // --- sums of differences: `value` at points, `factor` of pairs, not negative

  // B sum factor (f_i - f_j) W r_ij: (8), (14), (22)
  std::array<Sum, 3> gradient(std::size_t i, const AtPoint& value, const AtPoint& factor, const Matrix& b) const {
    std::array<Sum, 3> m{}, result{};
    const double own = value(sums_.points()[i]);
    each(i, [&](const SphPoint& point, const Vector& r, double w, double largest) {
      const double other = value(point), c = factor(point);
      for (int a = 0; a < d_; ++a)
        m[a].add(w * c, largest * c, (own - other) * r[a], (std::abs(own) + std::abs(other)) * std::abs(r[a]));
    });
    for (int a = 0; a < d_; ++a)
      for (int c = 0; c < d_; ++c) {
        result[a].value += b[a][c] * m[c].value;
        result[a].magnitude += std::abs(b[a][c]) * m[c].magnitude;
      }
    return result;
  }
  // factor_L sum factor (f_j - f_i) W (1 - r_ij . o): (9), (12), (24)
  Sum laplacian(std::size_t i, const AtPoint& value, const AtPoint& factor, const Stencil& stencil) const {
    Sum sum;
    const double own = value(sums_.points()[i]);
    each(i, [&](const SphPoint& point, const Vector& r, double w, double largest) {
      const double other = value(point), c = factor(point) * stencil.laplacian_factor;
      double along = 0;
      for (int a = 0; a < d_; ++a) along += std::abs(r[a] * stencil.offset[a]);
      sum.add(c * w, c * largest * (1 + along), (other - own) * (1 - dot(r, stencil.offset)),
              std::abs(other) + std::abs(own));
    });
    return sum;
  }
  // sum of factor, for (24)'s diagonal
  Sum laplacian_diagonal(std::size_t i, const AtPoint& factor, const Stencil& stencil) const {
    Sum sum;
    each(i, [&](const SphPoint& point, const Vector& r, double w, double largest) {
      const double c = factor(point) * stencil.laplacian_factor;
      double along = 0;
      for (int a = 0; a < d_; ++a) along += std::abs(r[a] * stencil.offset[a]);
      sum.add(c * w, c * largest * (1 + along), 1 - dot(r, stencil.offset), 1);
    });
    return sum;
  }

  // --- momentum diffusion; a velocity has one array per dimension

  // Viscosity and density of particles; whether means are taken and gradients added in the row; grad mu / rho there.
  template <class Velocity, class Scalar>
  std::array<Sum, 3> stress(std::size_t i, MomentumDiffusion form, const Velocity& u, const Scalar& mu, double density,
                            bool varies, const Vector& viscosity_gradient, const Stencil& stencil) const {
    std::array<Sum, 3> result{};
    const bool pairwise = form == MomentumDiffusion::rotation_free;
    const bool means =
        varies && (form == MomentumDiffusion::split || form == MomentumDiffusion::mu_laplacian || pairwise);
    const bool gradients =
        varies && (form == MomentumDiffusion::split || form == MomentumDiffusion::printed || pairwise);
    std::array<std::array<Sum, 3>, 3> slope{};  // [a][b] = d u_a / d x_b
    for (int a = 0; a < d_; ++a) {
      const AtPoint velocity = [&](const SphPoint& p) { return sums_.velocity_at(u, p, a); };
      const AtPoint viscosity = [&](const SphPoint& p) {
        return means ? harmonic(double(mu[i]), double(mu[p.source])) / density : double(mu[i]) / density;
      };
      result[a] = laplacian(i, velocity, viscosity, stencil);
      slope[a] = varies && pairwise ? weighted_slope(i, velocity, mu) : gradient(i, velocity, one, stencil.correction);
    }
    std::array<Sum, 3> mu_slope{};
    for (int b = 0; b < d_ && gradients && pairwise; ++b) {
      each(i, [&](const SphPoint& p, const Vector& r, double w, double largest) {
        const double c = harmonic(double(mu[i]), double(mu[p.source])) / density * stencil.laplacian_factor;
        double along = 0;
        for (int a = 0; a < d_; ++a) along += std::abs(r[a] * stencil.offset[a]);
        mu_slope[b].add(c * w, c * largest * (1 + along), -r[b] * (1 - dot(r, stencil.offset)), std::abs(r[b]));
      });
    }
    for (int a = 0; a < d_ && gradients && pairwise; ++a)
      for (int b = 0; b < d_; ++b) {
        result[a].value += slope[b][a].value * mu_slope[b].value;
        result[a].magnitude += slope[b][a].magnitude * mu_slope[b].magnitude;
      }
    for (int a = 0; a < d_ && gradients && !pairwise; ++a)
      for (int b = 0; b < d_; ++b) {
        // (grad u)^T . grad mu: d u_b / d x_a; of 2 T both.
        result[a].value += slope[b][a].value * viscosity_gradient[b];
        result[a].magnitude += slope[b][a].magnitude * std::abs(viscosity_gradient[b]);
        if (form != MomentumDiffusion::printed) continue;
        result[a].value += slope[a][b].value * viscosity_gradient[b];
        result[a].magnitude += slope[a][b].magnitude * std::abs(viscosity_gradient[b]);
      }
    return result;
  }
  // (sum mu_ij W r (x) r)^-1 sum mu_ij (f_i - f_j) W r, and a bound of its rounding: dB = -B dM B on the slope.
  template <class Scalar>
  std::array<Sum, 3> weighted_slope(std::size_t i, const AtPoint& value, const Scalar& mu) const {
    const AtPoint mean = [&](const SphPoint& p) { return harmonic(double(mu[i]), double(mu[p.source])); };
    const Moments m = moments(i, mean);
    double trace = 0;
    for (int a = 0; a < d_; ++a) trace += m.second[a][a].value;
    if (trace == 0) return {};
    Matrix b{};
    if (!inverse(m.second, trace, 6, b))  // that of the operators
      for (int a = 0; a < d_; ++a) b[a][a] = d_ / trace;
    auto slope = gradient(i, value, mean, b);
    const auto exact = slope;
    for (int a = 0; a < d_; ++a)
      for (int e = 0; e < d_; ++e)
        for (int f = 0; f < d_; ++f)
          slope[a].magnitude += std::abs(b[a][e]) * m.second[e][f].magnitude * std::abs(exact[f].value);
    return slope;
  }
  // (13), over the density
  template <class Velocity, class Scalar>
  std::array<Sum, 3> hu_adams(std::size_t i, const Velocity& u, const Scalar& mu, const Scalar& volume, double density,
                              bool varies) const {
    std::array<Sum, 3> sum{};
    const PlainKernel& kernel = sums_.kernel();
    const double h = sums_.width(i), scale = kernel.normalisation() / std::pow(h, d_ + 2);
    each(i, [&](const SphPoint& point, const Vector& r, double, double) {
      const double vi = volume[i], vj = volume[point.source];
      const double mean = varies ? harmonic(double(mu[i]), double(mu[point.source])) : double(mu[i]);
      const double factor = mean * (vi * vi + vj * vj) / vi * scale / density;
      for (int a = 0; a < d_; ++a) {
        const double own = u[a][i], other = sums_.velocity_at(u, point, a);
        sum[a].add(factor * kernel.f(std::sqrt(dot(r, r)) / h), factor * std::abs(kernel.f(0)), own - other,
                   std::abs(own) + std::abs(other));
      }
    });
    return sum;
  }

  // --- interfaces

  // Whether the support holds another phase than the particle's.
  template <class Phases>
  bool mixed(std::size_t i, const Phases& phase) const {
    bool found = false;
    each(i, [&](const SphPoint& p, const Vector&, double, double) { found = found || phase[p.source] != phase[i]; });
    return found;
  }
  // (6)
  template <class Phases>
  Sum colour(std::size_t i, const Phases& phase, int n) const {
    std::vector<double> indicator(sums_.size());
    for (std::size_t k = 0; k < indicator.size(); ++k) indicator[k] = phase[k] == n ? 1 : 0;
    return sums_.filtered_scalar(i, indicator);
  }
  // The change of the velocity of i by what its neighbours lose, and a bound of its rounding.
  template <class Scalar, class Velocity>
  std::array<Sum, 3> exchanged(std::size_t i, const Scalar& gain, double density, const Velocity& u) const {
    std::array<Sum, 3> change{};
    if (!(gain[i] > 0)) return change;
    Sum total;
    each(i, [&](const SphPoint& p, const Vector&, double w, double largest) {
      total.add(w, largest, std::max(-double(gain[p.source]), 0.0), std::abs(double(gain[p.source])));
    });
    if (!(total.value > 0)) return change;
    const double share = std::min(1.0, gain[i] / density) / total.value;
    for (int a = 0; a < d_; ++a) {
      each(i, [&](const SphPoint& p, const Vector&, double w, double largest) {
        const double own = u[a][i], other = sums_.velocity_at(u, p, a), lost = std::max(-double(gain[p.source]), 0.0);
        change[a].add(share * w * lost, share * largest * lost, other - own, std::abs(other) + std::abs(own));
      });
      change[a].magnitude += std::abs(change[a].value) * total.magnitude / total.value;
    }
    return change;
  }
  // -div n over the particles with a normal, and a bound of its rounding; B that of these particles.
  template <class Normal>
  Sum curvature(std::size_t i, const Normal& normal, double largest_correction) const {
    const auto component = [&](const SphPoint& p, int a) { return p.reflection[a] * double(normal[a][p.source]); };
    const AtPoint on_band = [&](const SphPoint& p) {
      double square = 0;
      for (int a = 0; a < d_; ++a) square += component(p, a) * component(p, a);
      return square > 0 ? 1.0 : 0.0;
    };
    const Moments m = moments(i, on_band);
    double trace = 0;
    for (int a = 0; a < d_; ++a) trace += m.second[a][a].value;
    Matrix b{};
    Sum sum;
    if (trace == 0) return sum;
    if (!inverse(m.second, trace, largest_correction, b))
      for (int a = 0; a < d_; ++a) b[a][a] = d_ / trace;
    for (int a = 0; a < d_; ++a) {
      const auto slope = gradient(
          i, [&](const SphPoint& p) { return component(p, a); }, on_band, b);
      sum.value -= slope[a].value;
      sum.magnitude += slope[a].magnitude;
      // dB = -B dM B on the slope.
      for (int e = 0; e < d_; ++e)
        for (int f = 0; f < d_; ++f)
          sum.magnitude += std::abs(b[a][e]) * m.second[e][f].magnitude * std::abs(slope[f].value);
    }
    return sum;
  }

  static double harmonic(double a, double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }
  static double one(const SphPoint&) { return 1; }

 private:
  static double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  // visit(point, r_ij, W, W(0))
  template <class Visit>
  void each(std::size_t i, Visit&& visit) const {
    const double largest = sums_.kernel().w(0);
    for (const Pair& pair : pairs_[i]) visit(*pair.point, pair.r, pair.w, largest);
  }

  // False where the inverse amplifies more than `largest`.
  bool inverse(const std::array<std::array<Sum, 3>, 3>& sums, double trace, double largest, Matrix& result) const {
    Matrix m{};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) m[a][b] = a < d_ && b < d_ ? sums[a][b].value * d_ / trace : (a == b ? 1.0 : 0.0);
    const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    double squares = 0;
    Matrix full{};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
        full[b][a] = (m[a1][b1] * m[a2][b2] - m[a1][b2] * m[a2][b1]) / determinant;
      }
    for (int a = 0; a < d_; ++a)
      for (int b = 0; b < d_; ++b) squares += full[a][b] * full[a][b] / d_;
    if (!(determinant > 1e-9) || !(squares < largest * largest)) return false;
    for (int a = 0; a < d_; ++a)
      for (int b = 0; b < d_; ++b) result[a][b] = full[a][b] * d_ / trace;
    return true;
  }

  const SphSums& sums_;
  int d_;
  struct Pair {
    const SphPoint* point;
    Vector r;
    double w;
  };
  std::vector<std::vector<Pair>> pairs_;
  std::vector<double> tolerance_;
};

}  // namespace spume::reference
