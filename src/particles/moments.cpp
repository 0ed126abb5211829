// SPDX-License-Identifier: MIT
#include "spume/particles/moments.hpp"

#include <string>

namespace spume {

MomentFields::MomentFields(ParticleStore& particles, const Wanted& wanted) : wanted_(wanted) {
  if (!wanted.correction) return;
  divergence_of_position = &particles.fields.add<float>("divergence_of_position", Lifetime::result);
  const int d = particles.dimensions;
  for (int k = 0; k < d * (d + 1) / 2; ++k)
    correction[k] = &particles.fields.add<float>("gradient_correction_" + std::to_string(k), Lifetime::result);
  if (wanted.normal) particles.add_vector(normal, "normal", Lifetime::result);
}

void MomentFields::lease(ParticleStore& particles) {
  if (wanted_.kernel_sum) particles.scratch().lease(kernel_sum, particles.size());
  if (wanted_.concentration_gradient)
    particles.scratch().lease(concentration_gradient, particles.dimensions, particles.size());
}

void MomentFields::measure(Arrangement& arrangement, ParticleStore& particles, double spacing) {
  const std::size_t n = particles.size();
  particles.scratch().lease(laplacian_diagonal, n);
  lease(particles);
  uncorrected.resize(n);

  KernelMomentOptions options;
  options.shifting = wanted_.concentration_gradient;
  options.normals = wanted_.normal;
  options.spacing = spacing;
  options.fading = wanted_.fading;
  KernelMoments out;
  out.divergence_of_position = divergence_of_position->data();
  if (wanted_.kernel_sum) out.kernel_sum = kernel_sum.data();
  out.laplacian_diagonal = laplacian_diagonal.data();
  for (std::size_t k = 0; k < correction.size(); ++k)
    out.correction[k] = correction[k] == nullptr ? nullptr : correction[k]->data();
  out.uncorrected = uncorrected.data();
  out.concentration_gradient = write(concentration_gradient);
  out.normal = write(normal);
  kernel_moment_sweep(arrangement.context, arrangement.packed, options, out);
}

std::array<const float*, 6> MomentFields::read_correction() const {
  std::array<const float*, 6> pointers{};
  for (std::size_t k = 0; k < 6; ++k) pointers[k] = correction[k] == nullptr ? nullptr : correction[k]->data();
  return pointers;
}

}  // namespace spume
