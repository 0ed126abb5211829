// SPDX-License-Identifier: MIT
// Scalars of a case: concentrations that the liquid carries. The sections [[scalar]] fill this group of options. A
// method that carries scalars names the section in its registration and calls the checks in its own.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace spume {

struct Draft;
class Expression;
class Problems;
struct Scene;
struct Section;

// Within the 0.2 to 1.3 that Tominaga & Stathopoulos (2007) collect for turbulent dispersion.
inline constexpr double usual_turbulent_schmidt = 0.7;

struct ScalarOption {
  std::string name;
  std::string unit = {};                           // of the concentration; empty: none
  std::shared_ptr<const Expression> initial = {};  // of the place; null: zero
  std::shared_ptr<const Expression> source = {};   // per volume of liquid and time; null: none
  std::shared_ptr<const Expression> inflow = {};   // of what enters; null: that of the nearest liquid
  double diffusivity = 0;                          // length^2 / time
  bool not_negative = false;                       // of a substance that another section uses
  double turbulent_schmidt = usual_turbulent_schmidt;
};

struct ScalarOptions {
  std::vector<ScalarOption> scalars;
};

Section scalar_section();

// Names; completes ScalarOptions but for the expressions. `taken` are the output fields that the method has beside.
void check_scalars(Draft& draft, const std::vector<std::string>& taken, Problems& problems);
// Index of the scalar of that name; one that no [[scalar]] gives is added as described. It may not be negative.
std::size_t require_scalar(Draft& draft, const ScalarOption& scalar);
// Values where the particles start, and of what enters.
void check_initial_scalars(const Draft& draft, const Scene& scene, Problems& problems);

}  // namespace spume
