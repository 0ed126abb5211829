// SPDX-License-Identifier: MIT
// What a case needs of the machine's memory, before anything of it is made.
#pragma once

#include "spume/scene/case.hpp"

namespace spume {

// Bytes per particle, or per point of a grid, that a run holds once its first steps are done, as `spume check` counts
// them: fields, neighbour lists with the particles of a full support, sweep records and the pressure system of a large
// les-sph case; the spectral states of the integrator. Left out is what falls with the size of the case (images beside
// walls, planes of a product) and what the scene adds (surfaces, bubbles): a run needs no less.
double bytes_per_particle(const Case& options, int dimensions);

}  // namespace spume
