// SPDX-License-Identifier: MIT
// From a case file to a typed, validated case and its scene with initial particles.
#pragma once

#include <string>
#include <vector>

#include "spume/scene/case_schema.hpp"

namespace spume {

// Reads the case at `path` by the schema: a TOML file, a folder that holds case.toml, or the name of a folder below
// cases/. `overrides` are "section.key=value" texts of the command line (entries of lists of tables by number:
// "liquid.0.where=..."); a value that is not TOML counts as a string. Another option of the command line may stand in
// front of a text, "--until time.end=20": it is then named as the origin of the value.
//
// Throws InputError with every problem of the case: those of the file in file order with line and column,
// then those of the overrides. Nothing is written anywhere.
LoadedCase load_case(const std::string& path, const std::vector<std::string>& overrides, const CaseSchema& schema);

}  // namespace spume
