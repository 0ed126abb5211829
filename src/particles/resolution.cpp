// SPDX-License-Identifier: MIT
#include "spume/particles/resolution.hpp"

#include "spume/core/kernel.hpp"

namespace spume {
namespace {

double support_of(KernelKind kernel) {
  return kernel == KernelKind::wendland_c2 ? WendlandC2::support : QuinticSpline::support;
}

}  // namespace

Resolution::Resolution(int scene_dimensions, double scene_spacing, KernelKind scene_kernel, double ratio)
    : dimensions(scene_dimensions),
      spacing(scene_spacing),
      kernel(scene_kernel),
      smoothing_ratio(ratio),
      smoothing_length(ratio * scene_spacing),
      support_radius(support_of(scene_kernel) * smoothing_length),
      lattice(lattice_constants(scene_dimensions, scene_kernel, ratio)) {}

}  // namespace spume
