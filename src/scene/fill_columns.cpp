// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "filler.hpp"

namespace spume {
namespace {

// Columns per block: a block is some ten thousand evaluations, so that its bookkeeping is noise.
constexpr std::size_t column_block = 32;
// In spacings: one layer has more than four times the volume of thinner liquid.
constexpr double least_depth = 0.25;
// Of the height of a layer: slabs between the levels of solids hold whole layers, which a fifth more or less in height
// does not crowd.
constexpr double least_slab = 2;
// What the upper layers take in below them; less is left to parts_of().
constexpr double least_rest = 0.75;

}  // namespace

// Runs of cells along an axis between two corners: between their planes and the faces that any of the regions wets
// there, so that touching regions and all rows have columns in common but for a plate in a row, which is thinner than
// they are. Regions that take sites of the lattice keep those without such
// faces.
std::vector<CellRun> Filler::runs_of(std::size_t r, std::size_t axis, const Vec3& lower, const Vec3& upper,
                                     const Vec3& row_lower, const Vec3& row_upper) const {
  const LiquidRegion& region = regions_[r];
  const ColumnFit fit(lattice_, solids_.get());
  std::vector<double> faces;
  if (solids_ != nullptr && !layered()) {
    for (const LiquidRegion& other : regions_) {
      Vec3 from = lower, to = upper;
      const std::size_t up = static_cast<std::size_t>(lattice_.dimensions) - 1;
      if (!is_box(region)) {
        from[up] = other.lower[up];
        to[up] = other.upper[up];
      }
      for (const double face : solids_->wetted_planes(static_cast<int>(axis), from, to)) faces.push_back(face);
    }
    std::sort(faces.begin(), faces.end());
  }
  if (faces.empty() && !is_box(region)) {
    const auto [first, last] = index_range(region, axis);
    return {{lattice_.origin[axis], lattice_.spacing[axis], last - first, true, first}};
  }
  return fit.runs(axis, lower[axis], upper[axis], faces, [&](double start, double end) {
    Vec3 from = row_lower, to = row_upper;
    from[axis] = start;
    to[axis] = end;
    return solids_->free_volume(from, to) == 0;
  });
}

void Filler::add_columns(std::size_t r, double bottom, double top, std::vector<ColumnCell>& columns) {
  const std::size_t up = static_cast<std::size_t>(lattice_.dimensions) - 1;
  const ColumnFit fit(lattice_, solids_.get());
  Vec3 lower{}, upper{};
  for (std::size_t a = 0; a <= up; ++a) {
    lower[a] = std::max(regions_[r].lower[a], scene_.domain.lower[a]);
    upper[a] = std::min(regions_[r].upper[a], scene_.domain.upper[a]);
  }
  lower[up] = bottom;
  upper[up] = top;
  // In three dimensions rows along x between faces across y; those of one run have cells in common.
  struct Row {
    double y = 0, width = 1;
    std::size_t cells = 0;  // index of `lines`
  };
  std::vector<Row> rows;
  std::vector<std::vector<std::pair<double, double>>> lines;  // centre and width along x
  const auto add_line = [&](const Vec3& from, const Vec3& to, double width) {
    std::vector<CellRun> runs = runs_of(r, 0, lower, upper, from, to);
    std::vector<std::pair<double, double>> line;
    for (CellRun& run : runs) {
      const Vec3 middle{run.lower + 0.5 * run.width * run.cells, 0.5 * (from[1] + to[1]), 0};
      if (is_box(regions_[r]) && runs.size() > 1) fit.fit_parts(run, 0, width, fit.parts(middle, lower[up], upper[up]));
      if (is_box(regions_[r]) && solids_ != nullptr) {
        compare_width(r, run, 0, middle);
        compare_depths(r, run, from[1], to[1], run.width / lattice_.spacing[0] * width, bottom, top);
      }
      for (double k = 0; k < run.cells; ++k) line.emplace_back(fit.centre(run, 0, k), run.width);
    }
    lines.push_back(std::move(line));
  };
  if (up == 1) {
    add_line(lower, upper, 1);
    rows.push_back({0, 1, 0});
  } else {
    for (const CellRun& run : runs_of(r, 1, lower, upper, lower, upper)) {
      Vec3 from = lower, to = upper;
      if (solids_ != nullptr) {
        from[1] = run.lower;
        to[1] = run.lower + run.width * run.cells;
      }
      const double width = run.width / lattice_.spacing[1];
      if (is_box(regions_[r]) && solids_ != nullptr)
        compare_width(r, run, 1, {0.5 * (lower[0] + upper[0]), run.lower + 0.5 * run.width * run.cells, 0});
      add_line(from, to, width);
      for (double k = 0; k < run.cells; ++k) rows.push_back({fit.centre(run, 1, k), width, lines.size() - 1});
    }
  }
  std::size_t longest = 0;
  for (const auto& line : lines) longest = std::max(longest, line.size());
  for (std::size_t i = 0; i < longest; ++i)
    for (const Row& row : rows) {
      const auto& line = lines[row.cells];
      if (i < line.size())
        columns.push_back({line[i].first, row.y, line[i].second / lattice_.spacing[0] * row.width, bottom, top});
    }
}

// The columns of all regions, and the volume that the layers below the surface of each have: that of most columns,
// which then hold one layer like the other.
void Filler::find_columns() {
  const std::size_t up = static_cast<std::size_t>(lattice_.dimensions) - 1;
  const double spacing = lattice_.spacing[up];
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    std::vector<ColumnCell>& columns = columns_.emplace_back();
    layer_volume_.push_back(1);
    const double bottom = lower_of(r), top = upper_of(r), depth = top - bottom;
    double start = bottom;
    if (solids_ != nullptr && is_box(regions_[r])) {
      // Between the levels of solids these are pillars, which columns can stand beside.
      const double layers = std::max(1.0, std::round(depth / spacing)), least = least_slab * spacing;
      const double between = top - std::min(layers, ColumnFit::upper_layers) * depth / layers;
      Vec3 from = regions_[r].lower, to = regions_[r].upper;
      to[up] = between;
      for (const double level : solids_->wetted_planes(static_cast<int>(up), from, to)) {
        if (level - start < least || between - level < least_rest * spacing) continue;
        add_columns(r, start, level, columns);
        start = level;
      }
      // Pillars that go on through the surface have one column over the whole depth beside them. Cut in two, the
      // upper layers would have to make up a volume that is no whole number of particles by themselves: 0.01 sqrt(g H)
      // from gaps of 2.8 to 3.5 cells, 2e-4 in one.
      from[up] = start;
      to[up] = top;
      const auto faces_within = [&](std::size_t axis) {
        const std::vector<double> faces = solids_->wetted_planes(static_cast<int>(axis), from, to);
        return std::any_of(faces.begin(), faces.end(), [&](double x) { return x > from[axis] && x < to[axis]; });
      };
      const bool pillars = !faces_within(up) && (faces_within(0) || (up == 2 && faces_within(1)));
      if (between - start >= least && !pillars) {
        add_columns(r, start, between, columns);
        start = between;
      }
    }
    const std::size_t upper = columns.size();
    add_columns(r, start, top, columns);
    if (!is_box(regions_[r]) || columns.size() == upper) continue;
    std::vector<double> areas;
    for (std::size_t c = upper; c < columns.size(); ++c) areas.push_back(columns[c].area);
    std::nth_element(areas.begin(), areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2), areas.end());
    const double area = areas[areas.size() / 2];
    layer_volume_.back() = area * depth / spacing / std::max(1.0, std::round(area * depth / spacing));
  }
}

