// SPDX-License-Identifier: MIT
// The null space of an operator whose unknowns fall into parts that do not meet: what is constant on each of them.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace spume {

class PartConstants {
 public:
  // Unknowns of each part, ascending; `rest`: the constants on all others are in the null space, too.
  PartConstants() = default;
  PartConstants(std::vector<std::vector<std::int32_t>> parts, bool rest) : parts_(std::move(parts)), rest_(rest) {}

  // Only some combinations of the constants of parts are in the null space: each by its coefficients over the parts.
  // They are made orthonormal.
  PartConstants(std::vector<std::vector<std::int32_t>> parts, std::vector<std::vector<double>> combinations);

  bool empty() const { return parts_.empty(); }
  const std::vector<std::vector<std::int32_t>>& parts() const { return parts_; }
  bool rest() const { return rest_; }

  // Takes from the unknowns of each part, and of the rest where it is one, their mean; of combinations the components
  // along them. For one length: that of the vectors whose unknowns the parts number. Bit-identical for any thread
  // count.
  template <class Real>
  void remove(std::span<Real> x) const;

 private:
  std::vector<std::vector<std::int32_t>> parts_;
  bool rest_ = false;
  std::vector<std::vector<double>> combinations_;  // empty: the constants on each part
};

}  // namespace spume
