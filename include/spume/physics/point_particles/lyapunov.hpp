// SPDX-License-Identifier: MIT
// Lyapunov exponents of particles in the six dimensions of place and velocity, and the Kaplan-Yorke dimension of the
// set that they cluster on (Calzavarini et al. 2008).
#pragma once

#include <array>
#include <vector>

#include "spume/operators/spline_field.hpp"
#include "spume/physics/point_particles/motion.hpp"

namespace spume {

// lambda_1 >= ... >= lambda_6 -> J + (lambda_1 + ... + lambda_J) / |lambda_{J+1}|, with the largest J whose sum is not
// negative; 6 when no sum is.
double kaplan_yorke_dimension(const std::array<double, 6>& exponents);

// Follows reference particles, each with six shadows a small way off along orthogonal directions of phase space
// (Benettin et al. 1980). Shadows move by the same step as particles do, so that every term of the motion is in the
// tangent dynamics; after each step they are made orthonormal again and the growth along each direction is recorded.
// Shadows lie 1e-5 grid spacings off: fields with records in double precision alone resolve their differences.
class LyapunovTracker {
 public:
  LyapunovTracker() = default;
  // Reference particles at random places with the velocity of the present field. The diameter is the one that the
  // response time belongs to: the law of Schiller and Naumann takes its Reynolds number from it.
  LyapunovTracker(const SplineField<double>& field, std::size_t count, double response_time, double diameter,
                  std::uint64_t seed);

  // The step that the particles make.
  void advance(const MotionModel& model, const SplineField<double>& field, double dt);

  std::size_t size() const { return particles_.size() / 7; }
  // Mean over the reference particles of the logarithm of the growth since the start, per direction, strongest first:
  // exponents are its rates in time.
  std::array<double, 6> stretching() const;
  // The same over the g-th of `groups` groups, for sampling errors.
  std::array<double, 6> stretching(std::size_t g, std::size_t groups) const;

  // State to save and restore.
  Particles& particles() { return particles_; }
  Array<double>& growth() { return growth_; }

 private:
  void set_shadow(std::size_t base, int direction, const std::array<double, 6>& q);

  PeriodicGrid grid_;
  double offset_ = 0, time_scale_ = 1;  // a velocity times the time scale compares with a length
  Particles particles_;                 // 7 i: reference particle i, then its shadows
  Array<double> growth_;                // 6 per reference particle
};

}  // namespace spume
