// SPDX-License-Identifier: MIT
// Bodies that are released again and again, as bubbles from an orifice: each entry of the case stands for as many
// copies as are on their way at a time.
#pragma once

#include "spume/scene/draft.hpp"

namespace spume {

void check_release(const Draft& draft, std::size_t body, bool floats, Problems& problems);

// Adds the copies behind the bodies of the case, each with a motion of its own.
void add_released(const Draft& draft, std::vector<Body>& bodies, std::vector<BodyMotion>& motions, Problems& problems);

// Bodies that meet no liquid on their way, as it stands at the start, where no more enters.
void check_released_ways(const Draft& draft, const Scene& scene, Problems& problems);

// Bodies that meet no liquid until more has entered, appear in it, grow beside it, or are taken out of it.
std::vector<Problem> release_warnings(const Draft& draft, const Scene& scene, const std::string& file);

}  // namespace spume
