// SPDX-License-Identifier: MIT
// Options of the scene: domain, solids, resolution, fluid, liquid, forces.
#include "option.hpp"

namespace spume {
namespace {

BoundaryKind boundary(const std::string& word) {
  if (word == "periodic") return BoundaryKind::periodic;
  if (word == "free-slip") return BoundaryKind::free_slip;
  return word == "no-slip" ? BoundaryKind::no_slip : BoundaryKind::open;
}

const Methods particle_methods{"les-sph"};
const Methods grid_methods{"spectral"};

Section general() {
  return {.name = "",
          .options = {
              {.key = "title",
               .type = OptionType::string,
               .absent = "the name of the case",
               .description = "title of reports and pictures",
               .set = [](Draft& d, const Value& v) { d.options.title = v.text; }},
              {.key = "method",
               .type = OptionType::word,
               .required = true,
               .words = {"les-sph", "spectral"},
               .description = "numerical method",
               .set = [](Draft& d, const Value& v) { d.options.method = v.text; }},
              {.key = "seed",
               .type = OptionType::integer,
               .default_text = "1",
               .range = not_negative(),
               .description = "seed of all random numbers",
               .set = [](Draft& d, const Value& v) { d.options.seed = static_cast<std::uint64_t>(v.integer); }},
          }};
}

Section domain() {
  Section section{.name = "domain",
                  .options = {
                      {.key = "lower",
                       .type = OptionType::numbers,
                       .unit = "length",
                       .required = true,
                       .description = "lower corner; two entries: 2-D, up is y; three: 3-D, up is z",
                       .set = [](Draft& d, const Value& v) { d.lower = v.numbers; }},
                      {.key = "upper",
                       .type = OptionType::numbers,
                       .unit = "length",
                       .required = true,
                       .description = "upper corner",
                       .set = [](Draft& d, const Value& v) { d.upper = v.numbers; }},
                  }};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    section.options.push_back({.key = name,
                               .type = OptionType::word,
                               .absent = "not periodic",
                               .words = {"periodic"},
                               .description = "both sides of the " + name + " axis are one",
                               .set = [axis](Draft& d, const Value&) { d.periodic[axis] = true; }});
  }
  const std::pair<const char*, const char*> sides[] = {{"left", "lower x side"},
                                                       {"right", "upper x side"},
                                                       {"front", "lower y side in 3-D"},
                                                       {"back", "upper y side in 3-D"},
                                                       {"bottom", "lower side of the last axis"},
                                                       {"top", "upper side of the last axis"}};
  for (const auto& [name, description] : sides) {
    section.options.push_back(
        {.key = name,
         .type = OptionType::word,
         .absent = "open",
         .words = {"free-slip", "no-slip", "open"},
         .description = description,
         .set = [name = std::string(name)](Draft& d, const Value& v) { d.sides[name] = boundary(v.text); },
         .methods = particle_methods});
  }
  return section;
}

Section wall_velocity() {
  Section section{.name = "domain.wall_velocity", .methods = particle_methods};
  for (const std::string name : {"left", "right", "front", "back", "bottom", "top"}) {
    section.options.push_back({.key = name,
                               .type = OptionType::expressions,
                               .unit = "length/time",
                               .absent = "at rest",
                               .description = "velocity of the " + name + " wall: expressions of x y z t",
                               .set = [name](Draft& d, const Value& v) { d.wall_velocity[name] = v.expressions; }});
  }
  return section;
}

Section solid() {
  return {.name = "solid",
          .repeated = true,
          .begin_entry = [](Draft& d) { d.solids.emplace_back(); },
          .options =
              {
                  {.key = "lower",
                   .type = OptionType::numbers,
                   .unit = "length",
                   .required = true,
                   .description = "lower corner of a solid box",
                   .set = [](Draft& d, const Value& v) { d.solids.back().lower = v.numbers; }},
                  {.key = "upper",
                   .type = OptionType::numbers,
                   .unit = "length",
                   .required = true,
                   .description = "upper corner of a solid box",
                   .set = [](Draft& d, const Value& v) { d.solids.back().upper = v.numbers; }},
                  {.key = "wall",
                   .type = OptionType::word,
                   .default_text = "\"free-slip\"",
                   .words = {"free-slip", "no-slip"},
                   .description = "condition on its faces",
                   .set = [](Draft& d, const Value& v) { d.solids.back().wall = boundary(v.text); }},
              },
          .methods = particle_methods};
}

Section resolution() {
  return {.name = "resolution",
          .options = {
              {.key = "spacing",
               .type = OptionType::number,
               .unit = "length",
               .required = true,
               .range = positive(),
               .description = "distance between particles at the start",
               .set = [](Draft& d, const Value& v) { d.options.spacing = v.number; },
               .methods = particle_methods},
              {.key = "grid",
               .type = OptionType::integers,
               .required = true,
               .range = between(4, 16384),
               .description = "points along x, y, z, even; one number: the same along each",
               .set = [](Draft& d, const Value& v) { d.grid = v.integers; },
               .methods = grid_methods},
              {.key = "smoothing_ratio",
               .type = OptionType::number,
               .unit = "1",
               .default_text = "1.3",
               .range = between(0.8, 3),
               .description = "smoothing length h over spacing",
               .set = [](Draft& d, const Value& v) { d.options.resolution.smoothing_ratio = v.number; },
               .methods = particle_methods},
              {.key = "kernel",
               .type = OptionType::word,
               .default_text = "\"wendland-c2\"",
               .words = {"wendland-c2", "quintic-spline"},
               .description = "smoothing kernel: support 2h for wendland-c2, 3h for quintic-spline",
               .set =
                   [](Draft& d, const Value& v) {
                     d.options.resolution.kernel =
                         v.text == "wendland-c2" ? KernelKind::wendland_c2 : KernelKind::quintic_spline;
                   },
               .methods = particle_methods},
          }};
}

Section fluid() {
  const auto group = [](const char* key, const char* absent, Range range, const char* description,
                        std::optional<double> FluidDraft::*member, const char* unit = "1",
                        const Methods& methods = {}) {
    return Option{.key = key,
                  .type = OptionType::number,
                  .unit = unit,
                  .absent = absent,
                  .range = range,
                  .description = description,
                  .set = [member](Draft& d, const Value& v) { d.fluid.*member = v.number; },
                  .methods = methods};
  };
  return {
      .name = "fluid",
      .options = {
          group("reynolds", "inviscid", positive(), "Reynolds number; kinematic viscosity is 1/Re",
                &FluidDraft::reynolds),
          group("froude", "no gravity", positive(), "Froude number; gravity is 1/Fr^2", &FluidDraft::froude, "1",
                particle_methods),
          group("mach", "incompressible", between(0, 1), "Mach number; sound speed is 1/Ma; 0: incompressible",
                &FluidDraft::mach, "1", particle_methods),
          group("density", "1, in groups", positive(), "density, first of the SI set", &FluidDraft::density, "kg/m3"),
          group("viscosity", "inviscid", not_negative(), "dynamic viscosity", &FluidDraft::viscosity, "Pa s"),
          group("gravity", "no gravity", not_negative(), "gravity, downwards along the last axis", &FluidDraft::gravity,
                "m/s2", particle_methods),
          group("sound_speed", "incompressible", not_negative(), "sound speed; 0: incompressible",
                &FluidDraft::sound_speed, "m/s", particle_methods),
      }};
}

Section constants() {
  return {.name = "constants",
          .options = {{.key = "*",
                       .type = OptionType::free_table,
                       .absent = "none",
                       .description = "names for numbers and expressions, used in expressions in any order"}}};
}

Section liquid() {
  return {.name = "liquid",
          .repeated = true,
          .begin_entry = [](Draft& d) { d.liquids.emplace_back(); },
          .options =
              {
                  {.key = "where",
                   .type = OptionType::expression,
                   .absent = "everywhere",
                   .description = "expression of x y z, positive inside the region",
                   .set = [](Draft& d, const Value& v) { d.liquids.back().where = v.expression; }},
                  {.key = "lower",
                   .type = OptionType::numbers,
                   .unit = "length",
                   .absent = "the domain",
                   .description = "lower corner of a box",
                   .set = [](Draft& d, const Value& v) { d.liquids.back().lower = v.numbers; }},
                  {.key = "upper",
                   .type = OptionType::numbers,
                   .unit = "length",
                   .absent = "the domain",
                   .description = "upper corner of a box",
                   .set = [](Draft& d, const Value& v) { d.liquids.back().upper = v.numbers; }},
                  {.key = "centre",
                   .type = OptionType::numbers,
                   .unit = "length",
                   .absent = "no ball",
                   .description = "centre of a ball (disc in 2-D)",
                   .set = [](Draft& d, const Value& v) { d.liquids.back().centre = v.numbers; }},
                  {.key = "radius",
                   .type = OptionType::number,
                   .unit = "length",
                   .absent = "no ball",
                   .range = positive(),
                   .description = "radius of a ball (disc in 2-D)",
                   .set = [](Draft& d, const Value& v) { d.liquids.back().radius = v.number; }},
                  {.key = "velocity",
                   .type = OptionType::expressions,
                   .unit = "length/time",
                   .absent = "at rest",
                   .description = "velocity at the start: expressions of x y z",
                   .set = [](Draft& d, const Value& v) { d.liquids.back().velocity = v.expressions; }},
                  {.key = "conform",
                   .type = OptionType::boolean,
                   .default_text = "false",
                   .description = "columns of particles end exactly on the surface where = 0",
                   .set = [](Draft& d, const Value& v) { d.liquids.back().conform = v.boolean; }},
              },
          .methods = particle_methods};
}

Section initial() {
  return {.name = "initial",
          .options = {
              {.key = "jitter",
               .type = OptionType::number,
               .unit = "spacing",
               .default_text = "0.0",
               .range = between(0, 0.5),
               .description = "largest random displacement of a particle along each axis",
               .set = [](Draft& d, const Value& v) { d.jitter = v.number; },
               .methods = particle_methods},
              {.key = "kind",
               .type = OptionType::word,
               .required = true,
               .words = {"taylor-green", "abc", "random", "expressions", "checkpoint", "rest"},
               .description = "velocity at the start",
               .set =
                   [](Draft& d, const Value& v) {
                     d.options.initial.kind = v.text == "taylor-green"  ? InitialKind::taylor_green
                                              : v.text == "abc"         ? InitialKind::abc
                                              : v.text == "random"      ? InitialKind::random
                                              : v.text == "expressions" ? InitialKind::expressions
                                              : v.text == "checkpoint"  ? InitialKind::checkpoint
                                                                        : InitialKind::rest;
                   },
               .methods = grid_methods},
              {.key = "amplitude",
               .type = OptionType::numbers,
               .unit = "length/time",
               .absent = "1, or 1, 1, 1",
               .description = "taylor-green: one speed; abc: A, B, C",
               .set = [](Draft& d, const Value& v) { d.options.initial.amplitude = v.numbers; },
               .methods = grid_methods},
              {.key = "wavenumber",
               .type = OptionType::integer,
               .absent = "1",
               .range = between(1, 8192),
               .description = "taylor-green, abc: periods in the box",
               .set = [](Draft& d, const Value& v) { d.options.initial.wavenumber = static_cast<int>(v.integer); },
               .methods = grid_methods},
              {.key = "velocity",
               .type = OptionType::expressions,
               .unit = "length/time",
               .absent = "required for expressions",
               .description = "expressions: of x y z; what is not solenoidal is removed",
               .set = [](Draft& d, const Value& v) { d.initial_velocity = v.expressions; },
               .methods = grid_methods},
              {.key = "spectrum",
               .type = OptionType::expression,
               .absent = "required for random",
               .description = "random: E(k) up to a factor, an expression of k",
               .set = [](Draft& d, const Value& v) { d.initial_spectrum = v.expression; },
               .methods = grid_methods},
              {.key = "energy",
               .type = OptionType::number,
               .unit = "energy/mass",
               .absent = "required for random",
               .range = positive(),
               .description = "random: mean kinetic energy per mass",
               .set = [](Draft& d, const Value& v) { d.options.initial.energy = v.number; },
               .methods = grid_methods},
              {.key = "file",
               .type = OptionType::string,
               .absent = "required for checkpoint",
               .description = "checkpoint: checkpoint.h5 of a run on any grid, path from the working folder",
               .set = [](Draft& d, const Value& v) { d.options.initial.file = v.text; },
               .methods = grid_methods},
          }};
}

Section forces() {
  return {.name = "forces",
          .options = {{.key = "body",
                       .type = OptionType::expressions,
                       .unit = "length/time2",
                       .absent = "none beside gravity",
                       .description = "acceleration beside gravity: expressions of x y z t",
                       .set = [](Draft& d, const Value& v) { d.body_force = v.expressions; }}},
          .methods = particle_methods};
}

}  // namespace

std::vector<Section> scene_sections() {
  return {general(), domain(),    wall_velocity(), solid(),   resolution(),
          fluid(),   constants(), liquid(),        initial(), forces()};
}

}  // namespace spume
