// SPDX-License-Identifier: MIT
// What is drawn of a state at one time: particles, and fields on a grid. Arrays belong to whoever made the snapshot.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace spume {

// A quantity of every particle, one array per component; either f64 or i64 is filled, the other is empty. Files write
// two components as three, the third 0. The name holds no '/' and no '.'.
struct ParticleField {
  std::string name;
  std::vector<const double*> f64;
  std::vector<const std::int64_t*> i64;
  // Fills f64, where that has yet to be done.
  std::function<void()> compute = {};
};

// Particles of one kind: "fluid", "bubbles".
struct ParticleSnapshot {
  std::string name;
  std::size_t size = 0;
  std::vector<const double*> position;  // two or three arrays; files write a missing z as 0
  std::vector<ParticleField> fields;
};

// Families with all fields filled.
inline std::vector<ParticleSnapshot> completed(std::vector<ParticleSnapshot> families) {
  for (ParticleSnapshot& family : families)
    for (ParticleField& field : family.fields)
      if (field.compute) field.compute();
  return families;
}

// Fields on the points of a grid, which goes on periodically unless it is said not to: value (ix, iy, iz) of a
// component lies at (ix * ny + iy) * nz + iz.
struct GridSnapshot {
  struct Field {
    std::string name;                      // holds no '/' and no '.'
    std::vector<const float*> components;  // one or three
  };
  std::string name;
  std::array<std::size_t, 3> points{};
  std::array<double, 3> origin{}, spacing{};
  std::vector<Field> fields;
  bool periodic = true;
};

// Segments or triangles, with numbers of each.
struct SurfaceSnapshot {
  std::string name;
  std::vector<std::array<double, 3>> points;
  std::vector<std::int32_t> corners;
  int corners_per_cell = 3;  // 2: segments
  std::vector<std::pair<std::string, std::vector<std::int32_t>>> fields = {};
};

}  // namespace spume
