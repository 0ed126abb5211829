// SPDX-License-Identifier: MIT
#include "reasons.hpp"

#include <cstdio>

#include "spume/methods/spectral/options.hpp"

namespace spume::spectral::reason {

std::string forcing(const Case& options) {
  switch (options.get<ForcingOptions>().kind) {
    case ForcingKind::shell:
      return "f below (2): constant injection on a shell";
    case ForcingKind::linear:
      return "forcing.kind = \"linear\": the rate itself";
    case ForcingKind::none:
      break;
  }
  return "forcing.kind = \"none\"";
}

std::string product(const Case& options) {
  switch (options.get<SpectralOptions>().dealiasing) {
    case Dealiasing::padded:
      return "(A6), fig. 3b: u x omega on (3N/2)^3 points";
    case Dealiasing::two_thirds:
      return "(A6), fig. 3a: u x omega on N^3 points, modes above N/3 set to zero";
    case Dealiasing::none:
      break;
  }
  return "(A6): u x omega on N^3 points, aliased";
}

std::string update(const Case& options) {
  switch (options.get<SpectralOptions>().integrator) {
    case Integrator::ab2:
      return "(A7), (A10): Adams-Bashforth 2";
    case Integrator::rk3:
      return "(A7): Runge-Kutta 3, three tendencies a step";
    case Integrator::rk4:
      break;
  }
  return "(A7): Runge-Kutta 4, five tendencies a step";
}

std::string feedback(const ParticleSystem& system) {
  if (!system.couples())
    return excludes(system.options().coupling) ? "particles.coupling = \"colliding\""
                                               : "particles.coupling = \"one-way\"";
  char text[100];
  std::snprintf(text, sizeof text, "(8), (13): spread to eight points, clipped above %.3g",
                system.options().max_volume_fraction);
  return text;
}

std::string motion(const ParticleSystem& system) {
  return system.options().motion.frozen ? "particles.frozen: the forces on particles at rest"
         : system.removes_self_disturbance()
             ? "(3), (4), (15): Maxey-Riley, exponential in the drag, without the own disturbance"
             : "(3), (4), (15): Maxey-Riley, exponential in the drag";
}

std::string exclusion(const ParticleSystem& system) {
  if (system.collides()) return "III A: strongest overlaps, one per particle";
  return system.options().motion.frozen ? "particles.frozen"
                                        : "particles.coupling is neither \"four-way\" nor \"colliding\"";
}

std::string exponents(const Case& options) {
  return options.get<ParticleCaseOptions>().lyapunov > 0 ? "shadow trajectories" : "particles.lyapunov = 0";
}

}  // namespace spume::spectral::reason
