// SPDX-License-Identifier: MIT
#include "spume/particles/continued_liquid.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/operators/pair_sweep.hpp"
#include "spume/operators/surface_layers.hpp"
#include "spume/particles/near_particles.hpp"

namespace spume {
namespace {

// In support radii: a wall point beside the surface lies up to one from a particle that sees it, which itself is up to
// one from liquid that sees no body; and some way along the surface, so that a slope is not taken from one particle.
constexpr double plane_reach = 2.2;

// div r in a single layer of a lattice, a row in 2-D.
double layer_divergence_of_position(int dimensions) {
  return dimensions == 3 ? 1.12 : 0.55;
}
constexpr double sparse_share = 0.75;

// A particle or an image of one; a wall point that planes count by less than its whole, whole, and one that no plane is
// near.
enum class Seen { particle, beside_surface, continued, wet };

// Calls visit(seen, sign) for the place and its mirror images in walls nearer than `reach`; what is found beside an
// image is seen at the place with the components of its offset multiplied by `sign`.
template <class Visit>
void visit_reflections(const Domain& domain, const WallPositions& walls, const Vec3& place, double reach,
                       Visit&& visit) {
  std::array<std::array<double, 3>, 3> choice{};  // per axis: the place, then its images
  std::array<std::size_t, 3> choices{1, 1, 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    choice[axis][0] = place[axis];
    if (axis >= static_cast<std::size_t>(domain.dimensions)) continue;
    for (std::size_t side = 0; side < 2; ++side)
      if (is_wall(domain.sides[axis][side].kind) && std::abs(place[axis] - walls[axis][side]) < reach)
        choice[axis][choices[axis]++] = 2 * walls[axis][side] - place[axis];
  }
  for (std::size_t k = 0; k < choices[2]; ++k)
    for (std::size_t j = 0; j < choices[1]; ++j)
      for (std::size_t i = 0; i < choices[0]; ++i)
        visit(Vec3{choice[0][i], choice[1][j], choice[2][k]},
              Vec3{i == 0 ? 1.0 : -1.0, j == 0 ? 1.0 : -1.0, k == 0 ? 1.0 : -1.0});
}

}  // namespace

void ContinuedLiquid::sort_points(const Boundary& boundary) {
  const std::vector<WallPoint>& points = boundary.bodies()->all_points();
  const Domain& domain = boundary.domain();
  Vec3 lower = domain.lower, upper = domain.upper;
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    lower[axis] -= resolution_.support_radius;
    upper[axis] += resolution_.support_radius;
  }
  grid_ = CellGrid(domain.dimensions, lower, upper, resolution_.support_radius, points.size());
  std::array<Array<double>, 3> at;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis].resize(points.size());
    parallel_for(points.size(), [&](std::size_t g) { at[axis][g] = points[g].position[axis]; });
  }
  table_.build(grid_, at[0].data(), at[1].data(), domain.dimensions == 3 ? at[2].data() : nullptr, points.size());
  point_.resize(points.size());
  share_.resize(points.size());
  continued_.resize(points.size());
  parallel_for(points.size(),
               [&](std::size_t k) { point_[k] = points[static_cast<std::size_t>(table_.order()[k])].position; });
}

void ContinuedLiquid::find(const Arrangement& arrangement, MomentFields& moments, const Boundary& boundary,
                           const VectorField& at, Array<float>& counted) {
  if (point_.empty() || boundary.features.displaced_bodies) sort_points(boundary);
  for (auto* flags : {&sees_planes_, &sees_surface_, &sparse_}) flags->resize(moments.divergence_of_position->size());
  const int d = resolution_.dimensions;
  const double reach = resolution_.support_radius;
  const NeighbourList& list = arrangement.list;
  const Array<float>& divergence_of_position = *moments.divergence_of_position;
  const auto is_near = [&](std::size_t i) { return interior_(divergence_of_position[i]) < 1; };
  const BodyWalls& bodies = *boundary.bodies();
  parallel_select(divergence_of_position.size(), beside_, [&](std::size_t i) {
    const Vec3 place = vector_at(at, d, i);
    if (bodies.surely_farther(place, reach)) return false;
    // The surface before the distance, which a mesh takes 3 us for.
    bool sees = is_near(i);
    for (const std::int32_t j : list.of(i)) sees = sees || is_near(arrangement.particle_of(j));
    return sees && bodies.nearer_than(place, reach);
  });
  parallel_for(sees_surface_.size(), [&](std::size_t i) { sees_planes_[i] = sees_surface_[i] = sparse_[i] = 0; });
  depths_.resize(beside_.size());
  if (beside_.size() == 0) return;
  with_plain_kernel(d, resolution_.kernel, [&]<int dimensions, class Kernel>() {
    find_planes<dimensions>(arrangement, moments, boundary, at);
    find_shares<dimensions, Kernel>(arrangement, boundary);
    count<dimensions, Kernel>(arrangement, boundary, at);
  });
  parallel_for(beside_.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(beside_[k]);
    counted[i] = static_cast<float>(count_[k].divergence_of_position);
    for (int axis = 0; axis < d; ++axis) (*moments.normal[axis])[i] = static_cast<float>(count_[k].normal[axis]);
    depths_[k] = {beside_[k], static_cast<float>(count_[k].depth)};
    sees_planes_[i] = count_[k].sees_planes ? 1 : 0;
    sees_surface_[i] = count_[k].sees_surface ? 1 : 0;
    sparse_[i] = count_[k].of_particles < sparse_share * layer_divergence_of_position(d) ? 1 : 0;
  });
}

