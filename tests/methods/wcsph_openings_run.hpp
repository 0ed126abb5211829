// SPDX-License-Identifier: MIT
// Scenes of wcsph with inflows and outflows, and scalars that go through them.
#pragma once

#include "methods/stream_of_phases.hpp"
#include "methods/wcsph_run.hpp"

namespace spume::test {

inline const std::string stream = stream_of_phases("wcsph");

// A stream below a free surface, which enters through a patch of a wall.
inline const std::string below_surface = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 0.6]
left = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.05
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1000
viscosity = 0.1
[[region]]
phase = "water"
upper = [1, 0.3]
velocity = ["0.5", "0"]
[[inflow]]
side = "left"
upper = [0, 0.3]
velocity = ["0.5", "0"]
[[outflow]]
side = "right"
level = 0.3
[compressibility]
max_speed = 1.5
[time]
end = 0.2
)toml";

// Liquid at rest between two outflows, on the right one of which the pressure is 20.
inline const std::string between_outflows =
    replaced(replaced(replaced(stream, "viscosity = 1\n", "viscosity = 0.01\n"), "velocity = [\"1\", \"0\"]", ""),
             "[[inflow]]\nside = \"left\"\nvelocity = [\"1\", \"0\"]\n[[outflow]]",
             "[[outflow]]\nside = \"left\"\n[[outflow]]\npressure = 20");

// A tank of water with a free surface at 0.5.
inline const std::string tank_half_full = R"toml(method = "wcsph"
[domain]
lower = [0, 0]
upper = [1, 1]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.05
[fluid]
gravity = 1
[[phase]]
name = "water"
density = 1000
viscosity = 1
[[region]]
phase = "water"
upper = [1, 0.5]
[time]
end = 1
)toml";

// A profile that the stream carries along and diffusion leaves as it is; one of which nothing is said where it enters.
inline const std::string carried = R"toml([[scalar]]
name = "dye"
initial = "3 - x"
inflow = "3 - x + t"
diffusivity = 0.01
)toml";
inline const std::string unled = R"toml([[scalar]]
name = "silt"
initial = "1 + y"
)toml";

}  // namespace spume::test
