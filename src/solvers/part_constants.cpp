// SPDX-License-Identifier: MIT
#include "spume/solvers/part_constants.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "spume/core/parallel.hpp"

namespace spume {

PartConstants::PartConstants(std::vector<std::vector<std::int32_t>> parts,
                             std::vector<std::vector<double>> combinations)
    : parts_(std::move(parts)) {
  if (combinations.empty()) parts_.clear();
  // Gram and Schmidt, in the product of the unknowns.
  const auto product = [&](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < parts_.size(); ++k) sum += a[k] * b[k] * static_cast<double>(parts_[k].size());
    return sum;
  };
  for (std::vector<double>& next : combinations) {
    for (const std::vector<double>& other : combinations_) {
      const double along = product(next, other);
      for (std::size_t k = 0; k < next.size(); ++k) next[k] -= along * other[k];
    }
    const double size = std::sqrt(product(next, next));
    for (double& value : next) value /= size;
    combinations_.push_back(std::move(next));
  }
}

template <class Real>
void PartConstants::remove(std::span<Real> x) const {
  const auto at = [&](std::int32_t i) -> Real& { return x[static_cast<std::size_t>(i)]; };
  if (!combinations_.empty()) {
    std::vector<double> sum, taken(parts_.size(), 0);
    for (const auto& part : parts_)
      sum.push_back(parallel_sum(part.size(), [&](std::size_t k) { return static_cast<double>(at(part[k])); }));
    for (const std::vector<double>& combination : combinations_) {
      const double along = std::inner_product(sum.begin(), sum.end(), combination.begin(), 0.0);
      for (std::size_t p = 0; p < parts_.size(); ++p) taken[p] += along * combination[p];
    }
    for (std::size_t p = 0; p < parts_.size(); ++p)
      parallel_for(parts_[p].size(), [&](std::size_t k) { at(parts_[p][k]) -= static_cast<Real>(taken[p]); });
    return;
  }
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
