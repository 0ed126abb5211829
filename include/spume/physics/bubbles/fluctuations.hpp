// SPDX-License-Identifier: MIT
// The unresolved velocity of the liquid that a bubble feels (King et al. 2022, section 2.2.1; Pozorski & Apte 2009):
//
//   u'(t + dt) = E u'(t) + W zeta,  E = (E_par - E_perp) R + E_perp I,  R = w (x) w / |w|^2,
//   E = exp(-dt/tau), W = sigma sqrt(1 - exp(-2 dt/tau)) along and across the filtered relative velocity w,
//   tau_par = tau / sqrt(1 + |w|^2/sigma^2), tau_perp = tau / sqrt(1 + 4 |w|^2/sigma^2)   [(2.19), modulus squared]
//   sigma = sqrt(2 k / 3), tau = C Delta / sigma.
//
// The update is exact for constant coefficients: the variance tends to sigma^2 per component.
#pragma once

#include "spume/scene/scene.hpp"

namespace spume::bubbles {

// `energy` is k of the unresolved motion, `width` the filter width, `noise` three standard normal numbers. Without
// relative velocity both directions are across; without energy the fluctuation is zero.
Vec3 advance_fluctuation(const Vec3& fluctuation, const Vec3& relative_velocity, double energy, double width,
                         double constant, double dt, const Vec3& noise);

}  // namespace spume::bubbles
