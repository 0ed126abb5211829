// SPDX-License-Identifier: MIT
// A frame of the live view: what is drawn of a state, as one binary message.
//
//   uint32   bytes of arrays
//   arrays   of the blocks, each from a multiple of 4 bytes after that number on ("at", in bytes)
//   header   JSON: {"step", "time", "blocks": [...]}
//
// A block of kind "particles" has positions, `dimensions` numbers of 16 bits a particle between lower and upper of its
// box, then values of 8 or 16 bits between low and high, then sizes (diameters, 16 bits from 0 to largest) where its
// family has them. A block of kind "plane" has the values of columns x rows points in a plane across a grid, rows
// following each other. The largest value of 8 or 16 bits stands for what is no finite number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "spume/io/snapshot.hpp"

namespace spume {

struct FrameScratch {
  std::vector<std::uint32_t> selected;
  std::vector<double> values;
};

// What a viewer wants to see.
struct FrameWish {
  std::size_t points = 100000;  // of all families together; more are thinned
  int bits = 16;                // of a value: 8 or 16
  std::map<std::string, std::string> fields =
      {};                 // colour of each family: "pressure", "velocity" (its size), "velocity_x"
  int plane_axis = 2;     // normal of the plane through fields on a grid
  double plane_at = 0.5;  // its place, from 0 at the lower side of the grid to 1
  bool operator==(const FrameWish&) const = default;
};
inline constexpr std::size_t most_frame_points = 2000000;
inline constexpr std::size_t most_plane_points = 512;  // along each side; more are thinned

// What a family may be coloured by.
std::vector<std::string> colourings(const ParticleSnapshot& family);

// Makes frames in memory that it keeps: pages that are new to the process cost more than the codes in them (10 ms
// against 1 ms for 1e5 particles on a virtual machine).
class FrameMaker {
 public:
  std::shared_ptr<const std::string> make(std::int64_t step, double time, const std::vector<ParticleSnapshot>& families,
                                          const std::vector<GridSnapshot>& grids, const FrameWish& wish);

 private:
  std::shared_ptr<std::string> free_buffer();
  std::vector<std::shared_ptr<std::string>> buffers_;  // those that nobody else holds are free
  FrameScratch scratch_;
};

}  // namespace spume
