// SPDX-License-Identifier: MIT
// The particles that a case asks for, as the physics takes them.
#pragma once

#include "spume/core/periodic_grid.hpp"
#include "spume/physics/point_particles/options.hpp"
#include "spume/scene/case.hpp"

namespace spume::spectral {

// Points of the flow of a case, without padding along z.
PeriodicGrid flow_grid(const LoadedCase& loaded);

// Counts from volume fractions, lengths and times from the Kolmogorov scales of the injected energy:
//   eta = (nu^3 / epsilon)^(1/4),  tau_eta = (nu / epsilon)^(1/2),  tau_p = St tau_eta or D^2 / (12 beta nu)
// Throws InputError for what no option alone shows: an unreadable file of positions, too little memory.
PointParticleOptions particle_options(const LoadedCase& loaded);

// Memory of the particles and of the fields between them and the flow, in bytes, before anything is allocated; that of
// the flow (flow_bytes) not included.
double suspension_bytes(const LoadedCase& loaded, const PointParticleOptions& options);

}  // namespace spume::spectral
