// SPDX-License-Identifier: MIT
// Options of the multiphase scheme alone. Those of its parts: particles/options.hpp.
#pragma once

#include "spume/particles/options.hpp"

namespace spume::gfd {

// Joubert et al. and operators/gfd_stress.hpp; hu_adams: operators/sph_diffusion.hpp.
enum class Diffusion { split, printed, mu_laplacian, laplacian, hu_adams, rotation_free };

// What the plan says of it.
const char* in_words(Diffusion diffusion);

// How the viscosity of mixed particles is blended from the phases.
enum class ViscosityMean { arithmetic, harmonic };

struct MomentumOptions {
  Diffusion diffusion = Diffusion::split;
  ViscosityMean viscosity_mean = ViscosityMean::harmonic;
};

// Whether diffusion is implicit and steps pass the viscous limit. automatic: as ViscousChoice finds.
enum class ViscousSteps { automatic, explicit_alone, implicit };

// What the scheme adds to [time].
struct LimitOptions {
  ViscousSteps viscosity = ViscousSteps::automatic;
  double diffusive = 0.2;
  double capillary = 0.5;
};

Section momentum_section();
Section limits_section();

}  // namespace spume::gfd
