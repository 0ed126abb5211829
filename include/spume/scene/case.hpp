// SPDX-License-Identifier: MIT
// The case: everything a case file says, typed, validated, with defaults filled in. Each member is declared
// once as an option in src/scene/options.cpp with its key, type, unit, default, range and description.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "spume/core/error.hpp"
#include "spume/core/kernel_kind.hpp"
#include "spume/scene/bubbles.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

enum class TurbulenceModel { none, mixed_scale, smagorinsky, dynamic_shepard, dynamic_lagrangian };
enum class PressureSolver { bicgstab, cg };
enum class PreconditionerKind { jacobi, multigrid };
enum class Precision { mixed, f64 };
enum class ShiftCorrection { none, first_order, second_order };
enum class Integrator { ab2, rk3, rk4 };
enum class Dealiasing { padded, two_thirds, none };
enum class FieldPrecision { f64, f32 };
enum class PlanEffort { estimate, measured };
enum class ForcingKind { none, shell, linear };
enum class ParticleCoupling { one_way, two_way, four_way, colliding };
enum class ParticlePlacement { random, lattice, clustered, file };
enum class ParticleDrag { stokes, schiller_naumann };
enum class InitialKind { rest, taylor_green, abc, random, expressions, checkpoint };

struct ResolutionOptions {
  double smoothing_ratio = 1.3;  // h / spacing
  KernelKind kernel = KernelKind::wendland_c2;
};

// What diffuses momentum: div(nu grad u), or div(2 nu S), which also holds at a surface free of stress.
enum class DiffusionForm { automatic, laplacian, stress };

struct TurbulenceOptions {
  TurbulenceModel model = TurbulenceModel::none;
  DiffusionForm diffusion = DiffusionForm::automatic;  // automatic: stress with a free surface
  double mixed_scale_constant = 0.06;
  double smagorinsky_constant = 0.18;
};

struct PressureOptions {
  PressureSolver solver = PressureSolver::bicgstab;
  PreconditionerKind preconditioner = PreconditionerKind::multigrid;
  Precision precision = Precision::mixed;
  double tolerance = 1e-6;  // residual relative to the right-hand side
  int max_iterations = 500;
  double cell_ratio = 1.5;  // multigrid cell side / spacing
  bool warm_start = true;
  double density_relaxation = 30;
};

struct ShiftingOptions {
  bool on = true;
  double coefficient = 0.25;                                           // displacement = -coefficient h^2 grad C
  double limit = 0.1;                                                  // largest displacement / h per step
  bool remove_drift = true;                                            // subtract what neighbours share of the shift
  ShiftCorrection velocity_correction = ShiftCorrection::first_order;  // Taylor terms of u at the new place
};

struct SurfaceOptions {
  double threshold = 0;  // div r below which a particle is a surface particle; 0: 2.3 in 3-D, 1.5 in 2-D
  double blend_width = 0.32;
};

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

// Small spheres in the flow of the spectral method; none when `count` and `volume_fraction` are zero.
struct ParticleCaseOptions {
  std::int64_t count = 0;
  double volume_fraction = 0;  // sets the count
  double diameter = 0;
  double diameter_over_eta = 0;  // in Kolmogorov lengths of the injected energy
  std::vector<double> diameters, shares;
  double beta = 1;
  double stokes = 0;         // response time in Kolmogorov times of the injected energy
  double response_time = 0;  // 0 and stokes = 0: diameter^2 / (12 beta nu)
  ParticleDrag drag = ParticleDrag::stokes;
  std::vector<double> gravity;
  ParticleCoupling coupling = ParticleCoupling::one_way;
  bool matching_by_sorting = false;
  std::int64_t collision_sweeps = 1;
  double max_volume_fraction = 0.74048048969306104;  // pi / (3 sqrt 2), close packing
  bool mean_force_moves_fluid = false;               // else a mean pressure gradient holds it
  bool frozen = false;
  std::int64_t spline_order = 4;
  bool double_records = false;
  std::int64_t sort_every = 8;
  ParticlePlacement placement = ParticlePlacement::random;
  std::int64_t clusters = 8;
  double cluster_radius = 0.05;  // of the shortest side
  std::string file;
  std::int64_t overlap_samples = 20000;
  std::int64_t lyapunov = 0;

  bool any() const { return count > 0 || volume_fraction > 0; }
};

struct TimeOptions {
  double end = 0;
  double courant = 0;  // 0: not given; load_case then chooses it by method and integrator
  double viscous = 0.2;
  bool centred = true;  // velocities free of divergence half a step ahead: second order in time
  double max_step = 0;  // 0: none
  int max_retries = 6;
};

struct OutputOptions {
  double every = 0;                 // snapshot interval in time; 0: start and end only
  double series_every = 0;          // 0: every step
  double checkpoint_every = 300;    // wall seconds
  double spectrum_every = 0;        // 0: no spectra
  std::vector<std::string> fields;  // empty: the method's standard set
  bool h5part_view = true;
};

enum class ProbeKind { point, elevation, wetted, front, line, plane };

struct ProbeOptions {
  std::string name;
  ProbeKind kind = ProbeKind::point;
  Vec3 position{};    // point; foot of the column for elevation and wetted; start of a line; a point of a plane
  Vec3 end{};         // end of a line
  int samples = 2;    // points of a line
  int axis = 0;       // front; normal of a plane
  double height = 0;  // front: looks below this height
};

struct Case {
  std::string path;  // the file as given
  std::string title;
  std::string method;
  double spacing = 0;
  std::uint64_t seed = 1;
  ResolutionOptions resolution;
  TurbulenceOptions turbulence;
  PressureOptions pressure;
  ShiftingOptions shifting;
  SurfaceOptions surface;
  SpectralOptions spectral;
  ForcingOptions forcing;
  InitialOptions initial;
  ParticleCaseOptions particles;
  BubbleOptions bubbles;
  TimeOptions time;
  OutputOptions output;
  std::vector<ProbeOptions> probes;
  std::map<std::string, std::string> groups;  // derived and given groups and constants, as text, for the start-up table
  std::map<std::string, Problem> places;      // of what the case gives, by "section.key" and "section"; without a text
  std::vector<Problem> unused_options;  // what the case sets and another of its values makes useless, with the place
  std::string resolved;  // the case as TOML with defaults filled in and the origin of each value in comments
};

// A case and the scene that it describes.
struct LoadedCase {
  Case options;
  Scene scene;
  bool resuming = false;  // the state comes from a checkpoint: files that only the start reads may be gone
};

}  // namespace spume
