// SPDX-License-Identifier: MIT
#pragma once

#include "spume/methods/registry.hpp"

namespace spume::les_sph {

Registration registration();

}  // namespace spume::les_sph
