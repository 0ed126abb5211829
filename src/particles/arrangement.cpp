// SPDX-License-Identifier: MIT
#include "spume/particles/arrangement.hpp"

#include <variant>

#include "spume/core/borrowed_array.hpp"

namespace spume {
namespace {

CellGrid grid_of(const Domain& domain, double support_radius, std::size_t particles) {
  std::array<double, 3> lower{}, upper{};
  for (int axis = 0; axis < domain.dimensions; ++axis) {
    lower[axis] = domain.lower[axis] - support_radius;
    upper[axis] = domain.upper[axis] + support_radius;
  }
  return {domain.dimensions, lower, upper, support_radius, particles};
}

}  // namespace

Arrangement::Arrangement(const Domain& domain, const Resolution& resolution, double particle_volume,
                         std::size_t particles, double skin)
    : origin{(domain.lower[0] + domain.upper[0]) / 2, (domain.lower[1] + domain.upper[1]) / 2,
             (domain.lower[2] + domain.upper[2]) / 2},
      grid(grid_of(domain, resolution.support_radius + skin, particles)) {
  context.list = &list;
  context.images = &images;
  context.dimensions = domain.dimensions;
  context.kernel = resolution.kernel;
  context.smoothing_length = resolution.smoothing_length;
  context.volume = particle_volume;
}

void Arrangement::sort(ParticleStore& particles, const VectorField& at) {
  const auto r = read(at);
  const BorrowedArray<std::int32_t> order(particles.scratch(), particles.size());
  table.build(grid, r[0], r[1], r[2], particles.size(), particles.scratch(), order.data());
  if (!table.already_sorted()) particles.fields.permute({order.data(), order.size()});
}

void Arrangement::find_neighbours(const ParticleStore& particles, const VectorField& at, const ParticleSizes& sizes) {
  const auto r = read(at);
  list.build(grid, table, r[0], r[1], r[2], particles.size(), images, origin,
             sizes.variable ? sizes.support_radius.data() : nullptr,
             grid.support_radius() * sizes.largest_length_ratio);
  packed.invalidate();
}

void Arrangement::move(const std::array<const double*, 3>& at) {
  list.move(at, images, context.dimensions);
  packed.invalidate();
}

void Arrangement::set_sizes(const ParticleSizes* sizes) {
  context.length_ratio = sizes == nullptr ? nullptr : sizes->length_ratio.data();
  context.volume_ratio = sizes == nullptr ? nullptr : sizes->volume_ratio.data();
}

double Arrangement::sort_traffic(const ParticleStore& particles) const {
  double permuted = 0;
  if (!table.already_sorted())
    for (const auto& field : particles.fields.fields())
      if (field->lifetime != Lifetime::result)
        permuted += std::visit([](const auto& array) { return 2.0 * sizeof(array[0]) + 4; }, field->values);
  return table.build_traffic() + static_cast<double>(particles.size()) * permuted;
}

// Every image has a place, a source and a path.
double Arrangement::image_traffic() const {
  return static_cast<double>(images.size()) * (8 * context.dimensions + 4 + 4);
}

// Coordinates are written in float and gathered from by way of the cells; lists are written once, with their sizes.
double Arrangement::list_traffic(const ParticleSizes& sizes) const {
  const double d = context.dimensions;
  const auto points = static_cast<double>(list.points());
  const auto cells = static_cast<double>(grid.cell_count()) * (images.size() > 0 ? 2 : 1);
  return points * (8 * d + 2 * 4 * d) + 4 * cells + list.list_bytes() +
         static_cast<double>(list.particles()) * (12 + (sizes.variable ? 4 : 0));
}

}  // namespace spume
