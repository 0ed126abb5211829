// SPDX-License-Identifier: MIT
// The shift: small displacements that even out the arrangement of the particles.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph {
namespace {

// Of what a lattice stands. At the limit a wave of steepness 0.33 in 2-D gains energy, at 0.9 of it none; at 0.75 it
// loses a third less, but vortices without viscosity in a full domain blow up at courant 0.4 and the splash of
// dam_break_3d evens out more slowly.
constexpr double share_of_largest_shift = 0.9;

// Edge particles and those of the layer below them: within reach of an edge particle, in spacings. On a lattice the
// layer below has neighbours in the edge layer at 1 and 1.41, the next one at 2.
constexpr double layer_reach = 1.8;
// Sum of the weights below over the edge neighbours at which a particle counts fully to the layer; half of what the
// layer below has on a square lattice (0.77; 1.08 on a cubic one).
constexpr double full_weight = 0.4;

float layer_weight(float distance2) {
  const float x = 1 - distance2 / static_cast<float>(layer_reach * layer_reach);
  return x > 0 ? x * x : 0;
}

// What the loops over the neighbours of the upper layers read, in float as the lists hold it.
template <int dimensions>
struct Surroundings {
  using Vector = std::array<float, dimensions>;

  explicit Surroundings(const Liquid& l)
      : liquid(l),
        particles(static_cast<std::int32_t>(l.size())),
        inverse_spacing(static_cast<float>(1 / l.scene.spacing)) {
    for (int axis = 0; axis < dimensions; ++axis) coordinate[axis] = l.list.coordinate(axis);
  }

  // Vector from particle i to the listed point j, in spacings.
  Vector separation(std::size_t i, std::int32_t j) const {
    Vector dr;
    for (int axis = 0; axis < dimensions; ++axis)
      dr[axis] = (coordinate[axis][j] - coordinate[axis][i]) * inverse_spacing;
    return dr;
  }

  // A geometric vector at the listed point j, mirrored where j is an image.
  Vector vector_at(const FloatVectorField& field, std::int32_t j) const {
    Vector value;
    if (j < particles) {
      for (int axis = 0; axis < dimensions; ++axis) value[axis] = (*field[axis])[j];
      return value;
    }
    const std::int32_t source = liquid.images.source()[j - particles];
    const auto& sign = liquid.reflection[liquid.images.path()[j - particles]];
    for (int axis = 0; axis < dimensions; ++axis) value[axis] = sign[axis] * (*field[axis])[source];
    return value;
  }

  const Liquid& liquid;
  std::int32_t particles;
  float inverse_spacing;
  std::array<const float*, dimensions> coordinate;
};

template <std::size_t dimensions>
float dot(const std::array<float, dimensions>& a, const std::array<float, dimensions>& b) {
  float sum = 0;
  for (std::size_t axis = 0; axis < dimensions; ++axis) sum += a[axis] * b[axis];
  return sum;
}

template <int dimensions>
void find_upper_layers(Liquid& liquid) {
  const Surroundings<dimensions> around(liquid);
  liquid.beside_edge.resize(liquid.size());
  parallel_for(liquid.size(), [&](std::size_t i) { liquid.beside_edge[i] = 0; });
  parallel_for(liquid.edge_particles.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(liquid.edge_particles[k]);
    const auto mark = [&](std::size_t j) {
      std::atomic_ref<std::uint8_t>(liquid.beside_edge[j]).store(1, std::memory_order_relaxed);
    };
    mark(i);
    for (const std::int32_t j : liquid.list.of(i)) {
      const auto dr = around.separation(i, j);
      if (layer_weight(dot(dr, dr)) > 0) mark(liquid.particle_of(j));
    }
  });
  parallel_select(liquid.size(), liquid.upper_particles, [&](std::size_t i) { return liquid.beside_edge[i] != 0; });
}

// The normals of the edge particles, made one long.
template <int dimensions>
void find_unit_normals(const Liquid& liquid, const FloatVectorField& unit_normal) {
  parallel_for(liquid.edge_particles.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(liquid.edge_particles[k]);
    std::array<float, dimensions> normal;
    for (int axis = 0; axis < dimensions; ++axis) normal[axis] = (*liquid.normal[axis])[i];
    const float size = std::sqrt(dot(normal, normal));
    for (int axis = 0; axis < dimensions; ++axis) (*unit_normal[axis])[i] = size > 0 ? normal[axis] / size : 0;
  });
}

// The unit normal of the edge particles around particle i, weighted, and how far i belongs to the two upper layers.
template <int dimensions>
float upper_normal(const Surroundings<dimensions>& around, const FloatVectorField& unit_normal, std::size_t i,
                   typename Surroundings<dimensions>::Vector& normal) {
  const Liquid& liquid = around.liquid;
  normal = {};
  float total = 0;
  const auto add = [&](std::int32_t j, float weight) {
    const auto neighbour = around.vector_at(unit_normal, j);
    for (int axis = 0; axis < dimensions; ++axis) normal[axis] += weight * neighbour[axis];
    total += weight;
  };
  const bool edge = liquid.is_edge(i);
  if (edge) add(static_cast<std::int32_t>(i), 1);
  for (const std::int32_t j : liquid.list.of(i)) {
    const auto dr = around.separation(i, j);
    const float weight = layer_weight(dot(dr, dr));
    if (weight > 0 && liquid.is_edge(liquid.particle_of(j))) add(j, weight);
  }
  const float size = std::sqrt(dot(normal, normal));
  if (!(size > 0)) return 0;
  for (float& component : normal) component /= size;
  return edge ? 1 : std::min(1.0F, total / static_cast<float>(full_weight));
}

