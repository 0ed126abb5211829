// SPDX-License-Identifier: MIT
#include "spume/operators/pair_sweep.hpp"

namespace spume {

float* PackedNeighbours::prepare(const SweepContext& context, int payload) {
  const NeighbourList& list = *context.list;
  const int dimensions = context.dimensions;
  const int width = record_width(dimensions, payload);
  const std::size_t points = list.points() + 1;
  const float* const before = storage_.data();
  storage_.fit(points * static_cast<std::size_t>(width));
  float* records = storage_.data();
  if (records != before) coordinates_width_ = 0;
  const int rewritten = coordinates_width_ == width ? 0 : dimensions;
  count(4 * static_cast<double>(points) * (2 * rewritten + payload + width) + list.list_bytes() +
        12 * static_cast<double>(list.particles()));
  if (coordinates_width_ != width) {
    const float* x[3] = {list.coordinate(0), list.coordinate(1), list.coordinate(2)};
    parallel_for(points, [&, records, width, dimensions](std::size_t k) {
      for (int axis = 0; axis < dimensions; ++axis) records[k * width + axis] = x[axis][k];
    });
    coordinates_width_ = width;
  }
  for (int c = dimensions; c < width; ++c) records[(points - 1) * static_cast<std::size_t>(width) + c] = 0;
  return records;
}

}  // namespace spume
