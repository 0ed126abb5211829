// SPDX-License-Identifier: MIT
// Why a stage of the step runs, or does not, in the words of the case file and the numbers of the paper.
#pragma once

#include <string>

#include "spume/physics/point_particles/particle_system.hpp"
#include "spume/scene/case.hpp"

namespace spume::spectral::reason {

std::string forcing(const Case& options);
std::string product(const Case& options);
std::string update(const Case& options);
std::string feedback(const ParticleSystem& system);
std::string motion(const ParticleSystem& system);
std::string exclusion(const ParticleSystem& system);
std::string exponents(const Case& options);

}  // namespace spume::spectral::reason
