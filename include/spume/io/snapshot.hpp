// SPDX-License-Identifier: MIT
// What is drawn of a state at one time: particles, and fields on a grid. Arrays belong to whoever made the snapshot.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace spume {

// A quantity of every particle, one array per component; either f64 or i64 is filled, the other is empty. Files write
// two components as three, the third 0. The name holds no '/' and no '.'.
struct ParticleField {
  std::string name;
  std::vector<const double*> f64;
  std::vector<const std::int64_t*> i64;
};

// Particles of one kind: "fluid", "bubbles".
struct ParticleSnapshot {
  std::string name;
  std::size_t size = 0;
  std::vector<const double*> position;  // two or three arrays; files write a missing z as 0
  std::vector<ParticleField> fields;
};

// Fields on the points of a periodic grid: value (ix, iy, iz) of a component lies at (ix * ny + iy) * nz + iz.
struct GridSnapshot {
  struct Field {
    std::string name;                      // holds no '/' and no '.'
    std::vector<const float*> components;  // one or three
  };
  std::string name;
  std::array<std::size_t, 3> points{};
  std::array<double, 3> origin{}, spacing{};
  std::vector<Field> fields;
};

}  // namespace spume
