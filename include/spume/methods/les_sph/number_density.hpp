// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph {

// How far the liquid moves over dt, relative to its mean velocity and without spray, over the distance that the courant
// limit allows; at most 1, and the same in every frame. A liquid at rest needs no care for its arrangement, and small
// steps no more of it than large ones.
double displacement_fraction(const Liquid& liquid, double dt);

// Subtracts from `divergence` that which evens out the number density over `pressure.density_relaxation` steps N at the
// courant limit:
//   div u^{n+1} = displacement / (N dt) (e_i - mean e),  e = div r / (div r of the lattice) - 1, within 0.1.
// Velocities free of divergence keep the density only as far as their discrete divergence tells the volume of a moving
// arrangement: without this a lid-driven cavity thins out by an eighth below the lid and thickens at the bottom, and
// the circulation is 4 % too weak. Only differences are evened out: the mean of e tells the disorder of the arrangement
// (half a per cent), which must not raise the level of a liquid with a surface. Particles without full support, at the
// surface or within reach of a solid box, whose images overlap at edges, are left alone.
void even_out_density(const Liquid& liquid, double dt, std::span<double> divergence);

}  // namespace spume::les_sph
