// SPDX-License-Identifier: MIT
#include "spume/particles/surface.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/operators/surface_layers.hpp"
#include "spume/particles/options.hpp"
#include "spume/particles/pockets.hpp"

namespace spume {
namespace {

// On a lattice with the Wendland kernel and an h of 1.3 spacings div r is 2.03 in the surface layer, 2.88 in the second
// one and 2.94 in the bulk in 3-D, 1.25, 1.87 and 1.95 in 2-D: the thresholds lie between the first two layers.
double standard_threshold(int dimensions) {
  return dimensions == 3 ? surface_threshold_3d : surface_threshold_2d;
}

// div r in the surface layer of a lattice, as a share of the threshold. A particle of a flat layer before a gap has at
// least this, whatever it sees of the solid; one that has less is spray, of which solids hide nothing. Spray beside a
// wall, of a div r of 0.5 to 1.1, taken for liquid inside reached 23 m/s in dam_break_3d at a spacing of 0.03, where
// nothing else passes 6.5 m/s.
double surface_layer_share(int dimensions) {
  return dimensions == 3 ? 2.03 / surface_threshold_3d : 1.25 / surface_threshold_2d;
}

// Spacings around the place that a normal points to: beside the edge of a body it points past the body.
constexpr double beside = 0.4;
// Cosine of the angle between a normal and the face that it points to. A wall beside the surface is not meant: a
// particle 0.38 spacings beside a pillar, taken for liquid inside, left still water at 4 sqrt(g H).
constexpr double in_front = 0.5;

// Whether a particle meets walls alone, and images of itself.
bool is_alone(const Arrangement& arrangement, std::size_t i) {
  const NeighbourList& list = arrangement.list;
  const auto n = static_cast<std::int32_t>(list.particles());
  const std::int32_t* wall_point = arrangement.images.wall_point();
  for (const std::int32_t j : list.of(i)) {
    if (j >= n && wall_point != nullptr && wall_point[j - n] >= 0) continue;
    if (arrangement.particle_of(j) != i) return false;
  }
  return true;
}

}  // namespace

InteriorWeight interior_weight(int dimensions, const SurfaceOptions& options) {
  return {options.threshold > 0 ? options.threshold : standard_threshold(dimensions), options.blend_width};
}

FreeSurface::FreeSurface(const Resolution& resolution, const Options& options)
    : resolution_(resolution), options_(options), continued_(resolution, options.interior) {}

void FreeSurface::find(Arrangement& arrangement, ParticleStore& particles, MomentFields& moments,
                       const Boundary& boundary, const VectorField& at) {
  const std::size_t n = particles.size();
  const SolidUnion* solids = boundary.solids();
  const bool obstacles = boundary.has_obstacles();
  at_surface.resize(n);
  pressure_fixed.resize(n);
  interior_weight.resize(n);
  if (solids != nullptr) count_in_boxes(arrangement, moments, at, *solids);
  if (boundary.bodies() != nullptr) continue_into_bodies(arrangement, moments, boundary, at);
  const Array<float>& divergence_of_position = obstacles ? counted_ : *moments.divergence_of_position;
  const double least = surface_layer_share(resolution_.dimensions) * options_.interior.threshold;
  std::atomic<bool> some_closed_off = false;
  parallel_for(n, [&](std::size_t i) {
    at_surface[i] = divergence_of_position[i] < options_.interior.threshold ? 1 : 0;
    const bool sparse = boundary.bodies() != nullptr && continued_.is_sparse(i);
    pressure_fixed[i] = at_surface[i] != 0 && (moments.uncorrected[i] != 0 || sparse) ? 1 : 0;
    interior_weight[i] = options_.interior(divergence_of_position[i]);
    bool inside = is_covered(i);
    if (!inside && obstacles && interior_weight[i] < 1) {
      // Where the liquid continues into a body, what a surface particle lacks is no gap before it.
      const bool continued = at_surface[i] != 0 && boundary.bodies() != nullptr && continues_into_body(i);
      const auto before_solid = [&] {
        return is_near(moments, i) && divergence_of_position[i] >= least && faces_solid(boundary, moments, at, i);
      };
      inside = !continued && (before_solid() || is_in_pocket(arrangement, boundary, moments, at, i));
    }
    if (inside) {
      at_surface[i] = pressure_fixed[i] = 0;
      interior_weight[i] = 1;
    }
    if (boundary.bodies() != nullptr && pressure_fixed[i] == 0 && (sparse || is_alone(arrangement, i)))
      some_closed_off.store(true, std::memory_order_relaxed);
  });
  closed_off = some_closed_off.load();
  if (obstacles) pass_over_gaps(arrangement, at, boundary);
  parallel_select(n, surface_particles, [&](std::size_t i) { return at_surface[i] != 0; });
  parallel_select(n, near_surface, [&](std::size_t i) { return is_near(moments, i); });
  depth.resize(near_surface.size());
  rise.resize(near_surface.size());
  rise.fill(0.0F);
  ScratchArray<float> of_particle(particles.scratch(), n);
  surface_depths(arrangement.context, arrangement.packed,
                 {resolution_.spacing, near_surface, read(moments.normal), solids, boxes_, continued_.depths()},
                 of_particle, depth);
  if (options_.smooth_normals) {
    particles.scratch().lease(smoothed_normal, resolution_.dimensions, n);
    filter_vector_subset(arrangement.context, arrangement.packed, read(moments.normal), boundary.reflection(),
                         surface_particles, write(smoothed_normal));
  }
  arrangement.packed.take_traffic();  // it counts the lists of all particles, not of those at the surface alone
}

void FreeSurface::count_in_boxes(const Arrangement& arrangement, MomentFields& moments, const VectorField& at,
                                 const SolidUnion& solids) {
  const double reach = arrangement.grid.support_radius();
  const std::size_t n = moments.divergence_of_position->size();
  counted_.resize(n);
  parallel_for(n, [&](std::size_t i) { counted_[i] = (*moments.divergence_of_position)[i]; });
  parallel_select(n, beside_edges_,
                  [&](std::size_t i) { return !solids.open_around(vector_at(at, resolution_.dimensions, i), reach); });
  boxes_.resize(beside_edges_.size());
  box_moments_.resize(beside_edges_.size());
  parallel_for(boxes_.size(), [&](std::size_t k) {
    FreeBox& box = boxes_[k];
    box.particle = beside_edges_[k];
    box.place = vector_at(at, resolution_.dimensions, static_cast<std::size_t>(box.particle));
    const auto [lower, upper] = solids.free_box(box.place, reach);
    box.lower = lower;
    box.upper = upper;
  });
  box_moments(arrangement.context, solids, resolution_.spacing, boxes_, box_moments_);
  parallel_for(boxes_.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(boxes_[k].particle);
    counted_[i] = box_moments_[k].divergence_of_position;
    for (int axis = 0; axis < resolution_.dimensions; ++axis) (*moments.normal[axis])[i] = box_moments_[k].normal[axis];
  });
}

