// SPDX-License-Identifier: MIT
#include "spume/particles/wall_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/core/random.hpp"
#include "spume/core/vectors.hpp"
#include "spume/neighbours/neighbour_list.hpp"
#include "spume/operators/pair_sweep.hpp"
#include "wall_shells.hpp"

namespace spume {
namespace {

// Of the concentration gradient: King (3.12) inside the liquid.
constexpr double even_out = 0.25;
// Rounds until points move by less than 1 % of a spacing a round, around discs, balls and the inside of a pipe.
constexpr int rounds = 40;
constexpr double longest_slide = 0.2;  // spacings a round

// Sites of the lattice per point, along each axis.
constexpr std::size_t finer_2d = 3, finer_3d = 2;
// The volume of a shell is that of the parts of cells that lie in it, by the mean width of a square or a cube: of a
// ring of ten spacings to 0.2 %, in place of 1 to 6 % by the number of its sites, of which a pipe on a symmetry of the
// lattice has 5.7 % too many in the first shell: its liquid was held back by that much.
constexpr double mean_width_2d = 4 / std::numbers::pi, mean_width_3d = 1.5;

// Bits of a, b and c in turns: numbers along a curve whose pieces are compact.
std::uint64_t interleave(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  std::uint64_t code = 0;
  for (unsigned bit = 0; bit < 21; ++bit)
    code |= ((a >> bit & 1) << 3 * bit) | ((b >> bit & 1) << (3 * bit + 1)) | ((c >> bit & 1) << (3 * bit + 2));
  return code;
}

// Beyond a side that an opening covers points are the images of those before it (particles/open_sides.hpp).
bool goes_on(const Side& side) {
  return side.kind == BoundaryKind::open && !side.opening;
}

// A lattice over the domain, beyond open sides by `reach`.
struct ShellLattice {
  int dimensions;
  Vec3 origin{}, step{1, 1, 1};
  std::array<std::size_t, 3> count{1, 1, 1};

