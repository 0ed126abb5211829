// SPDX-License-Identifier: MIT
#include "region_fit.hpp"

#include <algorithm>
#include <cmath>

namespace spume {
namespace {

// Of a spacing: what separates a plane of the lattice from one beside it.
constexpr double on_plane = 1e-6;
// Of the height of a layer: no layer below is that thin, or that much thicker. The four upper layers keep their height
// as long as the lowest can take what they leave, half a layer at most: over a box with 4.47 layers, 2e-6 sqrt(g H);
// with two layers of 1.24 below two of 1, 0.23.
constexpr double least_layer = 0.62;
// Of a column over a solid: 3.45 layers, 10 columns of three or 8 of four, move at 0.16 and 0.035 sqrt(g H).
constexpr double most_stretch = 1.25;

bool whole(double x) {
  return std::abs(x - std::round(x)) < on_plane;
}

}  // namespace

CellRun ColumnFit::run_between(std::size_t axis, double lower, double upper) const {
  const double d = lattice_.spacing[axis];
  const double first = (lower - lattice_.origin[axis]) / d, last = (upper - lattice_.origin[axis]) / d;
  if (whole(first) && whole(last) && std::round(first) >= 0 && std::round(last) > std::round(first))
    return {lower, d, std::round(last) - std::round(first), true, std::round(first)};
  const double cells = std::max(1.0, std::round((upper - lower) / d));
  return {lower, (upper - lower) / cells, cells, false, 0};
}

bool ColumnFit::is_thin(double layers) {
  return layers <= upper_layers + 1;
}

void ColumnFit::fit_parts(CellRun& run, std::size_t axis, double width, const std::vector<ColumnPart>& parts) const {
  const double length = run.width * run.cells, lattice_cells = length / lattice_.spacing[axis];
  // Thin parts lack or exceed the volume of a layer as a whole, deep ones below what the surface sees: a tenth counts.
  // A cell 10 % off the lattice is worth 2 % of a thin part: at half a per cent columns of 1.24 spacings beside a box
  // moved at 0.3 sqrt(g H).
  const auto cost = [&](double cells) {
    const double stretch = lattice_cells / cells, area = stretch * width;
    double sum = 2 * std::pow(std::log(stretch), 2);
    for (const ColumnPart& part : parts) {
      const double exact = depth(part, area), n = std::max(1.0, std::round(exact));
      sum += is_thin(n) ? std::abs(exact / n - 1) : 0.1 * std::abs(exact - n) / (n - upper_layers);
    }
    return sum;
  };
  double best = run.cells;
  for (double cells = std::max(1.0, std::ceil(lattice_cells / most_stretch)); cells <= lattice_cells * most_stretch;
       ++cells)
    if (cost(cells) < cost(best) - 1e-9) best = cells;
  if (best != run.cells) run = {run.lower, length / best, best, false, 0};
}

std::vector<ColumnPart> ColumnFit::parts(const Vec3& p, double lower, double upper) const {
  if (solids_ == nullptr) return {{lower, upper, true}};
  std::vector<ColumnPart> result;
  const std::vector<double>& planes = solids_->planes(static_cast<int>(up()));
  double start = lower;
  const auto add = [&](double end, bool last) {
    Vec3 middle = p;
    middle[up()] = 0.5 * (start + end);
    if (!(end > start) || solids_->inside(middle)) return;
    if (!result.empty() && result.back().upper == start) {
      result.back().upper = end;
    } else {
      result.push_back({start, end, false});
    }
    if (!last) return;
    middle[up()] = end + on_plane * lattice_.spacing[up()];
    result.back().free_above = !solids_->inside(middle);
  };
  for (const double plane : planes)
    if (plane > start && plane < upper) {
      add(plane, false);
      start = plane;
    }
  add(upper, true);
  return result;
}

bool ColumnFit::on_lattice(const ColumnPart& part, double area) const {
  return area == 1 && whole(line_of(part.lower)) && whole(line_of(part.upper));
}

double ColumnFit::layers(const ColumnPart& part, double area) const {
  const double exact = depth(part, area);
  return part.free_above && exact < least_film ? 0 : std::round(exact);
}

void ColumnFit::heights(const ColumnPart& part, double area, double particle_volume, std::vector<double>& out) const {
  const double n = layers(part, area), height = part.upper - part.lower;
  if (on_lattice(part, area)) {
    for (double k = 0; k < n; ++k)
      out.push_back(lattice_.origin[up()] + (std::round(line_of(part.lower)) + k + 0.5) * lattice_.spacing[up()]);
    return;
  }
  // Layers of the right volume from the surface down; the others share the rest of the height.
  const double upper = particle_volume / area * lattice_.spacing[up()];
  double exact = part.free_above ? std::min(upper_layers, n - 1) : 0;
  const auto below = [&] { return (height - exact * upper) / (n - exact); };
  while (exact > 0 && (below() < least_layer * upper || below() > upper / least_layer)) --exact;
  for (double k = 0; k < n; ++k) {
    const bool of_surface = k >= n - exact;
    out.push_back(of_surface ? part.upper - (n - k - 0.5) * upper : part.lower + (k + 0.5) * below());
  }
}

}  // namespace spume