void FreeSurface::continue_into_bodies(const Arrangement& arrangement, MomentFields& moments, const Boundary& boundary,
                                       const VectorField& at) {
  const Array<float>& divergence_of_position = *moments.divergence_of_position;
  const std::size_t n = divergence_of_position.size();
  counted_.resize(n);
  parallel_for(n, [&](std::size_t i) { counted_[i] = divergence_of_position[i]; });
  continued_.find(arrangement, moments, boundary, at, counted_);
}

bool FreeSurface::faces_solid(const Boundary& boundary, const MomentFields& moments, const VectorField& at,
                              std::size_t i) const {
  const Vec3 place = vector_at(at, resolution_.dimensions, i);
  Vec3 normal{};
  for (int axis = 0; axis < resolution_.dimensions; ++axis) normal[axis] = (*moments.normal[axis])[i];
  const double size = std::sqrt(dot(normal, normal)), reach = 0.5 * resolution_.support_radius;
  if (!(size > 0) || !boundary.obstacle_near(place, reach)) return false;
  normal = multiply(1 / size, normal);
  if (const BodyWalls* bodies = boundary.bodies(); bodies != nullptr) {
    const Vec3 ahead = add(place, multiply(reach, normal));
    const auto towards = [&](const Vec3& p) { return dot(bodies->normal(p), normal) < -in_front; };
    if (bodies->distance(ahead) < beside * resolution_.spacing && (towards(place) || towards(ahead))) return true;
  }
  if (boundary.solids() == nullptr) return false;
  const auto [lower, upper] = boundary.solids()->free_box(place, reach);
  for (int axis = 0; axis < resolution_.dimensions; ++axis) {
    const double face = normal[axis] > 0 ? upper[axis] : lower[axis];
    if (std::abs(normal[axis]) > in_front && (face - place[axis]) / normal[axis] < reach) return true;
  }
  return false;
}

