// SPDX-License-Identifier: MIT
#include "spume/methods/gfd/options.hpp"

#include "spume/scene/option.hpp"

namespace spume::gfd {

const char* in_words(Diffusion diffusion) {
  switch (diffusion) {
    case Diffusion::split:
      return "(12) and (grad u)^T . grad mu: div(2 mu T)";
    case Diffusion::printed:
      return "(19): grad mu . 2 T + mu lap u";
    case Diffusion::mu_laplacian:
      return "(12): div(mu grad u)";
    case Diffusion::laplacian:
      return "mu lap u";
    case Diffusion::rotation_free:
      return "(12) and (grad u)^T . grad mu of its weights: div(2 mu T)";
    case Diffusion::hu_adams:
      return "(13): Hu and Adams";
  }
  return "";
}

Section momentum_section() {
  return section<MomentumOptions>("momentum")
      .word(
          "diffusion", &MomentumOptions::diffusion,
          {{"split", Diffusion::split},
           {"printed", Diffusion::printed},
           {"mu-laplacian", Diffusion::mu_laplacian},
           {"laplacian", Diffusion::laplacian},
           {"hu-adams", Diffusion::hu_adams},
           {"rotation-free", Diffusion::rotation_free}},
          "diffusion of momentum where the viscosity varies; split and rotation-free alone converge to div(2 mu T) at "
          "an interface")
      .word("viscosity_mean", &MomentumOptions::viscosity_mean,
            {{"harmonic", ViscosityMean::harmonic}, {"arithmetic", ViscosityMean::arithmetic}},
            "filter of the viscosity across interfaces; arithmetic as in the paper's (7)");
}

Section limits_section() {
  using L = LimitOptions;
  return section<L>("time")
      .behind("courant")
      .word("viscosity", &L::viscosity,
            {{"automatic", ViscousSteps::automatic},
             {"explicit", ViscousSteps::explicit_alone},
             {"implicit", ViscousSteps::implicit}},
            "diffusion of momentum; implicit: steps pass the limit by viscosity")
      .option("diffusive", &L::diffusive, "1", above_up_to(0, 0.4), "step limit by viscosity, of spacing^2 / nu")
      .option("capillary", &L::capillary, "1", above_up_to(0, 1),
              "step limit by tension, of sqrt((rho_1 + rho_2) spacing^3 / (4 pi sigma))");
}

}  // namespace spume::gfd
