// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/flow_fields.hpp"

#include <algorithm>

#include "spume/fourier/lane_vector.hpp"

namespace spume::spectral {
namespace {

template <class T>
T factor_of(const Multiplier<T>& multiplier, std::size_t axis, std::size_t index) {
  return multiplier[axis].empty() ? T(1) : multiplier[axis][index];
}

// Wavenumbers of a mode in the working precision.
template <class T>
std::array<T, 3> wavevector(const ModeLayout& layout, std::size_t ix, std::size_t iy, std::size_t iz) {
  return {static_cast<T>(layout.wavenumber[0][ix]), static_cast<T>(layout.wavenumber[1][iy]),
          static_cast<T>(layout.wavenumber[2][iz])};
}

// Blocks of the velocity's modes u = i k x b, with the mean velocity at k = 0.
template <class T>
class VelocityModes {
  using V = fourier::Vector<T>;

 public:
  VelocityModes(const ModeLayout& layout, const Modes<T>& potential) : layout_(layout), b_(potential) {
    for (std::size_t iz = 0; iz < layout.row; ++iz) {
      const T k = static_cast<T>(layout.wavenumber[2][iz]);
      kz_.push_back({k, k});
    }
  }
  // Component c, times factor, times i k_axis when an axis is given.
  template <bool gradient>
  void block(std::size_t c, std::size_t axis, T factor, std::size_t ix, std::size_t iy, std::size_t first,
             std::complex<T>* out) const {
    const std::size_t at = ix * layout_.plane + iy * layout_.row + first, p = (c + 1) % 3, q = (c + 2) % 3;
    const T kx = static_cast<T>(layout_.wavenumber[0][ix]), ky = static_cast<T>(layout_.wavenumber[1][iy]);
    for (std::size_t l = 0; l < lanes<T>; l += fourier::vector_width<T>) {
      const V k[3] = {V{} + kx, V{} + ky, fourier::load(&kz_[first + l])};
      V u = factor * fourier::times_i<T>(k[p] * fourier::load(&b_[q][at + l]) - k[q] * fourier::load(&b_[p][at + l]));
      if constexpr (gradient) u = fourier::times_i<T>(k[axis] * u);
      fourier::store<T>(out + l, u);
    }
    if (!gradient && at == 0) out[0] = factor * b_[c][0];
  }