// Beneath the surface the kernel is cut, and the concentration gradient pushes whole layers along the normal; so does
// every change of their distance. The volume above them, by which the surface is placed, would follow: a standing wave
// of 64 particles then loses 4 % of its amplitude in three periods. What the neighbours of one layer share of the
// normal shift is therefore taken out before it spreads; particles that stand out of their layer are moved as before.
void keep_layers(Liquid& liquid) {
  const FloatVectorField& unit_normal = liquid.acceleration;  // free until the viscous sweep
  with_kernel(liquid.context, [&]<int dimensions, class Kernel>() {
    find_upper_layers<dimensions>(liquid);
    find_unit_normals<dimensions>(liquid, unit_normal);
    liquid.layer_shift.resize(liquid.upper_particles.size());
    const Surroundings<dimensions> around(liquid);
    parallel_for(liquid.upper_particles.size(), [&](std::size_t k) {
      const auto i = static_cast<std::size_t>(liquid.upper_particles[k]);
      std::array<float, dimensions> normal;
      const float share = upper_normal(around, unit_normal, i, normal);
      float total = static_cast<float>(Kernel::w(0.0));
      float sum = total * dot(around.vector_at(liquid.shift, static_cast<std::int32_t>(i)), normal);
      const auto inverse_h = static_cast<float>(liquid.scene.spacing / liquid.width_at(i));
      for (const std::int32_t j : liquid.list.of(i)) {
        const auto dr = around.separation(i, j);
        const float out_of_layer = std::abs(dot(dr, normal));
        if (!(share > 0) || out_of_layer >= 1) continue;
        const auto kernel = static_cast<float>(Kernel::w(double{std::sqrt(dot(dr, dr)) * inverse_h}));
        const float weight = kernel * (1 - out_of_layer);
        total += weight;
        sum += weight * dot(around.vector_at(liquid.shift, j), normal);
      }
      for (int axis = 0; axis < dimensions; ++axis) liquid.layer_shift[k][axis] = share * sum / total * normal[axis];
    });
  });
  parallel_for(liquid.upper_particles.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(liquid.upper_particles[k]);
    for (int axis = 0; axis < liquid.dimensions; ++axis) (*liquid.shift[axis])[i] -= liquid.layer_shift[k][axis];
  });
}

}  // namespace

void choose_shift(Liquid& liquid) {
  const int d = liquid.dimensions;
  // King (3.12) at steps of courant 0.2, else in proportion to the distance moved, as far as that evens out: a liquid
  // at rest is not shifted, and small steps do not shift more (and dissipate more) than large ones. Particles that have
  // to make room for a bubble move whatever the speed, until they are no denser than the lattice: by 1/alpha - 1 just
  // after a bubble has come. Shifted for ever, those beside a bubble at rest below a surface lift the liquid.
  const double most =
      std::max(1.0, share_of_largest_shift * liquid.largest_shift / liquid.options.shifting.coefficient);
  const double of_distance = std::min(liquid.displacement, most);
  const auto strength = [&liquid, of_distance](std::size_t i) {
    const double taken = 1 / liquid.alpha_at(i) - 1;
    if (!(taken > 0)) return of_distance;
    const double excess = (*liquid.divergence_of_position)[i] / liquid.lattice.divergence_of_position - 1;
    return std::clamp(excess / taken, of_distance, std::max(1.0, of_distance));
  };
  const auto limit = [&liquid](std::array<double, 3>& shift, std::size_t i) {
    const double longest = liquid.options.shifting.limit * std::max(1.0, liquid.displacement) * liquid.width_at(i);
    const double length = std::hypot(shift[0], shift[1], shift[2]);
    if (length > longest)
      for (double& component : shift) component *= longest / length;
  };
  parallel_for(liquid.size(), [&](std::size_t i) {
    std::array<double, 3> shift{};
    const double h = liquid.width_at(i);
    const double coefficient = liquid.options.shifting.coefficient * h * h * strength(i);
    for (int axis = 0; axis < d; ++axis) shift[axis] = -coefficient * (*liquid.shift[axis])[i];
    if (liquid.plan.free_surface && liquid.at_surface[i] != 0) {
      // King (3.12), sign and tangential projection corrected: only the part along the surface is kept.
      double along = 0, norm2 = 1e-30;
      for (int axis = 0; axis < d; ++axis) {
        const double normal = (*liquid.smoothed_normal[axis])[i];
        along += normal * shift[axis];
        norm2 += normal * normal;
      }
      for (int axis = 0; axis < d; ++axis) shift[axis] -= along / norm2 * (*liquid.smoothed_normal[axis])[i];
      if (liquid.list.count(i) == 0) shift = {};
    }
    limit(shift, i);
    for (int axis = 0; axis < d; ++axis) (*liquid.shift[axis])[i] = static_cast<float>(shift[axis]);
  });
  if (!liquid.plan.drift_removal) return;
  if (liquid.plan.free_surface) keep_layers(liquid);
  // What neighbours share of the shift transports liquid without any force: near a surface it lifts the liquid step by
  // step (a tenth of a wave's energy per period at 1/50). Only what differs from the neighbours evens out the
  // arrangement.
  filter_vector(liquid.context, liquid.records, liquid.read(liquid.shift), liquid.reflection,
                liquid.write(liquid.acceleration));
  parallel_for(liquid.size(), [&](std::size_t i) {
    std::array<double, 3> shift{};
    for (int axis = 0; axis < d; ++axis)
      shift[axis] = double{(*liquid.shift[axis])[i]} - (*liquid.acceleration[axis])[i];
    limit(shift, i);
    for (int axis = 0; axis < d; ++axis) (*liquid.shift[axis])[i] = static_cast<float>(shift[axis]);
  });
}

}  // namespace spume::les_sph
