// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "checks.hpp"
#include "resolved.hpp"
#include "spume/core/parallel.hpp"

namespace spume {
namespace {

constexpr double standard_gravity = 9.81;   // m/s2
constexpr double water_viscosity = 1.0e-6;  // kinematic, m2/s, 20 C

double largest_speed(const InitialParticles& particles, int dimensions) {
  return std::sqrt(parallel_max(particles.size(), 0.0, [&](std::size_t i) {
    double square = 0;
    for (int a = 0; a < dimensions; ++a) square += particles.velocity[a][i] * particles.velocity[a][i];
    return square;
  }));
}

// Groups of a case in SI: length is the height of the domain; velocity is sqrt(g L), without gravity the
// largest initial speed.
void groups_of_si(const Draft& draft, const Scene& scene, std::map<std::string, std::string>& groups) {
  const Fluid& fluid = scene.fluid;
  const std::size_t up = static_cast<std::size_t>(scene.domain.dimensions) - 1;
  const double length = scene.domain.upper[up] - scene.domain.lower[up];
  const double gravity = -fluid.gravity[up];
  groups["density"] = brief(fluid.density) + " kg/m3";
  groups["viscosity"] = fluid.kinematic_viscosity > 0 ? brief(*draft.fluid.viscosity) + " Pa s" : "0 (inviscid)";
  groups["gravity"] = gravity > 0 ? brief(gravity) + " m/s2" : "none";
  groups["sound speed"] = fluid.sound_speed > 0 ? brief(fluid.sound_speed) + " m/s" : "infinite (incompressible)";
  const double speed =
      gravity > 0 ? std::sqrt(gravity * length) : largest_speed(scene.particles, scene.domain.dimensions);
  if (!(speed > 0)) return;
  groups["reference length"] = brief(length) + " m (height of the domain)";
  groups["reference velocity"] = brief(speed) + " m/s" + (gravity > 0 ? " (sqrt(g L))" : " (largest initial speed)");
  groups["Reynolds"] =
      fluid.kinematic_viscosity > 0 ? brief(speed * length / fluid.kinematic_viscosity) : "infinite (inviscid)";
  groups["Froude"] = gravity > 0 ? "1" : "infinite (no gravity)";
  groups["Mach"] = fluid.sound_speed > 0 ? brief(speed / fluid.sound_speed) : "0 (incompressible)";
}

void groups_as_given(const Draft& draft, const Scene& scene, std::map<std::string, std::string>& groups) {
  const FluidDraft& fluid = draft.fluid;
  groups["Reynolds"] = fluid.reynolds ? brief(*fluid.reynolds) : "infinite (inviscid)";
  if (scene.grid[0] > 0) return;
  groups["Froude"] = fluid.froude ? brief(*fluid.froude) : "infinite (no gravity)";
  const bool compressible = fluid.mach && *fluid.mach > 0;
  groups["Mach"] = compressible ? brief(*fluid.mach) : "0 (incompressible)";
  if (!fluid.reynolds || !fluid.froude) return;
  // Re = U L / nu and Fr = U / sqrt(g L) fix the length and the velocity unit for water under gravity.
  const double length =
      std::pow(*fluid.reynolds * water_viscosity / (*fluid.froude * std::sqrt(standard_gravity)), 2.0 / 3);
  const double velocity = *fluid.froude * std::sqrt(standard_gravity * length);
  groups["in water"] = "length unit " + brief(length) + " m, velocity unit " + brief(velocity) + " m/s, time unit " +
                       brief(length / velocity) + " s" +
                       (compressible ? ", sound speed " + brief(velocity / *fluid.mach) + " m/s" : "");
}

void groups_of_phases(const Draft& draft, const Scene& scene, std::map<std::string, std::string>& groups) {
  const auto value = [si = uses_si(draft)](double number, const char* unit) {
    return brief(number) + (si ? unit : "");
  };
  for (const Phase& phase : scene.phases)
    groups["phase " + phase.name] = "density " + value(phase.density, " kg/m3") + ", viscosity " +
                                    value(phase.viscosity, " Pa s") +
                                    (phase.sound_speed > 0 ? ", sound speed " + value(phase.sound_speed, " m/s") : "");
  groups["surface tension"] = value(scene.surface_tension, " N/m");
  const double gravity = -scene.fluid.gravity[static_cast<std::size_t>(scene.domain.dimensions) - 1];
  groups["gravity"] = gravity > 0 ? value(gravity, " m/s2") : "none";
}

}  // namespace

std::map<std::string, std::string> describe_groups(const Draft& draft, const Scene& scene,
                                                   const ExpressionScope& scope) {
  std::map<std::string, std::string> groups;
  if (!scene.phases.empty())
    groups_of_phases(draft, scene, groups);
  else if (uses_si(draft.fluid))
    groups_of_si(draft, scene, groups);
  else
    groups_as_given(draft, scene, groups);
  for (const auto& [side, velocity] : draft.wall_velocity) {
    std::string text;
    for (const ExpressionText& component : velocity) text += (text.empty() ? "(" : ", ") + component.text;
    groups["moving wall " + side] = text + ")";
  }
  const Node* constants = draft.node("constants");
  for (std::size_t i = 0; constants && i < constants->keys.size(); ++i) {
    if (const auto value = scope.value(constants->keys[i])) groups["constant " + constants->keys[i]] = brief(*value);
  }
  return groups;
}

void describe_lattice(const Scene& scene, const Lattice& lattice, std::map<std::string, std::string>& groups) {
  std::string effective;
  for (std::size_t a = 0; a < static_cast<std::size_t>(lattice.dimensions); ++a) {
    const bool differs = std::abs(lattice.spacing[a] / scene.spacing - 1) > 1e-9;
    if (differs) effective += std::string(effective.empty() ? "" : ", ") + "xyz"[a] + " " + brief(lattice.spacing[a]);
  }
  if (!effective.empty()) groups["effective spacing"] = effective;
  groups["particles"] = std::to_string(scene.particles.size());
  const bool only = scene.fills.size() == 1;
  for (std::size_t n = 0; n < scene.fills.size(); ++n) {
    const RegionFill& fill = scene.fills[n];
    const double density = scene.phases.empty() ? scene.fluid.density : scene.phases[n].density;
    groups["mass" + (only ? std::string() : " of " + fill.name)] = brief(density * fill.asked) + " asked, " +
                                                                   brief(density * fill.got) + " got in " +
                                                                   std::to_string(fill.particles) + " particles";
  }
}

}  // namespace spume
