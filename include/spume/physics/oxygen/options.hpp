// SPDX-License-Identifier: MIT
// The section [oxygen]: a scalar that is dissolved oxygen, exchanged with bubbles and through the free surface. A
// method that carries scalars names it in its registration and calls the check in its own, behind that of the scalars.
#pragma once

#include <optional>
#include <string>

#include "spume/physics/oxygen/transfer.hpp"

namespace spume {

struct Case;
struct Draft;
class Problems;
struct Section;

struct OxygenOptions {
  bool on = false;
  std::string scalar = "oxygen";  // with [biokinetics] S_O
  std::size_t index = 0;          // of the scalar among ScalarOptions
  double temperature = oxygen::standard_temperature;
  double salinity = 0;
  double air_pressure = oxygen::atmosphere;
  std::optional<double> saturation;  // under air at one atmosphere; none: by temperature and salinity
  double saturation_factor = 1;      // beta
  double transfer_factor = 1;        // alpha
  double gas_fraction = oxygen::oxygen_of_air;
  oxygen::Coefficient bubble_coefficient = oxygen::Coefficient::higbie;
  std::optional<double> bubble_k_l;
  double surface_k_l = 0;
  bool bubbles_shrink = false;

  // beta times the saturation under air at one atmosphere.
  double saturation_at_atmosphere() const;
};

Section oxygen_section();

// SI units, the scalar (added where the case does not give it), what the coefficients need; completes OxygenOptions.
void check_oxygen(Draft& draft, Problems& problems);

// The gas of the case, for a liquid with a surface at `level`.
oxygen::Gas gas_of(const Case& options, double density, double viscosity, double gravity, double level);

}  // namespace spume
