// SPDX-License-Identifier: MIT
// Reads a document into a draft through the schema: types, ranges, words, missing and unknown keys.
#pragma once

#include "spume/scene/case_schema.hpp"

namespace spume {

void read_document(const Node& document, const CaseSchema& schema, Draft& draft, Problems& problems);

// The table of a section ("domain.wall_velocity" too), or null.
const Node* find_section(const Node& document, const std::string& name);

}  // namespace spume
