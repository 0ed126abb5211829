// SPDX-License-Identifier: MIT
// Places the liquid particles of the start.
//
// Lattice: cell centres lower + (k + 1/2) d per axis. Where both sides of an axis are walls or the axis is
// periodic, d is the length over the nearest integer count; otherwise d is the spacing, measured from the wall
// if there is one. Every particle has the volume of a lattice cell.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spume/scene/case.hpp"
#include "spume/scene/document.hpp"

namespace spume {

// A [[liquid]] or [[region]] entry, compiled. The region is the intersection of what is given.
struct LiquidRegion {
  std::string name;                         // "liquid.0", "region.0"
  const Node* node = nullptr;               // for messages
  std::shared_ptr<const Expression> where;  // null: everywhere
  Vec3 lower{}, upper{};                    // box, the domain where none is given
  bool ball = false;
  Vec3 centre{};
  double radius = 0;
  ShapePointer body;  // null: no body
  VectorExpression velocity;
  bool conform = false;
  std::int32_t phase = -1;  // index of the phase that fills it, in place of what earlier regions put there; -1: none
};

struct Lattice {
  int dimensions = 3;
  Vec3 origin{};                         // lower corner of the first cell
  Vec3 spacing{};                        // 1 in directions that do not exist
  std::array<double, 3> count{1, 1, 1};  // whole numbers, as double because a foolish case may overflow
  double volume() const { return spacing[0] * spacing[1] * spacing[2]; }
  double sites() const { return count[0] * count[1] * count[2]; }
};

Lattice make_lattice(const Domain& domain, double spacing);

// Fills scene.particles and sets scene.free_surface. Regions of phases replace what earlier ones put there; others must
// not overlap. Reports empty and overlapping regions, values that are not
// finite, counts beyond 2^31, and more than `most` particles, which the machine's memory does not hold.
void fill_scene(Scene& scene, const Lattice& lattice, const std::vector<LiquidRegion>& regions, double jitter,
                double most, Problems& problems);

// Of a filled scene with gravity and a surface: where cells beside solid boxes differ from the lattice by more than
// still water bears, and a spacing near the one asked for with which none do.
std::vector<Problem> cell_warnings(Scene& scene, const Lattice& lattice, const std::vector<LiquidRegion>& regions,
                                   const std::string& file);
// The same without solids too: where a region that does not conform is no whole number of layers deep.
std::vector<Problem> level_warnings(const Scene& scene, const Lattice& lattice,
                                    const std::vector<LiquidRegion>& regions, const std::string& file);

}  // namespace spume
