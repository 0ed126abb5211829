// SPDX-License-Identifier: MIT
// The choices of the particle models, in a header that options and checks can include without the models.
#pragma once

namespace spume {

enum class Coupling {
  one_way,    // the flow moves the particles
  two_way,    // and the particles the flow
  four_way,   // and they exclude each other
  colliding,  // they exclude each other, and the flow feels nothing
};

inline bool acts_on_flow(Coupling coupling) {
  return coupling == Coupling::two_way || coupling == Coupling::four_way;
}
inline bool excludes(Coupling coupling) {
  return coupling == Coupling::four_way || coupling == Coupling::colliding;
}

enum class DragLaw { stokes, schiller_naumann };

enum class Placement {
  random,     // evenly at random
  lattice,    // on a lattice with one particle at the lower corner of the box
  clustered,  // in Gaussian clouds
  file,       // at given positions, those of a file
};

enum class MatchingMethod {
  rounds,   // locally strongest pairs, in parallel
  sorting,  // the paper's: all overlaps listed, sorted, purged
};

}  // namespace spume
