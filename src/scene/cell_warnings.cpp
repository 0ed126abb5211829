// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "filler.hpp"

namespace spume {
namespace {

// What still water bears, as shares. Of 60 scenes in two dimensions, boxes of random size and place, 14 passed 1e-3
// sqrt(g H) within 20 sqrt(H / g) before liquid at rest was balanced, two since. All of these have a part of up to
// `film_layers` layers below a free surface that is more than `most_depth` off, or columns over five layers at most
// that are stretched by more than `most_stretch`; so have 11 of the others. In three dimensions pillars with cells 5 %
// off leave 7e-5, 10 % off 0.009, 19 to 48 % off 0.01 to 0.5.
constexpr double most_depth = 0.05, most_width = 0.075, most_stretch = 0.15, film_layers = 4;
// A spacing with which all cells keep to both is looked for among numbers of three digits, from the one asked for to
// these shares of it, and among so many columns in all, which take half a second.
constexpr double finest = 0.4, coarsest = 1.3;
constexpr std::size_t most_columns = 20'000'000;

double nearest_fitting(Scene& scene, const std::vector<LiquidRegion>& regions, Problems& unheard) {
  const double digit = std::pow(10, std::floor(std::log10(scene.spacing)) - 2),
               from = std::round(scene.spacing / digit);
  std::size_t columns = 0;
  for (double k = 0; (from - k) * digit >= finest * scene.spacing && columns < most_columns; ++k)
    for (const double way : {-1.0, 1.0}) {
      const double spacing = std::stod(brief((from + way * k) * digit));
      if (spacing > coarsest * scene.spacing) continue;
      const Lattice lattice = make_lattice(scene.domain, spacing);
      Filler filler(scene, lattice, regions, 0, unheard);
      if (filler.largest_misfit(true).excess <= 1) return spacing;
      columns += filler.columns();
    }
  return 0;
}

}  // namespace

void Filler::compare_width(std::size_t r, const CellRun& run, std::size_t axis, const Vec3& middle) {
  if (!compares_widths_ || run.own) return;
  const double length = run.width * run.cells, fits = length / lattice_.spacing[axis];
  Vec3 from = regions_[r].lower, to = regions_[r].upper;
  from[axis] = run.lower;
  to[axis] = run.lower + length;
  const double excess = std::abs(fits / run.cells - 1) / most_width;
  if (excess <= misfit_.excess || solids_->free_volume(from, to) == 0) return;
  misfit_ = {excess, r, axis, from[axis], to[axis], fits, run.cells, middle};
}

// Of a run of columns one between each two planes of faces, which need not be wetted where the columns are: they see
// solids below theirs.
void Filler::compare_depths(std::size_t r, const CellRun& run, double row_lower, double row_upper, double area,
                            double bottom, double top) {
  const auto middles = [&](int axis, double lower, double upper) {
    std::vector<double> result;
    for (const double plane : solids_->planes(axis)) {
      if (plane <= lower || plane >= upper) continue;
      result.push_back(0.5 * (lower + plane));
      lower = plane;
    }
    result.push_back(0.5 * (lower + upper));
    return result;
  };
  const bool deep = lattice_.dimensions == 3;
  for (const double y : deep ? middles(1, row_lower, row_upper) : std::vector<double>{0})
    for (const double x : middles(0, run.lower, run.lower + run.width * run.cells))
      compare_depth(r, {x, y, area, bottom, top});
  // Over few layers, which the surface sees, columns are stretched for them to be whole.
  const double fits = run.width * run.cells / lattice_.spacing[0],
               excess = std::abs(fits / run.cells - 1) / most_stretch;
  const Vec3 middle{run.lower + 0.5 * run.width * run.cells, 0.5 * (row_lower + row_upper), 0};
  if (run.own || run.cells < 2 || excess <= misfit_.excess) return;
  const ColumnFit fit(lattice_, solids_.get());
  for (const ColumnPart& part : parts_of({middle[0], middle[1], area, bottom, top}, r))
    if (part.free_above && ColumnFit::is_thin(fit.layers(part, area)))
      misfit_ = {excess, r, 0, run.lower, run.lower + run.width * run.cells, fits, run.cells, middle};
}

// Films: of more layers the lowest, which the surface hardly sees, may be of another height.
void Filler::compare_depth(std::size_t r, const ColumnCell& cell) {
  const std::size_t up = static_cast<std::size_t>(lattice_.dimensions) - 1;
  const ColumnFit fit(lattice_, solids_.get());
  for (const ColumnPart& part : parts_of(cell, r)) {
    const double fits = fit.depth(part, cell.area), layers = std::max(1.0, fit.layers(part, cell.area));
    const double excess = std::abs(fits / layers - 1) / most_depth;
    if (!part.free_above || layers > film_layers || excess <= misfit_.excess) continue;
    misfit_ = {excess, r, up, part.lower, part.upper, fits, layers, {cell.x, cell.y, 0}};
  }
}

// Particles on a lattice share the mass of the region: where layers are no whole number, their sum is off.
std::vector<Problem> level_warnings(const Scene& scene, const Lattice& lattice,
                                    const std::vector<LiquidRegion>& regions, const std::string& file) {
  const std::size_t up = static_cast<std::size_t>(scene.domain.dimensions) - 1;
  if (!scene.free_surface || !scene.phases.empty() || !(scene.fluid.gravity[up] < 0)) return {};
  // 0.5 % is the bound of the pressure of still water (cases/hydrostatic); what is lost below is that of curved
  // surfaces.
  constexpr double most_off = 0.01;
  const double off = lattice.volume() / scene.particles.volume - 1;
  if (std::abs(off) <= most_off) return {};
  for (const LiquidRegion& region : regions) {
    if (region.conform || !region.where || region.node == nullptr) continue;
    return {
        {file, region.node->place.line, region.node->place.column,
         region.name + " is no whole number of layers of particles deep: they stand in cells with " +
             brief(std::round(1000 * std::abs(off)) / 10) + " % " + (off > 0 ? "more" : "less") +
             " volume than their own, and the level of the liquid and the pressure at its floor are off by about as "
             "much; add  conform = true,  or choose a spacing that divides its depth"}};
  }
  return {};
}

std::vector<Problem> cell_warnings(Scene& scene, const Lattice& lattice, const std::vector<LiquidRegion>& regions,
                                   const std::string& file) {
  const std::size_t up = static_cast<std::size_t>(scene.domain.dimensions) - 1;
  if (scene.domain.boxes.empty() || !scene.free_surface || !(scene.fluid.gravity[up] < 0)) return {};
  Problems unheard(file);
  const CellMisfit worst = Filler(scene, lattice, regions, 0, unheard).largest_misfit(up == 2);
  if (worst.excess <= 1) return {};
  const auto axis_name = [&](std::size_t axis) { return std::string(1, "xyz"[axis]); };
  const auto hundredths = [](double x) { return brief(std::round(100 * x) / 100); };
  const std::string interval = axis_name(worst.axis) + " = " + brief(worst.lower) + " and " + brief(worst.upper);
  std::string place;
  for (std::size_t a = 0; a < up; ++a)
    if (a != worst.axis)
      place += (place.empty() ? " at " : ", ") + axis_name(a) + " = " + brief(std::round(1e4 * worst.place[a]) / 1e4);
  std::string text = "water at rest may move beside solids: between " + interval + place + " there is room for " +
                     hundredths(worst.fits) +
                     (worst.axis == up ? " layers of particles, filled with " : " cells, filled with ") +
                     brief(worst.cells) + ". ";
  const double spacing = nearest_fitting(scene, regions, unheard);
  text += spacing > 0 ? "With resolution.spacing = " + brief(spacing) + " the cells fit everywhere"
                      : "Move the faces of the solids, or lower resolution.spacing, so that whole numbers fit";
  const Node* node = regions[worst.region].node;
  const bool placed = node != nullptr;
  return {{file, placed ? node->place.line : 0, placed ? node->place.column : 0, text}};
}

}  // namespace spume
