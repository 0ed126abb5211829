// SPDX-License-Identifier: MIT
#include "spume/methods/factory.hpp"

#include "spume/methods/les_sph/les_sph.hpp"
#include "spume/methods/spectral/spectral.hpp"

namespace spume {

std::unique_ptr<Method> make_method(const LoadedCase& loaded) {
  if (loaded.options.method == "spectral") {
    if (loaded.options.spectral.precision == FieldPrecision::f32)
      return std::make_unique<spectral::Spectral<float>>(loaded);
    return std::make_unique<spectral::Spectral<double>>(loaded);
  }
  return std::make_unique<les_sph::LesSph>(loaded);
}

}  // namespace spume
