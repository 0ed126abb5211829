// SPDX-License-Identifier: MIT
#pragma once

#include <array>

namespace spume {

using Vec3 = std::array<double, 3>;

}  // namespace spume
