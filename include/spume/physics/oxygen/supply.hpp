// SPDX-License-Identifier: MIT
// Bubbles, of whatever kind, as what supplies a liquid with oxygen: what the columns of [oxygen] ask of them.
#pragma once

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
};

}  // namespace spume::oxygen
