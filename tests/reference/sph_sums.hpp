// SPDX-License-Identifier: MIT
// Slow twins of the SPH operators: every sum over all pairs of particles and explicit images, in double, from the
// definitions in sph_operators.hpp and pressure_operator.hpp.
//
// Where particles differ in size a sum at particle i takes h_i and the volumes V_j of its neighbours.
//
// A sum carries its magnitude beside its value: the sum of |V W(0)| or |V F(0)| times the moduli of the other
// factors over the neighbours in the support. Rounding errors of a float sum are a multiple of it,
// SphSums::tolerance().
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "reference/brute_force.hpp"
#include "reference/plain_kernel.hpp"
#include "spume/scene/case.hpp"

namespace spume::reference {

// What the sides do to velocities; `wall` is the uniform velocity of a side.
struct Boundaries {
  std::array<std::array<BoundaryKind, 2>, 3> sides{};
  std::array<std::array<Vec3, 2>, 3> wall{};
  std::vector<SolidBox> boxes;
};

struct Sum {
  double value = 0, magnitude = 0;
  void add(double factor, double largest_factor, double term, double largest_term) {
    value += factor * term;
    magnitude += largest_factor * largest_term;
  }
};

using Vector = std::array<double, 3>;
using Matrix = std::array<std::array<double, 3>, 3>;

class SphSums {
 public:
  // A particle (source = itself) or an image of one.
  struct SphPoint {
    Point position{};
    std::size_t source = 0;
    Vector velocity_sign{1, 1, 1}, velocity_offset{}, reflection{1, 1, 1};
    Point end{};            // of a ray to it, reflected
    bool in_solid = false;  // reflected in a scene with solid boxes
  };

  // h_i / h and V_i / V per particle; empty: all alike.
  struct Sizes {
    std::vector<float> length_ratio, volume_ratio;
  };

  SphSums(const PlainKernel& kernel, double smoothing_length, double volume, const std::vector<Point>& particles,
          const ImageRules& rules, const Boundaries& boundaries, Sizes sizes = {})
      : kernel_(kernel),
        h_(smoothing_length),
        volume_(volume),
        n_(particles.size()),
        sizes_(std::move(sizes)),
        rules_(rules),
        boxes_(boundaries.boxes) {
    for (std::size_t i = 0; i < n_; ++i)
      points_.push_back({particles[i], i, {1, 1, 1}, {}, {1, 1, 1}, particles[i], false});
    for (const Image& image : images(rules, particles, boxes_)) {
      points_.push_back(transformed(image, boundaries));
      points_.back().end = end_of_ray(rules, image, particles[static_cast<std::size_t>(image.source)]);
      points_.back().in_solid = image.path.reflections() > 0;
    }
    pairs_.resize(n_);
  }
  SphSums(const SphSums&) = delete;  // pairs name points

  // What an image carries, from the reflections of its path in their order.
  static SphPoint transformed(const Image& image, const Boundaries& boundaries) {
    SphPoint point{image.position, static_cast<std::size_t>(image.source), {1, 1, 1}, {}, {1, 1, 1}, {}, false};
    for (int axis = 0; axis < 3; ++axis)
      for (const int face : image.path.face[axis]) {
        if (face < 0) continue;
        if (face < 2) {
          reflect(point, axis, boundaries.sides[axis][face], boundaries.wall[axis][face]);
        } else {
          reflect(point, axis, boundaries.boxes[static_cast<std::size_t>(face - 2) / 2].kind, {});
        }
      }
    for (int axis = 0; axis < 3; ++axis)
      if (const int side = image.path.side[axis]; side >= 0)
        reflect(point, axis, boundaries.sides[axis][side], boundaries.wall[axis][side]);
    return point;
  }

  std::size_t size() const { return n_; }
  const PlainKernel& kernel() const { return kernel_; }
  int dimensions() const { return kernel_.dimensions; }
  const std::vector<SphPoint>& points() const { return points_; }
  // Whether no solid stands between a particle and a point.
  bool seen(std::size_t i, std::size_t j) const {
    return boxes_.empty() || sees(rules_, boxes_, points_[i].position, points_[j].position, points_[j].end);
  }
  double width(std::size_t i) const { return sizes_.length_ratio.empty() ? h_ : h_ * sizes_.length_ratio[i]; }
  double volume_ratio(std::size_t i) const { return sizes_.volume_ratio.empty() ? 1 : sizes_.volume_ratio[i]; }

