// SPDX-License-Identifier: MIT
// Options of [[inflow]] and [[outflow]].
#include "scene_sections.hpp"

namespace spume {
namespace {

void add_place(SectionOf<OpeningDraft>& section, const char* what) {
  using O = OpeningDraft;
  section.word("side", &O::side, side_words(), what)
      .required()
      .option("lower", &O::lower, "length", "lower corner of a box: the part of the side within it")
      .absent("the whole side")
      .option("upper", &O::upper, "length", "upper corner of that box")
      .absent("the whole side")
      .option("where", &O::where, "expression of x y z, positive in the part of the side")
      .absent("everywhere");
}

Section inflow() {
  using O = OpeningDraft;
  auto section = repeated_section<O>("inflow", &Draft::inflows);
  add_place(section, "side of the domain through which liquid enters");
  return section
      .option("velocity", &O::velocity, "length/time", "velocity with which it enters: expressions of x y z t")
      .absent("none; velocity or flow_rate is required")
      .steerable()
      .option("flow_rate", &O::flow_rate, "volume per time, in 2-D per unit width: expression of t")
      .absent("none; velocity or flow_rate is required")
      .steerable()
      .option("phase", &O::phase, "name of the phase that enters")
      .absent("the only phase; of several one is to be named")
      .only(fills_phases)
      .option("level", &O::level, "height of the surface, below which liquid enters: expression of t")
      .absent("liquid enters everywhere")
      .steerable()
      .option("table", &O::table, "CSV file with columns t and velocity_x ..., flow_rate or level, in their place")
      .beside_case()
      .absent("none")
      .whole_only(passes_openings);
}

Section outflow() {
  using O = OpeningDraft;
  auto section = repeated_section<O>("outflow", &Draft::outflows);
  add_place(section, "side of the domain through which liquid leaves");
  return section
      .option("pressure", &O::pressure, "pressure on it: expression of x y z t; with level the pressure there")
      .absent("0")
      .steerable()
      .option("level", &O::level, "height of the surface, from which on the pressure is hydrostatic: expression of t")
      .absent("not hydrostatic")
      .steerable()
      .option("table", &O::table, "CSV file with columns t and pressure or level, in their place")
      .beside_case()
      .absent("none")
      .whole_only(passes_openings);
}

}  // namespace

std::vector<Section> opening_sections() {
  return {inflow(), outflow()};
}

}  // namespace spume
