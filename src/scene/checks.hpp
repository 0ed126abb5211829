// SPDX-License-Identifier: MIT
// What a case must satisfy beyond types and ranges: geometry, sides, fluid, regions, intervals, probes. Each check runs
// on the values that were read without error and reports in words, with the fix.
#pragma once

#include "spume/scene/draft.hpp"
#include "spume/scene/method_declaration.hpp"
#include "spume/scene/side_names.hpp"

namespace spume {

void check_title(const Draft& draft, Problems& problems);
void check_domain(Draft& draft, Problems& problems);  // sets draft.dimensions
void check_resolution(const Draft& draft, Problems& problems);
void check_solids(const Draft& draft, Problems& problems);
void check_fluid(const Draft& draft, Problems& problems);
void check_liquids(const Draft& draft, Problems& problems);
void check_phases(const Draft& draft, Problems& problems);  // and the regions that they fill
// Regions may lie below others or be cut away by solids: only the particles tell which phases there are.
void check_phases_filled(const Draft& draft, const Scene& scene, Problems& problems);
void warn_of_kinematic_viscosity(const Draft& draft, Problems& problems);
void check_output(const Draft& draft, Problems& problems);
// Of output.fields; `known` are those of the method.
void check_output_fields(const Draft& draft, const std::vector<OutputFieldInfo>& known, Problems& problems);
// `scalars` are those of the method; completes the probes of draft.options.
void check_probes(Draft& draft, const std::vector<ProbeScalar>& scalars, Problems& problems);

std::pair<int, int> side_place(const std::string& side, int dimensions);  // axis and end, or -1

}  // namespace spume
