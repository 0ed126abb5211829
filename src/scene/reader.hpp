// SPDX-License-Identifier: MIT
// Reads a document into a draft through the table of options: types, ranges, words, missing and unknown keys.
#pragma once

#include "draft.hpp"
#include "option.hpp"

namespace spume {

void read_document(const Node& document, Draft& draft, Problems& problems);

// The table of a section ("domain.wall_velocity" too), or null.
const Node* find_section(const Node& document, const std::string& name);

}  // namespace spume
