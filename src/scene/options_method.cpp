// SPDX-License-Identifier: MIT
// Options of the method, of time, and of what a run records.
#include "option_builders.hpp"

namespace spume {
namespace {

Section turbulence() {
  const auto group = &Case::turbulence;
  using T = TurbulenceOptions;
  return {
      .name = "turbulence",
      .options =
          {
              word_option("model", "\"none\"", "closure of the unresolved stresses", group, &T::model,
                          {{"none", TurbulenceModel::none},
                           {"mixed-scale", TurbulenceModel::mixed_scale},
                           {"smagorinsky", TurbulenceModel::smagorinsky},
                           {"dynamic-shepard", TurbulenceModel::dynamic_shepard},
                           {"dynamic-lagrangian", TurbulenceModel::dynamic_lagrangian}}),
              word_option("diffusion", "\"automatic\"",
                          "div(nu grad u) or div(2 nu S); automatic: stress with a surface", group, &T::diffusion,
                          {{"automatic", DiffusionForm::automatic},
                           {"laplacian", DiffusionForm::laplacian},
                           {"stress", DiffusionForm::stress}}),
              with({"model", {"mixed-scale"}}, option("mixed_scale_constant", "1", "0.06", between(0, 1),
                                                      "C_M of the mixed-scale model", group, &T::mixed_scale_constant)),
              with({"model", {"smagorinsky"}}, option("smagorinsky_constant", "1", "0.18", between(0, 1),
                                                      "C_s of the Smagorinsky model", group, &T::smagorinsky_constant)),
          },
      .methods = {"les-sph"}};
}

Section pressure() {
  const auto group = &Case::pressure;
  using P = PressureOptions;
  return {.name = "pressure",
          .options =
              {
                  word_option("solver", "\"bicgstab\"", "Krylov method of the pressure equation", group, &P::solver,
                              {{"bicgstab", PressureSolver::bicgstab}, {"cg", PressureSolver::cg}}),
                  word_option("preconditioner", "\"multigrid\"", "multigrid: Jacobi plus one V-cycle on cells", group,
                              &P::preconditioner,
                              {{"jacobi", PreconditionerKind::jacobi}, {"multigrid", PreconditionerKind::multigrid}}),
                  word_option("precision", "\"mixed\"", "mixed: residuals in double, corrections in float", group,
                              &P::precision, {{"mixed", Precision::mixed}, {"double", Precision::f64}}),
                  option("tolerance", "1", "1e-6", above_up_to(0, 0.1), "residual relative to the right-hand side",
                         group, &P::tolerance),
                  option("max_iterations", "", "500", between(1, 1e6), "iterations after which a solve has failed",
                         group, &P::max_iterations),
                  with({"preconditioner", {"multigrid"}}, option("cell_ratio", "spacing", "1.5", between(1, 8),
                                                                 "side of the multigrid cells", group, &P::cell_ratio)),
                  option("warm_start", "", "true", {}, "start from the last pressure, carried by the particles", group,
                         &P::warm_start),
                  option("density_relaxation", "steps", "30", between(1, 1e6),
                         "steps of courant 0.2 over which number density is evened out, in a scene with a free "
                         "surface ten times as many where liquid is too dense; 1e6: never",
                         group, &P::density_relaxation),
              },
          .methods = {"les-sph"}};
}

Section shifting() {
  const auto group = &Case::shifting;
  using S = ShiftingOptions;
  return {.name = "shifting",
          .options =
              {
                  option("on", "", "true", {}, "move particles towards an even distribution", group, &S::on),
                  with({"on", {"true"}}, option("coefficient", "1", "0.25", between(0, 1),
                                                "displacement = -coefficient h^2 grad C", group, &S::coefficient)),
                  with({"on", {"true"}},
                       option("limit", "h", "0.1", above_up_to(0, 0.5),
                              "largest displacement per step of up to courant 0.2, longer steps in proportion", group,
                              &S::limit)),
                  with({"on", {"true"}}, option("remove_drift", "", "true", {},
                                                "subtract what neighbours share of the shift: no net transport", group,
                                                &S::remove_drift)),
                  with({"on", {"true"}},
                       word_option("velocity_correction", "\"first-order\"",
                                   "Taylor terms that give the velocity at the new place; the first is bounded by the "
                                   "neighbours' velocities",
                                   group, &S::velocity_correction,
                                   {{"none", ShiftCorrection::none},
                                    {"first-order", ShiftCorrection::first_order},
                                    {"second-order", ShiftCorrection::second_order}})),
              },
          .methods = {"les-sph"}};
}

Section surface() {
  const auto group = &Case::surface;
  using S = SurfaceOptions;
  return {
      .name = "surface",
      .options =
          {
              option("threshold", "1", "0.0", between(0, 3),
                     "div r below which a particle is on the surface; 0: 2.3 in 3-D, 1.5 in 2-D", group, &S::threshold),
              option("blend_width", "1", "0.32", between(0, 1), "span of div r over which pressure rows blend", group,
                     &S::blend_width),
          },
      .methods = {"les-sph"}};
}

Section time() {
  const auto group = &Case::time;
  using T = TimeOptions;
  Option end{.key = "end",
             .type = OptionType::number,
             .unit = "time",
             .required = true,
             .range = positive(),
             .description = "time at which the run ends",
             .set = set(group, &T::end)};
  return {.name = "time",
          .options = {
              end,
              {.key = "courant",
               .type = OptionType::number,
               .unit = "1",
               .absent = "0.2, with a free surface 0.3; rk3 without particles 0.5, rk4 0.9",
               .chosen = [](const Draft& d) { return shortest(d.options.time.courant); },
               .range = above_up_to(0, 1),
               .description = "step limit by speed: Courant number",
               .set = set(group, &T::courant)},
              option("centred", "", "true", {}, "velocities free of divergence half a step ahead: second order in time",
                     group, &T::centred, {"les-sph"}),
              option("viscous", "1", "0.2", above_up_to(0, 0.3),
                     "step limit by viscosity, eddy viscosity included; a third of it with div(2 nu S)", group,
                     &T::viscous, {"les-sph"}),
              option("max_step", "time", "0.0", not_negative(), "largest step; 0: none", group, &T::max_step),
              option("max_retries", "", "6", between(0, 30), "halvings of a refused step before the run gives up",
                     group, &T::max_retries),
          }};
}

Section output() {
  const auto group = &Case::output;
  using O = OutputOptions;
  return {
      .name = "output",
      .options = {
          option("every", "time", "0.0", not_negative(), "snapshot interval; 0: start and end only", group, &O::every),
          option("series_every", "time", "0.0", not_negative(), "interval of series.csv; 0: every step", group,
                 &O::series_every),
          option("checkpoint_every", "s of wall time", "300.0", not_negative(), "checkpoint interval", group,
                 &O::checkpoint_every),
          option("spectrum_every", "time", "0.0", not_negative(), "interval of energy spectra; 0: none", group,
                 &O::spectrum_every),
          option("fields", "", "[]", {}, "fields of a snapshot; empty: the method's standard set", group, &O::fields),
          option("h5part_view", "", "true", {}, "let ParaView's H5Part reader open the snapshots too", group,
                 &O::h5part_view),
      }};
}

Section probe() {
  return {
      .name = "probe",
      .repeated = true,
      .begin_entry = [](Draft& d) { d.probes.emplace_back(); },
      .options = {
          {.key = "name",
           .type = OptionType::string,
           .required = true,
           .description = "name of its columns in probes.csv",
           .set = [](Draft& d, const Value& v) { d.probes.back().options.name = v.text; }},
          {.key = "kind",
           .type = OptionType::word,
           .default_text = "\"point\"",
           .words = {"point", "elevation", "wetted", "front", "line", "plane"},
           .description = "what is recorded; elevation: height of the uppermost liquid above a foot, wetted: length of "
                          "the vertical through it that lies in liquid, as a wire gauge measures it, plane: area of "
                          "the liquid on a plane across the domain and averages of velocity and pressure over it",
           .set =
               [](Draft& d, const Value& v) {
                 d.probes.back().options.kind = v.text == "point"       ? ProbeKind::point
                                                : v.text == "elevation" ? ProbeKind::elevation
                                                : v.text == "wetted"    ? ProbeKind::wetted
                                                : v.text == "front"     ? ProbeKind::front
                                                : v.text == "line"      ? ProbeKind::line
                                                                        : ProbeKind::plane;
               }},
          {.key = "position",
           .type = OptionType::numbers,
           .unit = "length",
           .absent = "required but for front",
           .description = "point; foot of the column (elevation, wetted); start of a line; a point of a plane, or its "
                          "coordinate along the normal alone",
           .set = [](Draft& d, const Value& v) { d.probes.back().position = v.numbers; }},
          {.key = "end",
           .type = OptionType::numbers,
           .unit = "length",
           .absent = "required for line",
           .description = "end of a line",
           .set = [](Draft& d, const Value& v) { d.probes.back().end = v.numbers; },
           .needs = {"kind", {"line"}}},
          {.key = "samples",
           .type = OptionType::integer,
           .default_text = "2",
           .range = between(2, 1e6),
           .description = "points of a line, ends included",
           .set = [](Draft& d, const Value& v) { d.probes.back().options.samples = static_cast<int>(v.integer); },
           .needs = {"kind", {"line"}}},
          {.key = "axis",
           .type = OptionType::word,
           .default_text = "\"x\"",
           .words = {"x", "y", "z"},
           .description = "front: axis along which the liquid's largest coordinate is sought; plane: its normal",
           .set = [](Draft& d, const Value& v) { d.probes.back().options.axis = v.text[0] - 'x'; },
           .needs = {"kind", {"front", "plane"}}},
          {.key = "height",
           .type = OptionType::number,
           .unit = "length",
           .absent = "top of the domain",
           .description = "front: looks below this height",
           .set = [](Draft& d, const Value& v) { d.probes.back().height = v.number; },
           .needs = {"kind", {"front"}}},
      }};
}

Section verify() {
  return {.name = "verify",
          .options = {{.key = "*",
                       .type = OptionType::free_table,
                       .absent = "none",
                       .description = "references and bounds for `spume verify`"}}};
}

}  // namespace

std::vector<Section> method_sections() {
  return {turbulence(), pressure(), shifting(), surface(), time(), output(), probe(), verify()};
}

}  // namespace spume