  ShellLattice(const Domain& domain, double spacing, double reach) : dimensions(domain.dimensions) {
    for (int axis = 0; axis < dimensions; ++axis) {
      double lower = domain.lower[axis], upper = domain.upper[axis];
      if (goes_on(domain.sides[axis][0])) lower -= reach;
      if (goes_on(domain.sides[axis][1])) upper += reach;
      count[axis] = static_cast<std::size_t>(std::max(1.0, std::round((upper - lower) / spacing)));
      step[axis] = (upper - lower) / static_cast<double>(count[axis]);
      origin[axis] = lower;
    }
  }
  Vec3 place(std::size_t i, std::size_t j, std::size_t k) const {
    return {origin[0] + (static_cast<double>(i) + 0.5) * step[0], origin[1] + (static_cast<double>(j) + 0.5) * step[1],
            dimensions == 3 ? origin[2] + (static_cast<double>(k) + 0.5) * step[2] : 0.0};
  }
};

// Onto the middle of the shell, along the normal: twice, as a normal turns on the way.
void onto_shell(const Combination& walls, ShellPoint& point) {
  for (int round = 0; round < 2; ++round) {
    const NearestPoint near = walls.nearest(point.place);
    point.place = add(point.place, multiply(point.distance - near.distance, near.normal));
  }
}

// Sites above each other come to one place, and points at one place do not part.
void part_points(std::vector<ShellPoint>& points, const Combination& walls, double spacing, int dimensions) {
  parallel_for(points.size(), [&](std::size_t i) {
    const auto random = random_uniform(0, RandomPurpose::wall_point, i, 0, 0);
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(dimensions); ++axis)
      points[i].place[axis] += 0.1 * spacing * (random[axis] - 0.5);
    onto_shell(walls, points[i]);
  });
}

std::vector<ShellPoint> cut_shells(const Combination& walls, const Domain& domain, double spacing, double reach,
                                   bool outside) {
  const int d = domain.dimensions;
  const std::size_t finer = d == 3 ? finer_3d : finer_2d;
  const ShellLattice lattice(domain, spacing / static_cast<double>(finer), reach);
  const double layers = std::ceil(reach / spacing);
  const double cell = lattice.step[0] * lattice.step[1] * (d == 3 ? lattice.step[2] : 1.0);
  const double width = (d == 3 ? mean_width_3d : mean_width_2d) * std::pow(cell, 1.0 / d);
  struct Site {
    int shell = 0;  // from -layers to layers - 1
    std::uint64_t code = 0;
    Vec3 place{};
    double share = 1;  // of its volume that counts
  };
  const auto shells = static_cast<std::size_t>(2 * layers);
  std::vector<std::vector<Site>> rows(lattice.count[1] * lattice.count[2]);
  std::vector<std::vector<double>> parts(rows.size(), std::vector<double>(shells, 0.0));  // of cells, by row and shell
  parallel_blocks(rows.size(), 1, [&](std::size_t row, std::size_t, std::size_t) {
    for (std::size_t i = 0; i < lattice.count[0];) {
      const std::size_t j = row % lattice.count[1], k = row / lattice.count[1];
      const Vec3 place = lattice.place(i, j, k);
      const double distance = walls.distance(place);
      const double beyond = std::abs(distance) - width / 2 - layers * spacing;
      if (beyond >= 0) {
        // Along the row distances change by no more than the way.
        i += 1 + static_cast<std::size_t>(std::min(1e6, beyond / lattice.step[0]));
        continue;
      }
      const auto below = [&](double bound) { return std::clamp(0.5 + (bound - distance) / width, 0.0, 1.0); };
      const double first = std::max(-layers, std::floor((distance - width / 2) / spacing));
      for (double shell = first; shell < layers && shell * spacing < distance + width / 2; ++shell)
        parts[row][static_cast<std::size_t>(shell + layers)] += below((shell + 1) * spacing) - below(shell * spacing);
      const double own = std::floor(distance / spacing);
      if (own >= (outside ? 0 : -layers) && own < layers) {
        rows[row].push_back({static_cast<int>(own), interleave(i, j, k), place});
        if (outside) rows[row].back().share = mirrored_share(walls, walls.nearest(place), place, spacing, d).share;
      }
      ++i;
    }
  });
  std::vector<Site> sites;
  for (const auto& row : rows) sites.insert(sites.end(), row.begin(), row.end());
  std::sort(sites.begin(), sites.end(),
            [](const Site& a, const Site& b) { return a.shell == b.shell ? a.code < b.code : a.shell < b.shell; });
  std::vector<double> cells(shells, 0.0), of_site(shells, 0.0);
  for (const auto& row : parts)
    for (std::size_t k = 0; k < shells; ++k) cells[k] += row[k];
  for (const Site& site : sites) ++of_site[static_cast<std::size_t>(site.shell + static_cast<int>(layers))];
  // Points per site. A shell that its sites count to a point, as those of a box do, keeps what they count: lattices
  // then stay lattices.
  const double of_cell = cell / std::pow(spacing, d);
  for (std::size_t k = 0; k < shells; ++k)
    of_site[k] =
        of_site[k] > 0 && std::abs(cells[k] - of_site[k]) * of_cell >= 1 ? of_cell * cells[k] / of_site[k] : of_cell;
  // Of each shell one of as many sites as a point has volume of.
  std::vector<ShellPoint> points;
  double counted = 0.5;
  for (std::size_t s = 0; s < sites.size(); ++s) {
    if (s > 0 && sites[s].shell != sites[s - 1].shell) counted = 0.5;
    counted += sites[s].share * of_site[static_cast<std::size_t>(sites[s].shell + static_cast<int>(layers))];
    if (counted < 1) continue;
    counted -= 1;
    points.push_back({sites[s].place, (sites[s].shell + 0.5) * spacing});
  }
  part_points(points, walls, spacing, d);
  return points;
}

ImageRules rules_of(const Domain& domain, double support_radius) {
  ImageRules rules;
  rules.dimensions = domain.dimensions;
  rules.lower = domain.lower;
  rules.upper = domain.upper;
  rules.support_radius = support_radius;
  for (int axis = 0; axis < domain.dimensions; ++axis)
    for (int side = 0; side < 2; ++side) {
      const BoundaryKind kind = domain.sides[axis][side].kind;
      rules.sides[axis][side] = kind == BoundaryKind::periodic      ? ImageKind::periodic
                                : goes_on(domain.sides[axis][side]) ? ImageKind::none
                                                                    : ImageKind::mirror;
    }
  return rules;
}

// One round of evening out.
class Evening {
 public:
  Evening(const Combination& walls, const Domain& domain, const Resolution& resolution, double volume, double spacing,
          const std::vector<std::vector<CornerPlane>>* corners = nullptr)
      : walls_(walls),
        domain_(domain),
        resolution_(resolution),
        volume_(volume),
        spacing_(spacing),
        corners_(corners) {}