  struct Pair {
    const SphPoint* point;
    Vector d;  // r_j - r_i
    double r, w, g, largest_w, largest_g;
  };

  // Calls visit(pair) for what particle i sees in its support.
  template <class Visit>
  void each(std::size_t i, Visit&& visit) const {
    for (const Pair& pair : pairs_of(i)) visit(pair);
  }
  // Looked for among all points once.
  const std::vector<Pair>& pairs_of(std::size_t i) const {
    if (pairs_[i].has_value()) return *pairs_[i];
    std::vector<Pair>& pairs = pairs_[i].emplace();
    for (std::size_t j = 0; j < points_.size(); ++j) {
      if (j == i) continue;
      Pair pair{&points_[j], {}, 0, 0, 0, 0, 0};
      double r2 = 0;
      for (int a = 0; a < dimensions(); ++a) {
        pair.d[a] = points_[j].position[a] - points_[i].position[a];
        r2 += pair.d[a] * pair.d[a];
      }
      pair.r = std::sqrt(r2);
      const double h = width(i), v = volume_ratio(points_[j].source);
      if (pair.r >= kernel_.support() * h) continue;
      if (!seen(i, j)) continue;
      pair.w = v * weight(pair.r, h);
      pair.g = v * slope(pair.r, h);
      pair.largest_w = v * weight(0, h);
      pair.largest_g = v * slope(0, h);
      pairs.push_back(pair);
    }
    return pairs;
  }

  std::size_t neighbours(std::size_t i) const { return pairs_of(i).size(); }

  // Bound on the rounding error of a float sum of the neighbours of i, added in eight lanes, in units of its magnitude,
  // eps = 2^-24. Differences of coordinates are exact when the coordinates are floats.
  //   kernel argument q = sqrt(sum d^2) * (1/h): 4 roundings; |q F'| <= 4 |F(0)| for both kernels       16 eps
  //   evaluation of the kernel, powers and cancelling quartics of the spline included                   16 eps
  //   factor V sigma / h^k, payload, product, correction                                                10 eps
  //   sum over a lane, then over lanes                                              (neighbours / 8 + 4) eps
  // and with sizes, from h_i as a float ratio: 2 roundings of 1 / h_i in q, 6 of its fifth power, 2 of V_j   16 eps
  double tolerance(std::size_t i) const {
    const double sizes = sizes_.length_ratio.empty() ? 0 : 16;
    return (42 + 4 + sizes + static_cast<double>(neighbours(i)) / 8) * std::ldexp(1.0, -24);
  }

  // --- shape of the arrangement

