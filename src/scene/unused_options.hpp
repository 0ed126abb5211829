// SPDX-License-Identifier: MIT
// Keys of a case that another of its values makes useless.
#pragma once

#include <string>
#include <vector>

#include "spume/scene/case_schema.hpp"

namespace spume {

// One remark, with its place, for every key that is given a value other than its default and whose Option::needs is not
// met. Not errors: a case under study switches models on and off and keeps their constants.
std::vector<Problem> unused_options(const Draft& draft, const CaseSchema& schema, const std::string& file);

}  // namespace spume
