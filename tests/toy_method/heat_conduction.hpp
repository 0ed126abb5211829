// SPDX-License-Identifier: MIT
// The smallest particle method: explicit heat conduction on particles at rest, dT/dt = div(kappa grad T). It shows what
// a method costs; it is no part of the program.
#pragma once

#include "spume/methods/registry.hpp"

namespace spume::test {

Registration heat_conduction();

}  // namespace spume::test