  Sum kernel_sum(std::size_t i) const {
    Sum sum;
    sum.add(own_weight(i), own_weight(i), 1, 1);
    each(i, [&](const Pair& p) { sum.add(p.w, p.largest_w, 1, 1); });
    return sum;
  }
  Sum divergence_of_position(std::size_t i) const {
    Sum sum;
    each(i, [&](const Pair& p) { sum.add(p.g, p.largest_g, p.r * p.r, p.r * p.r); });
    return sum;
  }
  Sum laplacian_diagonal(std::size_t i) const {
    Sum sum;
    each(i, [&](const Pair& p) { sum.add(2 * p.g, 2 * p.largest_g, 1, 1); });
    return sum;
  }
  // sum g d (x) d
  std::array<std::array<Sum, 3>, 3> moments(std::size_t i) const {
    std::array<std::array<Sum, 3>, 3> m{};
    each(i, [&](const Pair& p) {
      for (int a = 0; a < dimensions(); ++a)
        for (int b = 0; b < dimensions(); ++b)
          m[a][b].add(p.g, p.largest_g, p.d[a] * p.d[b], std::abs(p.d[a] * p.d[b]));
    });
    return m;
  }
  struct Correction {
    Matrix inverse{};
    double mean_square = 0;  // ||L||^2 / d: the fallback looks at its root
    double determinant = 0;
    bool corrected = true;
  };
  // `largest`: the root mean square entry per row above which the identity replaces the inverse.
  Correction correction(std::size_t i, double largest) const {
    const auto sums = moments(i);
    const int d = dimensions();
    Matrix m{};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) m[a][b] = a < d && b < d ? sums[a][b].value : (a == b ? 1.0 : 0.0);
    Correction result;
    result.determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
        result.inverse[b][a] = (m[a1][b1] * m[a2][b2] - m[a1][b2] * m[a2][b1]) / result.determinant;
      }
    for (int a = 0; a < d; ++a)
      for (int b = 0; b < d; ++b) result.mean_square += result.inverse[a][b] * result.inverse[a][b] / d;
    result.corrected = result.determinant > 1e-12 && result.mean_square < largest * largest;
    if (!result.corrected)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) result.inverse[a][b] = a == b ? 1 : 0;
    return result;
  }
  std::array<Sum, 3> concentration_gradient(std::size_t i, double spacing) const {
    const double reference = kernel_.w(spacing / h_);
    std::array<Sum, 3> sum{};
    each(i, [&](const Pair& p) {
      const double ratio = kernel_.w(p.r / width(i)) / reference, largest = kernel_.w(0) / reference;
      const double factor = 1 + 0.25 * std::pow(ratio, 4), most = 1 + 0.25 * std::pow(largest, 4);
      for (int a = 0; a < dimensions(); ++a) sum[a].add(p.g * factor, p.largest_g * most, p.d[a], std::abs(p.d[a]));
    });
    return sum;
  }
  std::array<Sum, 3> normal(std::size_t i) const {
    std::array<Sum, 3> sum{};
    each(i, [&](const Pair& p) {
      for (int a = 0; a < dimensions(); ++a)
        sum[a].add(-width(i) * p.g, width(i) * p.largest_g, p.d[a], std::abs(p.d[a]));
    });
    return sum;
  }

  // --- fields; a velocity has one array per dimension

  template <class Velocity>
  double velocity_at(const Velocity& u, const SphPoint& point, int a) const {
    return point.velocity_sign[a] * u[a][point.source] + point.velocity_offset[a];
  }

  // VelocityGradientOut: the least and the largest change of component a over s that both those ahead and those behind
  // show.
  template <class Velocity>
  std::array<double, 2> change_bounds(std::size_t i, const Velocity& u, const Vector& s, int a) const {
    std::array<std::array<double, 2>, 2> sides{};  // behind, ahead
    each(i, [&](const Pair& p) {
      double along = 0, square = 1e-300;
      for (int axis = 0; axis < dimensions(); ++axis) along += s[axis] * p.d[axis], square += p.d[axis] * p.d[axis];
      const double change = along / square * (velocity_at(u, *p.point, a) - u[a][i]);
      auto& side = sides[along > 0 ? 1 : 0];
      side = {std::min(side[0], change), std::max(side[1], change)};
    });
    return {std::max(sides[0][0], sides[1][0]), std::min(sides[0][1], sides[1][1])};
  }

  // sum g (u_j - u_i)_a d_b without the correction
  template <class Velocity>
  std::array<std::array<Sum, 3>, 3> velocity_difference_moments(std::size_t i, const Velocity& u) const {
    std::array<std::array<Sum, 3>, 3> m{};
    each(i, [&](const Pair& p) {
      for (int a = 0; a < dimensions(); ++a) {
        const double other = velocity_at(u, *p.point, a), own = u[a][i];
        for (int b = 0; b < dimensions(); ++b)
          m[a][b].add(p.g, p.largest_g, (other - own) * p.d[b], (std::abs(other) + std::abs(own)) * std::abs(p.d[b]));
      }
    });
    return m;
  }
  // d u_a / d x_b = L_bc m_ac
  template <class Velocity>
  std::array<std::array<Sum, 3>, 3> velocity_gradient(std::size_t i, const Velocity& u,
                                                      const Matrix& correction) const {
    const auto m = velocity_difference_moments(i, u);
    std::array<std::array<Sum, 3>, 3> gradient{};
    for (int a = 0; a < dimensions(); ++a)
      for (int b = 0; b < dimensions(); ++b)
        for (int c = 0; c < dimensions(); ++c) {
          gradient[a][b].value += correction[b][c] * m[a][c].value;
          gradient[a][b].magnitude += std::abs(correction[b][c]) * m[a][c].magnitude;
        }
    return gradient;
  }
  template <class Velocity>
  Sum divergence(std::size_t i, const Velocity& u, const Matrix& correction) const {
    const auto gradient = velocity_gradient(i, u, correction);
    Sum sum;
    for (int a = 0; a < dimensions(); ++a) {
      sum.value += gradient[a][a].value;
      sum.magnitude += gradient[a][a].magnitude;
    }
    return sum;
  }
  template <class Velocity>
  std::array<Sum, 3> filtered_velocity(std::size_t i, const Velocity& u) const {
    return filtered(i, [&](const SphPoint& point, int a) { return velocity_at(u, point, a); });
  }
  template <class Velocity>
  std::array<Sum, 3> filtered_vector(std::size_t i, const Velocity& v) const {
    return filtered(i, [&](const SphPoint& point, int a) { return point.reflection[a] * v[a][point.source]; });
  }
  template <class Scalar>
  Sum filtered_scalar(std::size_t i, const Scalar& f) const {
    return filtered(i, [&](const SphPoint& point, int a) { return a == 0 ? double(f[point.source]) : 0.0; })[0];
  }
  template <class Velocity, class Scalar>
  std::array<Sum, 3> viscous(std::size_t i, const Velocity& u, const Scalar& kappa) const {
    std::array<Sum, 3> sum{};
    each(i, [&](const Pair& p) {
      const double ki = kappa[i], kj = kappa[p.point->source];
      const double mean = ki + kj > 0 ? 2 * ki * kj / (ki + kj) : 0;
      for (int a = 0; a < dimensions(); ++a) {
        const double other = velocity_at(u, *p.point, a), own = u[a][i];
        sum[a].add(2 * p.g * mean, 2 * p.largest_g * mean, other - own, std::abs(other) + std::abs(own));
      }
    });
    return sum;
  }
  // div(2 kappa S) in pair form: the momentum that a pair exchanges lies along the line between its particles,
  //   sum_j 2 (d + 2) g k_ij ((u_j - u_i) . e) e,  e = d / |d|.
  template <class Velocity, class Scalar>
  std::array<Sum, 3> viscous_stress(std::size_t i, const Velocity& u, const Scalar& kappa) const {
    std::array<Sum, 3> sum{};
    each(i, [&](const Pair& p) {
      if (p.r == 0) return;
      const double ki = kappa[i], kj = kappa[p.point->source];
      const double mean = ki + kj > 0 ? 2 * ki * kj / (ki + kj) : 0;
      double along = 0, largest_along = 0;
      for (int a = 0; a < dimensions(); ++a) {
        const double other = velocity_at(u, *p.point, a), own = u[a][i], e = p.d[a] / p.r;
        along += (other - own) * e;
        largest_along += (std::abs(other) + std::abs(own)) * std::abs(e);
      }
      const double factor = 2 * (dimensions() + 2) * mean;
      for (int a = 0; a < dimensions(); ++a)
        sum[a].add(factor * p.g, factor * p.largest_g, along * p.d[a] / p.r, largest_along * std::abs(p.d[a]) / p.r);
    });
    return sum;
  }
  template <class Scalar>
  Sum negative_laplacian(std::size_t i, const Scalar& f) const {
    Sum sum;
    each(i, [&](const Pair& p) {
      const double other = f[p.point->source], own = f[i];
      sum.add(2 * p.g, 2 * p.largest_g, own - other, std::abs(own) + std::abs(other));
    });
    return sum;
  }
  template <class Scalar>
  std::array<Sum, 3> gradient(std::size_t i, const Scalar& f, double reference, const Matrix& correction) const {
    std::array<Sum, 3> m{}, result{};
    each(i, [&](const Pair& p) {
      const double other = f[p.point->source] - reference, own = f[i] - reference;
      for (int a = 0; a < dimensions(); ++a)
        m[a].add(p.g, p.largest_g, (other - own) * p.d[a], (std::abs(other) + std::abs(own)) * std::abs(p.d[a]));
    });
    for (int a = 0; a < dimensions(); ++a)
      for (int b = 0; b < dimensions(); ++b) {
        result[a].value += correction[a][b] * m[b].value;
        result[a].magnitude += std::abs(correction[a][b]) * m[b].magnitude;
      }
    return result;
  }
  // 1/2 s_b s_c d2 u_a / (d x_b d x_c); gradient[a * dimensions + b][i] = d u_a / d x_b.
  template <class Gradient>
  std::array<Sum, 3> shift_curvature(std::size_t i, const Gradient& gradient, const Vector& shift,
                                     const Matrix& correction) const {
    const int d = dimensions();
    std::array<Sum, 3> sum{};
    each(i, [&](const Pair& p) {
      // grad along s of f: s . L sum g (f_j - f_i) d
      double along = 0, largest_along = 0;
      for (int b = 0; b < d; ++b)
        for (int c = 0; c < d; ++c) {
          along += shift[b] * correction[b][c] * p.d[c];
          largest_along += std::abs(shift[b] * correction[b][c] * p.d[c]);
        }
      for (int a = 0; a < d; ++a)
        for (int b = 0; b < d; ++b) {
          const double sign = p.point->velocity_sign[a] * p.point->reflection[b];
          const double other = sign * gradient[a * d + b][p.point->source], own = gradient[a * d + b][i];
          sum[a].add(0.5 * p.g * along, 0.5 * p.largest_g * largest_along, shift[b] * (other - own),
                     std::abs(shift[b]) * (std::abs(other) + std::abs(own)));
        }
    });
    return sum;
  }

  // --- the pressure matrix: (A q)_i = V [ sum_j 2 g (q_i - q_j) + diagonal_shift_i q_i ], zero in masked rows

  template <class Scalar, class Extra, class Masked>
  Sum pressure_row(std::size_t i, const Scalar& q, const Extra& diagonal_shift, const Masked& masked) const {
    Sum sum = negative_laplacian(i, q);
    sum.value = volume_ * (sum.value + double(diagonal_shift[i]) * q[i]);
    sum.magnitude = volume_ * (sum.magnitude + std::abs(double(diagonal_shift[i]) * q[i]));
    return masked[i] != 0 ? Sum{} : sum;
  }
  // With sizes: (A q)_i = V [ row_i sum_j 2 (g / V_j) V weight_j (q_i - q_j) + diagonal_shift_i q_i ].
  template <class Scalar, class Shift, class Masked, class Weight>
  Sum weighted_pressure_row(std::size_t i, const Scalar& q, const Shift& diagonal_shift, const Masked& masked,
                            const Weight& weight, const Weight& row) const {
    Sum sum;
    each(i, [&](const Pair& p) {
      const std::size_t j = p.point->source;
      const double other = q[j], own = q[i], factor = 2 * volume_ * row[i] * weight[j] / volume_ratio(j);
      sum.add(factor * p.g, factor * p.largest_g, own - other, std::abs(own) + std::abs(other));
    });
    const double diagonal = volume_ * double(diagonal_shift[i]) * q[i];
    sum.value += diagonal;
    sum.magnitude += std::abs(diagonal);
    return masked[i] != 0 ? Sum{} : sum;
  }
  // Calls entry(j, a_ij) for the couplings of row i, a particle's own images left out: they cancel.
  template <class Entry>
  void pressure_couplings(std::size_t i, Entry&& entry) const {
    each(i, [&](const Pair& p) {
      if (p.point->source != i) entry(p.point->source, -2 * volume_ * p.g);
    });
  }

 private:
  // Volume V times W and -F sigma / h^(d+2).
  double weight(double r, double h) const {
    return volume_ * kernel_.normalisation() / std::pow(h, dimensions()) * kernel_.w(r / h);
  }
  double slope(double r, double h) const {
    return -volume_ * kernel_.normalisation() / std::pow(h, dimensions() + 2) * kernel_.f(r / h);
  }
  double own_weight(std::size_t i) const { return volume_ratio(i) * weight(0, width(i)); }

  static void reflect(SphPoint& point, int axis, BoundaryKind kind, const Vec3& wall) {
    if (kind == BoundaryKind::periodic) return;
    point.reflection[axis] *= -1;
    for (int a = 0; a < 3; ++a) {
      if (kind == BoundaryKind::free_slip && a != axis) continue;
      point.velocity_sign[a] *= -1;
      point.velocity_offset[a] = 2 * wall[a] - point.velocity_offset[a];
    }
  }
  template <class Value>
  std::array<Sum, 3> filtered(std::size_t i, Value&& value) const {
    std::array<Sum, 3> sum{};
    const Sum total = kernel_sum(i);
    for (int a = 0; a < dimensions(); ++a) {
      const double own = value(points_[i], a);
      sum[a].add(own_weight(i), own_weight(i), own, std::abs(own));
    }
    each(i, [&](const Pair& p) {
      for (int a = 0; a < dimensions(); ++a) {
        const double v = value(*p.point, a);
        sum[a].add(p.w, p.largest_w, v, std::abs(v));
      }
    });
    for (int a = 0; a < dimensions(); ++a) {
      sum[a].value /= total.value;
      // The weights' sum is rounded too.
      sum[a].magnitude = (sum[a].magnitude + std::abs(sum[a].value) * total.magnitude) / total.value;
    }
    return sum;
  }

  PlainKernel kernel_;
  double h_, volume_;
  std::size_t n_;
  Sizes sizes_;
  ImageRules rules_;
  std::vector<SolidBox> boxes_;
  std::vector<SphPoint> points_;
  mutable std::vector<std::optional<std::vector<Pair>>> pairs_;
};

}  // namespace spume::reference
