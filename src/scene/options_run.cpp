// SPDX-License-Identifier: MIT
// Options of time and of what a run records.
#include "scene_sections.hpp"

namespace spume {
namespace {

Section time(const std::string& default_courant) {
  using T = TimeOptions;
  return section<T>("time", [](Draft& d) -> T& { return d.options.time; })
      .option("end", &T::end, "time", positive(), "time at which the run ends")
      .required()
      .steerable()
      .option("courant", &T::courant, "1", above_up_to(0, 1), "step limit by speed: Courant number")
      .absent(default_courant)
      .chosen([](const Draft& d) { return shortest(d.options.time.courant); })
      .steerable()
      .option("max_step", &T::max_step, "time", not_negative(), "largest step; 0: none")
      .steerable()
      .option("max_retries", &T::max_retries, "", between(0, 30), "halvings of a refused step before the run ends");
}

Section output() {
  using O = OutputOptions;
  return section<O>("output", [](Draft& d) -> O& { return d.options.output; })
      .option("every", &O::every, "time", not_negative(), "snapshot interval; 0: start and end only")
      .steerable()
      .option("series_every", &O::series_every, "time", not_negative(), "interval of series.csv; 0: every step")
      .steerable()
      .option("checkpoint_every", &O::checkpoint_every, "s of wall time", not_negative(), "checkpoint interval")
      .steerable()
      .option("spectrum_every", &O::spectrum_every, "time", not_negative(), "interval of energy spectra; 0: none")
      .steerable()
      .option("fields", &O::fields, "fields of a snapshot; empty: the method's standard set")
      .or_one_alone()
      .option("h5part_view", &O::h5part_view,
              "add views for ParaView 5.11: <name>.h5part of particles, <name>.hdf.series of fields on a grid")
      .option("interface", &O::interface,
              "add interface.vtp.series: surfaces between phases at the times of snapshots, lines in 2-D")
      .only(fills_phases);
}

Section probe() {
  using P = ProbeDraft;
  return repeated_section<P>("probe", &Draft::probes)
      .option(
          "name", [](P& p) -> std::string& { return p.options.name; }, "name of its columns in probes.csv")
      .required()
      .word(
          "kind", [](P& p) -> ProbeKind& { return p.options.kind; },
          {{"point", ProbeKind::point},
           {"elevation", ProbeKind::elevation},
           {"wetted", ProbeKind::wetted},
           {"front", ProbeKind::front},
           {"line", ProbeKind::line},
           {"plane", ProbeKind::plane}},
          "quantity; elevation: largest height of the liquid on the vertical through position; wetted: wetted length "
          "of "
          "that vertical, as measured by a wire gauge; plane: area of the liquid on a plane across the domain, and "
          "mean "
          "velocity and pressure over that area")
      .option("position", &P::position, "length",
              "point; base of the vertical (elevation, wetted); start of a line; a point of a plane, or only its "
              "coordinate along the normal")
      .absent("required but for front")
      .option("end", &P::end, "length", "end of a line")
      .absent("required for line")
      .when("kind", {"line"})
      .option(
          "samples", [](P& p) -> int& { return p.options.samples; }, "", between(2, 1e6),
          "points of a line, ends included")
      .when("kind", {"line"})
      .option(
          "average", [](P& p) -> double& { return p.options.average; }, "time", not_negative(),
          "time over which the pressure is averaged, at least output.series_every: rows that far apart hold the whole "
          "impulse of an impact; 0: the pressure of the last step")
      .when("kind", {"point", "plane"})
      .option(
          "moves_with", [](P& p) -> std::string& { return p.options.moves_with; },
          "name of a moving [[body]] that carries it from its place at the start")
      .absent("it stands still")
      .when("kind", {"point", "line"})
      .word(
          "axis", [](P& p) -> int& { return p.options.axis; }, {{"x", 0}, {"y", 1}, {"z", 2}},
          "front: axis of the largest coordinate of the liquid; plane: normal")
      .when("kind", {"front", "plane"})
      .option("height", &P::height, "length", "front: liquid above this height is ignored")
      .absent("top of the domain")
      .when("kind", {"front"});
}

Section verify() {
  return {.name = "verify",
          .options = {{.key = "*",
                       .type = OptionType::free_table,
                       .absent = "none",
                       .description = "references and bounds for `spume verify`"}}};
}

}  // namespace

std::vector<Section> run_sections(const std::string& default_courant) {
  return {time(default_courant), output(), probe(), verify()};
}

}  // namespace spume
