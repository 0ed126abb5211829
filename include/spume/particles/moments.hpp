// SPDX-License-Identifier: MIT
// Kernel moments of the arrangement (operators/sph_operators.hpp) as a step keeps them.
#pragma once

#include "spume/operators/sph_operators.hpp"
#include "spume/particles/arrangement.hpp"

namespace spume {

class MomentFields {
 public:
  struct Wanted {
    bool kernel_sum = false;
    bool concentration_gradient = false;
    bool normal = false;
    bool correction = true;     // L, div r and the rest that measure() finds
    CorrectionFading fading{};  // of L, in a closed liquid
  };
  MomentFields(ParticleStore& particles, const Wanted& wanted);

  // Room for the kernel sum and the concentration gradient.
  void lease(ParticleStore& particles);
  // Measures them; leases what is not kept.
  void measure(Arrangement& arrangement, ParticleStore& particles, double spacing);

  // Results.
  Array<float>* divergence_of_position = nullptr;  // div r
  std::array<Array<float>*, 6> correction{};       // L, the gradient correction
  Array<std::uint8_t> uncorrected;                 // 1 where L fell back to the identity
  FloatVectorField normal{};                       // outward, times h; with Wanted::normal
  // Leased by measure(); whoever reads them last releases them.
  Array<float> laplacian_diagonal;  // sum_j 2 g
  Array<float> kernel_sum;
  FloatVectorScratch concentration_gradient;

  std::array<const float*, 6> read_correction() const;

 private:
  Wanted wanted_;
};

}  // namespace spume
