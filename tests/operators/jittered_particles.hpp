// SPDX-License-Identifier: MIT
// Particles on a lattice of cell centres of the unit box, each displaced at random.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "spume/core/array.hpp"
#include "spume/core/random.hpp"

namespace spume::test {

struct JitteredParticles {
  int dimensions;
  double spacing;
  std::array<Array<double>, 3> position;

  // `jitter`: largest displacement per axis in spacings.
  JitteredParticles(int dimensions, std::size_t across, double jitter, std::uint64_t seed = 1)
      : dimensions(dimensions), spacing(1.0 / static_cast<double>(across)) {
    std::size_t count = 1;
    for (int d = 0; d < dimensions; ++d) count *= across;
    for (auto& component : position) component.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto random = random_uniform(seed, RandomPurpose::test, i, 0, 0);
      std::size_t cell = i;
      for (int d = 0; d < dimensions; ++d) {
        position[d][i] = (static_cast<double>(cell % across) + 0.5 + jitter * (2 * random[d] - 1)) * spacing;
        cell /= across;
      }
    }
  }

  std::size_t size() const { return position[0].size(); }
  std::array<double, 3> at(std::size_t i) const { return {position[0][i], position[1][i], position[2][i]}; }
  std::array<std::span<const double>, 3> positions() const { return {position[0], position[1], position[2]}; }

  template <class Function>
  Array<double> sample(Function&& function) const {
    Array<double> values(size());
    for (std::size_t i = 0; i < size(); ++i) values[i] = function(at(i));
    return values;
  }
};

}  // namespace spume::test
