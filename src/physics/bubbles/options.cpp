// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/options.hpp"

#include "draft.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/expression.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

// A value of the gas that the checks complete from others. The declaration of an option asks an empty draft, which has
// no groups yet, for its default.
auto gas(std::optional<double> BubbleDraft::*value) {
  return [value](Draft& d) -> std::optional<double>& {
    d.options.declare<BubbleDraft>();
    return bubbles_of(d).*value;
  };
}

// Defaults: C_l = C_vm = 0.5 of Derakhti & Kirby (2014), below King (2.10); 0.6 of Sato & Sekoguchi, King (2.23);
// C_eps = 0.01 and the threshold 0.2, King section 3.4.1; c_def = 8.2 of Batchelor (1953), King (3.24); Sc = 700, sea
// water at 20 C, King (3.34); hinze_radius / 20, King section 3.4.1.
Section bubbles_section() {
  using B = BubbleOptions;
  using D = BubbleDraft;
  SectionOf<B> section = spume::section<B>("bubbles");
  section.declare = [](Case& options) {
    options.declare<BubbleOptions>();
    options.declare<BubbleDraft>();
    options.declare<BubbleSources>();
  };
  return section.option("weber", gas(&D::weber), "1", positive(), "Weber number")
      .absent("required for entrainment, breakup and a free surface")
      .option("surface_tension", gas(&D::surface_tension), "N/m", positive(),
              "surface tension, in place of weber in SI")
      .absent("groups: weber")
      .option("density_ratio", gas(&D::density_ratio), "1", positive(), "density of the liquid over that of the gas")
      .absent(brief(B{}.density_ratio) + ", water over air")
      .option("gas_density", gas(&D::gas_density), "kg/m3", positive(),
              "density of the gas, in place of density_ratio in SI")
      .absent("density_ratio")
      .option("entrainment", &B::entrainment, "air entrainment at the free surface, from the unresolved dissipation")
      .option("breakup", &B::breakup, "breakup of bubbles by turbulence")
      .option("fluctuations", &B::fluctuations, "unresolved velocity fluctuations at bubbles, by a Langevin equation")
      .option("surface_interaction", &B::surface_interaction,
              "deceleration below a free surface, persistence there, bursting")
      .option("fluid_inertia", &B::fluid_inertia, "fluid inertia force beta V Du/Dt")
      .word("integrator", &B::integrator,
            {{"stable", BubbleIntegrator::stable}, {"substep", BubbleIntegrator::substep}},
            "stable: stable at any step; substep: explicit, spacing / radius sub-steps")
      .word("momentum_form", &B::momentum_form,
            {{"mixture-pressure", MomentumForm::mixture_pressure}, {"two-fluid", MomentumForm::two_fluid}},
            "pressure force on the liquid: -grad(alpha p) or -alpha grad p")
      .word(
          "surface_reaction", &B::surface_reaction,
          {{"surface", SurfaceReaction::surface}, {"liquid", SurfaceReaction::liquid}},
          "what bears the reaction to the surface force on a bubble: the surface, without effect on the liquid, or the "
          "liquid around the bubble, King (3.33)")
      .option("lift_coefficient", &B::lift_coefficient, "1", between(-10, 10), "lift coefficient C_l")
      .option("virtual_mass_coefficient", &B::virtual_mass_coefficient, "1", between(0, 10),
              "virtual mass coefficient C_vm")
      .option("viscosity_constant", &B::viscosity_constant, "1", between(0, 10),
              "constant of the bubble-induced viscosity (Sato & Sekoguchi)")
      .option("fluctuation_constant", &B::fluctuation_constant, "1", above_up_to(0, 100),
              "constant of the time scale of the fluctuations")
      .when("fluctuations", {"true"})
      .option("entrainment_constant", &B::entrainment_constant, "1", between(0, 1),
              "C_eps: dissipation that forms bubble surface, per beta")
      .when("entrainment", {"true"})
      .option("entrainment_threshold", &B::entrainment_threshold, "length2/time3", not_negative(),
              "unresolved dissipation above which bubbles are entrained")
      .when("entrainment", {"true"})
      .word(
          "entrainment_overdraft", &B::entrainment_overdraft,
          {{"affordable", EntrainmentOverdraft::affordable}, {"printed", EntrainmentOverdraft::printed}},
          "probability of a bubble that needs more than the remaining energy; affordable: remaining / needed; printed: "
          "1 - remaining / needed, King section 3.4.1")
      .when("entrainment", {"true"})
      .option("deformation_constant", &B::deformation_constant, "1", positive(),
              "deformation constant c_def of breakup")
      .when("breakup", {"true"})
      .option("schmidt", &B::schmidt, "1", positive(), "Schmidt number of the persistence time at the surface")
      .option("hinze_radius", gas(&D::hinze_radius), "length", positive(),
              "radius at which series.csv divides the counts; without surface tension it has no such counts")
      .absent("We^(-3/5) / 2")
      .option("smallest_entrained_radius", gas(&D::smallest_entrained_radius), "length", positive(),
              "smallest bubble that is entrained")
      .absent("hinze_radius / 20")
      .when("entrainment", {"true"})
      .option("trace_every", &B::trace_every, "", between(0, 1e9),
              "bubble_traces.csv follows bubbles whose id is a multiple of this; 0: none")
      .option("trace_interval", &B::trace_interval, "time", not_negative(),
              "interval of the traces; 0: with every step")
      .whole_optional();
}

