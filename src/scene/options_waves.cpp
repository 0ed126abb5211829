// SPDX-License-Identifier: MIT
// Options of [[wavemaker]] and [[sponge]].
#include "scene_sections.hpp"

namespace spume {
namespace {

Section wavemaker() {
  using W = WavemakerDraft;
  return repeated_section<W>("wavemaker", &Draft::wavemakers)
      .word("side", &W::side, {{"left", "left"}, {"right", "right"}}, "wall of the domain that moves")
      .required()
      .word("kind", &W::kind, {{"piston", WavemakerKind::piston}, {"flap", WavemakerKind::flap}},
            "how it moves: piston: along its normal; flap: a wall of its own that turns about a hinge at the bed")
      .word("waves", &W::waves,
            {{"none", WaveKind::none},
             {"regular", WaveKind::regular},
             {"jonswap", WaveKind::jonswap},
             {"focused", WaveKind::focused},
             {"solitary", WaveKind::solitary}},
            "waves that it makes; focused: the crests of a JONSWAP spectrum meet; none: a piston that only absorbs")
      .required()
      .option("height", &W::height, "length", positive(), "wave height; of jonswap the significant one")
      .when("waves", {"regular", "jonswap", "solitary"})
      .absent("none; required of waves but focused ones")
      .option("amplitude", &W::amplitude, "length", positive(),
              "height above still water at the focus, by linear theory")
      .when("waves", {"focused"})
      .absent("none; required for focused waves")
      .option("period", &W::period, "time", positive(), "wave period; of jonswap and focused that of the peak")
      .when("waves", {"none", "regular", "jonswap", "focused"})
      .absent("none; required of waves but solitary ones")
      .option("gamma", &W::gamma, "1", between(1, 20), "peak enhancement; 1: Pierson and Moskowitz")
      .when("waves", {"jonswap", "focused"})
      .option("components", &W::components, "", between(10, 10000), "waves that represent the spectrum")
      .when("waves", {"jonswap", "focused"})
      .option("seed", &W::seed, "", between(0, 4294967295),
              "another number gives other frequencies and phases at the same seed of the case")
      .when("waves", {"jonswap"})
      .option("focus_place", &W::focus_place, "length", "x where the crests meet")
      .when("waves", {"focused"})
      .absent("none; required for focused waves")
      .option("focus_time", &W::focus_time, "time", positive(), "when they meet")
      .when("waves", {"focused"})
      .absent("none; required for focused waves")
      .option("depth", &W::depth, "length", positive(), "depth of still water")
      .absent("that of the liquid beside the wall; required for a flap")
      .option("hinge", &W::hinge, "length", "x of the hinge, and of the flap at rest")
      .when("kind", {"flap"})
      .absent("as near to the side as it can swing")
      .option("ramp", &W::ramp, "time", not_negative(), "time over which the motion grows from rest")
      .when("waves", {"regular", "jonswap", "focused"})
      .absent("two periods")
      .option("order", &W::order, "", between(0, 2), "order of the theory: 1 or 2; 0: 2, of up to 300 components")
      .when("waves", {"regular", "jonswap", "focused"})
      .word(
          "absorption", &W::absorption,
          {{"none", AbsorptionKind::none}, {"tuned", AbsorptionKind::tuned}, {"long-wave", AbsorptionKind::long_wave}},
          "how a piston takes up waves that come to it: tuned: all of those of the period, without one that of the "
          "first wavemaker with one, else as long-wave; long-wave: by shallow-water theory")
      .only(absorbs_waves)
      .when("kind", {"piston"})
      .whole_only(uses_particles);
}

Section sponge() {
  using S = SpongeDraft;
  return repeated_section<S>("sponge", &Draft::sponges)
      .word("side", &S::side, side_words(), "side of the domain at which the velocity is damped")
      .required()
      .option("length", &S::length, "length", positive(), "thickness of the layer, from the side inwards")
      .required()
      .option("strength", &S::strength, "1/time", positive(), "rate of damping at the side; falls to 0 as a square")
      .absent("three times the lowest angular frequency of the wavemakers")
      .option("velocity", &S::velocity, "length/time", "velocity that the liquid is damped to")
      .absent("at rest")
      .whole_only(damps_sponges);
}

}  // namespace

std::vector<Section> wave_sections() {
  return {wavemaker(), sponge()};
}

}  // namespace spume
