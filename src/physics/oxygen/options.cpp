// SPDX-License-Identifier: MIT
#include "spume/physics/oxygen/options.hpp"

#include <algorithm>

#include "spume/physics/scalars/options.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/option.hpp"

namespace spume {
namespace {

// Of oxygen in water at 20 to 25 C: 2.1e-9 m2/s (Cussler 1997).
constexpr double oxygen_diffusivity = 2.1e-9;

bool needs_diffusivity(oxygen::Coefficient model) {
  return model != oxygen::Coefficient::none && model != oxygen::Coefficient::given;
}

bool releases_bodies(const Draft& draft) {
  return std::any_of(draft.bodies.begin(), draft.bodies.end(),
                     [](const BodyDraft& body) { return body.release_interval.has_value(); });
}

void check_coefficients(const Draft& draft, const OxygenOptions& options, Problems& problems) {
  const bool given = options.bubble_coefficient == oxygen::Coefficient::given;
  if (given && !options.bubble_k_l && draft.usable("oxygen.bubble_k_l"))
    problems.add(*draft.node("oxygen.bubble_coefficient"),
                 "oxygen.bubble_coefficient = \"given\" needs a value; add  oxygen.bubble_k_l = <number>  # m/s, about "
                 "4e-4 for bubbles of 3 mm");
  if (options.bubbles_shrink && releases_bodies(draft))
    problems.add(*draft.node("oxygen.bubbles_shrink"),
                 "oxygen.bubbles_shrink is true, and bodies that are released keep their size whatever they give; "
                 "remove the key, or use [bubbles]");
  if (!needs_diffusivity(options.bubble_coefficient) || (draft.node("bubbles") == nullptr && !releases_bodies(draft)))
    return;
  const ScalarOption& scalar = draft.options.get<ScalarOptions>().scalars[options.index];
  if (!(scalar.diffusivity > 0))
    problems.add(*draft.node("oxygen"), "the scalar '" + options.scalar +
                                            "' has no diffusivity, on which the transfer coefficient of bubbles "
                                            "depends; give it  diffusivity = 2.1e-9, or set "
                                            "oxygen.bubble_coefficient = \"given\"");
}

}  // namespace

double OxygenOptions::saturation_at_atmosphere() const {
  return saturation_factor * saturation.value_or(oxygen::saturation_concentration(temperature, salinity));
}

Section oxygen_section() {
  using O = OxygenOptions;
  using oxygen::Coefficient;
  return section<O>("oxygen")
      .option("scalar", &O::scalar, "name of the [[scalar]] that is dissolved oxygen, in g/m3, added if there is none")
      .absent("oxygen, with [biokinetics] S_O")
      .option("temperature", &O::temperature, "degrees C", between(0, 40), "temperature of the water")
      .option("salinity", &O::salinity, "g/kg", between(0, 40), "salinity of the water")
      .option("air_pressure", &O::air_pressure, "Pa", between(3e4, 1.2e5), "pressure of the air above the surface")
      .option("saturation", &O::saturation, "g/m3", positive(), "saturation of clean water under air at 101325 Pa")
      .absent("by temperature and salinity (Benson & Krause 1984)")
      .option("saturation_factor", &O::saturation_factor, "1", above_up_to(0, 1.2),
              "beta: saturation of the water over that of clean water")
      .option("transfer_factor", &O::transfer_factor, "1", above_up_to(0, 2),
              "alpha: transfer coefficients in the water over those in clean water")
      .option("gas_fraction", &O::gas_fraction, "1", between(0, 1), "mole fraction of oxygen in dry gas that enters")
      .word("bubble_coefficient", &O::bubble_coefficient,
            {{"higbie", Coefficient::higbie},
             {"rigid-sphere", Coefficient::rigid_sphere},
             {"froessling", Coefficient::froessling},
             {"given", Coefficient::given},
             {"none", Coefficient::none}},
            "transfer coefficient of bubbles: of a mobile surface, of solid spheres (Clift et al. 1978; Froessling "
            "1938), "
            "bubble_k_l, or no transfer")
      .option("bubble_k_l", &O::bubble_k_l, "m/s", not_negative(), "transfer coefficient of bubbles")
      .absent("by bubble_coefficient")
      .when("bubble_coefficient", {"given"})
      .option("surface_k_l", &O::surface_k_l, "m/s", not_negative(), "transfer coefficient of the free surface")
      .option("bubbles_shrink", &O::bubbles_shrink,
              "volumes of bubbles follow from the gas that they hold and the pressure of their depth")
      .whole_optional();
}

// Dissolved oxygen has the name that sludge knows it by: one of another name would stand by without a word.
void warn_of_bystander(const Draft& draft, const OxygenOptions& options, Problems& problems) {
  const std::vector<ScalarOption>& scalars = draft.options.get<ScalarOptions>().scalars;
  for (std::size_t k = 0; k < scalars.size(); ++k)
    if (scalars[k].name == OxygenOptions().scalar && scalars[k].name != options.scalar)
      problems.warn(*draft.node("scalar." + std::to_string(k) + ".name"),
                    "the scalar '" + scalars[k].name + "' takes no part in [oxygen], whose scalar is '" +
                        options.scalar + "'; give it that name, or set oxygen.scalar");
}

void check_oxygen(Draft& draft, Problems& problems) {
  OxygenOptions& options = draft.options.get<OxygenOptions>();
  const Node* section = draft.node("oxygen");
  options.on = section != nullptr;
  if (!options.on) return;
  if (!uses_si(draft))
    problems.add(*section,
                 "[oxygen] holds values in SI units, and the liquid is given by groups; give density, viscosity and "
                 "fluid.gravity");
  if (draft.node("oxygen.scalar") == nullptr && draft.node("biokinetics") != nullptr) options.scalar = "S_O";
  warn_of_bystander(draft, options, problems);
  ScalarOption dissolved;
  dissolved.name = options.scalar;
  dissolved.unit = "g/m3";
  dissolved.diffusivity = oxygen_diffusivity;
  options.index = require_scalar(draft, dissolved);
  check_coefficients(draft, options, problems);
}

oxygen::Gas gas_of(const Case& options, double density, double viscosity, double gravity, double level) {
  const OxygenOptions& o = options.get<OxygenOptions>();
  return {.coefficient = o.bubble_coefficient,
          .given = o.bubble_k_l.value_or(0),
          .factor = o.transfer_factor,
          .diffusivity = options.get<ScalarOptions>().scalars[o.index].diffusivity,
          .viscosity = viscosity,
          .temperature = o.temperature,
          .saturation = o.saturation_at_atmosphere(),
          .air_pressure = o.air_pressure,
          .fraction = o.gas_fraction,
          .weight = density * gravity,
          .level = level,
          .shrinks = o.bubbles_shrink};
}

}  // namespace spume