std::vector<Chunk> Filler::fill_region(std::size_t r) {
  const LiquidRegion& region = regions_[r];
  const std::vector<ColumnCell>& columns = columns_[r];
  std::vector<Chunk> chunks(block_count(columns.size(), column_block));
  parallel_blocks(columns.size(), column_block, [&](std::size_t block, std::size_t first, std::size_t last) {
    if (too_many()) return;
    ThreadRegions& own = this->own();
    Chunk& chunk = chunks[block];
    for (std::size_t column = first; column < last; ++column) {
      const Vec3 p{columns[column].x, columns[column].y, 0};
      const double area = columns[column].area;
      if (region.conform) {
        conform_column(own, r, p, area, chunk);
      } else if (is_box(region)) {
        box_column(own, r, columns[column], chunk);
      } else {
        site_column(own, r, p, area, chunk);
      }
    }
    found_ += chunk.position[0].size();
  });
  return chunks;
}

// Only the uppermost columns of a region end on its surface. What is left above a solid at the top of a slab, less than
// a layer, belongs to the slab above: a layer at more than half a spacing above a face is unsteady (at one spacing a
// wave from particle to particle grew out of rounding within 4 sqrt(H/g)).
std::vector<ColumnPart> Filler::parts_of(const ColumnCell& cell, std::size_t r) const {
  const double layer = lattice_.spacing[static_cast<std::size_t>(lattice_.dimensions) - 1];
  const bool lowest = cell.lower == lower_of(r), uppermost = cell.upper == upper_of(r);
  const double below = lowest ? cell.lower : std::max(cell.lower - layer, lower_of(r));
  std::vector<ColumnPart> parts = ColumnFit(lattice_, solids_.get()).parts({cell.x, cell.y, 0}, below, cell.upper);
  std::erase_if(parts, [&](const ColumnPart& part) {
    const bool left =
        !uppermost && part.upper == cell.upper && part.lower > cell.lower && part.upper - part.lower < layer;
    return part.upper <= cell.lower || left;
  });
  for (ColumnPart& part : parts) {
    if (part.lower == below) part.lower = cell.lower;
    if (!uppermost) part.free_above = false;
  }
  return parts;
}

