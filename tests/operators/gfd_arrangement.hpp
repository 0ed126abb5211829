// SPDX-License-Identifier: MIT
// Stencils of generalised finite differences on the arrangements of sph_arrangement.hpp, beside their slow twin.
#pragma once

#include <map>

#include "operators/sph_arrangement.hpp"
#include "reference/gfd_sums.hpp"

namespace spume::test {

using reference::GfdSums;

// Calls body(arrangement) for every arrangement of particles of one size.
template <class Body>
void for_every_equal_arrangement(Body&& body) {
  for (Arrangement& a : all_arrangements()) {
    if (a.setup.sizes) continue;
    SCOPED_TRACE(a.setup.name);
    body(a);
  }
}

// The twin of an arrangement that lives as long as the program.
inline const GfdSums& gfd_twin(const Arrangement& a) {
  static std::map<const Arrangement*, GfdSums> twins;
  return twins.try_emplace(&a, a.twin).first->second;
}

struct Stencils {
  std::array<Array<float>, 6> correction;
  VectorArrays<float> offset;
  Array<float> laplacian_factor;
  Array<GfdFallback> fallback;
  Array<float> kernel_sum;  // this and the next: with sums of the kernel
  VectorArrays<float> concentration_gradient;
  int dimensions;

  explicit Stencils(Arrangement& a, bool with_kernel = false)
      : offset(a.size(), a.dimensions()), laplacian_factor(a.size()), fallback(a.size()), dimensions(a.dimensions()) {
    GfdMoments out;
    for (int k = 0; k < dimensions * (dimensions + 1) / 2; ++k) {
      correction[k].resize(a.size());
      out.correction[k] = correction[k].data();
    }
    out.offset = offset.write();
    out.laplacian_factor = laplacian_factor.data();
    out.fallback = fallback.data();
    if (with_kernel) {
      kernel_sum.resize(a.size());
      for (int axis = 0; axis < dimensions; ++axis) concentration_gradient[axis].resize(a.size());
      out.kernel_sum = kernel_sum.data();
      out.concentration_gradient = concentration_gradient.write();
      out.spacing = a.setup.spacing;
    }
    gfd_moment_sweep(a.context, a.packed, out);
  }
  GfdStencils read() const {
    GfdStencils all;
    for (std::size_t k = 0; k < 6; ++k) all.correction[k] = correction[k].data();
    all.offset = offset.read();
    all.laplacian_factor = laplacian_factor.data();
    return all;
  }
  // Of particle i, as the other sweeps were given them.
  GfdSums::Stencil of(std::size_t i) const {
    GfdSums::Stencil stencil;
    int slot = 0;
    for (int a = 0; a < dimensions; ++a) {
      for (int b = a; b < dimensions; ++b, ++slot)
        stencil.correction[a][b] = stencil.correction[b][a] = correction[slot][i];
      stencil.offset[a] = offset[a][i];
    }
    stencil.laplacian_factor = laplacian_factor[i];
    return stencil;
  }
};

// A positive property at random, a hundredfold apart at most, and rows that take it as varying: two of three.
struct RandomProperty {
  Array<float> value;
  Array<std::uint8_t> varies;
  RandomProperty(const Arrangement& a, std::uint32_t draw) : value(a.size()), varies(a.size()) {
    const auto random = a.random(draw);
    for (std::size_t i = 0; i < a.size(); ++i) {
      value[i] = static_cast<float>(std::pow(10.0, random[i]));
      varies[i] = i % 3 == 0 ? 0 : 1;
    }
  }
  PhaseProperty read() const { return {value.data(), varies.data()}; }
};

}  // namespace spume::test
