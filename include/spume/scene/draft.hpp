// SPDX-License-Identifier: MIT
// What the reader gathers from a case file before geometry and expressions are built: what checks look at.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "spume/scene/case.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/wave_modes.hpp"

namespace spume {

struct ExpressionText {
  std::string text;
  const Node* node = nullptr;  // for the place of an error; null for a default
};

struct LiquidDraft {
  std::optional<ExpressionText> where;
  std::vector<double> lower, upper, centre;
  std::optional<double> radius;
  std::string body;  // name of the body whose inside is filled; empty: none
  std::vector<ExpressionText> velocity;
  bool conform = false;
};

// A [[region]]: what a phase fills. `conform` stays false.
struct RegionDraft : LiquidDraft {
  std::string phase;
};

struct SolidDraft {
  std::vector<double> lower, upper;
  BoundaryKind wall = BoundaryKind::free_slip;
};

// What a [[body]] says of its shape; `expression` and `mesh` are not words of the key `shape`.
enum class BodyKind { none, box, ball, cylinder, cone, capsule, ellipsoid, half_space, outline, expression, mesh };

struct BodyDraft {
  std::string name;
  BodyKind kind = BodyKind::none;
  std::optional<ExpressionText> where;
  std::string mesh;
  std::vector<double> size, semi_axes, normal;
  std::optional<double> radius, length;
  double top_radius = 0;
  std::vector<std::array<double, 2>> points;
  std::vector<double> position, rotation;
  double scale = 1;
  bool inside = true;
  bool subtract = false;
  BoundaryKind wall = BoundaryKind::free_slip;  // open: none
  std::vector<ExpressionText> velocity;
  // How it moves: by expressions of time, by a table, with another body, or floating.
  std::vector<ExpressionText> displacement;
  std::optional<ExpressionText> angle;
  std::string motion, moves_with;
  std::vector<double> axis, pivot, inertia;
  std::optional<double> mass, density, restitution;
  std::vector<std::string> free;
  std::optional<double> release_interval, release_duration, release_delay, release_growth, release_shrinkage;
};

enum class WaveKind { none, regular, jonswap, focused, solitary };
enum class AbsorptionKind { none, tuned, long_wave };

// A [[wavemaker]]: a side of the domain that moves as a piston, or a flap before it. `side` is "left" or "right".
struct WavemakerDraft {
  std::string side;
  WavemakerKind kind = WavemakerKind::piston;
  WaveKind waves = WaveKind::regular;
  std::optional<double> height, amplitude, period;
  double gamma = 3.3;  // mean of the spectra that Hasselmann et al. (1973) measured
  // A hundred bands of 0.025 peak frequencies; the peak of a spectrum with gamma = 3.3 is 0.2 wide at half its height.
  std::int64_t components = 100;
  std::int64_t seed = 0;
  std::optional<double> focus_place, focus_time;
  std::optional<double> depth;
  std::optional<double> hinge;  // x, of a flap
  std::optional<double> ramp;
  std::int64_t order = 0;  // 0: the highest that there is for the waves
  AbsorptionKind absorption = AbsorptionKind::none;
};

struct SpongeDraft {
  std::string side;
  double length = 0;
  std::optional<double> strength;
  std::vector<double> velocity;
};

// An [[inflow]] or [[outflow]].
struct OpeningDraft {
  std::string side, phase;
  std::vector<double> lower, upper;
  std::optional<ExpressionText> where;
  std::vector<ExpressionText> velocity;
  std::optional<ExpressionText> flow_rate, pressure, level;
  std::string table;
};

struct ProbeDraft {
  ProbeOptions options;
  std::vector<double> position, end;
  std::optional<double> height;
};

struct FluidDraft {
  std::optional<double> reynolds, froude, mach;
  std::optional<double> density, viscosity, gravity, sound_speed;
};

// True when [fluid] is given by its SI set.
inline bool uses_si(const FluidDraft& fluid) {
  return fluid.density || fluid.viscosity || fluid.gravity || fluid.sound_speed;
}

// Entries that are not given are 0.
inline Vec3 to_vec3(const std::vector<double>& values) {
  Vec3 vector{};
  for (std::size_t a = 0; a < values.size() && a < 3; ++a) vector[a] = values[a];
  return vector;
}

struct Draft {
  Case options;
  std::vector<double> lower, upper;
  std::array<bool, 3> periodic{};
  std::map<std::string, BoundaryKind> sides;                         // by name: left, right, ...
  std::map<std::string, std::vector<ExpressionText>> wall_velocity;  // by name of the side
  FluidDraft fluid;
  std::vector<LiquidDraft> liquids;
  std::vector<Phase> phases;
  double surface_tension = 0;
  std::vector<RegionDraft> regions;
  std::vector<SolidDraft> solids;
  std::vector<BodyDraft> bodies;
  std::vector<WavemakerDraft> wavemakers;
  std::vector<SpongeDraft> sponges;
  std::vector<OpeningDraft> inflows, outflows;
  std::vector<ProbeDraft> probes;
  std::vector<ExpressionText> body_force;
  double jitter = 0;
  std::vector<std::int64_t> grid;  // one entry: the same along every axis
  std::vector<ExpressionText> initial_velocity;
  std::optional<ExpressionText> initial_spectrum;

  bool groups = false;                       // phases stand for groups: no SI values
  int dimensions = 0;                        // 0 while the domain is not understood
  std::map<std::string, const Node*> given;  // "section.key" or "section.0.key" -> value, sections included
  std::map<std::string, bool> bad;           // keys whose value was refused

  const Node* node(const std::string& name) const {
    const auto found = given.find(name);
    return found == given.end() ? nullptr : found->second;
  }
  bool usable(const std::string& name) const { return bad.count(name) == 0; }
};

// True when the case is in SI units: by its fluid, or because it has phases, which are unless they stand for groups.
inline bool uses_si(const Draft& draft) {
  return !draft.groups && !draft.fluid.froude && (uses_si(draft.fluid) || !draft.phases.empty());
}

}  // namespace spume
