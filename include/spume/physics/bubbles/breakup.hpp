// SPDX-License-Identifier: MIT
// Breakup of bubbles by turbulence (King et al. 2022, section 3.4.2; Martinez-Bazan et al. 2010).
#pragma once

#include "spume/core/array.hpp"
#include "spume/physics/bubbles/options.hpp"

namespace spume::bubbles {

struct BreakupModel {
  double tension = 0;                                                  // over the density of the liquid
  double deformation_constant = BubbleOptions{}.deformation_constant;  // c_def
};

// King (3.24) with d = 2a: sgn(X) sqrt|X|, X = c_def (2 eps a)^(2/3) - 6 tension / a. Stretching is positive.
double deformation_velocity(const BreakupModel& model, double radius, double dissipation);

// King (3.28): (12 tension / c_def)^(3/5) mean_eps^(-2/5) / (2a), the largest stable bubble over the parent.
double stable_ratio(const BreakupModel& model, double radius, double mean_dissipation);

// Beyond this ratio no child size is possible: 2^(-6/45).
double critical_ratio();
// Smallest child volume over that of the parent: max(1e-3, Lambda^(15/2)).
double smallest_child(double stable_ratio);

// The inverse of the distribution function of King (3.27), tabulated once over probability and Lambda^(5/3).
class ChildSizeTable {
 public:
  ChildSizeTable();
  // Volume of one child over that of the parent for u uniform in [0, 1); needs stable_ratio < critical_ratio().
  double operator()(double u, double stable_ratio) const;

 private:
  // With these sizes a child is off by 2.2e-6 of the parent's volume at most, by 3.2e-4 of its own.
  static constexpr int columns = 512;  // of t = sqrt(probability), which straightens the foot of the distribution
  static constexpr int rows_of_hard_limit = 64, rows_of_soft_limit = 192;
  Array<double> values_;  // (V - smallest) / (1/2 - smallest)
};

struct Children {
  double first_volume, second_volume;  // add up to the parent's volume to the last bit but one
  Vec3 first_offset, second_offset;    // touch each other; centre of volume at the parent's
};
// `fraction` of the volume goes to the first child; u1, u2 uniform in [0, 1) give the direction.
Children split(double volume, double fraction, double u1, double u2);

}  // namespace spume::bubbles
