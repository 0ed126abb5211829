// SPDX-License-Identifier: MIT
#pragma once

namespace spume {

struct Draft;
struct Scene;
class Problems;

// Bodies that are released where no liquid is, and give their oxygen to none. Without [oxygen] nothing is checked.
void check_released_gas(const Draft& draft, const Scene& scene, Problems& problems);

}  // namespace spume
