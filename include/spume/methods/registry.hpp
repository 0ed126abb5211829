// SPDX-License-Identifier: MIT
// The methods of the program. A method registers itself in src/methods/<name>/registration.cpp with all that the
// scene, the driver and the command line have to know of it; src/methods/methods.cpp lists the registrations.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "spume/methods/method.hpp"
#include "spume/scene/case_schema.hpp"

namespace spume {

struct Registration : MethodDeclaration {
  // The method in its initial state. `loaded` outlives it, but the initial particles are released after this call: the
  // method copies what it needs of them. Throws InputError for a case that the method cannot run.
  std::function<std::unique_ptr<Method>(const LoadedCase& loaded)> make;
};

const std::vector<Registration>& registered_methods();
// Throws InputError when there is none of that name.
const Registration& registered_method(const std::string& name);

// The schema of case files for all registered methods.
const CaseSchema& case_schema();

// load_case() of the scene by that schema.
LoadedCase load_case(const std::string& path, const std::vector<std::string>& overrides = {});

// The method that the case names: Registration::make().
std::unique_ptr<Method> make_method(const LoadedCase& loaded);

const std::vector<OptionInfo>& option_table();

}  // namespace spume
