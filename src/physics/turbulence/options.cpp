// SPDX-License-Identifier: MIT
#include "spume/physics/turbulence/options.hpp"

#include "spume/scene/option.hpp"

namespace spume {

Section turbulence_section() {
  using T = TurbulenceOptions;
  return section<T>("turbulence")
      .word("model", &T::model,
            {{"none", TurbulenceModel::none},
             {"mixed-scale", TurbulenceModel::mixed_scale},
             {"smagorinsky", TurbulenceModel::smagorinsky},
             {"dynamic-shepard", TurbulenceModel::dynamic_shepard},
             {"dynamic-lagrangian", TurbulenceModel::dynamic_lagrangian}},
            "closure of the unresolved stresses")
      .word("diffusion", &T::diffusion,
            {{"automatic", DiffusionForm::automatic},
             {"laplacian", DiffusionForm::laplacian},
             {"stress", DiffusionForm::stress}},
            "div(nu grad u) or div(2 nu S); automatic: stress with a surface")
      .option("mixed_scale_constant", &T::mixed_scale_constant, "1", between(0, 1), "C_M of the mixed-scale model")
      .when("model", {"mixed-scale"})
      .option("smagorinsky_constant", &T::smagorinsky_constant, "1", between(0, 1), "C_s of the Smagorinsky model")
      .when("model", {"smagorinsky"});
}

}  // namespace spume
