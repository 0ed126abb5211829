// SPDX-License-Identifier: MIT
// Interfaces between phases as they are drawn: where a smoothed colour is one half. The colour
//
//   C(x) = sum_j c_j V W(x - r_j) / sum_j V W(x - r_j),   c_j 1 in a phase and 0 elsewhere,
//
// (6) of Joubert et al. at any place, is found at nodes one spacing apart that end on the sides of the domain, averaged
// there, C', and again by as much, C'', and is (2 + sqrt 2) C' - (1 + sqrt 2) C''. On the surface of a ball an average
// of the variance s^2 is lower than one half by s / (sqrt(2 pi) R), which these take out; C' alone moves the surface
// inwards by (d - 1) s^2 / (2 R). Between nodes the colour is linear on triangles or tetrahedra. Nothing is drawn where
// the kernel finds less than half of its liquid: in bodies, deeper than half a spacing, and beyond free surfaces.
#pragma once

#include "spume/io/snapshot.hpp"
#include "spume/particles/point_sampler.hpp"

namespace spume {

// Of every phase but the first in a scene of two, else of all, whose numbers are the field "phase": of three or more
// phases every interface is there twice. Triangles are counter-clockwise seen from outside the phase, which lies to the
// left of segments.
SurfaceSnapshot interface_contours(const PointSampler& sampler, const Array<std::int64_t>& phase, std::size_t phases);

}  // namespace spume
