// SPDX-License-Identifier: MIT
// From a case to the method that runs it.
#pragma once

#include <memory>

#include "spume/methods/method.hpp"
#include "spume/scene/case.hpp"

namespace spume {

// The method that the case names, in its initial state. `loaded` outlives the method, but its initial particles
// are released after this call: the method copies what it needs of them. Throws InputError for a case that the
// method cannot run.
std::unique_ptr<Method> make_method(const LoadedCase& loaded);

}  // namespace spume
