// SPDX-License-Identifier: MIT
// Slow twins of the sums of weakly compressible SPH, from the definitions in wcsph_sums.hpp: over all pairs of
// particles and explicit images, in double.
#pragma once

#include "reference/sph_sums.hpp"

namespace spume::reference {

struct WcsphSums {
  const SphSums& sums;

  static double kappa(double own, double other) { return (other - own) / (own + other); }

  // velocity(point, axis), of particles and images. `density`: of the phases, where the rate is weighted.
  template <class Velocity, class Scalar>
  Sum rate(std::size_t i, const Velocity& velocity, const Scalar& volume, const Scalar* density = nullptr) const {
    Sum sum;
    sums.each(i, [&](const SphSums::Pair& p) {
      const double share = density == nullptr ? 1 : 1 + kappa((*density)[i], (*density)[p.point->source]);
      for (int a = 0; a < sums.dimensions(); ++a) {
        const double other = velocity(*p.point, a), own = velocity(sums.points()[i], a);
        const double v = volume[p.point->source];
        sum.add(-p.g * v, p.largest_g * v, share * (other - own) * p.d[a],
                2 * (std::abs(other) + std::abs(own)) * std::abs(p.d[a]));
      }
    });
    return sum;
  }
  template <class Scalar, class Phase>
  Sum diffusion(std::size_t i, const Scalar& excess, const Scalar& volume, const Phase& same_phase) const {
    Sum sum;
    sums.each(i, [&](const SphSums::Pair& p) {
      const std::size_t j = p.point->source;
      if (!same_phase(i, j)) return;
      sum.add(2 * p.g * volume[j], 2 * p.largest_g * volume[j], double{excess[j]} - excess[i],
              std::abs(excess[j]) + std::abs(excess[i]));
    });
    return sum;
  }
  template <class Velocity, class Scalar>
  Sum viscous(std::size_t i, int a, const Velocity& velocity, const Scalar& volume, const Scalar& mu) const {
    Sum sum;
    sums.each(i, [&](const SphSums::Pair& p) {
      const std::size_t j = p.point->source;
      const double both = double{mu[i]} + mu[j];
      const double mean = both > 0 ? 2.0 * mu[i] * mu[j] / both : 0;
      const double other = velocity(*p.point, a), own = velocity(sums.points()[i], a);
      sum.add(2 * p.g * volume[j] * mean, 2 * p.largest_g * volume[j] * mean, other - own,
              std::abs(other) + std::abs(own));
    });
    return sum;
  }
  template <class Pressure, class Scalar>
  Sum pressure_force(std::size_t i, int a, const Pressure& pressure, const Scalar& volume, const Scalar& density,
                     double repulsion, const Vec3& gravity, bool weighted = false, const Vec3& left_out = {}) const {
    Sum sum;
    sums.each(i, [&](const SphSums::Pair& p) {
      const std::size_t j = p.point->source;
      double other = pressure[j], of_all = 0, way = 0;  // the difference of the whole pressures, beside that of these
      for (int b = 0; b < sums.dimensions(); ++b) {
        other += (density[j] * gravity[b] - left_out[b]) * (p.point->position[b] - sums.points()[j].position[b]);
        of_all -= left_out[b] * p.d[b];
        way += std::abs(left_out[b] * p.d[b]);
      }
      const double k = kappa(density[i], density[j]), jump = std::abs(k);
      const double both = pressure[i] + other + (weighted ? k * (pressure[i] - other + of_all) : 0);
      const double modulus =
          (weighted ? 2 : 1) * (std::abs(pressure[i]) + std::abs(other) + way) * (1 + repulsion * jump);
      sum.add(-p.g * volume[j], p.largest_g * volume[j], (both + repulsion * jump * std::abs(both)) * p.d[a],
              modulus * std::abs(p.d[a]));
    });
    return sum;
  }
  template <class Scalar>
  Sum tension(std::size_t i, int a, const Scalar& colour, const Scalar& potential, const Scalar& volume) const {
    Sum sum;
    sums.each(i, [&](const SphSums::Pair& p) {
      const std::size_t j = p.point->source;
      const double mean = (double{potential[i]} + potential[j]) / 2, jump = double{colour[j]} - colour[i];
      sum.add(p.g * volume[j], p.largest_g * volume[j], mean * jump * p.d[a],
              (std::abs(potential[i]) + std::abs(potential[j])) / 2 * std::abs(jump * p.d[a]));
    });
    return sum;
  }
  // shift(point, axis), of particles and images.
  template <class Shift, class Scalar, class Phase>
  Sum carried(std::size_t i, const Shift& shift, const Scalar& excess, const Scalar& volume,
              const Phase& same_phase) const {
    Sum sum;
    sums.each(i, [&](const SphSums::Pair& p) {
      const std::size_t j = p.point->source;
      if (!same_phase(i, j)) return;
      for (int a = 0; a < sums.dimensions(); ++a) {
        const double way = shift(sums.points()[i], a) * p.d[a];
        sum.add(p.g * volume[j], p.largest_g * volume[j], way * (double{excess[j]} - excess[i]),
                std::abs(way) * (std::abs(excess[j]) + std::abs(excess[i])));
      }
    });
    return sum;
  }
  template <class Velocity, class Shift, class Scalar>
  Sum flux(std::size_t i, int a, const Velocity& velocity, const Shift& shift, const Scalar& volume) const {
    Sum sum;
    sums.each(i, [&](const SphSums::Pair& p) {
      const double v = volume[p.point->source];
      for (const SphSums::SphPoint* point : {&sums.points()[i], p.point})
        for (int b = 0; b < sums.dimensions(); ++b) {
          const double term = velocity(*point, a) * shift(*point, b) * p.d[b];
          sum.add(p.g * v, p.largest_g * v, term, std::abs(term));
        }
    });
    return sum;
  }
  template <class Scalar>
  Sum concentration(std::size_t i, int a, double h, const Scalar& volume) const {
    Sum sum;
    sums.each(i, [&](const SphSums::Pair& p) {
      const double v = h * volume[p.point->source];
      sum.add(p.g * v, p.largest_g * v, p.d[a], std::abs(p.d[a]));
    });
    return sum;
  }
  // The two sums of the filter: of 1 - v and of v.
  template <class Scalar, class Phase>
  std::array<double, 2> filter(std::size_t i, const Scalar& volume, const Phase& same_phase) const {
    std::array<double, 2> result{};
    double self = 1;  // without neighbours any weight will do
    sums.each(i, [&](const SphSums::Pair& p) {
      self = p.largest_w;
      const std::size_t j = p.point->source;
      if (!same_phase(i, j)) return;
      result[0] += p.w * (1 - double{volume[j]});
      result[1] += p.w * volume[j];
    });
    result[0] += self * (1 - double{volume[i]});
    result[1] += self * volume[i];
    return result;
  }
};

}  // namespace spume::reference
