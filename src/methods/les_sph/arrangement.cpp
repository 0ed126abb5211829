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
    apply_walls(liquid, liquid.next_walls, r, nullptr);
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
                    liquid.varying ? liquid.support_radius.data() : nullptr,
                    liquid.grid.support_radius() * liquid.largest_length_ratio);
  liquid.records.invalidate();
}

void measure_kernel_moments(Liquid& liquid) {
  KernelMomentOptions options;
  options.shifting = liquid.plan.shifting;
  options.normals = liquid.plan.free_surface;
  options.spacing = liquid.scene.spacing;
  KernelMoments out;
  out.divergence_of_position = liquid.divergence_of_position->data();
  if (liquid.kernel_sum != nullptr) out.kernel_sum = liquid.kernel_sum->data();
  out.laplacian_diagonal = liquid.laplacian_diagonal->data();
  for (std::size_t k = 0; k < out.correction.size(); ++k)
    out.correction[k] = liquid.correction[k] == nullptr ? nullptr : liquid.correction[k]->data();
  liquid.uncorrected.resize(liquid.size());
  out.uncorrected = liquid.uncorrected.data();
  out.concentration_gradient = liquid.write(liquid.shift);
  out.normal = liquid.write(liquid.normal);
  kernel_moment_sweep(liquid.context, liquid.records, options, out);
}

}  // namespace spume::les_sph
