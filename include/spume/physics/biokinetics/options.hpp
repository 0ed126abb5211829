// SPDX-License-Identifier: MIT
// The section [biokinetics]: components of a model as scalars that react. A method that carries scalars names it in its
// registration and calls the check in its own, behind those of the scalars and of [oxygen].
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spume/physics/biokinetics/asm1.hpp"

namespace spume {

struct Draft;
class Problems;
struct Section;

enum class BiokineticModel { asm1 };

struct BiokineticsOptions {
  bool on = false;
  BiokineticModel model = BiokineticModel::asm1;
  std::optional<double> temperature;         // degrees C
  double nutrient_half_saturation = 0.01;    // g N/m^3
  double alkalinity_half_saturation = 0.01;  // mol/m^3
  double tolerance = 1e-6;
  double interval = 0;                       // between reactions; 0: every step
  std::vector<std::optional<double>> given;  // of the parameters, in the order of asm1_parameter_list()
  std::vector<std::size_t> scalars;          // index of every component among ScalarOptions
  biokinetics::Asm1Parameters parameters;    // complete after the check
};

// Every parameter of ASM1 by its name in a case.
struct Asm1ParameterInfo {
  const char* key;
  double biokinetics::Asm1Parameters::*value;
  const char* unit;
  const char* description;
};
const std::vector<Asm1ParameterInfo>& asm1_parameter_list();

Section biokinetics_section();

// Needs [oxygen]; adds the components that no [[scalar]] gives; completes BiokineticsOptions. The scalar of [oxygen] is
// the component S_O.
void check_biokinetics(Draft& draft, Problems& problems);

}  // namespace spume
