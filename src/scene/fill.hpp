// SPDX-License-Identifier: MIT
// Places the liquid particles of the start, on a lattice or in columns of their own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "spume/scene/case.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/lattice.hpp"

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
