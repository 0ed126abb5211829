// SPDX-License-Identifier: MIT
// How much of the volume of spheres lies within others.
#pragma once

#include <vector>

#include "spume/physics/point_particles/exclusion.hpp"

namespace spume {

struct SampledValue {
  double value = 0;
  double standard_error = 0;
};

// Overlap ratio 1 - V_union / sum of volumes, de Wit et al. (2024), (14); 1 - (1 - exp(-alpha)) / alpha for spheres
// placed at random with volume fraction alpha.
//
// A point drawn in a sphere drawn by volume lies in m >= 1 spheres, and V_union / sum of volumes is the mean of 1/m
// (Karp, Luby and Madras 1989). No sample is spent on the space between spheres: at alpha = 3.5 % the error is 7 times
// smaller than with as many points drawn in the box. Points depend on (seed, step, sample) alone. Zero without spheres.
SampledValue overlap_ratio(Exclusion& exclusion, const Spheres& spheres, std::size_t samples, std::uint64_t seed,
                           std::uint32_t step);

// Probability density of overlap over touching distance among overlapping pairs, in `bins` equal bins of [0, 1]
// (de Wit et al., figure 8); zeros without overlaps.
std::vector<double> overlap_histogram(Exclusion& exclusion, const Spheres& spheres, int bins);

}  // namespace spume
