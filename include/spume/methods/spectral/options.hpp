// SPDX-License-Identifier: MIT
// Options of the spectral method: numerics, forcing, initial state, and point particles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spume/physics/point_particles/options.hpp"

namespace spume {

struct Draft;
class Problems;
struct Section;

enum class Integrator { ab2, rk3, rk4 };
enum class Dealiasing { padded, two_thirds, none };
enum class FieldPrecision { f64, f32 };
enum class PlanEffort { estimate, measured };
enum class ForcingKind { none, shell, linear };
enum class InitialKind { rest, taylor_green, abc, random, expressions, checkpoint };

struct SpectralOptions {
  Integrator integrator = Integrator::ab2;
  Dealiasing dealiasing = Dealiasing::padded;
  FieldPrecision precision = FieldPrecision::f64;
  PlanEffort plans = PlanEffort::estimate;
};

// Force of a homogeneous flow. Wavenumbers in units of 2 pi / the longest length of the box.
struct ForcingOptions {
  ForcingKind kind = ForcingKind::none;
  double wavenumber = 1;  // shell: wavenumber <= |k| < wavenumber + width
  double width = 1;
  double injection = 0;  // shell: energy per mass and time
  double rate = 0;       // linear: acceleration = rate * velocity
};

// Velocity at the start of a flow on a grid; expressions and the spectrum are in the scene.
struct InitialOptions {
  InitialKind kind = InitialKind::rest;
  std::vector<double> amplitude;  // taylor-green: one speed; abc: three
  int wavenumber = 1;             // taylor-green, abc: periods in the box
  double energy = 0;              // random: mean kinetic energy per mass
  std::string file;               // checkpoint
};

// Small spheres in the flow of the spectral method, as [particles] gives them; none when `count` and `volume_fraction`
// are zero. particle_options() makes PointParticleOptions of them.
struct ParticleCaseOptions {
  std::int64_t count = 0;
  double volume_fraction = 0;  // sets the count
  double diameter = 0;
  double diameter_over_eta = 0;  // in Kolmogorov lengths of the injected energy
  std::vector<double> diameters, shares;
  double beta = 1;
  double stokes = 0;         // response time in Kolmogorov times of the injected energy
  double response_time = 0;  // 0 and stokes = 0: diameter^2 / (12 beta nu)
  DragLaw drag = DragLaw::stokes;
  std::vector<double> gravity;
  Coupling coupling = Coupling::one_way;
  bool matching_by_sorting = false;
  std::int64_t collision_sweeps = 12;  // measured in cases/exclusion; the paper makes one
  double max_volume_fraction = PointParticleOptions{}.max_volume_fraction;
  bool remove_self_disturbance = true;
  bool mean_force_moves_fluid = false;  // else a mean pressure gradient holds it
  bool frozen = false;
  std::int64_t spline_order = PointParticleOptions{}.spline_order;
  bool double_records = false;
  std::int64_t sort_every = PointParticleOptions{}.sort_every;
  Placement placement = Placement::random;
  std::int64_t clusters = 8;
  double cluster_radius = 0.05;  // of the shortest side
  std::string file;
  std::int64_t overlap_samples = 20000;
  std::int64_t lyapunov = 0;

  bool any() const { return count > 0 || volume_fraction > 0; }
};

std::vector<Section> spectral_sections();  // [spectral], [forcing], [particles], and what belongs into [initial]

// What [particles] must satisfy beyond types and ranges.
void check_particles(const Draft& draft, Problems& problems);
// The rest: box, grid, forcing, initial state, probes.
void check_spectral(const Draft& draft, Problems& problems);

}  // namespace spume
