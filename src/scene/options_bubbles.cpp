// SPDX-License-Identifier: MIT
// Options of the bubbles: gas, models, and where bubbles come from.
#include "option_builders.hpp"

namespace spume {
namespace {

Option gas_option(const char* key, const char* unit, const char* absent, const char* description,
                  std::optional<double> BubbleDraft::*member) {
  return {.key = key,
          .type = OptionType::number,
          .unit = unit,
          .absent = absent,
          .range = positive(),
          .description = description,
          .set = [member](Draft& d, const Value& v) { d.bubbles.*member = v.number; }};
}

Section bubbles() {
  const auto group = &Case::bubbles;
  using B = BubbleOptions;
  Section section{
      .name = "bubbles",
      .options = {
          gas_option("weber", "1", "required for entrainment, breakup and a free surface", "Weber number",
                     &BubbleDraft::weber),
          gas_option("surface_tension", "N/m", "groups: weber", "surface tension, in place of weber in SI",
                     &BubbleDraft::surface_tension),
          gas_option("density_ratio", "1", "1000 / 1.2", "density of the liquid over that of the gas",
                     &BubbleDraft::density_ratio),
          gas_option("gas_density", "kg/m3", "density_ratio", "density of the gas, in place of density_ratio in SI",
                     &BubbleDraft::gas_density),
          option("entrainment", "", "false", {}, "bubbles are made at the surface where the liquid dissipates", group,
                 &B::entrainment),
          option("breakup", "", "false", {}, "turbulence splits bubbles", group, &B::breakup),
          option("fluctuations", "", "false", {}, "unresolved velocity that bubbles feel, by a Langevin equation",
                 group, &B::fluctuations),
          option("surface_interaction", "", "true", {}, "bubbles brake below a free surface, rest and burst", group,
                 &B::surface_interaction),
          option("fluid_inertia", "", "false", {}, "force of the accelerating liquid, beta V Du/Dt", group,
                 &B::fluid_inertia),
          word_option("integrator", "\"stable\"", "stable: any step; substep: explicit, spacing / radius sub-steps",
                      group, &B::integrator,
                      {{"stable", BubbleIntegrator::stable}, {"substep", BubbleIntegrator::substep}}),
          word_option("momentum_form", "\"mixture-pressure\"",
                      "pressure force on the liquid: -grad(alpha p) or -alpha grad p", group, &B::momentum_form,
                      {{"mixture-pressure", MomentumForm::mixture_pressure}, {"two-fluid", MomentumForm::two_fluid}}),
          word_option("surface_reaction", "\"surface\"",
                      "who holds the bubbles that brake below a surface: surface, which the liquid does not feel, or "
                      "the liquid around them, King (3.33)",
                      group, &B::surface_reaction,
                      {{"surface", SurfaceReaction::surface}, {"liquid", SurfaceReaction::liquid}}),
          option("lift_coefficient", "1", "0.5", between(-10, 10), "C_l", group, &B::lift_coefficient),
          option("virtual_mass_coefficient", "1", "0.5", between(0, 10), "C_vm", group, &B::virtual_mass_coefficient),
          option("viscosity_constant", "1", "0.6", between(0, 10), "of the bubble-induced viscosity (Sato & Sekoguchi)",
                 group, &B::viscosity_constant),
          with({"fluctuations", {"true"}},
               option("fluctuation_constant", "1", "1.0", above_up_to(0, 100), "of the time scale of the fluctuations",
                      group, &B::fluctuation_constant)),
          with({"entrainment", {"true"}},
               option("entrainment_constant", "1", "0.01", between(0, 1),
                      "C_eps: dissipation spent on surface, per beta", group, &B::entrainment_constant)),
          with({"entrainment", {"true"}},
               option("entrainment_threshold", "length2/time3", "0.2", not_negative(),
                      "unresolved dissipation above which bubbles are entrained", group, &B::entrainment_threshold)),
          with({"entrainment", {"true"}},
               word_option(
                   "entrainment_overdraft", "\"affordable\"",
                   "chance of a bubble that costs more than is left: affordable: left / cost; printed: 1 - left "
                   "/ cost, King section 3.4.1",
                   group, &B::entrainment_overdraft,
                   {{"affordable", EntrainmentOverdraft::affordable}, {"printed", EntrainmentOverdraft::printed}})),
          with({"breakup", {"true"}}, option("deformation_constant", "1", "8.2", positive(), "c_def of breakup", group,
                                             &B::deformation_constant)),
          option("schmidt", "1", "700.0", positive(), "Schmidt number of the persistence at the surface", group,
                 &B::schmidt),
          gas_option("hinze_radius", "length", "We^(-3/5) / 2",
                     "radius that divides the counts of series.csv; without tension none do",
                     &BubbleDraft::hinze_radius),
          with({"entrainment", {"true"}},
               gas_option("smallest_entrained_radius", "length", "hinze_radius / 20",
                          "smallest bubble that is entrained", &BubbleDraft::smallest_entrained_radius)),
          option("trace_every", "", "0", between(0, 1e9),
                 "bubble_traces.csv follows bubbles whose id is a multiple of this; 0: none", group, &B::trace_every),
          option("trace_interval", "time", "0.0", not_negative(), "interval of the traces; 0: with every step", group,
                 &B::trace_interval),
      }};
  section.optional = true;
  return section;
}

// The sizes that a source draws from; `sizes` picks them in the entry being read.
template <class Sizes>
void add_sizes(std::vector<Option>& options, Sizes sizes) {
  options.push_back({.key = "sizes",
                     .type = OptionType::word,
                     .default_text = "\"monodisperse\"",
                     .words = {"monodisperse", "truncated-gaussian", "log-normal"},
                     .description = "law of the radii",
                     .set = [sizes](Draft& d, const Value& v) {
                       sizes(d).law = v.text == "monodisperse"         ? SizeLaw::monodisperse
                                      : v.text == "truncated-gaussian" ? SizeLaw::truncated_gaussian
                                                                       : SizeLaw::log_normal;
                     }});
  options.push_back({.key = "bubble_radius",
                     .type = OptionType::number,
                     .unit = "length",
                     .required = true,
                     .range = positive(),
                     .description = "radius; mean before truncation of a Gaussian, median of a log-normal law",
                     .set = [sizes](Draft& d, const Value& v) { sizes(d).mean = v.number; }});
  options.push_back({.key = "deviation",
                     .type = OptionType::number,
                     .unit = "length, or 1 of log a",
                     .default_text = "0.0",
                     .range = not_negative(),
                     .description = "standard deviation of the radius before truncation, or of log a",
                     .set = [sizes](Draft& d, const Value& v) { sizes(d).deviation = v.number; }});
  options.push_back({.key = "smallest",
                     .type = OptionType::number,
                     .unit = "length",
                     .absent = "bubble_radius / 10",
                     .range = positive(),
                     .description = "smallest radius of a law with a deviation",
                     .set = [sizes](Draft& d, const Value& v) { sizes(d).minimum = v.number; }});
  options.push_back({.key = "largest",
                     .type = OptionType::number,
                     .unit = "length",
                     .absent = "the spacing",
                     .range = positive(),
                     .description = "largest radius of a law with a deviation",
                     .set = [sizes](Draft& d, const Value& v) { sizes(d).maximum = v.number; }});
}

Section sparger() {
  Section section{.name = "sparger",
                  .repeated = true,
                  .begin_entry = [](Draft& d) { d.bubbles.spargers.emplace_back(); },
                  .options = {
                      {.key = "shape",
                       .type = OptionType::word,
                       .default_text = "\"point\"",
                       .words = {"point", "disc", "line"},
                       .description = "where bubbles leave it; a disc is horizontal",
                       .set =
                           [](Draft& d, const Value& v) {
                             d.bubbles.spargers.back().sparger.shape = v.text == "point"  ? SpargerShape::point
                                                                       : v.text == "disc" ? SpargerShape::disc
                                                                                          : SpargerShape::line;
                           }},
                      {.key = "position",
                       .type = OptionType::numbers,
                       .unit = "length",
                       .required = true,
                       .description = "point, centre of the disc, start of the line",
                       .set = [](Draft& d, const Value& v) { d.bubbles.spargers.back().position = v.numbers; }},
                      {.key = "radius",
                       .type = OptionType::number,
                       .unit = "length",
                       .absent = "required for disc",
                       .range = positive(),
                       .description = "radius of the disc",
                       .set = [](Draft& d, const Value& v) { d.bubbles.spargers.back().sparger.radius = v.number; }},
                      {.key = "end",
                       .type = OptionType::numbers,
                       .unit = "length",
                       .absent = "required for line",
                       .description = "end of the line",
                       .set = [](Draft& d, const Value& v) { d.bubbles.spargers.back().end = v.numbers; }},
                      {.key = "rate",
                       .type = OptionType::expression,
                       .unit = "length3/time",
                       .required = true,
                       .description = "gas volume per time: an expression of t",
                       .set = [](Draft& d, const Value& v) { d.bubbles.spargers.back().rate = v.expression; }},
                  }};
  add_sizes(section.options, [](Draft& d) -> BubbleSizes& { return d.bubbles.spargers.back().sparger.sizes; });
  return section;
}

Section cloud() {
  Section section{.name = "bubble_cloud",
                  .repeated = true,
                  .begin_entry = [](Draft& d) { d.bubbles.clouds.emplace_back(); },
                  .options = {
                      {.key = "lower",
                       .type = OptionType::numbers,
                       .unit = "length",
                       .absent = "the domain",
                       .description = "lower corner of a box",
                       .set = [](Draft& d, const Value& v) { d.bubbles.clouds.back().lower = v.numbers; }},
                      {.key = "upper",
                       .type = OptionType::numbers,
                       .unit = "length",
                       .absent = "the domain",
                       .description = "upper corner of a box",
                       .set = [](Draft& d, const Value& v) { d.bubbles.clouds.back().upper = v.numbers; }},
                      {.key = "centre",
                       .type = OptionType::numbers,
                       .unit = "length",
                       .absent = "no ball",
                       .description = "centre of a ball, in place of a box",
                       .set = [](Draft& d, const Value& v) { d.bubbles.clouds.back().centre = v.numbers; }},
                      {.key = "radius",
                       .type = OptionType::number,
                       .unit = "length",
                       .absent = "0: at the centre",
                       .range = not_negative(),
                       .description = "radius of the ball",
                       .set = [](Draft& d, const Value& v) { d.bubbles.clouds.back().radius = v.number; }},
                      {.key = "number",
                       .type = OptionType::integer,
                       .default_text = "1",
                       .range = between(1, 1e8),
                       .description = "how many bubbles",
                       .set = [](Draft& d, const Value& v) { d.bubbles.clouds.back().cloud.number = v.integer; }},
                      {.key = "time",
                       .type = OptionType::number,
                       .unit = "time",
                       .default_text = "0.0",
                       .range = not_negative(),
                       .description = "when they appear, at rest relative to the liquid",
                       .set = [](Draft& d, const Value& v) { d.bubbles.clouds.back().cloud.time = v.number; }},
                  }};
  add_sizes(section.options, [](Draft& d) -> BubbleSizes& { return d.bubbles.clouds.back().cloud.sizes; });
  return section;
}

}  // namespace

std::vector<Section> bubble_sections() {
  std::vector<Section> sections{bubbles(), sparger(), cloud()};
  for (Section& section : sections) section.methods = {"les-sph"};
  return sections;
}

}  // namespace spume
