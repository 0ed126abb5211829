// SPDX-License-Identifier: MIT
// The shift: small displacements that even out the arrangement of the particles.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph {
namespace {

// Edge particles and those of the layer below them: within reach of an edge particle, in spacings. On a lattice the
// layer below has neighbours in the edge layer at 1 and 1.41, the next one at 2.
constexpr double layer_reach = 1.8;
// Sum of the weights below over the edge neighbours at which a particle counts fully to the layer; half of what the
// layer below has on a square lattice (0.77; 1.08 on a cubic one).
constexpr double full_weight = 0.4;

double layer_weight(double distance2) {
  const double x = 1 - distance2 / (layer_reach * layer_reach);
  return x > 0 ? x * x : 0;
}

// Vector from particle i to the listed point j, in spacings, and its square.
double separation(const Liquid& liquid, std::size_t i, std::int32_t j, Vec3& dr) {
  double r2 = 0;
  for (int axis = 0; axis < liquid.dimensions; ++axis) {
    const float* x = liquid.list.coordinate(axis);
    dr[axis] = (double{x[j]} - double{x[i]}) / liquid.scene.spacing;
    r2 += dr[axis] * dr[axis];
  }
  return r2;
}

// A geometric vector at the listed point j, mirrored where j is an image.
Vec3 vector_at(const Liquid& liquid, const FloatVectorField& field, std::int32_t j) {
  const auto n = static_cast<std::int32_t>(liquid.size());
  Vec3 value{};
  if (j < n) {
    for (int axis = 0; axis < liquid.dimensions; ++axis) value[axis] = (*field[axis])[j];
    return value;
  }
  const std::int32_t source = liquid.images.source()[j - n];
  const auto& sign = liquid.reflection[liquid.images.path()[j - n]];
  for (int axis = 0; axis < liquid.dimensions; ++axis) value[axis] = double{sign[axis]} * (*field[axis])[source];
  return value;
}

void find_upper_layers(Liquid& liquid) {
  liquid.beside_edge.resize(liquid.size());
  parallel_for(liquid.size(), [&](std::size_t i) { liquid.beside_edge[i] = 0; });
  parallel_for(liquid.edge_particles.size(), [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(liquid.edge_particles[k]);
    const auto mark = [&](std::size_t j) {
      std::atomic_ref<std::uint8_t>(liquid.beside_edge[j]).store(1, std::memory_order_relaxed);
    };
    mark(i);
    Vec3 dr{};
    for (const std::int32_t j : liquid.list.of(i))
      if (separation(liquid, i, j, dr) < layer_reach * layer_reach) mark(liquid.particle_of(j));
  });
  parallel_select(liquid.size(), liquid.upper_particles, [&](std::size_t i) { return liquid.beside_edge[i] != 0; });
}

// The unit normal of the edge particles around particle i, weighted, times how far i belongs to the two upper layers.
Vec3 upper_normal(const Liquid& liquid, std::size_t i) {
  Vec3 sum{};
  double total = 0;
  const auto add = [&](const Vec3& normal, double weight) {
    const double size = std::hypot(normal[0], normal[1], normal[2]);
    if (!(size > 0)) return;
    for (int axis = 0; axis < 3; ++axis) sum[axis] += weight * normal[axis] / size;
    total += weight;
  };
  const bool edge = liquid.is_edge(i);
  if (edge) add(vector_at(liquid, liquid.normal, static_cast<std::int32_t>(i)), 1);
  Vec3 dr{};
  for (const std::int32_t j : liquid.list.of(i)) {
    const double weight = layer_weight(separation(liquid, i, j, dr));
    if (weight > 0 && liquid.is_edge(liquid.particle_of(j))) add(vector_at(liquid, liquid.normal, j), weight);
  }
  const double size = std::hypot(sum[0], sum[1], sum[2]);
  if (!(size > 0)) return {};
  const double share = edge ? 1 : std::min(1.0, total / full_weight);
  for (double& component : sum) component *= share / size;
  return sum;
}

// Beneath the surface the kernel is cut, and the concentration gradient pushes whole layers along the normal; so does
// every change of their distance. The volume above them, by which the surface is placed, would follow: a standing wave
// of 64 particles then loses 4 % of its amplitude in three periods. What the neighbours of one layer share of the
// normal shift is therefore taken out before it spreads; particles that stand out of their layer are moved as before.
void keep_layers(Liquid& liquid) {
  find_upper_layers(liquid);
  liquid.layer_shift.resize(liquid.upper_particles.size());
  with_kernel(liquid.context, [&]<int dimensions, class Kernel>() {
    parallel_for(liquid.upper_particles.size(), [&](std::size_t k) {
      const auto i = static_cast<std::size_t>(liquid.upper_particles[k]);
      const Vec3 normal = upper_normal(liquid, i);
      const double share = std::hypot(normal[0], normal[1], normal[2]);
      double sum = 0, total = 0;
      const auto add = [&](const Vec3& shift, double weight) {
        total += weight;
        for (int axis = 0; axis < dimensions; ++axis) sum += weight * shift[axis] * normal[axis];
      };
      add(vector_at(liquid, liquid.shift, static_cast<std::int32_t>(i)), Kernel::w(0.0));
      Vec3 dr{};
      const double inverse_h = liquid.scene.spacing / liquid.width_at(i);
      for (const std::int32_t j : liquid.list.of(i)) {
        const double r2 = separation(liquid, i, j, dr);
        double out_of_layer = 0;
        for (int axis = 0; axis < dimensions; ++axis) out_of_layer += dr[axis] * normal[axis];
        out_of_layer = share > 0 ? std::abs(out_of_layer) / share : 1;
        if (out_of_layer < 1)
          add(vector_at(liquid, liquid.shift, j), Kernel::w(std::sqrt(r2) * inverse_h) * (1 - out_of_layer));
      }
      // The normal carries the share once in the sum and once here.
      for (int axis = 0; axis < 3; ++axis)
        liquid.layer_shift[k][axis] = share > 0 ? static_cast<float>(sum / total * normal[axis] / share) : 0.0F;
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
  // King (3.12) at the step that the courant limit allows, in proportion to the distance moved below it: a liquid at
  // rest is not shifted, and small steps do not shift more (and dissipate more) than large ones. Particles that have to
  // make room for a bubble move whatever the speed, until they are no denser than the lattice: by 1/alpha - 1 just
  // after a bubble has come. Shifted for ever, those beside a bubble at rest below a surface lift the liquid.
  const auto strength = [&liquid](std::size_t i) {
    const double taken = 1 / liquid.alpha_at(i) - 1;
    if (!(taken > 0)) return liquid.displacement;
    const double excess = (*liquid.divergence_of_position)[i] / liquid.lattice.divergence_of_position - 1;
    return std::clamp(excess / taken, liquid.displacement, 1.0);
  };
  const auto limit = [&liquid](std::array<double, 3>& shift, std::size_t i) {
    const double longest = liquid.options.shifting.limit * liquid.width_at(i);
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
