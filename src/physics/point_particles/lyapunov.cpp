// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/lyapunov.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "spume/core/parallel.hpp"
#include "spume/physics/point_particles/placement.hpp"

namespace spume {

double kaplan_yorke_dimension(const std::array<double, 6>& exponents) {
  double sum = 0;
  for (int j = 0; j < 6; ++j) {
    if (sum + exponents[j] < 0) return j + sum / std::abs(exponents[j]);
    sum += exponents[j];
  }
  return 6;
}

LyapunovTracker::LyapunovTracker(const SplineField<double>& field, std::size_t count, double response_time,
                                 double diameter, std::uint64_t seed)
    : grid_(field.grid()),
      // Far below the grid, where the flow is linear, and far above the rounding of positions, 1e-16 of the box.
      offset_(1e-5 * std::min({grid_.spacing(0), grid_.spacing(1), grid_.spacing(2)})),
      time_scale_(response_time),
      particles_(ParticleArrays{}),
      growth_(6 * count) {
  particles_.fields.resize(7 * count);
  particles_.common_diameter = diameter;
  PlacementOptions options;
  options.seed = seed;
  options.diameters = {diameter};
  place_particles(options, grid_.lower, grid_.length, particles_);
  gather(field, 7 * count, particles_.positions(),
         {particles_.velocity[0]->data(), particles_.velocity[1]->data(), particles_.velocity[2]->data()}, nullptr);
  for (std::size_t b = 0; b < count; ++b)
    for (int k = 0; k < 6; ++k) {
      std::array<double, 6> unit{};
      unit[static_cast<std::size_t>(k)] = 1;
      set_shadow(b, k, unit);
    }
}

void LyapunovTracker::set_shadow(std::size_t base, int direction, const std::array<double, 6>& q) {
  const std::size_t from = 7 * base, to = from + 1 + static_cast<std::size_t>(direction);
  for (int c = 0; c < 3; ++c) {
    (*particles_.position[c])[to] =
        wrap_periodic((*particles_.position[c])[from] + offset_ * q[c], grid_.lower[c], grid_.length[c]);
    (*particles_.velocity[c])[to] = (*particles_.velocity[c])[from] + offset_ / time_scale_ * q[3 + c];
  }
}

void LyapunovTracker::advance(const MotionModel& model, const SplineField<double>& field, double dt) {
  move_particles(model, field, dt, particles_);
  parallel_for(size(), [&](std::size_t b) {
    std::array<std::array<double, 6>, 6> q;
    for (int k = 0; k < 6; ++k) {
      const std::size_t from = 7 * b, to = from + 1 + static_cast<std::size_t>(k);
      for (int c = 0; c < 3; ++c) {
        q[k][c] = nearest_image((*particles_.position[c])[to] - (*particles_.position[c])[from], grid_.length[c]);
        q[k][3 + c] = time_scale_ * ((*particles_.velocity[c])[to] - (*particles_.velocity[c])[from]);
      }
      for (int earlier = 0; earlier < k; ++earlier) {
        double along = 0;
        for (int d = 0; d < 6; ++d) along += q[k][d] * q[earlier][d];
        for (int d = 0; d < 6; ++d) q[k][d] -= along * q[earlier][d];
      }
      double norm = 0;
      for (int d = 0; d < 6; ++d) norm += q[k][d] * q[k][d];
      // A direction that a stiff drag has flattened to nothing keeps the smallest size that rounding leaves it.
      norm = std::max(std::sqrt(norm), 1e-9 * offset_);
      for (int d = 0; d < 6; ++d) q[k][d] /= norm;
      growth_[6 * b + static_cast<std::size_t>(k)] += std::log(norm / offset_);
    }
    for (int k = 0; k < 6; ++k) set_shadow(b, k, q[k]);
  });
}

std::array<double, 6> LyapunovTracker::stretching(std::size_t g, std::size_t groups) const {
  const std::size_t first = g * size() / groups, last = (g + 1) * size() / groups;
  std::array<double, 6> mean{};
  for (std::size_t b = first; b < last; ++b)
    for (std::size_t k = 0; k < 6; ++k) mean[k] += growth_[6 * b + k];
  for (double& m : mean) m /= static_cast<double>(std::max<std::size_t>(last - first, 1));
  // Directions that the flow never mixes keep the order that they started in.
  std::sort(mean.begin(), mean.end(), std::greater<>());
  return mean;
}

std::array<double, 6> LyapunovTracker::stretching() const {
  return stretching(0, 1);
}

}  // namespace spume
