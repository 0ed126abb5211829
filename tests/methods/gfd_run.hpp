// SPDX-License-Identifier: MIT
// gfd on tiny cases.
#pragma once

#include <cmath>
#include <string>

#include "methods/method_run.hpp"
#include "methods/uncounted_stages.hpp"
#include "spume/methods/gfd/gfd.hpp"

namespace spume::test {

struct GfdRun : MethodRun<gfd::Gfd> {
  using MethodRun::MethodRun;

  const gfd::Flow& flow() const { return method.flow(); }
  // In equal parts of what is left, as long as the limits of the steps allow: the pressure of a sliver of a step has
  // all that the last projections left of the divergence over the time of the sliver.
  void until(double end) {
    while (true) {
      const double parts = std::ceil((end - method.time()) / method.step_limit().dt - 1e-9);
      if (parts < 1) return;
      method.step((end - method.time()) / parts, ledger);
    }
  }
  double max_speed() const { return flow().speeds.largest; }
};

// A drop in a box, 20 x 20 particles; walls of both kinds.
inline const std::string drop_in_a_box = R"toml(method = "gfd"
[domain]
lower = [0, 0]
upper = [1, 1]
left = "free-slip"
right = "free-slip"
bottom = "no-slip"
top = "no-slip"
[resolution]
spacing = 0.05
[fluid]
gravity = 1
[[phase]]
name = "outside"
density = 1
viscosity = 0.01
[[phase]]
name = "drop"
density = 10
viscosity = 0.1
[interface]
surface_tension = 1
[[region]]
phase = "outside"
[[region]]
phase = "drop"
centre = [0.5, 0.5]
radius = 0.25
[time]
end = 1
)toml";

// A ball in a periodic box, 12^3 particles.
inline const std::string ball_in_a_box = periodic_cube("gfd", "0.0833333333333333333") + R"toml([[phase]]
name = "outside"
density = 1
viscosity = 0.1
[[phase]]
name = "ball"
density = 2
viscosity = 0.5
[interface]
surface_tension = 1
[[region]]
phase = "outside"
velocity = ["0.2", "0", "0.1"]
[[region]]
phase = "ball"
centre = [0.5, 0.5, 0.5]
radius = 0.3
[time]
end = 1
)toml";

// Layers of three phases, the heaviest below, at rest under gravity.
inline const std::string three_layers = R"toml(method = "gfd"
[domain]
lower = [0, 0]
upper = [1, 1.5]
x = "periodic"
bottom = "no-slip"
top = "no-slip"
[resolution]
spacing = 0.05
[fluid]
gravity = 9.81
[[phase]]
name = "air"
density = 1.2
viscosity = 1.8e-5
[[phase]]
name = "oil"
density = 800
viscosity = 0.1
[[phase]]
name = "water"
density = 1000
viscosity = 1e-3
[interface]
surface_tension = 0.07
[[region]]
phase = "air"
[[region]]
phase = "oil"
where = "1 - y"
[[region]]
phase = "water"
where = "0.5 - y"
[time]
end = 1
)toml";

// A drop in a round tank that turns.
inline const std::string drop_in_a_turning_tank = R"toml(method = "gfd"
[domain]
lower = [-0.6, -0.6]
upper = [0.6, 0.6]
[resolution]
spacing = 0.05
[[phase]]
name = "outside"
density = 1
viscosity = 0.01
[[phase]]
name = "drop"
density = 10
viscosity = 0.1
[interface]
surface_tension = 1
[[region]]
phase = "outside"
[[region]]
phase = "drop"
centre = [0.15, 0]
radius = 0.2
[[body]]
shape = "cylinder"
radius = 0.5
inside = false
wall = "no-slip"
angle = "90*t*t"
[time]
end = 1
)toml";

}  // namespace spume::test
