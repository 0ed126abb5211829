// SPDX-License-Identifier: MIT
// Real fields of a flow on the points of its grid, and a real force on its modes.
//
// Point (ix, iy, iz) is at lower + (ix Lx/nx, iy Ly/ny, iz Lz/nz); its value lies at (ix * ny + iy) * z_stride + iz.
#pragma once

#include "spume/methods/spectral/flow.hpp"

namespace spume::spectral {

// Real factors by mode index along each axis, in Fourier space; an empty list stands for ones. The prefilter of a
// B-spline is such a product.
template <class T>
using Multiplier = std::array<std::vector<T>, 3>;

// u = curl b, component by component: three fields of nx * ny * z_stride numbers.
template <class T>
void real_velocity(Flow<T>& flow, const Modes<T>& potential, const Multiplier<T>& multiplier,
                   const std::array<T*, 3>& values, std::size_t z_stride);

// omega = curl u = k^2 b.
template <class T>
void real_vorticity(Flow<T>& flow, const Modes<T>& potential, const Multiplier<T>& multiplier,
                    const std::array<T*, 3>& values, std::size_t z_stride);

// Modes of a force per mass given on the points, up to N/2 along each axis; Flow::set_force takes them.
template <class T>
void force_modes(Flow<T>& flow, const std::array<const T*, 3>& values, std::size_t z_stride, Modes<T>& modes);

// Modes of u_component, as a source of BoxTransform.
template <class T>
typename BoxTransform<T>::Source velocity_source(const Flow<T>& flow, int component);

// Modes of d u_component / d x_axis, as a source of BoxTransform.
template <class T>
typename BoxTransform<T>::Source gradient_source(const Flow<T>& flow, int component, int axis);

// b of a velocity given on the points one component at a time: adds k^-2 i k x u for that component, and its mean.
template <class T>
void add_velocity(BoxTransform<T>& box, const ModeLayout& layout, const T* values, int component, Modes<T>& potential);

}  // namespace spume::spectral