// Spray has room.
bool FreeSurface::is_in_pocket(const Arrangement& arrangement, const Boundary& boundary, const MomentFields& moments,
                               const VectorField& at, std::size_t i) const {
  if (boundary.bodies() == nullptr) return false;
  const Vec3 place = vector_at(at, resolution_.dimensions, i);
  const Ahead ahead = ahead_of(boundary, arrangement, i, place, vector_at(moments.normal, resolution_.dimensions, i));
  const bool pocket = ahead == Ahead::pocket || (ahead == Ahead::wall && in_one_layer(boundary, place));
  return pocket && (!continued_.is_sparse(i) || !has_room(boundary, place));
}

void FreeSurface::pass_over_gaps(const Arrangement& arrangement, const VectorField& at, const Boundary& boundary) {
  const NeighbourList& list = arrangement.list;
  const double reach = layer_distance * resolution_.spacing;
  const auto reach2 = static_cast<float>(reach * reach);
  parallel_for(interior_weight.size(), [&](std::size_t i) {
    if (at_surface[i] != 0 || interior_weight[i] == 1 ||
        !boundary.obstacle_near(vector_at(at, resolution_.dimensions, i), resolution_.support_radius))
      return;
    for (const std::int32_t j : list.of(i)) {
      if (at_surface[arrangement.particle_of(j)] == 0) continue;
      float distance2 = 0;
      for (int axis = 0; axis < resolution_.dimensions; ++axis) {
        const float d = list.coordinate(axis)[j] - list.coordinate(axis)[i];
        distance2 += d * d;
      }
      if (distance2 < reach2) return;
    }
    interior_weight[i] = 1;
  });
}

void FreeSurface::release_smoothed_normals(ParticleStore& particles) {
  particles.scratch().release(smoothed_normal);
}

// m = sum_j g d, from the outward normal -h m.
Vec3 FreeSurface::moment_of(const MomentFields& moments, const ParticleSizes& sizes, std::size_t i) const {
  Vec3 m{};
  for (int axis = 0; axis < resolution_.dimensions; ++axis)
    m[axis] = -(*moments.normal[axis])[i] / sizes.smoothing_length(resolution_, i);
  return m;
}

void FreeSurface::find_rise(const Arrangement& arrangement, const MomentFields& moments, const VectorField& velocity,
                            const std::vector<std::array<float, 3>>& reflection, double dt) {
  const NeighbourList& list = arrangement.list;
  const Images& images = arrangement.images;
  const auto n = static_cast<std::int32_t>(list.particles());
  const int d = resolution_.dimensions;
  const double inverse2 = 1 / (resolution_.support_radius * resolution_.support_radius);
  parallel_for(near_surface.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(near_surface[k]);
    Vec3 normal{};
    for (int axis = 0; axis < d; ++axis) normal[axis] = (*moments.normal[axis])[i];
    const double size = std::sqrt(dot(normal, normal));
    if (!(size > 0)) return;
    const double own = dot(vector_at(velocity, d, i), normal) / size;
    double weights = 1 - double{interior_weight[i]}, sum = weights * own;
    for (const std::int32_t point : list.of(i)) {
      const std::size_t j = arrangement.particle_of(point);
      if (!is_near(moments, j)) continue;
      const bool image = point >= n;
      if (image && images.wall_point() != nullptr && images.wall_point()[point - n] >= 0) continue;
      double distance2 = 0, speed = 0;
      for (int axis = 0; axis < d; ++axis) {
        const double away = double{list.coordinate(axis)[point]} - list.coordinate(axis)[i];
        distance2 += away * away;
        const float sign = image ? reflection[static_cast<std::size_t>(images.path()[point - n])][axis] : 1.0F;
        speed += sign * (*velocity[axis])[j] * normal[axis];
      }
      const double inside = std::max(0.0, 1 - distance2 * inverse2);
      const double weight = (1 - double{interior_weight[j]}) * inside * inside;
      weights += weight;
      sum += weight * speed / size;
    }
    rise[k] = static_cast<float>(ripples_ahead * dt * (own - sum / weights));
  });
}

