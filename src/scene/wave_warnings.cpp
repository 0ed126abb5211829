// SPDX-License-Identifier: MIT
// Waves that break or are beyond the theory, and what damps or absorbs too little.
#include <cmath>
#include <numbers>

#include "checks.hpp"
#include "spume/scene/option.hpp"
#include "spume/scene/wave_absorption.hpp"
#include "wavemakers.hpp"

namespace spume {
namespace {

using std::numbers::pi;

class WarnOfWaves {
 public:
  WarnOfWaves(const Draft& draft, const Scene& scene, const std::string& file)
      : draft_(draft), scene_(scene), file_(file) {}

  void maker(const Wavemaker& maker, const WavemakerDraft& draft) {
    if (maker.height > 0) height(maker, draft);
    if (draft.order == 0 && draft.components > most_of_second_order &&
        (draft.waves == WaveKind::jonswap || draft.waves == WaveKind::focused)) {
      const Node* components = draft_.node(maker.name + ".components");
      warn(components != nullptr ? *components : *draft_.node(maker.name),
           maker.name + ".components is " + std::to_string(draft.components) + ", and above " +
               std::to_string(most_of_second_order) +
               " the motion is of first order: free waves go with the bound ones; lower it, or set  order = 1  to say "
               "so");
    }
    if (maker.absorbs && maker.wavenumber > 0 && draft.waves != WaveKind::solitary) absorption(maker, draft);
    // The surface is known to half a spacing.
    if (std::abs(maker.depth - maker.still_depth) > scene_.spacing / 2)
      warn(*draft_.node(maker.name + ".depth"), maker.name + ".depth is " + brief(maker.depth) +
                                                    ", and the liquid beside the wall is " + brief(maker.still_depth) +
                                                    " deep; remove the key to take that");
  }

  // The limits are those of McCowan (1894) for a solitary wave and of Miche (1944) for periodic ones.
  void height(const Wavemaker& maker, const WavemakerDraft& draft) {
    const Node* height = draft_.node(maker.name + (draft.waves == WaveKind::focused ? ".amplitude" : ".height"));
    const std::string what = draft.waves == WaveKind::jonswap   ? "the significant wave height "
                             : draft.waves == WaveKind::focused ? "twice the amplitude, "
                                                                : "the wave height ";
    const double kh = maker.wavenumber * maker.depth, steepness = maker.height * maker.wavenumber / (2 * pi);
    constexpr double highest = 0.78, steepest = 0.14;
    if (maker.height > highest * maker.depth)
      warn(*height, what + brief(maker.height) + " is " + brief(maker.height / maker.depth) +
                        " of the depth; waves break above " + brief(highest) + ": lower it");
    else if (draft.waves != WaveKind::solitary && steepness > steepest * std::tanh(kh))
      warn(*height, what + brief(maker.height) + " is " + brief(steepness) +
                        " of the wavelength; waves break above 0.14 tanh kh = " + brief(steepest * std::tanh(kh)) +
                        ": lower it, or make the period longer");
    if (takes_second_order(draft) && madsen_number(maker.height, maker.wavenumber, maker.depth) > 1)
      warn(*height, "waves of height " + brief(maker.height) +
                        " are too long for second-order theory: H L^2 / h^3 is " +
                        brief(8 * pi * pi / 3 * madsen_number(maker.height, maker.wavenumber, maker.depth)) +
                        " and should be below 8 pi^2 / 3 = 26.3; free waves will go with them: lower the height or "
                        "the period");
  }

  // Below a wavelength of four depths much of what a piston pushes up stays before it.
  void absorption(const Wavemaker& maker, const WavemakerDraft& draft) {
    constexpr double most = 0.3;
    const WaveAbsorption& of = *scene_.domain.sides[0][maker.side == "left" ? 0 : 1].absorption;
    const double share = std::abs(reflection(of.law, face_of(maker, scene_), maker.angular_frequency));
    if (share > most)
      warn(*draft_.node(maker.name + ".absorption"),
           maker.name + " sends back " + brief(100 * share) + " % of waves of period " +
               brief(2 * pi / maker.angular_frequency) +
               (draft.absorption == AbsorptionKind::long_wave ? "; take  absorption = \"tuned\""
                                                              : "; they are too short for a piston to absorb"));
  }

  void sponge(const Sponge& sponge, std::size_t k, const Wavemaker& maker) {
    if (!(maker.wavenumber > 0)) return;
    const double length = 2 * pi / maker.wavenumber;
    const std::string name = entry("sponge", k);
    if (sponge.axis == 0 && draft_.sponges[k].side == maker.side)
      warn(*draft_.node(name + ".side"),
           name + " damps the waves where " + maker.name + " makes them; put it at the other end");
    else if (sponge.length < length / 2)
      warn(*draft_.node(name + ".length"), name + ".length is " + brief(sponge.length / length) +
                                               " wavelengths; below 0.5 more than 6 % of a wave comes back: make it " +
                                               brief(length) + " or longer");
  }

  std::vector<Problem> warnings;

 private:
  void warn(const Node& node, const std::string& text) {
    warnings.push_back(node.override_text.empty() ? Problem{file_, node.place.line, node.place.column, text}
                                                  : Problem{node.override_text, 0, 0, text});
  }
  const Draft& draft_;
  const Scene& scene_;
  const std::string& file_;
};

}  // namespace

std::vector<Problem> wave_warnings(const Draft& draft, const Scene& scene, const std::vector<Wavemaker>& wavemakers,
                                   const std::string& file) {
  WarnOfWaves of(draft, scene, file);
  for (std::size_t k = 0; k < wavemakers.size(); ++k) of.maker(wavemakers[k], draft.wavemakers[k]);
  for (std::size_t k = 0; k < scene.sponges.size(); ++k)
    for (const Wavemaker& maker : wavemakers) of.sponge(scene.sponges[k], k, maker);
  return std::move(of.warnings);
}

}  // namespace spume
