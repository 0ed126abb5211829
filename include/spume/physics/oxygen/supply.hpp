// SPDX-License-Identifier: MIT
// Bubbles, of whatever kind, as what supplies a liquid with oxygen: what the columns of [oxygen] ask of them.
#pragma once

#include <functional>

#include "spume/core/vec3.hpp"

namespace spume::oxygen {

class Supply {
 public:
  Supply() = default;
  Supply(const Supply&) = delete;
  Supply& operator=(const Supply&) = delete;
  virtual ~Supply() = default;
  virtual double conductance() const = 0;        // sum of k_L A in the last step
  virtual double transfer_capacity() const = 0;  // what they would give to a liquid without oxygen, g per time
  virtual double oxygen_feed() const = 0;        // that comes with the gas, g per time
  // Of every bubble in the step: place, k_L A and k_L A c*, between its exchange and the next acceptance.
  using Each = std::function<void(const Vec3& place, double conductance, double capacity)>;
  virtual void each(const Each& see) const = 0;
};

}  // namespace spume::oxygen
