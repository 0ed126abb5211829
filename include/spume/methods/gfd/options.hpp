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

// Of [interface], beside the tension.
struct InterfaceOptions {
  // Passes of the average that continues the curvature across the band. What they take of long waves is given back,
  // which makes too much of waves of 10 spacings: 1.11 times with 4 passes, 1.16 with 3, 1.26 with 2. With 3 a
  // capillary wave of 64 spacings loses 15 % of its damping to such waves, with 4 none.
  int smoothing = 4;
};

// What the scheme adds to [time].
struct LimitOptions {
  double diffusive = 0.2;
  double capillary = 0.5;
};

Section momentum_section();
Section interface_band_section();
Section limits_section();

}  // namespace spume::gfd