  void round(std::vector<ShellPoint>& points) {
    const int d = domain_.dimensions;
    const double reach = resolution_.support_radius;
    Vec3 lower{}, upper{}, middle{};
    for (int axis = 0; axis < d; ++axis) {
      lower[axis] = domain_.lower[axis] - 2 * reach;
      upper[axis] = domain_.upper[axis] + 2 * reach;
      middle[axis] = 0.5 * (lower[axis] + upper[axis]);
    }
    const CellGrid grid(d, lower, upper, reach, points.size());
    load(points);
    order_.build(grid, position_[0].data(), position_[1].data(), d == 3 ? position_[2].data() : nullptr, points.size());
    std::vector<ShellPoint> sorted(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) sorted[i] = points[static_cast<std::size_t>(order_.order()[i])];
    points.swap(sorted);
    load(points);
    images_.build(rules_of(domain_, reach), grid, position_[0].data(), position_[1].data(),
                  d == 3 ? position_[2].data() : nullptr, points.size());
    list_.build(grid, order_, position_[0].data(), position_[1].data(), d == 3 ? position_[2].data() : nullptr,
                points.size(), images_, middle);
    with_plain_kernel(d, resolution_.kernel, [&]<int dimensions, class Kernel>() { move<dimensions, Kernel>(points); });
  }

 private:
  void load(const std::vector<ShellPoint>& points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      position_[axis].resize(points.size());
      parallel_for(points.size(), [&](std::size_t i) { position_[axis][i] = points[i].place[axis]; });
    }
  }

  template <int dimensions, class Kernel>
  void move(std::vector<ShellPoint>& points) {
    const double h = resolution_.smoothing_length;
    const double scale = -volume_ * Kernel::normalisation(dimensions) / std::pow(h, dimensions);  // times h^2
    const double longest = longest_slide * spacing_;
    parallel_for(points.size(), [&](std::size_t i) {
      Vec3 gradient{};
      for (const std::int32_t j : list_.of(i)) {
        Vec3 d{};
        double r2 = 0;
        for (int axis = 0; axis < dimensions; ++axis) {
          d[axis] = double{list_.coordinate(axis)[j]} - double{list_.coordinate(axis)[i]};
          r2 += d[axis] * d[axis];
        }
        const double g = scale * Kernel::f(std::sqrt(r2) / h);
        for (int axis = 0; axis < dimensions; ++axis) gradient[axis] += g * d[axis];
      }
      if (points[i].corner >= 0)
        gradient =
            add(gradient, behind_faces<dimensions, Kernel>(
                              i, points[i].place, (*corners_)[static_cast<std::size_t>(points[i].corner)], scale));
      Vec3 way = multiply(-even_out, gradient);
      const double length = std::sqrt(dot(way, way));
      if (length > longest) way = multiply(longest / length, way);
      points[i].place = add(points[i].place, way);
      onto_shell(walls_, points[i]);
      for (int axis = 0; axis < dimensions; ++axis) {
        double& x = points[i].place[axis];
        const double low = domain_.lower[axis], high = domain_.upper[axis];
        if (domain_.periodic(axis)) {
          if (x < low) x += high - low;
          if (x >= high) x -= high - low;
          continue;
        }
        if (!goes_on(domain_.sides[axis][0]) && x < low) x = 2 * low - x;
        if (!goes_on(domain_.sides[axis][1]) && x > high) x = 2 * high - x;
      }
    });
  }

  // The gradient by the images of point i and its neighbours in the planes of a corner, and in two of them.
  template <int dimensions, class Kernel>
  Vec3 behind_faces(std::size_t i, const Vec3& place, const std::vector<CornerPlane>& planes, double scale) const {
    Vec3 gradient{};
    const auto count = [&](const Vec3& way) {
      const double g = scale * Kernel::f(length(way) / resolution_.smoothing_length);
      gradient = add(gradient, multiply(g, way));
    };
    const auto height = [&](const Vec3& way, const CornerPlane& plane) {
      return dot(subtract(add(place, way), plane.point), plane.normal);
    };
    const auto count_images = [&](const Vec3& way) {
      for (const CornerPlane& first : planes) {
        const double before = height(way, first);
        if (!(before > 0)) continue;
        const Vec3 image = subtract(way, multiply(2 * before, first.normal));
        count(image);
        for (const CornerPlane* second = &first + 1; second != planes.data() + planes.size(); ++second)
          if (const double above = height(image, *second); above > 0)
            count(subtract(image, multiply(2 * above, second->normal)));
      }
    };
    count_images({});
    for (const std::int32_t j : list_.of(i)) {
      Vec3 way{};
      for (int axis = 0; axis < dimensions; ++axis)
        way[axis] = double{list_.coordinate(axis)[j]} - double{list_.coordinate(axis)[i]};
      count_images(way);
    }
    return gradient;
  }

