// SPDX-License-Identifier: MIT
// The list of methods, in the order in which messages name them.
#include "spume/methods/gfd/registration.hpp"
#include "spume/methods/les_sph/registration.hpp"
#include "spume/methods/registry.hpp"
#include "spume/methods/spectral/registration.hpp"
#include "spume/methods/wcsph/registration.hpp"

namespace spume {
const std::vector<Registration>& registered_methods() {
  static const std::vector<Registration> methods{les_sph::registration(), spectral::registration(), gfd::registration(),
                                                 wcsph::registration()};
  return methods;
}

const CaseSchema& case_schema() {
  static const CaseSchema schema({registered_methods().begin(), registered_methods().end()});
  return schema;
}

}  // namespace spume
