// SPDX-License-Identifier: MIT
#include "spume/solvers/part_constants.hpp"

#include <algorithm>

#include "spume/core/parallel.hpp"

namespace spume {

template <class Real>
void PartConstants::remove(std::span<Real> x) const {
  const auto at = [&](std::int32_t i) -> Real& { return x[static_cast<std::size_t>(i)]; };
  double of_parts = 0, members = 0;
  for (const auto& part : parts_) {
    const double sum = parallel_sum(part.size(), [&](std::size_t k) { return static_cast<double>(at(part[k])); });
    const double mean = sum / static_cast<double>(part.size());
    parallel_for(part.size(), [&](std::size_t k) { at(part[k]) -= static_cast<Real>(mean); });
    members += static_cast<double>(part.size());
  }
  if (!rest_) return;
  // The parts have a sum of rounding now, which is taken out again.
  for (const auto& part : parts_)
    of_parts += parallel_sum(part.size(), [&](std::size_t k) { return static_cast<double>(at(part[k])); });
  const double sum = parallel_sum(x.size(), [&](std::size_t i) { return static_cast<double>(x[i]); }) - of_parts;
  const Real mean = static_cast<Real>(sum / std::max(1.0, static_cast<double>(x.size()) - members));
  parallel_for(x.size(), [&](std::size_t i) { x[i] -= mean; });
  for (const auto& part : parts_) parallel_for(part.size(), [&](std::size_t k) { at(part[k]) += mean; });
}

template void PartConstants::remove(std::span<float>) const;
template void PartConstants::remove(std::span<double>) const;

}  // namespace spume
