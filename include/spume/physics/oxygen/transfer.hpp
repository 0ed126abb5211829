// SPDX-License-Identifier: MIT
// Oxygen between gas and water: saturation, transfer coefficients, the gas of a bubble. SI units but for temperatures
// in degrees C, concentrations in g/m^3, salinities in g/kg. Numbers of the equations are those of README.md beside the
// sources.
#pragma once

namespace spume::oxygen {

inline constexpr double atmosphere = 101325;           // Pa
inline constexpr double oxygen_of_air = 0.20946;       // mole fraction of dry air (Benson & Krause 1984)
inline constexpr double molar_mass = 31.998;           // g/mol of O2
inline constexpr double gas_constant = 8.314462618;    // J/(mol K)
inline constexpr double melting_point = 273.15;        // K
inline constexpr double transfer_temperature = 1.024;  // theta of kLa, ASCE 2-06
inline constexpr double standard_temperature = 20;     // of efficiencies, ASCE 2-06

// Saturation of water under moist air at one atmosphere, (1).
double saturation_concentration(double temperature, double salinity);
// Of water, (2).
double vapour_pressure(double temperature);

enum class Coefficient { none, higbie, rigid_sphere, froessling, given };

struct Motion {
  double diameter = 0, slip = 0, viscosity = 0, diffusivity = 0;
};
// k_L of a bubble, (4) to (6); `given` with Coefficient::given.
double transfer_coefficient(Coefficient model, const Motion& motion, double given);

// The gas of bubbles and the water that it meets. A bubble holds dry gas saturated with vapour, at the pressure of its
// depth below the level of the liquid.
struct Gas {
  Coefficient coefficient = Coefficient::higbie;
  double given = 0;         // k_L
  double factor = 1;        // alpha: of k_L in process water
  double diffusivity = 0;   // of oxygen in water
  double viscosity = 0;     // kinematic
  double temperature = 20;  // degrees C
  double saturation = 0;    // of the water under air at one atmosphere
  double air_pressure = atmosphere;
  double fraction = oxygen_of_air;  // of oxygen in dry gas that enters
  double weight = 0;                // rho g
  double level = 0;                 // height of the surface
  double vapour = vapour_pressure(temperature);
  bool shrinks = false;  // volumes follow from the amounts of gas

  double pressure(double height) const;
  // Saturation per mole fraction of oxygen in dry gas, (3).
  double solubility(double pressure) const;
  double saturation_below_air() const { return solubility(air_pressure) * oxygen_of_air; }
  // Moles of dry gas in a volume at a height.
  double moles(double volume, double height) const;
  double volume(double moles, double height) const;
};

struct Contents {
  double oxygen = 0, inert = 0;  // mol
};
inline double mass(const Contents& contents) {
  return molar_mass * contents.oxygen;
}

// What a bubble and water share: the area, and the diameter of the sphere of its volume, or in two dimensions of the
// circle of its area and the area per depth.
struct Interface {
  double diameter = 0, area = 0;
};
Interface sphere(double radius);

// A bubble over dt, in water of the concentration c at its surface: (7), exact while c and the total amount stay, so
// that it holds for any dt.
struct Exchange {
  Contents after;
  double given = 0;        // g, to the water; negative: taken from it
  double conductance = 0;  // k_L A
  double capacity = 0;     // k_L A c*: what water without oxygen would be given, g/s
};
Exchange exchange(const Gas& gas, const Contents& before, const Interface& interface, double height, double slip,
                  double concentration, double dt);

}  // namespace spume::oxygen
