// SPDX-License-Identifier: MIT
// Properties of phases smoothed over the interfaces between them: Joubert et al., equations (5) to (7).
//
//   C^n_i = sum_{j in phase n} W_ij / sum_j W_ij                                          (6)
//   f~_i  = sum_j f_j W_ij / sum_j W_ij = sum_n f^n C^n_i                                 (5), (7)
//
// with the particle itself in the sums. Where one phase fills the support C^n is 0 or 1 and f~ = f: only the mixed
// particles of InterfaceBands are summed over. Images carry the phase of their source.
#pragma once

#include <cstdint>
#include <span>

#include "spume/operators/interface_bands.hpp"

namespace spume {

// (6): colour[n][i] for all particles; null entries are not computed. The colours of a particle sum to 1 within
// rounding when all phases are asked for.
void filter_colours(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                    std::span<const std::uint8_t> phase, std::span<float* const> colour);

// (7), all phases: `of_phase` is the property of each phase, at least one.
void blend_property(const InterfaceBands& bands, std::span<const std::uint8_t> phase,
                    std::span<const float* const> colour, std::span<const double> of_phase, std::span<float> out);

// (5) of any value per particle that differs only between phases.
void filter_property(const SweepContext& context, PackedNeighbours& packed, const InterfaceBands& bands,
                     const float* values, std::span<float> out);

}  // namespace spume
