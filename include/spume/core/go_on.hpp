// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

namespace spume {

// How far work that takes long has come.
struct HowFar {
  std::string words;
  double share = 0;  // that is done, of the most that it may take
};

// Told it as often as that work likes; false: the work is to end where it stands.
using GoOn = std::function<bool(const HowFar&)>;

}  // namespace spume
