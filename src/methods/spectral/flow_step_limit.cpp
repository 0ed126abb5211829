// SPDX-License-Identifier: MIT
// The longest stable step of the flow.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "spume/methods/spectral/flow.hpp"

namespace spume::spectral {
namespace {

// Of the velocity by the force in a step, and of the modes of a forced shell by viscosity: 0.1 costs the multistep
// scheme an error of 0.4 % in either (5/12 of the square), and the sum of the dissipation over steps as much.
constexpr double most_growth = 0.1;

// Along the imaginary axis: sqrt(3) of every third-order scheme in three stages, and that of Carpenter and Kennedy
// (1994).
constexpr double rk3_reach = 1.73, rk4_reach = 3.34;

// Logarithm of the factor by which AB2 amplifies an oscillation in a step, phase = omega dt: that of the larger root of
// rho^2 - (1 + 3/2 i phase) rho + i phase/2 = 0; phase^4 / 4 for small phases.
double ab2_growth(double phase) {
  const std::complex<double> sum(1, 1.5 * phase);
  const std::complex<double> root = std::sqrt(sum * sum - std::complex<double>(0, 2 * phase));
  return std::log(std::max(std::abs(sum + root), std::abs(sum - root)) / 2);
}

// Advection by |u| <= U gives a mode of frequency omega, normalised, |omega| = |u . grad mode| <= U |grad mode|:
// viscosity damps it by nu (omega / U)^2 dt at least. That must outweigh ab2_growth for every frequency up to the
// largest of the modes kept, Omega; growth / phase^2 rises up to a phase of 1.08 and falls from there. Returns the
// largest Omega dt for damping = nu Omega / U^2.
double stable_ab2_phase(double damping) {
  constexpr double turning = 1.08;
  const double worst = ab2_growth(turning);
  if (damping * turning >= worst) return damping * turning * turning / worst;
  // Below phases of 0.01 rounding begins to show in the root, and phase^4 / 4 is 2e-4 short at most.
  double low = 0, high = std::min(turning, std::cbrt(4 * damping));  // growth >= phase^4 / 4 up to there
  if (high < 0.01) return high * (1 - 1e-4);
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = (low + high) / 2;
    (ab2_growth(middle) <= damping * middle ? low : high) = middle;
  }
  return low;
}

}  // namespace

template <class T>
StepLimit Flow<T>::limit_for(const VelocityPeak& peak) const {
  StepLimit limit{std::numeric_limits<double>::max(), "nothing"};
  const auto bound = [&](double dt, const char* name) {
    if (dt < limit.dt) limit = {dt, name};
  };
  if (limits_.max_step > 0) bound(limits_.max_step, "max_step");
  if (peak.rate > 0) {
    bound(limits_.courant / peak.rate, "courant");
    // Largest frequency of advection: sum |u_i| k_max,i = pi rate.
    const double frequency = std::numbers::pi * peak.rate;
    switch (options_.integrator) {
      case Integrator::ab2: {
        const double kept = kept_grid_wavenumber_ * peak.rate;
        bound(stable_ab2_phase(viscosity_ * kept / (peak.speed * peak.speed)) / kept, "ab2 stability");
        break;
      }
      case Integrator::rk3:
        bound(rk3_reach / frequency, "rk3 stability");
        break;
      case Integrator::rk4:
        bound(rk4_reach / frequency, "rk4 stability");
        break;
    }
  } else if (limits_.max_step == 0) {
    // Nothing moves yet: the first steps follow the time scale of the run.
    bound(limits_.end / 1000, "end of run");
  }
  return limit;
}

template <class T>
StepLimit Flow<T>::step_limit() const {
  const StepLimit limit = limit_for(peak_);
  const double growth = std::max(forcing_coefficient(potential_), forced_decay_);
  return growth * limit.dt > most_growth ? StepLimit{most_growth / growth, "forcing"} : limit;
}

template StepLimit Flow<double>::limit_for(const VelocityPeak&) const;
template StepLimit Flow<float>::limit_for(const VelocityPeak&) const;
template StepLimit Flow<double>::step_limit() const;
template StepLimit Flow<float>::step_limit() const;

}  // namespace spume::spectral
