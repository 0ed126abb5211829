// SPDX-License-Identifier: MIT
// Who is where: particles in cell order, their images, and the lists of neighbours, as every sweep of a step sees them.
#pragma once

#include "spume/neighbours/cell_grid.hpp"
#include "spume/neighbours/cell_order.hpp"
#include "spume/neighbours/images.hpp"
#include "spume/neighbours/neighbour_list.hpp"
#include "spume/operators/pair_sweep.hpp"
#include "spume/particles/resolution.hpp"
#include "spume/particles/store.hpp"

namespace spume {

struct Arrangement {
  // Cells cover the domain and one support radius around it. `particles`: how many there will be, about. `skin`: how
  // much farther than the support the lists reach; how long they hold then, particles/list_life.hpp says.
  Arrangement(const Domain& domain, const Resolution& resolution, double particle_volume, std::size_t particles,
              double skin = 0);
  Arrangement(const Arrangement&) = delete;
  Arrangement& operator=(const Arrangement&) = delete;

  const Vec3 origin;  // of the float coordinates
  CellGrid grid;
  CellOrder table;
  Images images;
  NeighbourList list;
  PackedNeighbours packed;
  SweepContext context;

  // Sorts the particles by the cells of `at`, one of their fields.
  void sort(ParticleStore& particles, const VectorField& at);
  // Lists of neighbours at `at`, within the support of each particle.
  void find_neighbours(const ParticleStore& particles, const VectorField& at, const ParticleSizes& sizes);
  // Particles and images are at new places, the lists are those of the old ones; Boundary::move_images() does so.
  void move(const std::array<const double*, 3>& at);

  // Sweeps see particles of these sizes from now on; null: all alike.
  void set_sizes(const ParticleSizes* sizes);

  double pair_count() const { return static_cast<double>(list.pair_count()); }
  // The particle at a listed point: itself, or the source of an image.
  std::size_t particle_of(std::int32_t point) const {
    const auto n = static_cast<std::int32_t>(list.particles());
    return static_cast<std::size_t>(point < n ? point : images.source()[point - n]);
  }

  // Compulsory traffic (core/ledger.hpp) of the last sort, images and lists, in bytes.
  double sort_traffic(const ParticleStore& particles) const;
  double image_traffic() const;
  double list_traffic(const ParticleSizes& sizes) const;
};

}  // namespace spume
