// SPDX-License-Identifier: MIT
// What a viewer points at: a particle, and the flow at a place.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "spume/view/frame.hpp"

namespace spume {

// The identifiers of a family; null without.
const std::int64_t* identifiers(const ParticleSnapshot& family);

// {"family", "index", "place", "id", "values": [{"name", "values"}]}; null when the family or the particle is not
// there.
nlohmann::json picked_particle(const std::vector<ParticleSnapshot>& families, const PickWish& wish);

// {"place", "values": [{"name", "value"}]}, each colouring of the first grid or else the first family: between the
// points of a grid linearly; of particles the mean with weights (1 - r^2/R^2)^2 within R = 2 spacings, and without a
// spacing the nearest. A value is null where nothing is that near.
nlohmann::json values_at(const FrameSide& shown, const std::array<double, 3>& place);

}  // namespace spume