const WallPoint& ContinuedLiquid::sorted_point(const Boundary& boundary, std::size_t sorted) const {
  return boundary.bodies()->all_points()[static_cast<std::size_t>(table_.order()[sorted])];
}

template <int dimensions>
void ContinuedLiquid::find_planes(const Arrangement& arrangement, const MomentFields& moments, const Boundary& boundary,
                                  const VectorField& at) {
  const NeighbourList& list = arrangement.list;
  const std::size_t n = list.particles();
  const double dr = resolution_.spacing;
  const auto reach = (1 + plane_reach) * resolution_.support_radius;
  parallel_select(n, planar_, [&](std::size_t i) {
    const Vec3 place = vector_at(at, dimensions, i);
    return interior_((*moments.divergence_of_position)[i]) == 0 && boundary.bodies()->nearer_than(place, reach) &&
           !boundary.bodies()->nearer_than(place, resolution_.support_radius);
  });
  plane_.assign(planar_.size(), {});
  for (auto& component : plane_place_) component.resize(planar_.size());
  parallel_for(planar_.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(planar_[k]);
    Vec3 normal{};
    for (int axis = 0; axis < dimensions; ++axis) normal[axis] = (*moments.normal[axis])[i];
    const double size = length(normal);
    for (std::size_t axis = 0; axis < 3; ++axis) plane_place_[axis][k] = vector_at(at, dimensions, i)[axis];
    if (!(size > 0)) return;
    normal = multiply(1 / size, normal);
    double content = column_weight(dimensions, 0, 0);
    for (const std::int32_t j : list.of(i)) {
      Vec3 offset{};
      for (int axis = 0; axis < dimensions; ++axis)
        offset[axis] = (double{list.coordinate(axis)[j]} - double{list.coordinate(axis)[i]}) / dr;
      const double outwards = dot(offset, normal);
      content +=
          column_weight(dimensions, std::sqrt(std::max(0.0, dot(offset, offset) - outwards * outwards)), -outwards);
    }
    plane_[k] = {add(vector_at(at, dimensions, i), multiply(dr * depth_of_column(dimensions, content), normal)),
                 normal};
  });
  plane_table_.build(arrangement.grid, plane_place_[0].data(), plane_place_[1].data(),
                     dimensions == 3 ? plane_place_[2].data() : nullptr, planar_.size());
}

template <int dimensions, class Kernel>
void ContinuedLiquid::find_shares(const Arrangement& arrangement, const Boundary& boundary) {
  const double reach = plane_reach * resolution_.support_radius, dr = resolution_.spacing;
  const ThinWalls* thin = boundary.bodies()->thin();
  parallel_blocks(share_.size(), 256, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t g = first; g < last; ++g) {
      double weights = 0, sum = 0;
      const auto weigh = [&](const Vec3& seen, const Vec3& sign) {
        // Planes beyond a thin body are those of other liquid than the point mirrors.
        Vec3 mirror = seen;
        if (thin != nullptr)
          for (std::size_t axis = 0; axis < 3; ++axis)
            mirror[axis] += sign[axis] * (sorted_point(boundary, g).mirror[axis] - point_[g][axis]);
        visit_near(boundary.domain(), arrangement.grid, plane_table_, seen, reach,
                   [&](std::int32_t j, const Vec3& shift) {
                     const auto k = static_cast<std::size_t>(plane_table_.order()[static_cast<std::size_t>(j)]);
                     const Plane& plane = plane_[k];
                     if (plane.normal == Vec3{}) return;  // a particle without one
                     if (thin != nullptr && thin->hides(mirror, add(plane.place, shift))) return;
                     const Vec3 offset = subtract(seen, add(plane.place, shift));
                     const double weight = Kernel::w(Kernel::support * length(offset) / reach);
                     weights += weight;
                     sum += weight * std::clamp(0.5 - dot(offset, plane.normal) / dr, 0.0, 1.0);
                   });
      };
      visit_reflections(boundary.domain(), boundary.next_walls, point_[g], reach, weigh);
      continued_[g] = weights > 0 ? 1 : 0;
      if (weights > 0)
        share_[g] = static_cast<float>(sum / weights);
      else
        share_[g] = boundary.bodies()->is_wet(static_cast<std::size_t>(table_.order()[g])) ? 1 : 0;
    }
  });
}

