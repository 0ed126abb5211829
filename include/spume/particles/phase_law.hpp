// SPDX-License-Identifier: MIT
// Weakly compressible phases: their equations of state, and which particle is of which.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

// The exponent of liquids (Monaghan 1994).
inline constexpr double liquid_exponent = 7;
// A phase is a gas where its density is below a fiftieth of the largest: the lightest liquids have half of that of
// water, the heaviest gases a hundredth.
inline constexpr double gas_density_ratio = 0.02;

// x^7 without a logarithm: water is most of most scenes.
inline double tait_power(double x, double exponent) {
  if (exponent != liquid_exponent) return std::pow(x, exponent);
  const double x3 = x * x * x;
  return x3 * x3 * x;
}

// Tait's equation of state of a phase, p = B ((1 + s)^gamma - 1) with s = rho / rho_0 - 1 and B = rho_0 c^2 / gamma.
struct PhaseLaw {
  double density = 0, viscosity = 0, sound_speed = 0, exponent = liquid_exponent;
  double stiffness() const { return density * sound_speed * sound_speed / exponent; }
  double pressure(double excess) const { return stiffness() * (tait_power(1 + excess, exponent) - 1); }
  double excess(double pressure) const { return std::pow(1 + pressure / stiffness(), 1 / exponent) - 1; }
  // c^2 = dp / d rho = c_0^2 (1 + s)^(gamma - 1).
  double local_sound_speed(double excess) const {
    return sound_speed * std::sqrt(tait_power(1 + excess, exponent) / (1 + excess));
  }
  // Of a unit of volume at rest over B: the integral of rho_0 p / rho^2 d rho.
  double energy_over_stiffness(double excess) const {
    const double x = 1 + excess, gamma = exponent;
    // (x^6 - 1) / 6 + 1 / x - 1 with its factor s^2 taken out: differences of numbers near 1 lose 9 of 16 digits at an
    // excess of 1e-4, and x^6 by std::pow takes 20 ns.
    if (gamma == liquid_exponent) return excess * excess * (6 + x * (5 + x * (4 + x * (3 + x * (2 + x))))) / (6 * x);
    const double of_state = gamma == 1 ? std::log(x) : (std::pow(x, gamma - 1) - 1) / (gamma - 1);
    return of_state + 1 / x - 1;
  }
  // Of the density in a flow that the sound speed is right for: three times what it is chosen for, 1 % in liquids and,
  // with equal stiffness, 5 % in air; impacts of a dam break reach 4 % in water. The exponents of liquids are 4 to 7,
  // those of gases 1 to 1.7.
  double largest_change() const { return exponent < 2 ? 0.15 : 0.03; }
};

// Of the phases of a scene whose flow reaches `speed`, as far as it does not give them: the heaviest has ten times that
// speed of sound, the others the same stiffness. All zero where the speed is and nothing is given.
std::vector<PhaseLaw> phase_laws(const Scene& scene, double speed);
// rho u^2 of the heaviest.
double dynamic_pressure(const std::vector<PhaseLaw>& laws, double speed);
// The largest that the viscous force of a particle sees; a mean of two viscosities is at most twice that of either.
double largest_kinematic_viscosity(const std::vector<PhaseLaw>& laws);
// What a plan says of them.
std::string in_words(const std::vector<PhaseLaw>& laws, const Scene& scene, double speed, double background);

// Densities at rest, of which no two are alike: they tell phases apart too.
std::vector<float> distinct_densities(const std::vector<PhaseLaw>& laws);

// The laws of particles. Both outlive it. Of one phase the numbers are not read.
class ParticleLaws {
 public:
  ParticleLaws(const std::vector<PhaseLaw>& laws, const Array<std::int64_t>& phase) : laws_(laws), phase_(phase) {}
  const PhaseLaw& operator()(std::size_t i) const { return laws_[static_cast<std::size_t>(phase_of(i))]; }

  // Calls body(law, from, to) for each run of particles of one phase in [first, last), in order. Particles are sorted
  // by cells, so that most blocks are one run; of a law that does not change in the loop the compiler takes several
  // particles at a time. `body` is compiled twice, once for the exponent of liquids as a constant.
  template <class Body>
  [[gnu::always_inline]] void each_run(std::size_t first, std::size_t last, Body&& body) const {
    while (first < last) {
      const std::int64_t phase = phase_of(first);
      std::size_t end = laws_.size() == 1 ? last : first + 1;
      while (end < last && phase_[end] == phase) ++end;
      PhaseLaw law = laws_[static_cast<std::size_t>(phase)];
      if (law.exponent == liquid_exponent) {
        law.exponent = liquid_exponent;
        body(std::as_const(law), first, end);
      } else {
        body(std::as_const(law), first, end);
      }
      first = end;
    }
  }

 private:
  std::int64_t phase_of(std::size_t i) const { return laws_.size() == 1 ? 0 : phase_[i]; }

  const std::vector<PhaseLaw>& laws_;
  const Array<std::int64_t>& phase_;
};

}  // namespace spume
