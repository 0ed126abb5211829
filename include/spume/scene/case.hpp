// SPDX-License-Identifier: MIT
// The case: everything a case file says, typed, validated, with defaults filled in. Each member is declared
// once as an option in src/scene/options.cpp with its key, type, unit, default, range and description.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "spume/scene/bubbles.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

enum class KernelKind { wendland_c2, quintic_spline };
enum class TurbulenceModel { none, mixed_scale, smagorinsky, dynamic_shepard, dynamic_lagrangian };
enum class PressureSolver { bicgstab, cg };
enum class PreconditionerKind { jacobi, multigrid };
enum class Precision { mixed, f64 };
enum class ShiftCorrection { none, first_order, second_order };

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

struct TimeOptions {
  double end = 0;
  double courant = 0.2;
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

enum class ProbeKind { point, elevation, front, line };

struct ProbeOptions {
  std::string name;
  ProbeKind kind = ProbeKind::point;
  Vec3 position{};    // point; foot of the column for elevation; start of a line
  Vec3 end{};         // end of a line
  int samples = 2;    // points of a line
  int axis = 0;       // front
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
  BubbleOptions bubbles;
  TimeOptions time;
  OutputOptions output;
  std::vector<ProbeOptions> probes;
  std::map<std::string, std::string> groups;  // derived and given groups and constants, as text, for the start-up table
  std::string resolved;  // the case as TOML with defaults filled in and the origin of each value in comments
};

// A case and the scene that it describes.
struct LoadedCase {
  Case options;
  Scene scene;
};

}  // namespace spume
