// SPDX-License-Identifier: MIT
// Where the particles are: intermediate positions, order, images, lists, surface and shift.
#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph {

void move_to_intermediate(Liquid& liquid, double dt) {
  liquid.next_walls = advanced_walls(liquid, dt);
  const int d = liquid.dimensions;
  parallel_for(liquid.size(), [&](std::size_t i) {
    Vec3 r{};
    for (int axis = 0; axis < d; ++axis) r[axis] = (*liquid.position[axis])[i] + dt * (*liquid.velocity[axis])[i];
    keep_inside(liquid, liquid.next_walls, r, nullptr);
    for (int axis = 0; axis < d; ++axis) (*liquid.intermediate[axis])[i] = r[axis];
  });
}

void sort_particles(Liquid& liquid) {
  const auto build = [&] {
    const auto r = liquid.read(liquid.intermediate);
    liquid.table.build(liquid.grid, r[0], r[1], r[2], liquid.size());
  };
  build();
  if (!liquid.table.already_sorted()) liquid.fields.permute(liquid.table.order());
}

void make_images(Liquid& liquid, double dt) {
  const auto r = liquid.read(liquid.intermediate);
  liquid.images.build(image_rules(liquid, liquid.next_walls), liquid.grid, r[0], r[1], r[2], liquid.size());
  update_image_rules(liquid, liquid.time + dt);
}

void find_neighbours(Liquid& liquid) {
  const auto r = liquid.read(liquid.intermediate);
  liquid.list.build(liquid.grid, liquid.table, r[0], r[1], r[2], liquid.size(), liquid.images, liquid.origin,
                    liquid.varying ? liquid.reach.data() : nullptr, liquid.grid.reach() * liquid.largest_length_ratio);
  liquid.records.invalidate();
}

void measure_geometry(Liquid& liquid) {
  GeometryOptions options;
  options.shifting = liquid.plan.shifting;
  options.normals = liquid.plan.free_surface;
  options.spacing = liquid.scene.spacing;
  GeometryOut out;
  out.divergence_of_position = liquid.divergence_of_position->data();
  out.coupling = liquid.coupling->data();
  for (std::size_t k = 0; k < out.correction.size(); ++k)
    out.correction[k] = liquid.correction[k] == nullptr ? nullptr : liquid.correction[k]->data();
  liquid.uncorrected.resize(liquid.size());
  out.uncorrected = liquid.uncorrected.data();
  out.concentration_gradient = liquid.write(liquid.shift);
  out.normal = liquid.write(liquid.normal);
  geometry_sweep(liquid.context, liquid.records, options, out);
}

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