template <int dimensions, class Kernel>
void ContinuedLiquid::count(const Arrangement& arrangement, const Boundary& boundary, const VectorField& at) {
  const NeighbourList& list = arrangement.list;
  const auto particles = static_cast<std::int32_t>(list.particles());
  const std::int32_t* const wall_point = arrangement.images.wall_point();
  const double h = resolution_.smoothing_length, reach = resolution_.support_radius, dr = resolution_.spacing;
  const SweepContext& context = arrangement.context;
  const ThinWalls* thin = boundary.bodies()->thin();
  const double gradient =
      context.gradient_scale * context.volume * Kernel::normalisation(dimensions) / std::pow(h, dimensions + 2);
  // What a particle sees: others and images of them, and wall points by their share.
  const auto visit_liquid = [&](std::size_t i, auto&& visit) {
    for (const std::int32_t j : list.of(i)) {
      if (j >= particles && wall_point != nullptr && wall_point[j - particles] >= 0 &&
          arrangement.context.walls->is_wall(static_cast<std::size_t>(wall_point[j - particles])))
        continue;
      Vec3 offset{};
      for (int axis = 0; axis < dimensions; ++axis)
        offset[axis] = double{list.coordinate(axis)[j]} - double{list.coordinate(axis)[i]};
      visit(1.0, offset, dot(offset, offset), Seen::particle);
    }
    const auto visit_points = [&](const Vec3& seen, const Vec3& sign) {
      visit_near(boundary.domain(), grid_, table_, seen, reach, [&](std::int32_t g, const Vec3& shift) {
        Vec3 offset{};
        for (int axis = 0; axis < dimensions; ++axis)
          offset[axis] = sign[axis] * (point_[static_cast<std::size_t>(g)][axis] + shift[axis] - seen[axis]);
        const double r2 = dot(offset, offset);
        if (r2 >= reach * reach) return;
        if (thin != nullptr) {
          const WallPoint& point = sorted_point(boundary, static_cast<std::size_t>(g));
          if (!thin->sees(seen, thin->particle_distance(i), add(point.position, shift), add(point.unfolded(), shift),
                          point))
            return;
        }
        const auto k = static_cast<std::size_t>(g);
        const Seen counted = continued_[k] == 0 ? Seen::wet : share_[k] < 1 ? Seen::beside_surface : Seen::continued;
        visit(double{share_[k]}, offset, r2, counted);
      });
    };
    visit_reflections(boundary.domain(), boundary.next_walls, vector_at(at, dimensions, i), reach, visit_points);
  };
  count_.resize(beside_.size());
  parallel_blocks(beside_.size(), 64, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const auto i = static_cast<std::size_t>(beside_[k]);
      Count& count = count_[k];
      count = {.depth = dr};
      visit_liquid(i, [&](double share, const Vec3& offset, double r2, Seen seen) {
        count.sees_planes = count.sees_planes || seen == Seen::continued || seen == Seen::beside_surface;
        count.sees_surface = count.sees_surface || seen == Seen::beside_surface;
        const double g = -share * gradient * Kernel::f(std::sqrt(r2) / h);
        count.divergence_of_position += g * r2;
        if (seen == Seen::particle) count.of_particles += g * r2;
        for (int axis = 0; axis < dimensions; ++axis) count.normal[axis] -= h * g * offset[axis];
      });
      const double size = length(count.normal);
      if (!(size > 0)) continue;
      double content = column_weight(dimensions, 0, 0);
      visit_liquid(i, [&](double share, const Vec3& offset, double r2, Seen) {
        const double outwards = dot(offset, count.normal) / size;
        content +=
            share * column_weight(dimensions, std::sqrt(std::max(0.0, r2 - outwards * outwards)) / dr, -outwards / dr);
      });
      count.depth = dr * depth_of_column(dimensions, content);
    }
  });
}

double ContinuedLiquid::bytes() const {
  return static_cast<double>(point_.capacity() * sizeof(Vec3) + plane_.capacity() * sizeof(Plane) +
                             count_.capacity() * sizeof(Count) + depths_.capacity() * sizeof(KnownDepth)) +
         share_.bytes() + continued_.bytes() + sees_planes_.bytes() + sees_surface_.bytes() + sparse_.bytes() +
         plane_table_.bytes() + table_.bytes() + beside_.bytes() + planar_.bytes();
}

}  // namespace spume
