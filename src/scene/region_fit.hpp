// SPDX-License-Identifier: MIT
// Cells for the particles of a region, fitted to its box and to the solids in it: particles start half a spacing from
// every wall, wherever it lies, and the cells make up the region.
//
// Faces that end below the upper layers do not shape these: there columns are as if the solids below were not.
//
// Across, cells are as near to those of the lattice as whole numbers of them fit between the faces. In a column the
// layers follow from the volume of a particle, which all have in common. Below a free surface the upper layers have
// exactly that volume: a surface is level when the liquid beside it has one density there, and layers that differ by 1
// % of a spacing make waves of 1e-3 sqrt(g H). Where box and faces lie on planes of the lattice its own cells are
// taken.
#pragma once

#include <vector>

#include "fill.hpp"
#include "spume/scene/solid_union.hpp"

namespace spume {

// Cells along an axis between two planes, of one width.
struct CellRun {
  double lower = 0, width = 0, cells = 0;
  bool own = false;  // of the lattice: centres are written as it writes them
  double first = 0;  // then the number of the first
};

// An interval of a column, filled with liquid.
struct ColumnPart {
  double lower = 0, upper = 0;
  bool free_above = false;
};

// A cell that a column stands on, its area over that of the lattice, and the ends of the column.
struct ColumnCell {
  double x = 0, y = 0, area = 1;
  double lower = 0, upper = 0;
};

class ColumnFit {
 public:
  // Layers that a surface row of the pressure equation sees: those within a support radius of 2.6 spacings, and one.
  static constexpr double upper_layers = 4;

  // Of a layer, of a film over a solid: of half a layer one row of particles, twice as thick as the film, runs off the
  // solid or lifts from it within a second.
  static constexpr double least_film = 0.75;

  // `solids`: null without.
  ColumnFit(const Lattice& lattice, const SolidUnion* solids) : lattice_(lattice), solids_(solids) {}

  // Runs between `lower`, `faces` and `upper`, each as near to the lattice as whole numbers of cells are. A face within
  // half a spacing of another plane is passed over, unless all is solid between them: solid(from, to).
  template <class Solid>
  std::vector<CellRun> runs(std::size_t axis, double lower, double upper, const std::vector<double>& faces,
                            Solid&& solid) const;
  // The number of cells of a run, within a quarter of those of the lattice, over which thin parts hold nearly whole
  // numbers of layers. `width`: of the run across, over the lattice.
  void fit_parts(CellRun& run, std::size_t axis, double width, const std::vector<ColumnPart>& parts) const;
  double centre(const CellRun& run, std::size_t axis, double k) const {
    return run.own ? lattice_.origin[axis] + (run.first + k + 0.5) * lattice_.spacing[axis]
                   : run.lower + (k + 0.5) * run.width;
  }

  // The parts of a column at p between two heights that are free.
  std::vector<ColumnPart> parts(const Vec3& p, double lower, double upper) const;
  // The depth of a part over a cell of `area` times that of the lattice, in layers of the lattice's volume.
  double depth(const ColumnPart& part, double area) const {
    return (part.upper - part.lower) / lattice_.spacing[up()] * area;
  }
  // A part of so few layers that all of them are seen from its surface.
  static bool is_thin(double layers);
  // The same in whole layers.
  double layers(const ColumnPart& part, double area) const;
  // Heights of their centres, ascending. `particle_volume`: over that of a cell of the lattice.
  void heights(const ColumnPart& part, double area, double particle_volume, std::vector<double>& out) const;

 private:
  bool on_lattice(const ColumnPart& part, double area) const;
  std::size_t up() const { return static_cast<std::size_t>(lattice_.dimensions) - 1; }
  double line_of(double height) const { return (height - lattice_.origin[up()]) / lattice_.spacing[up()]; }
  CellRun run_between(std::size_t axis, double lower, double upper) const;
  const Lattice& lattice_;
  const SolidUnion* solids_;
};

template <class Solid>
std::vector<CellRun> ColumnFit::runs(std::size_t axis, double lower, double upper, const std::vector<double>& faces,
                                     Solid&& solid) const {
  const double half = 0.5 * lattice_.spacing[axis];
  std::vector<CellRun> result;
  double start = lower;
  for (const double face : faces) {
    if (face <= start || face >= upper) continue;
    const bool wide = face > start + half && face < upper - half;
    if (!wide && !solid(start, face) && !solid(face, upper)) continue;
    result.push_back(run_between(axis, start, face));
    start = face;
  }
  result.push_back(run_between(axis, start, upper));
  if (result.size() > 1) std::erase_if(result, [&](const CellRun& run) { return run.width * run.cells < half; });
  return result;
}

}  // namespace spume
