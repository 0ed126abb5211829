// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/breakup.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/physics/bubbles/population.hpp"

namespace spume::bubbles {
namespace {

constexpr double hard_limit = 1e-3;  // of V_min, below King (3.27)

// Lambda^(5/3) at which Lambda^(15/2) is the hard limit, and where (3.27) vanishes everywhere.
const double hard_end = std::pow(hard_limit, 2.0 / 9);
const double soft_end = std::pow(2.0, -2.0 / 9);

double smallest_for(double confinement) {
  return std::max(hard_limit, std::pow(confinement, 4.5));
}

// Cubic roots: a power takes three times as long.
double density_for(double v, double confinement) {
  const double first = std::cbrt(v * v), second = std::cbrt((1 - v) * (1 - v));  // to the 2/3
  return (std::cbrt(first) - confinement) * (std::cbrt(second) - confinement) / (first * second);
}

}  // namespace

double deformation_velocity(const BreakupModel& model, double radius, double dissipation) {
  const double x = model.deformation_constant * std::cbrt(4 * dissipation * dissipation * radius * radius) -
                   6 * model.tension / radius;
  return std::copysign(std::sqrt(std::abs(x)), x);
}

double stable_ratio(const BreakupModel& model, double radius, double mean_dissipation) {
  return std::pow(12 * model.tension / model.deformation_constant, 0.6) * std::pow(mean_dissipation, -0.4) /
         (2 * radius);
}

double critical_ratio() {
  return std::pow(2.0, -6.0 / 45);
}

double smallest_child(double ratio) {
  return std::max(hard_limit, std::pow(ratio, 7.5));
}

ChildSizeTable::ChildSizeTable() {
  const int rows = rows_of_hard_limit + rows_of_soft_limit + 1;
  values_.resize(static_cast<std::size_t>(rows) * (columns + 1));
  parallel_blocks(static_cast<std::size_t>(rows), 1, [&](std::size_t row, std::size_t, std::size_t) {
    const auto r = static_cast<double>(row);
    double confinement = r <= rows_of_hard_limit
                             ? hard_end * r / rows_of_hard_limit
                             : hard_end + (soft_end - hard_end) * (r - rows_of_hard_limit) / rows_of_soft_limit;
    // At the very end the range is a point; the shape of the range just before it is the limit.
    confinement = std::min(confinement, soft_end * (1 - 1e-6));
    const double low = smallest_for(confinement), span = 0.5 - low;
    // Distribution over y = s^2 in [0, 1] by Simpson's rule: fine steps at the foot. It is off by 3e-10 of itself at
    // most; the interpolation between columns by 2e-6.
    constexpr int steps = 512;
    std::array<double, steps + 1> sum{}, at_node;
    const auto weight = [&](double s) { return 2 * s * std::max(0.0, density_for(low + span * s * s, confinement)); };
    for (int k = 0; k <= steps; ++k) at_node[k] = weight(static_cast<double>(k) / steps);
    for (int k = 0; k < steps; ++k)
      sum[k + 1] = sum[k] + (at_node[k] + 4 * weight((k + 0.5) / steps) + at_node[k + 1]) / (6.0 * steps);
    double* out = values_.data() + row * (columns + 1);
    int k = 0;
    for (int c = 0; c <= columns; ++c) {
      const double t = static_cast<double>(c) / columns, wanted = t * t * sum[steps];
      while (k + 1 < steps && sum[k + 1] < wanted) ++k;
      // Newton's method on the Simpson integral over part of a step, from where the density is constant in it.
      const double a = static_cast<double>(k) / steps;
      double part = sum[k + 1] > sum[k] ? (wanted - sum[k]) / (sum[k + 1] - sum[k]) : 0;
      for (int iteration = 0; iteration < 4; ++iteration) {
        const double end = weight(a + part / steps), middle = weight(a + 0.5 * part / steps);
        const double value = (at_node[k] + 4 * middle + end) * part / (6.0 * steps);
        if (!(end > 0)) break;
        const double change = (value - (wanted - sum[k])) * steps / end, before = part;
        part = std::clamp(part - change, 0.0, 1.0);
        if (std::abs(part - before) < 1e-9) break;
      }
      const double s = a + part / steps;
      out[c] = s * s;
    }
    out[0] = 0;
    out[columns] = 1;
  });
}

double ChildSizeTable::operator()(double u, double ratio) const {
  const double confinement = std::pow(ratio, 5.0 / 3);
  const double row =
      std::clamp(confinement <= hard_end
                     ? confinement / hard_end * rows_of_hard_limit
                     : rows_of_hard_limit + (confinement - hard_end) / (soft_end - hard_end) * rows_of_soft_limit,
                 0.0, rows_of_hard_limit + rows_of_soft_limit - 1e-9);
  const bool upper = u >= 0.5;
  const double column = std::sqrt(std::min(upper ? 2 * (1 - u) : 2 * u, 1.0)) * columns;
  const auto i = static_cast<std::size_t>(row), j = static_cast<std::size_t>(std::min<double>(column, columns - 1));
  const double y = row - static_cast<double>(i), x = column - static_cast<double>(j);
  const double* low = values_.data() + i * (columns + 1) + j;
  const double* high = low + columns + 1;
  const double value = (1 - y) * ((1 - x) * low[0] + x * low[1]) + y * ((1 - x) * high[0] + x * high[1]);
  const double smallest = smallest_for(confinement);
  const double fraction = smallest + (0.5 - smallest) * value;
  return upper ? 1 - fraction : fraction;
}

Children split(double volume, double fraction, double u1, double u2) {
  Children children;
  children.first_volume = fraction * volume;
  children.second_volume = volume - children.first_volume;
  const double cosine = 2 * u1 - 1, sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)),
               angle = 2 * std::numbers::pi * u2;
  const Vec3 direction{sine * std::cos(angle), sine * std::sin(angle), cosine};
  const double distance = radius_of(children.first_volume) + radius_of(children.second_volume);
  for (std::size_t a = 0; a < 3; ++a) {
    children.first_offset[a] = (1 - fraction) * distance * direction[a];
    children.second_offset[a] = -fraction * distance * direction[a];
  }
  return children;
}

}  // namespace spume::bubbles
