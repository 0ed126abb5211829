// SPDX-License-Identifier: MIT
// What a case must satisfy beyond types and ranges: geometry, sides, fluid, regions, intervals, probes. Each check runs
// on the values that were read without error and reports in words, with the fix.
#pragma once

#include "draft.hpp"

namespace spume {

void check_title(const Draft& draft, Problems& problems);
void check_domain(Draft& draft, Problems& problems);  // sets draft.dimensions
void check_resolution(const Draft& draft, Problems& problems);
void check_solids(const Draft& draft, Problems& problems);
void check_fluid(const Draft& draft, Problems& problems);
void check_liquids(const Draft& draft, Problems& problems);
void check_spectral(const Draft& draft, Problems& problems);   // box, grid, forcing, initial state
void check_particles(const Draft& draft, Problems& problems);  // of the spectral method
void check_bubbles(Draft& draft, Problems& problems);          // completes draft.options.bubbles
// What can be told of spargers and clouds only beside the compiled rates and the initial liquid.
void check_bubble_sources(const Draft& draft, const Scene& scene, Problems& problems);
void check_output(const Draft& draft, Problems& problems);
void check_probes(Draft& draft, Problems& problems);  // completes the probes of draft.options

// Names of the two sides of an axis: left/right, front/back (3-D), bottom/top.
std::array<std::string, 2> side_names(int axis, int dimensions);

// Reach of the smoothing kernel over the spacing.
double support_ratio(const ResolutionOptions& resolution);

// True when the case uses the SI set of [fluid].
bool uses_si(const FluidDraft& fluid);

// A number in a message: six digits.
std::string brief(double value);

}  // namespace spume
