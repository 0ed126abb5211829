// SPDX-License-Identifier: MIT
// Sort, images and neighbour lists: about 74 neighbours per particle in three dimensions.
// Arguments: those of particle_cube.hpp.
#include "machine.hpp"
#include "particle_cube.hpp"

namespace spume {
namespace {

void sort(benchmark::State& state) {
  ParticleCube particles(state);
  for (auto _ : state) particles.sort();
  particles.count(state, 0);
  // Three coordinates read and a key, an order and a count written and read again.
  count_against_machine(state, {static_cast<double>(particles.n) * (24 + 3 * 8), 0, 0, 0},
                        static_cast<int>(state.range(2)));
}

void images(benchmark::State& state) {
  ParticleCube particles(state);
  for (auto _ : state) particles.make_images();
  particles.count(state, 0);
  const auto images = static_cast<double>(particles.images.size());
  state.counters["images"] = images;
  // Three coordinates read of each particle; of each image written with its source and path, and sorted by cells.
  count_against_machine(state, {24 * static_cast<double>(particles.n) + (24 + 8 + 3 * 8 + 2 * 32) * images, 0, 0, 0},
                        static_cast<int>(state.range(2)));
}

void neighbour_list(benchmark::State& state) {
  ParticleCube particles(state);
  for (auto _ : state) particles.make_list();
  const double per_particle = static_cast<double>(particles.list.pair_count()) / static_cast<double>(particles.n);
  particles.count(state, per_particle);
  state.counters["neighbours"] = per_particle;
  // 27 cells of side one support hold 27 / (4 pi / 3) = 6.4 candidates per neighbour: 8 operations each. Each neighbour
  // is written as an index of 4 bytes.
  const auto pairs = static_cast<double>(particles.list.pair_count());
  count_against_machine(state, {4 * pairs + 40 * static_cast<double>(particles.n), 8 * 6.4 * pairs, 0, 0},
                        static_cast<int>(state.range(2)));
}

BENCHMARK(sort)->Apply(ParticleCube::sizes);
BENCHMARK(images)->Apply(ParticleCube::sizes);
BENCHMARK(neighbour_list)->Apply(ParticleCube::sizes);

}  // namespace
}  // namespace spume
