// SPDX-License-Identifier: MIT
// Momentum that goes with the mass which filtered densities pass between particles.
//
// The filtered density (7) of a particle changes when it comes near an interface or leaves it: what one gains others
// lose. A gas particle that runs into a liquid gains up to half of the liquid's density. If it keeps its velocity, it
// has gained the momentum of a liquid at the speed of the gas, and at 100:1 a jet presses with fifty times its dynamic
// pressure. As Rudman (1998, International Journal for Numerical Methods in Fluids 28, 357-378) has it for volumes of
// fluid, mass takes its momentum along: with D_i the gain of i, L_j = max(-D_j, 0) and of the particles with D_i > 0,
//
//   u_i += min(1, D_i / f~_i) sum_j L_j W_ij (u_j - u_i) / sum_j L_j W_ij
//
// A mean over those who lose: never beyond their velocities; kinetic energy of the filtered masses is not made; their
// momentum is kept as far as what is gained around each particle is lost around it. One without a neighbour that loses
// keeps its velocity. Particles of layers behind openings, whose gain is given as 0, take no part.
#pragma once

#include "spume/operators/image_values.hpp"
#include "spume/operators/interface_bands.hpp"

namespace spume {

struct MassExchange {
  const float* gain;     // D, per particle
  const float* density;  // f~ now, which D is included in; positive
  std::array<const double*, 3> velocity;
};

// The change of the velocity, of all particles. Only the varying ones of the bands can have one. Images lose what their
// sources lose, with the velocity by `rule`; wall points lose nothing.
void mass_exchange_sweep(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                         const MassExchange& exchange, const VelocityImageRule& rule,
                         const std::array<float*, 3>& change);

}  // namespace spume