// Of liquid that the acceleration presses along `inwards`, of any length, against what lies below.
double FreeSurface::pressure_of_depth(std::size_t k, const Vec3& acceleration, const Vec3& inwards) const {
  const double pressing = dot(acceleration, inwards) / length(inwards);
  const double lifted = lift_of(static_cast<std::size_t>(near_surface[k]));
  return depth[k] * pressing + rise[k] * std::abs(pressing) + lifted * length(acceleration);
}

SurfaceRow FreeSurface::row(const MomentFields& moments, const ParticleSizes& sizes,
                            const LocalAcceleration& acceleration, std::size_t k) const {
  const auto i = static_cast<std::size_t>(near_surface[k]);
  const double outside = 1 - double{interior_weight[i]};
  const double s = depth[k];
  const Vec3 m = moment_of(moments, sizes, i);
  const double size = std::sqrt(dot(m, m));
  // In a thin sheet |m| vanishes although the surface is near on both sides: there the pairs that are missing hold
  // p = 0.
  const double full = resolution_.lattice.laplacian_diagonal / (resolution_.spacing * resolution_.spacing);
  const double missing = std::max(0.0, full - double{moments.laplacian_diagonal[i]});
  SurfaceRow row;
  row.laplacian_diagonal = outside * std::max(2 * size / s, missing);
  if (size > 0) row.hydrostatic_pressure = pressure_of_depth(k, acceleration.at(i), m);
  return row;
}

void FreeSurface::complete_gradient(const MomentFields& moments, const ParticleSizes& sizes,
                                    const LocalAcceleration& acceleration, const Array<double>& reduced_pressure,
                                    const Array<double>* potential, FloatVectorScratch& gradient_of_q) const {
  const int d = resolution_.dimensions;
  parallel_for(near_surface.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(near_surface[k]);
    const Vec3 m = moment_of(moments, sizes, i);
    const double size = std::sqrt(dot(m, m));
    if (!(size > 0)) return;
    const double outside = 1 - double{interior_weight[i]};
    const double s = depth[k];
    const double height = potential == nullptr ? 0.0 : (*potential)[i];
    const double excess = reduced_pressure[i] - height - pressure_of_depth(k, acceleration.at(i), m);
    // L' by Sherman-Morrison: with v = L m and c = 2 s / |m|, L' x = L x - c v (v . x) / (1 + c m . v).
    Vec3 v{}, gradient{};
    int slot = 0;
    for (int a = 0; a < d; ++a) {
      gradient[a] = gradient_of_q[a][i];
      for (int b = a; b < d; ++b, ++slot) {
        const double entry = (*moments.correction[slot])[i];
        v[a] += entry * m[b];
        if (b != a) v[b] += entry * m[a];
      }
    }
    const double c = 2 * outside * s / size;
    const double factor = (2 * outside * excess - c * dot(m, gradient)) / (1 + c * dot(m, v));
    for (int a = 0; a < d; ++a) gradient_of_q[a][i] = static_cast<float>(gradient[a] + factor * v[a]);
  });
}

double FreeSurface::bytes() const {
  double sum = 0;
  for (const auto* flags : {&at_surface, &pressure_fixed}) sum += flags->bytes();
  for (const auto* values : {&interior_weight, &depth, &rise}) sum += values->bytes();
  for (const auto* numbers : {&surface_particles, &near_surface}) sum += numbers->bytes();
  return sum + continued_.bytes();
}

double FreeSurface::traffic() const {
  double sum = static_cast<double>(at_surface.size() + pressure_fixed.size());
  for (const std::size_t size :
       {interior_weight.size(), depth.size(), rise.size(), surface_particles.size(), near_surface.size(),
        smoothed_normal[0].size(), smoothed_normal[1].size(), smoothed_normal[2].size()})
    sum += 4 * static_cast<double>(size);
  return sum;
}

}  // namespace spume
