// SPDX-License-Identifier: MIT
// A stream between an inflow and an outflow, for the methods of phases.
#pragma once

#include <string>

#include "scene/helpers.hpp"

namespace spume::test {

// From the left to the right, between walls below and above.
inline std::string stream_of_phases(const std::string& method) {
  return "method = \"" + method + "\"\n" + R"toml([domain]
lower = [0, 0]
upper = [1, 0.5]
bottom = "free-slip"
top = "free-slip"
[resolution]
spacing = 0.05
[fluid]
gravity = 0
[[phase]]
name = "water"
density = 1000
viscosity = 1
[[region]]
phase = "water"
velocity = ["1", "0"]
[[inflow]]
side = "left"
velocity = ["1", "0"]
[[outflow]]
side = "right"
[time]
end = 2
)toml";
}

// The whole stream is of water, or of air and water, one above the other or one behind the other.
inline std::string stream_with_air(const std::string& stream, const std::string& region) {
  return replaced(
      replaced(stream, "[[region]]", "[[phase]]\nname = \"air\"\ndensity = 1\nviscosity = 0.01\n[[region]]"),
      "[[inflow]]",
      "[[region]]\nphase = \"air\"\nvelocity = [\"1\", \"0\"]\n" + region + "[[inflow]]\nphase = \"water\"");
}

}  // namespace spume::test
