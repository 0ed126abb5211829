// SPDX-License-Identifier: MIT
// How fast particles move, and the steps that follow.
#pragma once

#include "spume/core/error.hpp"
#include "spume/core/step_limit.hpp"
#include "spume/particles/arrangement.hpp"

namespace spume {

// The smallest of several bounds; of equal ones the first.
class SmallestStep {
 public:
  void bound(double dt, const char* name) {
    if (dt < limit_.dt) limit_ = {dt, name};
  }
  const StepLimit& limit() const { return limit_; }

 private:
  StepLimit limit_{1e300, "nothing"};
};

// Largest speeds of a state.
struct Speeds {
  double largest = 0;
  double limiting = 0;  // without spray, which only falls: one droplet need not hold up the whole liquid
};
// By the lists of the last step, where there are any.
Speeds find_speeds(const Arrangement& arrangement, const ParticleStore& particles);

// Names the first particle that is wrong, and where it is.
template <class Wrong>
void blame_first(StepFailure::Details& details, const ParticleStore& particles, const VectorField& at, Wrong&& wrong) {
  std::size_t i = 0;
  while (i < particles.size() && !wrong(i)) ++i;
  if (i == particles.size()) return;
  details.particle = (*particles.identifier)[i];
  for (int axis = 0; axis < particles.dimensions; ++axis) details.position[axis] = (*at[axis])[i];
}

// A particle that crosses half its support in one step has left the neighbours that its pressure was solved with.
// Throws StepFailure for one, or for a velocity that is not finite. `at`: where to say that it is.
void refuse_long_strides(const ParticleStore& particles, const VectorField& at, const VectorScratch& velocity,
                         double support_radius, double dt);

// The new state of a weakly compressible step, where it is.
struct CompressedState {
  const VectorField& at;
  const double* excess = nullptr;
  const FloatVectorScratch& force;
};
// Throws StepFailure for a density that has changed by half, which is that of no weakly compressible flow, or a force
// that is not finite, and names `option`.
void refuse_burst(const ParticleStore& particles, const CompressedState& state, const char* option);

}  // namespace spume
