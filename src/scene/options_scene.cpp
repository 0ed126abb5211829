// SPDX-License-Identifier: MIT
// Options of the scene: domain, solids, resolution, fluid, liquid, forces.
#include "scene_sections.hpp"

namespace spume {
namespace {

Draft& whole(Draft& draft) {
  return draft;
}

// Values in cm or of a benchmark without units are taken as they are, and nothing tells them from SI but gravity: on
// the Earth 9.764 to 9.834 m/s2.
std::string units_by_gravity(const Draft& draft) {
  const double gravity = draft.fluid.gravity.value_or(0);
  return uses_si(draft) && gravity >= 9.7 && gravity <= 9.9 ? "\"SI\"" : "\"none\"";
}

Section general() {
  Section section = spume::section<Draft>("", whole)
                        .option("title", &Case::title, "title of reports and pictures")
                        .absent("the name of the case")
                        .option("method", &Case::method, "numerical method")
                        .required()
                        .option("seed", &Case::seed, "", not_negative(), "seed of all random numbers")
                        .word("units", &Case::units, {{"SI", Units::si}, {"none", Units::none}},
                              "of its numbers, in pictures and tables; the gravity of the Earth shows that they are SI")
                        .absent("SI with a gravity of 9.7 to 9.9, else none")
                        .chosen(units_by_gravity);
  section.options[1].type = OptionType::word;  // the schema knows the words
  return section;
}

Section domain() {
  auto section =
      spume::section<Draft>("domain", whole)
          .option("lower", &Draft::lower, "length", "lower corner; two entries: 2-D, up is y; three: 3-D, up is z")
          .required()
          .option("upper", &Draft::upper, "length", "upper corner")
          .required();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    section
        .word(
            name.c_str(), [axis](Draft& d) -> bool& { return d.periodic[axis]; }, {{"periodic", true}},
            ("periodic in " + name).c_str())
        .absent("not periodic");
  }
  const std::pair<const char*, const char*> sides[] = {{"left", "lower x side"},
                                                       {"right", "upper x side"},
                                                       {"front", "lower y side in 3-D"},
                                                       {"back", "upper y side in 3-D"},
                                                       {"bottom", "lower side of the last axis"},
                                                       {"top", "upper side of the last axis"}};
  for (const auto& [name, description] : sides)
    section
        .word(
            name, [side = std::string(name)](Draft& d) -> BoundaryKind& { return d.sides[side]; },
            {{"free-slip", BoundaryKind::free_slip}, {"no-slip", BoundaryKind::no_slip}, {"open", BoundaryKind::open}},
            description)
        .absent("open")
        .only(uses_particles);
  return section;
}

Section wall_velocity() {
  auto section = spume::section<Draft>("domain.wall_velocity", whole).whole_only(uses_particles);
  for (const std::string name : {"left", "right", "front", "back", "bottom", "top"})
    section
        .option(
            name.c_str(), [name](Draft& d) -> std::vector<ExpressionText>& { return d.wall_velocity[name]; },
            "length/time", ("velocity of the " + name + " wall: expressions of x y z t").c_str())
        .absent("at rest")
        .steerable();
  return section;
}

Section solid() {
  using S = SolidDraft;
  return repeated_section<S>("solid", &Draft::solids)
      .option("lower", &S::lower, "length", "lower corner of a solid box")
      .elsewhere({"position", "size"})
      .required()
      .option("upper", &S::upper, "length", "upper corner of a solid box")
      .elsewhere({"position", "size"})
      .required()
      .word("wall", &S::wall, {{"free-slip", BoundaryKind::free_slip}, {"no-slip", BoundaryKind::no_slip}},
            "condition on its faces")
      .whole_only(uses_particles);
}

Section resolution() {
  using R = ResolutionOptions;
  return section<R>("resolution", [](Draft& d) -> R& { return d.options.resolution; })
      .option("spacing", &Case::spacing, "length", positive(), "initial particle spacing")
      .required()
      .only(uses_particles)
      .option("grid", &Draft::grid, "", between(4, 16384),
              "even numbers of grid points along x, y, z; one number applies to every axis")
      .required()
      .only(uses_grid)
      .option("smoothing_ratio", &R::smoothing_ratio, "1", between(0.8, 3), "smoothing length h over spacing")
      .only(uses_particles)
      .word("kernel", &R::kernel,
            {{"wendland-c2", KernelKind::wendland_c2}, {"quintic-spline", KernelKind::quintic_spline}},
            "smoothing kernel: support 2h for wendland-c2, 3h for quintic-spline")
      .only(uses_particles);
}

Section fluid() {
  using F = FluidDraft;
  return section<F>("fluid", &Draft::fluid)
      .option("reynolds", &F::reynolds, "1", positive(), "Reynolds number; kinematic viscosity is 1/Re")
      .absent("inviscid")
      .steerable()
      .only(has_one_fluid)
      .option("froude", &F::froude, "1", positive(),
              "Froude number; gravity is 1/Fr^2, lengths and phases in its units")
      .absent("no gravity")
      .steerable()
      .only(uses_particles)
      .option("mach", &F::mach, "1", between(0, 1), "Mach number; sound speed is 1/Ma; 0: incompressible")
      .absent("incompressible")
      .only(fills_regions)
      .option("density", &F::density, "kg/m3", positive(), "density; required with SI values")
      .absent("1, in groups")
      .only(has_one_fluid)
      .option("viscosity", &F::viscosity, "Pa s", not_negative(), "dynamic viscosity")
      .absent("inviscid")
      .steerable()
      .only(has_one_fluid)
      .option("gravity", &F::gravity, "m/s2", not_negative(), "gravity, downwards along the last axis")
      .absent("no gravity")
      .steerable()
      .only(uses_particles)
      .option("sound_speed", &F::sound_speed, "m/s", not_negative(), "sound speed; 0: incompressible")
      .absent("incompressible")
      .only(fills_regions);
}

Section constants() {
  return {.name = "constants",
          .options = {{.key = "*",
                       .type = OptionType::free_table,
                       .absent = "none",
                       .description = "named numbers and expressions, for use in expressions; in any order"}}};
}

// Shape of a region: the part of the domain that satisfies all that is given, and how it moves at the start.
template <class Region>
void add_shape(SectionOf<Region>& section) {
  using L = LiquidDraft;
  section.option("where", &L::where, "expression of x y z, positive inside the region")
      .absent("everywhere")
      .option("lower", &L::lower, "length", "lower corner of a box")
      .elsewhere({"position", "size"})
      .absent("the domain")
      .option("upper", &L::upper, "length", "upper corner of a box")
      .elsewhere({"position", "size"})
      .absent("the domain")
      .option("centre", &L::centre, "length", "centre of a ball (disc in 2-D)")
      .elsewhere({"position", "center"})
      .absent("no ball")
      .option("radius", &L::radius, "length", positive(),
              "radius of a ball (disc in 2-D); half of one where its centre is on a side")
      .absent("no ball")
      .option("body", &L::body, "name of a [[body]], whose inside it fills")
      .absent("no body")
      .option("velocity", &L::velocity, "length/time", "velocity at the start: expressions of x y z")
      .absent("at rest");
}

Section liquid() {
  auto section = repeated_section<LiquidDraft>("liquid", &Draft::liquids).whole_only(fills_regions);
  add_shape(section);
  return section.option("conform", &LiquidDraft::conform, "fit columns of particles to the surface where = 0");
}

Section phase() {
  using P = Phase;
  return repeated_section<P>("phase", &Draft::phases)
      .option("name", &P::name, "name, by which regions refer to the phase")
      .required()
      .option("density", &P::density, "kg/m3", positive(), "density")
      .required()
      .option("viscosity", &P::viscosity, "Pa s", not_negative(), "dynamic viscosity; 0: inviscid")
      .required()
      .steerable()
      .option("sound_speed", &P::sound_speed, "m/s", not_negative(),
              "sound speed; 0: incompressible, or chosen by a weakly compressible method")
      .option(
          "exponent", &P::exponent, "1", not_negative(),
          "exponent of the equation of state; 0: chosen by a weakly compressible method, 7 for liquids, 1.4 for gases")
      .whole_only(fills_phases);
}

Section interface_section() {
  return section<Draft>("interface", whole)
      .option("surface_tension", &Draft::surface_tension, "N/m", not_negative(), "surface tension between the phases")
      .steerable()
      .whole_optional()
      .whole_only(fills_phases);
}

Section region() {
  auto section = repeated_section<RegionDraft>("region", &Draft::regions).whole_only(fills_phases);
  section
      .option("phase", &RegionDraft::phase,
              "name of the phase that fills the region; later regions replace earlier ones")
      .required();
  add_shape(section);
  return section;
}

Section initial() {
  return section<Draft>("initial", whole)
      .option("jitter", &Draft::jitter, "spacing", between(0, 0.5),
              "largest random displacement of a particle along each axis")
      .only(uses_particles);
}

Section forces() {
  return section<Draft>("forces", whole)
      .option("body", &Draft::body_force, "length/time2", "acceleration in addition to gravity: expressions of x y z t")
      .absent("none")
      .steerable()
      .whole_only(uses_particles);
}

}  // namespace

std::vector<Section> scene_sections() {
  std::vector<Section> sections{general(),           domain(), wall_velocity(), solid(),  body_section(),
                                resolution(),        fluid(),  constants(),     liquid(), phase(),
                                interface_section(), region(), initial(),       forces()};
  for (Section& section : wave_sections()) sections.push_back(std::move(section));
  for (Section& section : opening_sections()) sections.push_back(std::move(section));
  return sections;
}

}  // namespace spume
