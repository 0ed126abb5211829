// SPDX-License-Identifier: MIT
// A frame of the live view: what is drawn of a state, as one binary message.
//
//   uint32   bytes of arrays
//   arrays   of the blocks, each from a multiple of 4 bytes after that number on ("at", in bytes)
//   header   JSON: {"step", "time", "blocks": [...], "picked", "point"}
//
// A block of kind "particles" has positions, `dimensions` numbers of 16 bits a particle between lower and upper of its
// box, then values of 8 or 16 bits between low and high, then sizes (diameters, 16 bits from 0 to largest) where its
// family has them. A block of kind "plane" has the values of columns x rows points in a plane across a grid, rows
// following each other; one of kind "volume" those of every so many points of the grid, the first axis outermost. The
// largest value of 8 or 16 bits stands for what is no finite number. Where the viewer asks for phases, a block of
// particles has a byte a particle with that of each.
//
// "picked" are all values of one particle, "point" those of the flow at a place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spume/io/snapshot.hpp"

namespace spume {

struct FrameScratch {
  std::vector<std::uint32_t> selected;
  std::vector<double> values;
  std::vector<std::vector<double>> gathered;  // numbers of particles that do not stand one behind the other, by column
};

// A particle: the nearest to a place, and from then on that with its identifier.
struct PickWish {
  std::string family = {};
  std::array<double, 3> place{};
  std::optional<std::int64_t> id = {};
  bool operator==(const PickWish&) const = default;
};

// What a viewer wants to see.
struct FrameWish {
  std::size_t points = 100000;  // of all families together; more are thinned
  int bits = 16;                // of a value: 8 or 16
  std::map<std::string, std::string> fields =
      {};                  // colour of each family: "pressure", "velocity" (its size), "velocity_x"
  int plane_axis = 2;      // normal of the plane through fields on a grid
  double plane_at = 0.5;   // its place, from 0 at the lower side of the grid to 1
  std::size_t volume = 0;  // points along the longest side of a grid that is sent as a whole; 0: none is
  bool phases = false;
  std::optional<PickWish> picked = {};
  std::optional<std::array<double, 3>> point = {};
  std::size_t snapshot = 0;  // of results that are played: which one
  bool operator==(const FrameWish&) const = default;
};
inline constexpr std::size_t most_frame_points = 2000000;
inline constexpr std::size_t most_plane_points = 512;  // along each side; more are thinned
inline constexpr std::size_t most_volume_points = 128;

// What a family may be coloured by.
std::vector<std::string> colourings(const ParticleSnapshot& family);

// A state that is shown.
struct FrameSide {
  double time = 0;
  const std::vector<ParticleSnapshot>& families;
  const std::vector<GridSnapshot>& grids;
  double spacing = 0;
};

// Makes frames in memory that it keeps: pages that are new to the process cost more than the codes in them (10 ms
// against 1 ms for 1e5 particles on a virtual machine).
class FrameMaker {
 public:
  // `spacing`: of the particles, where they have one; a place in the flow takes the mean over particles around it.
  std::shared_ptr<const std::string> make(std::int64_t step, double time, const std::vector<ParticleSnapshot>& families,
                                          const std::vector<GridSnapshot>& grids, const FrameWish& wish,
                                          double spacing = 0);
  // Of one run, or of two beside each other, which share the bound of the viewer: "side" 0 and 1 of the blocks, and
  // the time of the second in "beside".
  std::shared_ptr<const std::string> make(std::int64_t step, const std::vector<FrameSide>& sides,
                                          const FrameWish& wish);

 private:
  std::shared_ptr<std::string> free_buffer();
  std::vector<std::shared_ptr<std::string>> buffers_;  // those that nobody else holds are free
  FrameScratch scratch_;
};

}  // namespace spume
