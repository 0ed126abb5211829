// SPDX-License-Identifier: MIT
// The tendency K of a potential, handed mode by mode to the integrator while it is in registers.
#pragma once

#include "spume/fourier/lane_vector.hpp"
#include "spume/methods/spectral/flow.hpp"

namespace spume::spectral {

// Calls update(ix, iy, at, iz, k2, K) for every vector of modes: `at` is its place in the arrays, iz its first index
// along z, k2 and K[3] vectors. Partial sums on the way go to `sum`; update may write its own modes anywhere.
template <class T>
template <class Update>
VelocityPeak Flow<T>::evaluate(const Modes<T>& potential, Modes<T>& sum, Update&& update) {
  using V = fourier::Vector<T>;
  using fourier::load;
  using fourier::times_i;
  const T coefficient = static_cast<T>(forcing_coefficient(potential));
  const bool shell = forcing_.kind == ForcingKind::shell, linear = forcing_.kind == ForcingKind::linear;
  const bool cut = options_.dealiasing == Dealiasing::two_thirds;
  const bool force = force_[0] != nullptr;
  // Compared in double: in single precision rounding must not move a mode across the edge of the shell.
  const auto finish = [&](std::size_t ix, std::size_t iy, std::size_t first, const Complex* const product[3]) {
    const T kx = wavenumber_[0][ix], ky = wavenumber_[1][iy];
    const bool inside = std::abs(layout_.wavenumber[0][ix]) < cut_[0] && std::abs(layout_.wavenumber[1][iy]) < cut_[1];
    const double plane2 =
        layout_.wavenumber[0][ix] * layout_.wavenumber[0][ix] + layout_.wavenumber[1][iy] * layout_.wavenumber[1][iy];
    const bool near_shell = shell && plane2 < shell_high_;
    // The next block of what the update reads: its lines lie planes apart.
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t next = ix * layout_.plane + iy * layout_.row + first + lanes<T>;
      fourier::prefetch_block(potential_[c].data() + next);
      fourier::prefetch_block(earlier_[c].data() + next);
    }
    for (std::size_t q = 0; q < lanes<T>; q += fourier::vector_width<T>) {
      const std::size_t iz = first + q, at = ix * layout_.plane + iy * layout_.row + iz;
      const V kz = load(lane_wavenumber_.data() + iz);
      const V k2 = kx * kx + ky * ky + kz * kz;
      const V none{};
      const V inverse = k2 > none ? T(1) / k2 : none;
      V n[3];
      for (std::size_t c = 0; c < 3; ++c) n[c] = load(product[c] + q);
      if (force)
        for (std::size_t c = 0; c < 3; ++c) n[c] += load(force_[c] + at);
      V k[3] = {times_i<T>((ky * n[2] - kz * n[1]) * inverse), times_i<T>((kz * n[0] - kx * n[2]) * inverse),
                times_i<T>((kx * n[1] - ky * n[0]) * inverse)};
      if (cut) {
        const V keep = inside ? (kz < static_cast<T>(cut_[2]) ? none + T(1) : none) : none;
        for (auto& value : k) value *= keep;
      }
      // Of what forces are in proportion to, the part along k drives no velocity: forced, its rounding would grow
      // unseen.
      const auto add_force = [&](const V factor) {
        const V b[3] = {load(&potential[0][at]), load(&potential[1][at]), load(&potential[2][at])};
        const V along = (kx * b[0] + ky * b[1] + kz * b[2]) * inverse;
        k[0] += factor * (b[0] - kx * along);
        k[1] += factor * (b[1] - ky * along);
        k[2] += factor * (b[2] - kz * along);
      };
      if (linear) {
        add_force(k2 > none ? none + coefficient : none);
      } else if (near_shell) {
        V factor{};
        for (std::size_t l = 0; l < fourier::vector_width<T>; ++l) {
          const double square = plane2 + layout_.wavenumber[2][iz + l] * layout_.wavenumber[2][iz + l];
          if (square >= shell_low_ && square < shell_high_ && square > 0)
            factor[2 * l] = factor[2 * l + 1] = coefficient;
        }
        add_force(factor);
      }
      // The mean velocity takes the mean of the force as it is.
      if (force && at == 0)
        for (std::size_t c = 0; c < 3; ++c) k[c][0] = force_[c][0].real(), k[c][1] = 0;
      update(ix, iy, at, iz, k2, k);
    }
  };
  return product_.evaluate(view<T>(potential), {sum[0].data(), sum[1].data(), sum[2].data()}, finish);
}

}  // namespace spume::spectral
