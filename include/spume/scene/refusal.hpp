// SPDX-License-Identifier: MIT
// Refusals of a case by what is built from it, after the case itself was found valid.
#pragma once

#include <string>

#include "spume/scene/case.hpp"

namespace spume {

// The error "file:line:col: error: text" at the value of an option, "section.key"; where the case does not give it, at
// its section, and without that at the start of the file. A value of the command line is its own place.
InputError refusal(const Case& options, const std::string& option, const std::string& text);

// The same for an error that was thrown without a place; one that has a place stays as it is.
InputError refusal(const Case& options, const std::string& option, const InputError& error);

}  // namespace spume
