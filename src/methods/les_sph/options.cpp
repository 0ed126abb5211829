// SPDX-License-Identifier: MIT
#include "spume/methods/les_sph/options.hpp"

#include "spume/scene/option.hpp"

namespace spume {

Section scheme_section() {
  using S = SchemeOptions;
  return section<S>("time")
      .behind("courant")
      .option("centred", &S::centred, "velocity solenoidal half a step ahead: second order in time")
      .option("viscous", &S::viscous, "1", above_up_to(0, largest_stable_viscous),
              "step limit by viscosity, eddy viscosity included; a third of it with div(2 nu S)");
}

}  // namespace spume
