// SPDX-License-Identifier: MIT
// The vector potential of the velocity that a case starts from.
#pragma once

#include "spume/methods/spectral/flow.hpp"

namespace spume::spectral {

// taylor-green: u = V (sin X cos Y cos Z, -(kx/ky) cos X sin Y cos Z, 0), X = kx (x - lower), m periods in the box;
// abc: u = (A sin Z + C cos Y, B sin X + A cos Z, C sin Y + B cos X) with one wavelength, that of the box of equal
// sides; random: phases from the seed (the same for a mode on every grid), energy in shells of width 2 pi / longest
// length as the spectrum says, scaled to the mean energy; expressions: the solenoidal part of the values on the points;
// checkpoint: the modes that both grids hold.
// Built in the arrays of the flow (Flow::take_potential). Throws InputError for what the case cannot start from.
template <class T>
Modes<T> initial_potential(const LoadedCase& loaded, Flow<T>& flow);

}  // namespace spume::spectral
