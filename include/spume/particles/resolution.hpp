// SPDX-License-Identifier: MIT
// Spacing, kernel and the sums of an undisturbed lattice; and the sizes of particles where these differ.
#pragma once

#include <cstddef>

#include "spume/core/array.hpp"
#include "spume/core/kernel_kind.hpp"
#include "spume/operators/sph_operators.hpp"

namespace spume {

struct Resolution {
  Resolution(int dimensions, double spacing, KernelKind kernel, double smoothing_ratio);

  int dimensions;
  double spacing;
  KernelKind kernel;
  double smoothing_ratio;
  double smoothing_length;  // h = smoothing_ratio spacing
  double support_radius;    // of the kernel at h
  LatticeConstants lattice;
};

// Sizes of particles that make room for something that is not resolved (bubbles). Without it (`variable` is false) all
// particles are alike and the arrays are empty.
struct ParticleSizes {
  bool variable = false;
  double largest_length_ratio = 1;
  Array<float> length_ratio, volume_ratio;  // h_i / h and V_i / V
  Array<float> support_radius;              // of h_i
  Array<float> volume_fraction;             // of the carrier at the positions of the step, alpha

  double smoothing_length(const Resolution& resolution, std::size_t i) const {
    return variable ? resolution.smoothing_length * length_ratio[i] : resolution.smoothing_length;
  }
  double alpha(std::size_t i) const { return variable ? double{volume_fraction[i]} : 1.0; }
  double bytes() const {
    return length_ratio.bytes() + volume_ratio.bytes() + support_radius.bytes() + volume_fraction.bytes();
  }
};

// Particles with fewer neighbours than a surface gives are spray: they exchange next to nothing.
constexpr int spray_neighbours(int dimensions) {
  return dimensions == 3 ? 8 : 3;
}

}  // namespace spume