// The sizes that a source draws from; `sizes` finds them in an entry.
template <class Source, class Sizes>
void add_sizes(SectionOf<Source>& section, Sizes sizes) {
  const auto radius = [sizes](double BubbleSizes::*value) {
    return [sizes, value](Source& source) -> double& { return sizes(source).*value; };
  };
  section
      .word(
          "sizes", [sizes](Source& source) -> SizeLaw& { return sizes(source).law; },
          {{"monodisperse", SizeLaw::monodisperse},
           {"truncated-gaussian", SizeLaw::truncated_gaussian},
           {"log-normal", SizeLaw::log_normal}},
          "law of the radii")
      .option("bubble_radius", radius(&BubbleSizes::mean), "length", positive(),
              "radius; mean before truncation of a Gaussian, median of a log-normal law")
      .required()
      .option("deviation", radius(&BubbleSizes::deviation), "length, or 1 of log a", not_negative(),
              "standard deviation of the radius before truncation, or of log a")
      .option("smallest", radius(&BubbleSizes::minimum), "length", positive(),
              "smallest radius of a law with a deviation")
      .absent("bubble_radius / 10")
      .option("largest", radius(&BubbleSizes::maximum), "length", positive(),
              "largest radius of a law with a deviation")
      .absent("the spacing");
}

void make_spargers(Draft& draft, const CompileExpression& compile) {
  for (std::size_t k = 0; k < bubbles_of(draft).spargers.size(); ++k) {
    const SpargerDraft& given = bubbles_of(draft).spargers[k];
    Sparger sparger = given.sparger;
    sparger.position = to_vec3(given.position);
    sparger.end = to_vec3(given.end);
    if (given.rate)
      sparger.rate = compile(*given.rate, "sparger." + std::to_string(k) + ".rate", Arguments::place_and_time);
    draft.options.get<BubbleSources>().spargers.push_back(std::move(sparger));
  }
}

void make_clouds(Draft& draft, const CompileExpression& /*compile*/) {
  for (const BubbleCloudDraft& given : bubbles_of(draft).clouds) {
    BubbleCloud cloud = given.cloud;
    cloud.lower = to_vec3(given.lower.empty() ? draft.lower : given.lower);
    cloud.upper = to_vec3(given.upper.empty() ? draft.upper : given.upper);
    cloud.ball = !given.centre.empty();
    cloud.centre = to_vec3(given.centre);
    cloud.radius = given.radius.value_or(0);
    draft.options.get<BubbleSources>().clouds.push_back(cloud);
  }
}

Section sparger() {
  using S = SpargerDraft;
  auto section = repeated_section<S>("sparger", [](Draft& d) -> std::vector<S>& { return bubbles_of(d).spargers; });
  section
      .word(
          "shape", [](S& s) -> SpargerShape& { return s.sparger.shape; },
          {{"point", SpargerShape::point}, {"disc", SpargerShape::disc}, {"line", SpargerShape::line}},
          "shape of the source; a disc is horizontal")
      .option("position", &S::position, "length", "point, centre of the disc, start of the line")
      .required()
      .option(
          "radius", [](S& s) -> double& { return s.sparger.radius; }, "length", positive(), "radius of the disc")
      .absent("required for disc")
      .option("end", &S::end, "length", "end of the line")
      .absent("required for line")
      .option("rate", &S::rate, "length3/time", "volume flow rate of gas: an expression of t")
      .required();
  add_sizes(section, [](S& s) -> BubbleSizes& { return s.sparger.sizes; });
  section.compile = make_spargers;
  return section;
}

Section cloud() {
  using C = BubbleCloudDraft;
  auto section = repeated_section<C>("bubble_cloud", [](Draft& d) -> std::vector<C>& { return bubbles_of(d).clouds; });
  section.option("lower", &C::lower, "length", "lower corner of a box")
      .absent("the domain")
      .option("upper", &C::upper, "length", "upper corner of a box")
      .absent("the domain")
      .option("centre", &C::centre, "length", "centre of a ball, in place of a box")
      .absent("no ball")
      .option("radius", &C::radius, "length", not_negative(), "radius of the ball")
      .absent("0: at the centre")
      .option(
          "number", [](C& c) -> std::int64_t& { return c.cloud.number; }, "", between(1, most_bubbles_of_a_cloud),
          "number of bubbles")
      .option(
          "time", [](C& c) -> double& { return c.cloud.time; }, "time", not_negative(),
          "time of release, at rest relative to the liquid");
  add_sizes(section, [](C& c) -> BubbleSizes& { return c.cloud.sizes; });
  section.compile = make_clouds;
  return section;
}

}  // namespace

std::vector<Section> bubble_sections() {
  return {bubbles_section(), sparger(), cloud()};
}

}  // namespace spume
