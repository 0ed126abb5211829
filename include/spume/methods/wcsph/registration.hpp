// SPDX-License-Identifier: MIT
#pragma once

#include "spume/methods/registry.hpp"

namespace spume::wcsph {

Registration registration();

}  // namespace spume::wcsph
