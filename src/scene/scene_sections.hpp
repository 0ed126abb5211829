// SPDX-License-Identifier: MIT
// The sections that the scene declares itself.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "spume/scene/method_declaration.hpp"

namespace spume {

std::vector<Section> scene_sections();  // title ... forces
Section body_section();
// Names of the sides of a domain, as an option takes them.
inline std::vector<std::pair<std::string, std::string>> side_words() {
  std::vector<std::pair<std::string, std::string>> words;
  for (const char* side : {"left", "right", "front", "back", "bottom", "top"}) words.emplace_back(side, side);
  return words;
}
std::vector<Section> wave_sections();     // wavemaker, sponge
std::vector<Section> opening_sections();  // inflow, outflow
// time, output, probes, verify; `default_courant` says what a case without time.courant gets.
std::vector<Section> run_sections(const std::string& default_courant);

}  // namespace spume
