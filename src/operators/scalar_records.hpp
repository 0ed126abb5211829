// SPDX-License-Identifier: MIT
// Records of the sweeps that carry scalars (scalar_transport.hpp): whose values images take, and which exchange
// nothing.
#pragma once

#include "spume/operators/pair_sweep.hpp"

namespace spume {

// The value of an image that exchanges nothing; its products with finite weights are finite.
inline constexpr float exchanges_nothing = 1e30F;

// write(record, i) for each record that has the values of particle i, and clear(record) for the images that exchange
// nothing: wall points, points behind openings, images in solid boxes.
template <class Write, class Clear>
void for_each_scalar_record(const SweepContext& context, Write&& write, Clear&& clear) {
  const std::size_t n = context.list->particles();
  parallel_for(n, [&](std::size_t i) { write(i, i); });
  const Images& images = *context.images;
  const std::int32_t* point = context.walls == nullptr ? nullptr : images.wall_point();
  parallel_for(images.size(), [&](std::size_t k) {
    const bool stands_for_wall = point != nullptr && point[k] >= 0;
    if (stands_for_wall || images.paths()[static_cast<std::size_t>(images.path()[k])].reflections() > 0)
      clear(n + k);
    else
      write(n + k, static_cast<std::size_t>(images.source()[k]));
  });
}

}  // namespace spume
