// SPDX-License-Identifier: MIT
// The sections that the scene declares itself.
#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "spume/scene/method_declaration.hpp"

namespace spume {

std::vector<Section> scene_sections();  // title ... forces
Section body_section();
// Names of the sides of a domain, as an option takes them.
inline const auto& side_words() {
  static const std::initializer_list<std::pair<const char*, std::string>> words = {
      {"left", "left"}, {"right", "right"}, {"front", "front"}, {"back", "back"}, {"bottom", "bottom"}, {"top", "top"}};
  return words;
}
std::vector<Section> wave_sections();     // wavemaker, sponge
std::vector<Section> opening_sections();  // inflow, outflow
// time, output, probes, verify; `default_courant` says what a case without time.courant gets.
std::vector<Section> run_sections(const std::string& default_courant);

}  // namespace spume
