// SPDX-License-Identifier: MIT
// Measures of how particles cluster: pair statistics and counts in boxes.
#pragma once

#include <array>
#include <vector>

#include "spume/neighbours/periodic_cells.hpp"

namespace spume {

// Pairs by distance. `radius` holds the edges of logarithmic bins. Per bin, g = pairs over what a random distribution
// would have (radial distribution function); per edge, correlation = mean number of particles within that distance of a
// particle (correlation integral). The mean runs over the centres looked at.
struct PairStatistics {
  std::vector<double> radius;
  std::vector<double> radial_distribution;  // one fewer than radius
  std::vector<double> correlation;
};

// Distances from smallest to largest, below half of the shortest side; at most `centres` particles, evenly spread over
// the order of the arrays, are looked at against all. Throws std::invalid_argument for other distances or no bins.
PairStatistics pair_statistics(const std::array<double, 3>& lower, const std::array<double, 3>& length,
                               const std::array<const double*, 3>& position, std::size_t size, double smallest,
                               double largest, int bins, std::size_t centres);

// Correlation dimension: slope of log correlation against log radius by least squares over the edges in
// [from, to] that found a pair; 3 for a random distribution. Not a number when fewer than two did.
double correlation_dimension(const PairStatistics& pairs, double from, double to);

// The same of spheres that exclude each other, whose correlation grows from nothing at contact and has a slope far
// above 3 there: 3 + slope of log radial_distribution against log radius (at the middle of a bin) over the bins in
// [from, to].
double dimension_beyond_contact(const PairStatistics& pairs, double from, double to);

// Variance of the number of particles in a box over that of particles placed at random: 1 for these in the mean,
// exactly (their variance is mean (1 - 1/boxes), as all particles lie somewhere), 0 for a lattice. Zero without
// particles or with a single box.
double box_count_variance(const PeriodicCells& boxes, const std::array<const double*, 3>& position, std::size_t size);

// The same for cubes (nearly: a whole number fits along every axis) with sides of `smallest` and doublings of it, as
// long as two fit along every axis.
struct BoxCount {
  double side;  // cube root of the volume
  double mean;  // particles in a box
  double variance;
};
std::vector<BoxCount> box_counts(const std::array<double, 3>& lower, const std::array<double, 3>& length,
                                 const std::array<const double*, 3>& position, std::size_t size, double smallest);

}  // namespace spume
