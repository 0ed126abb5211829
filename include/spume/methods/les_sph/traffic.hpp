// SPDX-License-Identifier: MIT
// Compulsory memory traffic of the stages of a step (core/ledger.hpp), in bytes, for the ledger: counted from the
// arrays that a stage passes over and from the sweeps since Records::take_traffic() was last called, which each of the
// functions that hold a sweep calls. Nothing is measured: a call costs some additions.
//
// Counted are the passes over all particles, all points and all lists. Left out are the loops over the particles at a
// surface alone (the layers of the shift, the rows and gradients of edge particles), values of images (they come from
// particles that the same pass reads) and, of the pressure solve, all but the matrix: the vectors of the Krylov method
// and the cells of the preconditioner. Stages without a function here have no count: images, surface, bubbles.
#pragma once

#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph::traffic {

double move(const Liquid& liquid);
double sort(const Liquid& liquid);
double neighbours(const Liquid& liquid);
double geometry(Liquid& liquid);
double shift(Liquid& liquid);
double gradients(Liquid& liquid);
double shift_curvature(Liquid& liquid);
double eddy_viscosity(Liquid& liquid);
double prediction(Liquid& liquid);
double divergence(Liquid& liquid);
double pressure(Liquid& liquid);
double projection(Liquid& liquid);
double accept(const Liquid& liquid);

}  // namespace spume::les_sph::traffic
