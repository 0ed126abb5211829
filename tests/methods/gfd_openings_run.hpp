// SPDX-License-Identifier: MIT
// gfd between an inflow and an outflow.
#pragma once

#include <functional>

#include "methods/gfd_run.hpp"
#include "methods/stream_of_phases.hpp"

namespace spume::test {

inline const std::string gfd_stream = stream_of_phases("gfd");
inline std::string gfd_stream_with_air(const std::string& region) {
  return stream_with_air(gfd_stream, region);
}

// A round drop of air carried through, with tension, weight and viscosity.
inline const std::string gfd_drop_in_a_stream = replaced(gfd_stream_with_air("centre = [0.6, 0.25]\nradius = 0.15\n"),
                                                         "[time]", "[interface]\nsurface_tension = 2\n[time]");

// Water over its level at rest in a tank that is open to the right.
inline const std::string gfd_layers_beside_an_outflow = R"toml(method = "gfd"
[domain]
lower = [0, 0]
upper = [1, 1]
left = "free-slip"
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.05
[fluid]
gravity = 9.81
[[phase]]
name = "water"
density = 1000
viscosity = 1e-3
[[phase]]
name = "oil"
density = 800
viscosity = 1e-2
[[region]]
phase = "oil"
[[region]]
phase = "water"
upper = [1, 0.5]
[[outflow]]
side = "right"
level = 0.5
[time]
end = 1
)toml";

// Root mean squares over the particles of the domain.
struct StreamErrors {
  double velocity = 0, pressure = 0;
};
inline StreamErrors stream_errors(const GfdRun& run, const std::function<Vec3(const Vec3&)>& velocity,
                                  const std::function<double(const Vec3&)>& pressure) {
  const gfd::Flow& flow = run.flow();
  double u = 0, p = 0, n = 0;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    if (!flow.in_domain(i)) continue;
    const Vec3 r = vector_at(flow.particles.position, flow.dimensions, i), exact = velocity(r);
    for (int axis = 0; axis < flow.dimensions; ++axis)
      u += std::pow((*flow.particles.velocity[axis])[i] - exact[axis], 2);
    p += std::pow((*flow.pressure)[i] - pressure(r), 2);
    ++n;
  }
  return {std::sqrt(u / n), std::sqrt(p / n)};
}

}  // namespace spume::test
