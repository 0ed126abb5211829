// SPDX-License-Identifier: MIT
#pragma once

#include "spume/methods/registry.hpp"

namespace spume::gfd {

Registration registration();

}  // namespace spume::gfd
