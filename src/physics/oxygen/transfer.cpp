// SPDX-License-Identifier: MIT
#include "spume/physics/oxygen/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spume::oxygen {
namespace {

// Sherwood number of a solid sphere: Clift, Grace & Weber (1978), table 5.4, with their analytical form for creeping
// flow.
double rigid_sphere(double reynolds, double schmidt) {
  const double peclet = reynolds * schmidt;
  if (reynolds < 1) return 1 + std::cbrt(1 + peclet);
  const double root = std::cbrt(schmidt);
  if (reynolds <= 100) return 1 + std::cbrt(1 + 1 / peclet) * std::pow(reynolds, 0.41) * root;
  if (reynolds <= 2000) return 1 + 0.724 * std::pow(reynolds, 0.48) * root;
  return 1 + 0.425 * std::pow(reynolds, 0.55) * root;
}

}  // namespace

double saturation_concentration(double temperature, double salinity) {
  const double x = 1 / (temperature + melting_point);
  const double fresh = -139.34411 + x * (1.575701e5 + x * (-6.642308e7 + x * (1.243800e10 - x * 8.621949e11)));
  return std::exp(fresh - salinity * (1.7674e-2 + x * (-1.0754e1 + x * 2.1407e3)));
}

double vapour_pressure(double temperature) {
  const double x = 1 / (temperature + melting_point);
  return atmosphere * std::exp(11.8571 - x * (3840.70 + x * 216961));
}

double transfer_coefficient(Coefficient model, const Motion& m, double given) {
  const double reynolds = m.slip * m.diameter / m.viscosity, schmidt = m.viscosity / m.diffusivity;
  switch (model) {
    case Coefficient::none:
      return 0;
    case Coefficient::higbie:
      return 2 * std::sqrt(m.diffusivity * m.slip / (std::numbers::pi * m.diameter));
    case Coefficient::rigid_sphere:
      return rigid_sphere(reynolds, schmidt) * m.diffusivity / m.diameter;
    case Coefficient::froessling:
      return (2 + 0.552 * std::sqrt(reynolds) * std::cbrt(schmidt)) * m.diffusivity / m.diameter;
    case Coefficient::given:
      return given;
  }
  return 0;
}

double Gas::pressure(double height) const {
  return air_pressure + weight * std::max(0.0, level - height);
}

double Gas::solubility(double pressure) const {
  return saturation * (pressure - vapour) / ((atmosphere - vapour) * oxygen_of_air);
}

double Gas::moles(double volume, double height) const {
  return volume * (pressure(height) - vapour) / (gas_constant * (temperature + melting_point));
}

double Gas::volume(double moles, double height) const {
  return moles * gas_constant * (temperature + melting_point) / (pressure(height) - vapour);
}

Interface sphere(double radius) {
  const double diameter = 2 * radius;
  return {diameter, std::numbers::pi * diameter * diameter};
}

Exchange exchange(const Gas& gas, const Contents& before, const Interface& interface, double height, double slip,
                  double concentration, double dt) {
  Exchange result{.after = before};
  const double total = before.oxygen + before.inert;
  if (!(total > 0)) return result;
  const double k =
      gas.factor *
      transfer_coefficient(
          gas.coefficient,
          {.diameter = interface.diameter, .slip = slip, .viscosity = gas.viscosity, .diffusivity = gas.diffusivity},
          gas.given);
  const double per_mole = gas.solubility(gas.pressure(height)) / total;  // c* over the moles of oxygen
  result.conductance = k * interface.area;
  result.capacity = result.conductance * per_mole * before.oxygen;
  const double balance = concentration / per_mole, rate = result.conductance * per_mole / molar_mass;
  const double given = (balance - before.oxygen) * std::expm1(-rate * dt);
  result.after.oxygen = before.oxygen - given;
  result.given = molar_mass * given;
  return result;
}

}  // namespace spume::oxygen