 private:
  const ModeLayout& layout_;
  const Modes<T>& b_;
  std::vector<std::complex<T>> kz_;
};

template <class T>
void multiply_along_z(const Multiplier<T>& multiplier, std::size_t first, std::complex<T>* block) {
  if (multiplier[2].empty()) return;
  for (std::size_t l = 0; l < lanes<T> && first + l < multiplier[2].size(); ++l) block[l] *= multiplier[2][first + l];
}

}  // namespace

template <class T>
void real_velocity(Flow<T>& flow, const Modes<T>& potential, const Multiplier<T>& multiplier,
                   const std::array<T*, 3>& values, std::size_t z_stride) {
  const VelocityModes<T> velocity(flow.layout(), potential);
  for (std::size_t c = 0; c < 3; ++c)
    flow.box().inverse(
        [&](std::size_t ix, std::size_t iy, std::size_t first, std::complex<T>* block) {
          const T factor = factor_of(multiplier, 0, ix) * factor_of(multiplier, 1, iy);
          velocity.template block<false>(c, 0, factor, ix, iy, first, block);
          multiply_along_z(multiplier, first, block);
        },
        values[c], z_stride);
}

template <class T>
void real_vorticity(Flow<T>& flow, const Modes<T>& potential, const Multiplier<T>& multiplier,
                    const std::array<T*, 3>& values, std::size_t z_stride) {
  const ModeLayout& layout = flow.layout();
  for (std::size_t c = 0; c < 3; ++c)
    flow.box().inverse(
        [&](std::size_t ix, std::size_t iy, std::size_t first, std::complex<T>* block) {
          const T factor = factor_of(multiplier, 0, ix) * factor_of(multiplier, 1, iy);
          const std::complex<T>* const from = &potential[c][ix * layout.plane + iy * layout.row + first];
          for (std::size_t l = 0; l < lanes<T>; ++l) {
            const auto k = wavevector<T>(layout, ix, iy, first + l);
            block[l] = factor * (k[0] * k[0] + k[1] * k[1] + k[2] * k[2]) * from[l];
          }
          multiply_along_z(multiplier, first, block);
        },
        values[c], z_stride);
}

template <class T>
void force_modes(Flow<T>& flow, const std::array<const T*, 3>& values, std::size_t z_stride, Modes<T>& modes) {
  const ModeLayout& layout = flow.layout();
  for (std::size_t c = 0; c < 3; ++c) {
    modes[c].resize(layout.size());
    flow.box().forward(values[c], z_stride,
                       [&](std::size_t ix, std::size_t iy, std::size_t first, const std::complex<T>* block) {
                         std::complex<T>* const to = &modes[c][ix * layout.plane + iy * layout.row + first];
                         // Wavenumbers grow along the stored modes; what follows them is zero in the block.
                         const std::size_t last = std::min(first + lanes<T>, layout.modes_z) - 1;
                         if (flow.keeps(ix, iy, first) && flow.keeps(ix, iy, last))
                           return fourier::copy_block(block, to);
                         for (std::size_t l = 0; l < lanes<T>; ++l)
                           to[l] = flow.keeps(ix, iy, first + l) ? block[l] : 0;
                       });
  }
}

template <class T>
typename BoxTransform<T>::Source velocity_source(const Flow<T>& flow, int component) {
  return [velocity = VelocityModes<T>(flow.layout(), flow.potential()), c = static_cast<std::size_t>(component)](
             std::size_t ix, std::size_t iy, std::size_t first, std::complex<T>* block) {
    velocity.template block<false>(c, 0, T(1), ix, iy, first, block);
  };
}

template <class T>
typename BoxTransform<T>::Source gradient_source(const Flow<T>& flow, int component, int axis) {
  const auto c = static_cast<std::size_t>(component), a = static_cast<std::size_t>(axis);
  return [velocity = VelocityModes<T>(flow.layout(), flow.potential()), c, a](
             std::size_t ix, std::size_t iy, std::size_t first, std::complex<T>* block) {
    velocity.template block<true>(c, a, T(1), ix, iy, first, block);
  };
}

template <class T>
void add_velocity(BoxTransform<T>& box, const ModeLayout& layout, const T* values, int component, Modes<T>& potential) {
  const auto c = static_cast<std::size_t>(component), p = (c + 1) % 3, q = (c + 2) % 3;
  box.forward(values, layout.points[2],
              [&](std::size_t ix, std::size_t iy, std::size_t first, const std::complex<T>* block) {
                for (std::size_t l = 0; l < lanes<T>; ++l) {
                  const auto k = wavevector<double>(layout, ix, iy, first + l);
                  const double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
                  const std::size_t at = ix * layout.plane + iy * layout.row + first + l;
                  if (at == 0) potential[c][0] = block[0].real();
                  if (k2 == 0 || first + l >= layout.modes_z) continue;
                  const std::complex<double> i(0, 1), u = std::complex<double>(block[l]) / k2;
                  // k x (u e_c): component p is k_q u, component q is -k_p u.
                  potential[p][at] += static_cast<std::complex<T>>(i * k[q] * u);
                  potential[q][at] -= static_cast<std::complex<T>>(i * k[p] * u);
                }
              });
}

// NOLINTBEGIN(bugprone-macro-parentheses): a type in parentheses is none
#define SPUME_INSTANTIATE(T)                                                                                           \
  template void real_velocity(Flow<T>&, const Modes<T>&, const Multiplier<T>&, const std::array<T*, 3>&, std::size_t); \
  template void real_vorticity(Flow<T>&, const Modes<T>&, const Multiplier<T>&, const std::array<T*, 3>&,              \
                               std::size_t);                                                                           \
  template void force_modes(Flow<T>&, const std::array<const T*, 3>&, std::size_t, Modes<T>&);                         \
  template BoxTransform<T>::Source velocity_source(const Flow<T>&, int);                                               \
  template BoxTransform<T>::Source gradient_source(const Flow<T>&, int, int);                                          \
  template void add_velocity(BoxTransform<T>&, const ModeLayout&, const T*, int, Modes<T>&)
// NOLINTEND(bugprone-macro-parentheses)
SPUME_INSTANTIATE(double);
SPUME_INSTANTIATE(float);
#undef SPUME_INSTANTIATE

}  // namespace spume::spectral
