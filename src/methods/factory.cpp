// SPDX-License-Identifier: MIT
#include "spume/methods/factory.hpp"

#include "spume/methods/les_sph/les_sph.hpp"

namespace spume {

std::unique_ptr<Method> make_method(const LoadedCase& loaded) {
  return std::make_unique<les_sph::LesSph>(loaded);
}

}  // namespace spume