void Filler::box_column(ThreadRegions& own, std::size_t r, const ColumnCell& cell, Chunk& chunk) const {
  Vec3 p{cell.x, cell.y, 0};
  const std::size_t up = static_cast<std::size_t>(lattice_.dimensions) - 1;
  const ColumnFit fit(lattice_, solids_.get());
  std::vector<double> heights;
  for (const ColumnPart& part : parts_of(cell, r)) {
    fit.heights(part, cell.area, layer_volume_[r], heights);
    chunk.volume += fit.depth(part, cell.area);
  }
  for (const double height : heights) {
    p[up] = height;
    accept(own, r, p, chunk);
  }
}

void Filler::site_column(ThreadRegions& own, std::size_t r, Vec3 p, double area, Chunk& chunk) const {
  const std::size_t up = static_cast<std::size_t>(lattice_.dimensions) - 1;
  const auto [first, last] = index_range(regions_[r], up);
  for (double k = first; k < last; ++k) {
    p[up] = centre(up, k);
    if (contains(own, r, p, chunk)) accept(own, r, p, chunk);
    chunk.volume += area * part_of_cell(own, r, p, chunk);
  }
}

// Share of the cell of the lattice around p that is inside, by samples of a Kronecker sequence, frac((k + 1/2) a): `a`
// of the plane and of space are powers of the inverse of the real root of x^(d+1) = x + 1, which spread evenly along
// every direction (Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018). Taken from -n/2 to n/2 -
// 1 they are symmetric about p without a sample on it, so that a plane through p cuts off one half. Samples in rows lie
// on the planes of a lattice together: of cells cut along their diagonal 8 x 8 count 7/16.
template <class Inside>
double Filler::share_of_cell(const Vec3& p, Inside&& inside) const {
  const bool deep = lattice_.dimensions == 3;
  const int half = deep ? 256 : 128;
  const double root = deep ? 1.2207440846057596 : 1.3247179572447460;
  const Vec3 step{1 / root, 1 / (root * root), deep ? 1 / (root * root * root) : 0};
  int count = 0;
  for (int k = -half; k < half; ++k) {
    Vec3 q = p;
    for (std::size_t a = 0; a < (deep ? 3U : 2U); ++a) {
      const double offset = (k + 0.5) * step[a];
      q[a] += (offset - std::floor(offset) - 0.5) * lattice_.spacing[a];
    }
    count += inside(q) ? 1 : 0;
  }
  return static_cast<double>(count) / (2 * half);
}