  const Combination& walls_;
  const Domain& domain_;
  const Resolution& resolution_;
  double volume_, spacing_;
  const std::vector<std::vector<CornerPlane>>* corners_;
  std::array<Array<double>, 3> position_;
  CellOrder order_;
  Images images_;
  NeighbourList list_;
};

}  // namespace

MirroredShare mirrored_share(const Combination& walls, const NearestPoint& near, const Vec3& place, double spacing,
                             int dimensions) {
  constexpr double step = 0.25, crossed = 0.9;  // spacings; of the distance at which normals that meet do so
  const Vec3 n = near.normal;
  Vec3 first = dimensions == 3 ? cross(n, std::abs(n[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}) : Vec3{-n[1], n[0], 0};
  first = unit(first, dimensions);
  const std::array<Vec3, 2> along{first, dimensions == 3 ? cross(n, first) : Vec3{}};
  const int ways = dimensions - 1;
  std::array<std::array<double, 2>, 2> bent{};
  for (int b = 0; b < ways; ++b) {
    const Vec3 way = multiply(step * spacing, along[static_cast<std::size_t>(b)]);
    const Vec3 ahead = multiply(1 / (step * spacing), subtract(walls.nearest(add(place, way)).normal, n));
    const Vec3 back = multiply(1 / (step * spacing), subtract(n, walls.nearest(subtract(place, way)).normal));
    const Vec3& less = dot(ahead, ahead) < dot(back, back) ? ahead : back;
    for (int a = 0; a < ways; ++a)
      bent[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] =
          near.distance * dot(less, along[static_cast<std::size_t>(a)]);
  }
  const double trace = bent[0][0] + bent[1][1], determinant = bent[0][0] * bent[1][1] - bent[0][1] * bent[1][0];
  const double largest = 0.5 * trace + std::sqrt(std::max(0.0, 0.25 * trace * trace - determinant));
  if (largest > crossed) return {1, true};
  return {largest >= 0.5 ? 0.0 : std::max(0.0, 1 - 2 * trace + 4 * determinant), false};
}

std::vector<ShellPoint> make_shells(const Combination& walls, const Domain& domain, const Resolution& resolution,
                                    double particle_volume, bool outside) {
  const double spacing = std::pow(particle_volume, 1.0 / domain.dimensions);
  std::vector<ShellPoint> shells = cut_shells(walls, domain, spacing, resolution.support_radius, outside);
  Evening evening(walls, domain, resolution, particle_volume, spacing);
  for (int round = 0; round < rounds; ++round) evening.round(shells);
  return shells;
}

void even_out_in_corners(const Combination& walls, const Domain& domain, const Resolution& resolution,
                         double particle_volume, const std::vector<std::vector<CornerPlane>>& corners,
                         std::vector<ShellPoint>& shells) {
  const double spacing = std::pow(particle_volume, 1.0 / domain.dimensions);
  part_points(shells, walls, spacing, domain.dimensions);
  Evening evening(walls, domain, resolution, particle_volume, spacing, &corners);
  for (int round = 0; round < rounds; ++round) evening.round(shells);
}

std::vector<WallPoint> make_wall_points(const Combination& walls, const Domain& domain, const Resolution& resolution,
                                        double particle_volume) {
  std::vector<WallPoint> points;
  for (const ShellPoint& point : make_shells(walls, domain, resolution, particle_volume, false)) {
    if (point.distance > 0) continue;
    const NearestPoint near = walls.nearest(point.place);
    if (near.distance >= 0) continue;
    points.push_back({point.place, near.point, near.normal, subtract(multiply(2, near.point), point.place)});
  }
  return points;
}

}  // namespace spume
