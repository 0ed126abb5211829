// SPDX-License-Identifier: MIT
// The shift: small displacements that even out the arrangement of the particles (Lind et al. 2012; King (3.11),
// (3.12)).
#pragma once

#include "spume/particles/moments.hpp"
#include "spume/particles/options.hpp"
#include "spume/particles/surface.hpp"

namespace spume {

struct ShiftInput {
  double coefficient = 0;     // displacement = -coefficient h^2 grad C
  double limit = 0;           // largest displacement over h in a step of displacement 1
  bool remove_drift = true;   // subtract what neighbours share of the shift
  double largest_stable = 0;  // largest_stable_shift() of this lattice
  double displacement = 0;    // displacement_fraction() of the step
};

ShiftInput shift_input(const ShiftingOptions& options, double largest_stable, double displacement);

class Shift {
 public:
  // In smoothing lengths squared times the concentration gradient; see compute().
  Shift(ParticleStore& particles, const Resolution& resolution);

  // King (3.12), in proportion to the distance that the liquid moves in the step: a liquid at rest is not shifted, and
  // small steps do not shift more than large ones. At a surface only the part along it is kept. Releases the
  // concentration gradient. `surface`: null without one.
  void compute(Arrangement& arrangement, ParticleStore& particles, const ShiftInput& input, const ParticleSizes& sizes,
               MomentFields& moments, FreeSurface* surface, const std::vector<std::array<float, 3>>& reflection);

  FloatVectorField displacement{};  // result

  double bytes() const;

 private:
  void keep_layers(Arrangement& arrangement, ParticleStore& particles, const MomentFields& moments,
                   const FreeSurface& surface, const std::vector<std::array<float, 3>>& reflection);

  const Resolution& resolution_;
  Array<std::uint8_t> beside_surface_;       // near the surface, or of the layer below
  Array<std::int32_t> upper_particles_;      // the same as a list
  Array<std::array<float, 3>> layer_shift_;  // of those: the normal shift that they share
};

}  // namespace spume
