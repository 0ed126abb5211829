// SPDX-License-Identifier: MIT
#include "spume/methods/registry.hpp"

#include "spume/scene/load.hpp"

namespace spume {

const Registration& registered_method(const std::string& name) {
  for (const Registration& method : registered_methods())
    if (method.name == name) return method;
  throw InputError("there is no method '" + name + "'");
}

LoadedCase load_case(const std::string& path, const std::vector<std::string>& overrides) {
  return load_case(path, overrides, case_schema());
}

std::unique_ptr<Method> make_method(const LoadedCase& loaded) {
  return registered_method(loaded.options.method).make(loaded);
}

const std::vector<OptionInfo>& option_table() {
  return case_schema().option_table();
}

}  // namespace spume
