// SPDX-License-Identifier: MIT
#include "spume/particles/packing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/particles/number_density.hpp"
#include "spume/particles/pockets.hpp"

namespace spume {
namespace {

constexpr double packed_layers = 4;  // spacings from a body: the support radius, and where it fades into the lattice
// The same of rows at a level surface, which can give way to the side alone: half a column too many crowds them by 5 %.
constexpr double level_layers = 10;
constexpr double coefficient = 0.25;    // of the move: King (3.12)
constexpr double longest_move = 0.1;    // spacings a round
constexpr double still_enough = 0.005;  // spacings: rounds end when nothing moves farther
constexpr int most_rounds = 200;
constexpr int wet_rounds =
    10;  // which wall points are wet is found once in so many: particles move by a spacing at most
// Of the kernel sum of a lattice, what is missing beside a surface at least: half a layer. What stands within a
// support radius and a spacing of it stays: there the surface counts the liquid below it.
constexpr double surface_lack = 0.1;
constexpr double beyond_support = 1.1, beyond_support_over_solids = 1.6;  // there the fourth layer may lie 1.5 apart
// Of the kernel sum of a lattice. Thinner liquid is closed as a void (number_density.cpp). At the edge of a box that
// fits the lattice 4.5 % are missing: of the site across it, which the edge hides.
constexpr double even_enough = 0.05;
// Spacings: no surface is looked for below a ceiling this high, where the one layer that fits may be as thin as one.
constexpr double flat_channel = 2;
// Spacings: at the face of a body a particle that stands in a hole between wall points, or that may move horizontally
// alone before a slope, would stay. The pressure of the start was off by 0.1 to 0.3 of the depth at such ones, beside
// plates turned in 3-D, and the water moved at 0.12 sqrt(gH) after the first step.
// Below a free surface alone: pushed out, rows at an interface of layers over a ball moved at 2e-3 m/s, and else at
// less than 1e-3.
constexpr double least_gap = 0.25;
// Spacings: what is narrower is filled with nothing, and stays so.
constexpr double least_room = 0.5;
// Spacings between the rows beside a level interface, at least.
constexpr double level_height = 0.9;
// Of the squared horizontal part of a normal: below it, a wall at 6 degrees, images along the horizontal are ten times
// the distance away, and there are none. Kept at that, they came the nearer the more level a face was: over a lid at
// 0.13 degrees, eight spacings below the surface, the upper four rows moved off and left it bare, and the water
// collapsed at 4 sqrt(gH).
constexpr double least_aside = 0.01;

Vec3 way_to(const NeighbourList& list, int dimensions, std::size_t i, std::int32_t j) {
  Vec3 way{};
  for (int axis = 0; axis < dimensions; ++axis)
    way[axis] = double{list.coordinate(axis)[j]} - double{list.coordinate(axis)[i]};
  return way;
}

// Share of a lattice's kernel sum that a particle lacks, and whether it lacks it all around, as in a gap between walls
// that is too wide for its particles (number_density.hpp).
struct Lack {
  double share = 0;
  bool all_around = false;
  Vec3 normal{};  // towards what it lacks, of any length
};

void find_lacks(const Arrangement& arrangement, const ParticleStore& particles, const Resolution& resolution,
                std::vector<Lack>& lacks) {
  const NeighbourList& list = arrangement.list;
  const int d = particles.dimensions;
  lacks.resize(particles.size());
  with_plain_kernel(d, resolution.kernel, [&]<int dimensions, class Kernel>() {
    const double h = resolution.smoothing_length;
    const double value = particles.volume * Kernel::normalisation(dimensions) / std::pow(h, dimensions);
    parallel_for(particles.size(), [&](std::size_t i) {
      double sum = value * Kernel::w(0.0), divergence = 0;
      Vec3 m{};
      for (const std::int32_t j : list.of(i)) {
        const Vec3 dr = way_to(list, d, i, j);
        const double r = length(dr), g = -value * Kernel::f(r / h) / (h * h);
        sum += value * Kernel::w(r / h);
        divergence += g * r * r;
        m = add(m, multiply(g, dr));
      }
      lacks[i].share = 1 - sum / resolution.lattice.kernel_sum;
      const double missing = resolution.lattice.divergence_of_position - divergence;
      lacks[i].all_around = h * length(m) < largest_isotropic_normal * missing;
      lacks[i].normal = multiply(-1, m);
    });
  });
}

// 1 for particles that the height of a free surface depends on.
void find_surface(const Arrangement& arrangement, const ParticleStore& particles, const Resolution& resolution,
                  const std::vector<Lack>& lacks, double beyond, std::vector<std::uint8_t>& sees_surface) {
  const NeighbourList& list = arrangement.list;
  const std::size_t n = particles.size();
  const auto identifier = [&](std::size_t i) { return static_cast<std::size_t>((*particles.identifier)[i]); };
  const double near2 = std::pow(beyond * resolution.spacing, 2);
  const auto distance2 = [&](std::size_t i, std::int32_t j) {
    const Vec3 way = way_to(list, particles.dimensions, i, j);
    return dot(way, way);
  };
  std::vector<std::uint8_t> surface(n), seen(n);
  parallel_for(n, [&](std::size_t i) { surface[i] = lacks[i].share > surface_lack && !lacks[i].all_around ? 1 : 0; });
  parallel_for(n, [&](std::size_t i) {
    seen[i] = surface[i];
    for (const std::int32_t j : list.of(i)) seen[i] = seen[i] != 0 || surface[arrangement.particle_of(j)] != 0 ? 1 : 0;
  });
  parallel_for(n, [&](std::size_t i) {
    bool sees = seen[i] != 0;
    for (const std::int32_t j : list.of(i))
      sees = sees || (seen[arrangement.particle_of(j)] != 0 && distance2(i, j) < near2);
    sees_surface[identifier(i)] = sees ? 1 : 0;
  });
}

// Where phases are layers, 1 for particles that the height of an interface depends on: those that meet another phase,
// and their neighbours, whose sums are those of its colour. In layers whoever meets another phase meets it above alone
// or below alone.
void find_interfaces_of_layers(const Arrangement& arrangement, const ParticleStore& particles,
                               const Resolution& resolution, const Array<std::int64_t>& phase,
                               std::vector<std::uint8_t>& sees_interface) {
  const NeighbourList& list = arrangement.list;
  const std::size_t n = particles.size();
  const double least_height = level_height * resolution.spacing;
  const auto is_wall_point = [&](std::int32_t j) {
    const std::int32_t* point = arrangement.images.wall_point();
    return j >= static_cast<std::int32_t>(n) && point != nullptr && point[static_cast<std::size_t>(j) - n] >= 0;
  };
  std::vector<std::uint8_t> meets(n);
  const double uneven = parallel_max(n, 0.0, [&](std::size_t i) {
    bool above = false, below = false, beside = false;
    for (const std::int32_t j : list.of(i)) {
      if (is_wall_point(j) || phase[arrangement.particle_of(j)] == phase[i]) continue;
      const double height = way_to(list, particles.dimensions, i, j)[particles.dimensions - 1];
      above = above || height >= least_height;
      below = below || height <= -least_height;
      beside = beside || std::abs(height) < least_height;
    }
    meets[i] = above || below || beside ? 1 : 0;
    return beside || (above && below) ? 1.0 : 0.0;
  });
  if (uneven > 0) return;
  parallel_for(n, [&](std::size_t i) {
    bool sees = meets[i] != 0;
    for (const std::int32_t j : list.of(i))
      sees = sees || (!is_wall_point(j) && meets[arrangement.particle_of(j)] != 0);
    sees_interface[static_cast<std::size_t>((*particles.identifier)[i])] = sees ? 1 : 0;
  });
}

// A way from a place, and as much away from the walls of the domain as its end is nearer to them than `gap`: a face at
// an acute angle to a wall presses what is between to it, and an image that is near repels no more.
Vec3 kept_before_sides(const Boundary& boundary, const Vec3& place, Vec3 way, double gap) {
  for (int axis = 0; axis < boundary.domain().dimensions; ++axis)
    for (std::size_t end = 0; end < 2; ++end) {
      if (!is_wall(boundary.domain().sides[axis][end].kind)) continue;
      const double inwards = end == 0 ? 1 : -1;
      const double distance = inwards * (place[axis] + way[axis] - boundary.walls[axis][end]);
      way[axis] += inwards * std::max(0.0, gap - distance);
    }
  return way;
}

Vec3 limited(const Vec3& way, double longest) {
  const double size = length(way);
  return size > longest ? multiply(longest / size, way) : way;
}

// Rounds of moves at `at` until none is longer than `still_enough`. start(): with the first lists; whether to move at
// all. move(i, f): what particle i moves by, with f(dr) = V h^2 W'(r) / r of a neighbour.
template <class Start, class Move>
void move_in_rounds(Arrangement& arrangement, ParticleStore& particles, Boundary& boundary,
                    const Resolution& resolution, const VectorField& at, double t, const Array<std::int64_t>* layer,
                    Start&& start, Move&& move) {
  const int d = particles.dimensions;
  const std::size_t n = particles.size();
  const double longest = longest_move * resolution.spacing;
  const Domain& domain = boundary.domain();
  const auto stays = [layer](std::size_t i) { return layer != nullptr && (*layer)[i] >= 0; };
  VectorScratch way;
  particles.scratch().lease(way, d, n);
  for (int round = 0; round < most_rounds; ++round) {
    arrangement.sort(particles, at);
    boundary.make_images(arrangement, particles, at, 1, {t, t, t}, round % wet_rounds == 0);
    arrangement.find_neighbours(particles, at, {});
    if (round == 0 && !start()) break;
    with_plain_kernel(d, resolution.kernel, [&]<int dimensions, class Kernel>() {
      const double h = resolution.smoothing_length;
      const double value = particles.volume * Kernel::normalisation(dimensions) / std::pow(h, dimensions);
      parallel_for(n, [&](std::size_t i) {
        if (stays(i)) return;
        const Vec3 moved = limited(move(i, [&](const Vec3& dr) { return value * Kernel::f(length(dr) / h); }), longest);
        for (int axis = 0; axis < d; ++axis) way[axis][i] = moved[axis];
      });
    });
    // Between the walls of a wedge what pushes never ends, but nothing moves any more.
    const double farthest = parallel_max(n, 0.0, [&](std::size_t i) {
      if (stays(i)) return 0.0;
      const Vec3 before = vector_at(at, d, i);
      Vec3 place = add(before, vector_at(way, d, i));
      boundary.hold_liquid(boundary.walls, place, nullptr, nullptr, &before);
      for (int axis = 0; axis < d; ++axis) {
        // Open sides let it through; its other components move on.
        if (!domain.periodic(axis) && (place[axis] < domain.lower[axis] || place[axis] > domain.upper[axis])) continue;
        (*at[axis])[i] = place[axis];
        (*particles.position[axis])[i] = place[axis];
      }
      return length(domain.shortest(subtract(vector_at(at, d, i), before)));
    });
    if (farthest < still_enough * resolution.spacing) break;
  }
  particles.scratch().release(way);
  arrangement.sort(particles, at);
}

}  // namespace

void pack_beside_bodies(Arrangement& arrangement, ParticleStore& particles, Boundary& boundary,
                        const Resolution& resolution, const VectorField& at, bool free_surface, double t,
                        const Array<std::int64_t>* phase, const Array<std::int64_t>* layer) {
  const int d = particles.dimensions;
  const BodyWalls& bodies = *boundary.bodies();
  const NeighbourList& list = arrangement.list;
  const auto particle_count = static_cast<std::int32_t>(particles.size());
  std::vector<std::uint8_t> sees_surface(particles.size());  // by identifier: the order changes
  const auto start = [&] {
    std::vector<Lack> lacks;
    if (free_surface) {
      find_lacks(arrangement, particles, resolution, lacks);
      // Bodies leave no gaps of whole rows, but pockets.
      for (Lack& lack : lacks) lack.all_around = false;
      parallel_for(lacks.size(), [&](std::size_t i) {
        if (!(lacks[i].share > surface_lack)) return;
        const Ahead ahead = ahead_of(boundary, arrangement, i, vector_at(at, d, i), lacks[i].normal);
        lacks[i].all_around = ahead == Ahead::pocket || ahead == Ahead::wall;
      });
      find_surface(arrangement, particles, resolution, lacks, beyond_support, sees_surface);
    }
    if (phase != nullptr) find_interfaces_of_layers(arrangement, particles, resolution, *phase, sees_surface);
    return true;
  };
  move_in_rounds(arrangement, particles, boundary, resolution, at, t, layer, start, [&](std::size_t i, auto&& f) {
    const Vec3 place = vector_at(at, d, i);
    // Wall points beside the surface are there or not as a whole: those that move horizontally see their neighbours
    // mirrored at the wall instead, which spaces the first row evenly.
    const bool horizontally = sees_surface[static_cast<std::size_t>((*particles.identifier)[i])] != 0;
    const double reach = (horizontally ? level_layers : packed_layers) * resolution.spacing;
    if (bodies.surely_farther(place, reach)) return Vec3{};
    const double distance = bodies.distance(place);
    if (distance >= reach) return Vec3{};
    Vec3 gradient{};
    const auto add_neighbour = [&](const Vec3& dr) {
      const double weight = f(dr);
      for (int axis = 0; axis < d; ++axis) gradient[axis] -= weight * dr[axis];
    };
    // The liquid continues at its level, mirrored along the horizontal: what lies behind the tangent plane moves by
    // `across` for every length that its mirror image lies before it.
    Vec3 normal{}, across{};
    bool has_images = false;
    if (horizontally) {
      normal = bodies.normal(place);
      Vec3 aside = normal;
      aside[d - 1] = 0;
      has_images = dot(aside, aside) >= least_aside;
      across = multiply(-2 / std::max(dot(aside, aside), least_aside), aside);
      if (has_images) add_neighbour(multiply(distance, across));
    }
    for (const std::int32_t j : list.of(i)) {
      const bool wall_point = j >= particle_count && arrangement.images.wall_point() != nullptr &&
                              arrangement.images.wall_point()[j - particle_count] >= 0;
      if (horizontally && wall_point) continue;
      const Vec3 dr = way_to(list, d, i, j);
      add_neighbour(dr);
      const double before = distance + dot(dr, normal);
      if (has_images && before > 0) add_neighbour(add(dr, multiply(before, across)));
    }
    if (horizontally) gradient[d - 1] = 0;
    // Less and less towards the lattice, which stays.
    const Vec3 moved = multiply(-coefficient * std::min(1.0, 2 * (1 - distance / reach)), gradient);
    const double gap = least_gap * resolution.spacing;
    if (!free_surface) return moved;
    Vec3 out = moved;
    if (distance <= gap) {
      if (!horizontally) normal = bodies.normal(place);
      const double lack = gap - distance - dot(moved, normal);
      if (lack > 0) out = add(moved, multiply(lack, horizontally ? multiply(-0.5, across) : normal));
    }
    return horizontally ? out : kept_before_sides(boundary, place, out, gap);
  });
}

void pack_beside_solids(Arrangement& arrangement, ParticleStore& particles, Boundary& boundary,
                        const Resolution& resolution, const VectorField& at, bool free_surface, double t) {
  const int d = particles.dimensions;
  const NeighbourList& list = arrangement.list;
  const double support_radius = resolution.support_radius;
  // Between faces on either side, the nearest.
  const auto room_at = [&](const Vec3& place) {
    const auto [lower, upper] = boundary.solids()->free_box(place, support_radius);
    double room = upper[0] - lower[0];
    for (int axis = 1; axis < d; ++axis) room = std::min(room, upper[axis] - lower[axis]);
    return room;
  };
  std::vector<std::uint8_t> stays(particles.size());  // by identifier: the order changes
  const auto uneven = [&] {
    std::vector<Lack> lacks;
    find_lacks(arrangement, particles, resolution, lacks);
    parallel_for(particles.size(), [&](std::size_t i) {
      if (!(lacks[i].share > surface_lack)) return;
      const auto [lower, upper] = boundary.solids()->free_box(vector_at(at, d, i), support_radius);
      if (upper[d - 1] - lower[d - 1] < flat_channel * resolution.spacing) lacks[i].all_around = true;
    });
    if (free_surface) find_surface(arrangement, particles, resolution, lacks, beyond_support_over_solids, stays);
    return parallel_max(particles.size(), 0.0, [&](std::size_t i) {
             const bool moves = stays[static_cast<std::size_t>((*particles.identifier)[i])] == 0;
             return moves ? std::abs(lacks[i].share) : 0.0;
           }) > even_enough;
  };
  move_in_rounds(arrangement, particles, boundary, resolution, at, t, nullptr, uneven, [&](std::size_t i, auto&& f) {
    Vec3 gradient{};
    if (stays[static_cast<std::size_t>((*particles.identifier)[i])] != 0) return gradient;
    for (const std::int32_t j : list.of(i)) {
      const Vec3 dr = way_to(list, d, i, j);
      const double weight = f(dr);
      for (int axis = 0; axis < d; ++axis) gradient[axis] -= weight * dr[axis];
    }
    const Vec3 way = limited(multiply(-coefficient, gradient), longest_move * resolution.spacing);
    return room_at(add(vector_at(at, d, i), way)) < least_room * resolution.spacing ? Vec3{} : way;
  });
}

}  // namespace spume
