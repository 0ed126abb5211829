// SPDX-License-Identifier: MIT
#pragma once

#include "spume/methods/registry.hpp"

namespace spume::spectral {

Registration registration();

}  // namespace spume::spectral
