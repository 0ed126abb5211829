// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

#include "fill.hpp"
#include "spume/scene/case_schema.hpp"
#include "spume/scene/expression.hpp"

namespace spume {

// The case as TOML: every option with its value, and in a comment its origin (default, case, --set) and unit.
// Reading the text gives the same case again.
std::string resolved_text(const Node& document, const CaseSchema& schema, const Draft& draft);

// Groups and constants for the start-up table, as text: those given, those that follow, the equivalent in
// water.
std::map<std::string, std::string> describe_groups(const Draft& draft, const Scene& scene,
                                                   const ExpressionScope& scope);
// Adds the particle count and, where it differs from the wanted one, the effective spacing.
void describe_lattice(const Scene& scene, const Lattice& lattice, std::map<std::string, std::string>& groups);

}  // namespace spume