// Of the cell, the share that the region fills and no other replaces: all or nothing where its corners agree.
double Filler::part_of_cell(ThreadRegions& own, std::size_t r, const Vec3& p, Chunk& chunk) const {
  const auto inside = [&](const Vec3& q) {
    return contains(own, r, q, chunk) && !is_replaced(own, r, q) && !(solids_ != nullptr && solids_->inside(q)) &&
           (scene_.walls.empty() || own.walls.at(q) > 0);
  };
  constexpr double to_corner = 0.5 * (1 - 1e-9);
  int corners = 0, all = 0;
  for (const double z : {-to_corner, to_corner}) {
    if (lattice_.dimensions == 2 && z > 0) break;
    for (const double y : {-to_corner, to_corner})
      for (const double x : {-to_corner, to_corner}) {
        const double up = lattice_.dimensions == 3 ? z * lattice_.spacing[2] : 0;
        corners += inside({p[0] + x * lattice_.spacing[0], p[1] + y * lattice_.spacing[1], p[2] + up}) ? 1 : 0;
        ++all;
      }
  }
  if (corners == 0 || corners == all) return corners == 0 ? 0 : 1;
  return share_of_cell(p, inside);
}

// Of the cell, the share outside the walls of bodies.
double Filler::open_part(ThreadRegions& own, const Vec3& p) const {
  const double distance = own.walls.at(p), half_diagonal = 0.5 * std::sqrt(lattice_.dimensions) * scene_.spacing;
  if (std::abs(distance) > half_diagonal) return distance > 0 ? 1 : 0;
  return share_of_cell(p, [&](const Vec3& q) { return own.walls.at(q) > 0; });
}

// The column through p: the surface is the highest root of `where`, found from above in steps of half a
// spacing and bisected to the last bit. Over a depth D the n particles stand D/n apart, the highest half a distance
// below the surface and the lowest half a distance above the bottom: the column's liquid ends on both. A depth below
// a quarter spacing holds no particle. With solids each part of the column is fitted for itself.
void Filler::conform_column(ThreadRegions& own, std::size_t r, Vec3 p, double area, Chunk& chunk) const {
  const LiquidRegion& region = regions_[r];
  const std::size_t up = static_cast<std::size_t>(lattice_.dimensions) - 1;
  const double spacing = lattice_.spacing[up];
  const double bottom = region.lower[up], top = region.upper[up];
  p[up] = 0.5 * (bottom + top);
  if (!in_shapes(own, r, p)) return;

  const auto inside = [&](double height) {
    p[up] = height;
    const double value = (*own.where[r])(p[0], p[1], p[2], 0);
    if (!std::isfinite(value)) chunk.not_finite.add(p);
    return value > 0;
  };
  // The last height inside, between one that is and one that is not.
  const auto bisect = [&](double in, double out) {
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (in + out);
      if (middle == in || middle == out) break;
      (inside(middle) ? in : out) = middle;
    }
    return in;
  };

  if (inside(top)) {
    chunk.beyond_top.add(p);
    return;
  }
  const double steps = std::ceil((top - bottom) / (0.5 * spacing));
  double surface = bottom, floor = bottom;
  bool found = false;
  for (double i = 1; i <= steps; ++i) {
    const double above = top - (top - bottom) * (i - 1) / steps;
    const double height = i == steps ? bottom : top - (top - bottom) * i / steps;
    const bool wet = inside(height);
    if (!found && wet) {
      surface = bisect(height, above);
      found = true;
    } else if (found && !wet) {
      floor = bisect(above, height);
      break;
    }
  }
  const double depth = surface - floor;
  const ColumnFit fit(lattice_, solids_.get());
  const std::vector<ColumnPart> parts = fit.parts(p, floor, surface);
  for (const ColumnPart& part : parts)
    if (found) chunk.volume += fit.depth(part, area);
  if (!found || depth < least_depth * spacing) return;
  if (solids_ != nullptr) {
    for (const ColumnPart& part : parts) {
      std::vector<double> heights;
      fit.heights(part, area, 1, heights);
      for (auto height = heights.rbegin(); height != heights.rend(); ++height) {
        p[up] = *height;
        accept(own, r, p, chunk);
      }
    }
    return;
  }

  const auto distance = [&](double n) { return depth / n; };
  double layers = std::max(1.0, std::floor(depth / spacing));
  if (std::abs(distance(layers + 1) - spacing) < std::abs(distance(layers) - spacing)) ++layers;
  for (double k = layers - 1; k >= 0; --k) {
    p[up] = surface - (k + 0.5) * distance(layers);
    accept(own, r, p, chunk);
  }
}

}  // namespace spume
