// SPDX-License-Identifier: MIT
// Slow twin of spume/operators/scalar_transport.hpp: every sum over all pairs in double, from the definitions there.
#pragma once

#include <algorithm>
#include <cmath>

#include "reference/sph_sums.hpp"

namespace spume::reference {

struct ScalarTransport {
  const SphSums& sums;
  double h = 0, volume = 0;  // of the context

  // V F(r / h) sigma / h^(d+2) at the smoothing length of the context.
  double slope(double r) const {
    const PlainKernel& kernel = sums.kernel();
    return -volume * kernel.normalisation() * kernel.f(r / h) / std::pow(h, kernel.dimensions + 2);
  }
  static bool exchanges(const SphSums::Pair& pair) { return !pair.point->in_solid; }

  // dc_i/dt; with `exchange` the sum of the weights in its place.
  template <class Scalar, class Field>
  Sum rate(std::size_t i, const Scalar& c, double diffusivity, const Field& normalisation, const Field& eddy,
           double share, bool exchange = false) const {
    Sum sum;
    sums.each(i, [&](const SphSums::Pair& p) {
      if (!exchanges(p)) return;
      const std::size_t j = p.point->source;
      const double k =
          (double{normalisation[i]} + normalisation[j]) / 2 * (diffusivity + share * (double{eddy[i]} + eddy[j]) / 2);
      const double factor = 2 * sums.volume_ratio(i) * sums.volume_ratio(j) * k;
      if (exchange)
        sum.add(factor * slope(p.r), factor * slope(0), 1, 1);
      else
        sum.add(factor * slope(p.r), factor * slope(0), c[j] - c[i], std::abs(c[j]) + std::abs(c[i]));
    });
    return sum;
  }

  // s . grad c, bounded by half of the extreme differences.
  template <class Scalar>
  Sum change(std::size_t i, const Scalar& c, const Vector& shift, const Matrix& correction) const {
    Sum sum;
    double low = 0, high = 0;
    sums.each(i, [&](const SphSums::Pair& p) {
      if (!exchanges(p)) return;
      const double difference = c[p.point->source] - c[i];
      low = std::min(low, difference);
      high = std::max(high, difference);
      double along = 0, largest = 0;
      for (int a = 0; a < sums.dimensions(); ++a)
        for (int b = 0; b < sums.dimensions(); ++b) {
          along += shift[a] * correction[a][b] * p.d[b];
          largest += std::abs(shift[a] * correction[a][b] * p.d[b]);
        }
      sum.add(p.g, p.largest_g, difference * along, (std::abs(c[p.point->source]) + std::abs(c[i])) * largest);
    });
    sum.value = std::clamp(sum.value, low / 2, high / 2);
    sum.magnitude += high - low;
    return sum;
  }
};

}  // namespace spume::reference
