// SPDX-License-Identifier: MIT
// Whether a weakly compressible liquid starts at rest, to be settled (particles/settling.hpp) before its first step.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "spume/scene/scene.hpp"

namespace spume {

// Some particle has a first velocity.
bool starts_moving(const Scene& scene);

struct StartAtRest {
  bool settles = false;
  std::string reason;                // why, or why not
  std::vector<std::uint8_t> chosen;  // by identifier, 1 for those at rest; empty: all or none

  // What the scene does not say.
  struct Circumstances {
    bool moving_bodies = false;
    bool oxygen = false;         // passes the surface, of which a settled one has 8 % too much area
    bool in_layers = false;      // several phases do, in a closed tank, and their pressures meet by densities
    bool unasked = false;        // nobody wants it to
    std::string mean_pressures;  // why the pressures of several phases meet otherwise; empty where they do not
  };
  StartAtRest() = default;
  // Particles of the scene, without velocities: of several phases that lie in layers, or of one phase the parts that
  // are level (particles_at_rest).
  StartAtRest(const Scene& scene, const Circumstances& circumstances);
};

}  // namespace spume
