// SPDX-License-Identifier: MIT
#include "spume/particles/phase_law.hpp"

#include <algorithm>

#include "spume/scene/document.hpp"

namespace spume {
namespace {

// Sound is ten times as fast as the flow: the density changes by Ma^2 = 1 % (Monaghan 1994, Morris et al. 1997).
constexpr double sound_over_speed = 10;
// Monaghan (1994), Colagrossi and Landrini (2003).
constexpr double gas_exponent = 1.4;

}  // namespace

std::vector<PhaseLaw> phase_laws(const Scene& scene, double speed) {
  std::vector<PhaseLaw> laws;
  double largest = 0;
  for (const Phase& phase : scene.phases) largest = std::max(largest, phase.density);
  for (const Phase& phase : scene.phases)
    laws.push_back({phase.density, phase.viscosity, phase.sound_speed,
                    phase.exponent > 0                            ? phase.exponent
                    : phase.density < gas_density_ratio * largest ? gas_exponent
                                                                  : liquid_exponent});
  PhaseLaw& heaviest = *std::max_element(laws.begin(), laws.end(),
                                         [](const PhaseLaw& a, const PhaseLaw& b) { return a.density < b.density; });
  if (heaviest.sound_speed == 0) heaviest.sound_speed = sound_over_speed * speed;
  // Of equal stiffness B sound is 14 times as fast in air as in water.
  for (PhaseLaw& law : laws)
    if (law.sound_speed == 0) law.sound_speed = std::sqrt(law.exponent * heaviest.stiffness() / law.density);
  return laws;
}

double dynamic_pressure(const std::vector<PhaseLaw>& laws, double speed) {
  double density = 0;
  for (const PhaseLaw& law : laws) density = std::max(density, law.density);
  return density * speed * speed;
}

double largest_kinematic_viscosity(const std::vector<PhaseLaw>& laws) {
  double largest = 0;
  for (const PhaseLaw& law : laws) largest = std::max(largest, law.viscosity / law.density);
  return laws.size() > 1 ? 2 * largest : largest;
}

std::vector<float> distinct_densities(const std::vector<PhaseLaw>& laws) {
  std::vector<float> densities;
  for (const PhaseLaw& law : laws) {
    auto density = static_cast<float>(law.density);
    while (std::find(densities.begin(), densities.end(), density) != densities.end())
      density = std::nextafter(density, 2 * density);
    densities.push_back(density);
  }
  return densities;
}

std::string in_words(const std::vector<PhaseLaw>& laws, const Scene& scene, double speed, double background) {
  std::string text = "largest speed " + brief(speed) + " m/s";
  for (std::size_t n = 0; n < laws.size(); ++n)
    text += ", sound in " + scene.phases[n].name + " " + brief(laws[n].sound_speed) + " m/s (exponent " +
            brief(laws[n].exponent) + ")";
  if (background > 0) text += ", background " + brief(background) + " Pa";
  return text;
}

}  // namespace spume
