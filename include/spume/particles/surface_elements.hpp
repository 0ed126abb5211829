// SPDX-License-Identifier: MIT
// The surfaces of bodies in elements of about a spacing, where the bodies stand at the start, and which of the elements
// lie beside each other.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "spume/particles/body_walls.hpp"

namespace spume {

class SurfaceElements {
 public:
  struct Element {
    Vec3 middle{}, area{};  // area times the normal out of the body
    std::int32_t body = 0;  // among those of the scene
  };

  // Of all bodies that are walls; elements inside of others are left out. Scene and walls, where they stand at the
  // start, are read here alone.
  SurfaceElements(const Scene& scene, const BodyWalls& walls, double spacing);

  std::size_t size() const { return elements_.size(); }
  const Element& operator[](std::size_t e) const { return elements_[e]; }
  // Those that share a corner with it, and of other bodies that move with its own those next to it, nearest first.
  std::span<const std::int32_t> beside(std::size_t e) const {
    return std::span(beside_).subspan(static_cast<std::size_t>(first_[e]),
                                      static_cast<std::size_t>(first_[e + 1] - first_[e]));
  }

  // What an element is for those that look for the nearest source along the surface.
  enum class Role : std::uint8_t {
    none,    // no way leads over it
    seeks,   // one of those
    source,  // found where nearest
    end      // found where no source is as near
  };
  // For each that seeks the source or end that is the fewest steps from element to element away, of those as far the
  // one that the nearest neighbour leads to; -1 where there is none.
  std::vector<std::int32_t> nearest_sources(const std::vector<Role>& role,
                                            const std::vector<std::size_t>& seeking) const;

 private:
  using Corner = std::pair<std::array<std::int64_t, 3>, std::int32_t>;  // its place, and whose it is
  void add_body(const Scene& scene, std::size_t body, const RigidWalls& walls, double spacing,
                std::vector<Corner>& corners);
  void find_neighbours(const Scene& scene, double spacing, std::vector<Corner>& corners);

  std::vector<Element> elements_;
  std::vector<std::int32_t> first_, beside_;
};

}  // namespace spume
