// SPDX-License-Identifier: MIT
#include "spume/particles/store.hpp"

#include "spume/core/parallel.hpp"

namespace spume {

ParticleStore::ParticleStore(int scene_dimensions, const InitialParticles& initial)
    : dimensions(scene_dimensions), volume(initial.volume) {
  fields.resize(initial.size());
  add_vector(position, "position", Lifetime::state);
  add_vector(velocity, "velocity", Lifetime::state);
  identifier = &fields.add<std::int64_t>("identifier", Lifetime::state);
  parallel_for(size(), [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis) {
      (*position[axis])[i] = initial.position[axis][i];
      (*velocity[axis])[i] = initial.velocity[axis][i];
    }
    (*identifier)[i] = static_cast<std::int64_t>(i);
  });
}

}  // namespace spume
