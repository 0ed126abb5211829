// SPDX-License-Identifier: MIT
// What the scene knows of a method: its options, its checks, and what it takes of a scene. Methods are handed in from
// above (spume/methods/registry.hpp); nothing here knows one of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "spume/scene/option.hpp"

namespace spume {

// A field that output.fields may name.
struct OutputFieldInfo {
  std::string name;
  std::string lacks = {};  // what the case has to set for it, in words; empty: nothing
};

struct MethodDeclaration {
  std::string name;         // as a case names it
  std::string description;  // one line

  // Properties: which of the scene's own sections and options the method takes.
  bool uses_grid = false;      // resolution.grid; the flow fills the box, and [initial] tells its velocity
  bool fills_regions = false;  // resolution.spacing; particles of one fluid fill [[liquid]] between walls and solids
  bool fills_phases = false;   // the same with the fluids of [[phase]], which fill each [[region]]

  bool honours_bodies =
      false;  // liquid does not pass the walls of [[body]]; a case with such walls is refused otherwise

  bool honours_solids = true;  // the same of [[solid]]

  // Beside walls of bodies and openings, and where liquid fills the domain, [[solid]] boxes are bodies too.
  bool solids_join_bodies = false;

  bool honours_floating_bodies = false;  // whose motion follows from the pressure

  bool honours_displaced_walls = true;  // sides that move along their normal, pistons among them

  bool incompressible = false;  // without a sound speed in [fluid]: liquid that fills a closed tank cannot be pressed

  bool damps_sponges = false;    // [[sponge]]
  bool absorbs_waves = false;    // absorption of a [[wavemaker]]
  bool passes_openings = false;  // [[inflow]], [[outflow]]

  // Sections of its own, and options that it adds to sections of the scene. Several methods may name the same
  // declaration: its options then belong to all of them.
  std::vector<Section> sections;

  // What the case must satisfy beyond types and ranges, before geometry and expressions are built; completes the groups
  // of options. Null: nothing.
  std::function<void(Draft&, Problems&)> check = {};
  // What can be told only beside the compiled expressions and the initial particles.
  std::function<void(const Draft&, const Scene&, Problems&)> check_scene = {};

  // Bytes per particle or point of the grid that a run holds once its first steps are done; a run needs no less.
  std::function<double(const Draft&)> bytes_per_particle;

  // Courant number of a case that gives none, and in words what decides it.
  std::function<double(const Case&, const Scene&)> default_courant;
  std::string default_courant_in_words;

  // What output.fields may name.
  std::function<std::vector<OutputFieldInfo>(const Case&)> output_fields;

  // What probes record beside the velocity, in the order of PointSample::scalars. Null: nothing.
  std::function<std::vector<ProbeScalar>(const Case&)> probe_scalars = {};
};

inline bool uses_grid(const MethodDeclaration& method) {
  return method.uses_grid;
}
inline bool fills_regions(const MethodDeclaration& method) {
  return method.fills_regions;
}
inline bool fills_phases(const MethodDeclaration& method) {
  return method.fills_phases;
}
inline bool uses_particles(const MethodDeclaration& method) {
  return method.fills_regions || method.fills_phases;
}
inline bool damps_sponges(const MethodDeclaration& method) {
  return method.damps_sponges;
}
inline bool absorbs_waves(const MethodDeclaration& method) {
  return method.absorbs_waves;
}
inline bool passes_openings(const MethodDeclaration& method) {
  return method.passes_openings;
}
inline bool has_one_fluid(const MethodDeclaration& method) {
  return !method.fills_phases;
}

}  // namespace spume
