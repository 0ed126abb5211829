// SPDX-License-Identifier: MIT
#include "spume/core/error.hpp"

#include <utility>

namespace spume {
namespace {

std::string join(const std::vector<Problem>& problems) {
  std::string text;
  for (const auto& problem : problems) {
    if (!text.empty()) text += '\n';
    text += problem.message();
  }
  return text;
}

}  // namespace

std::string Problem::message(const std::string& severity) const {
  std::string place = file;
  if (line > 0) place += ':' + std::to_string(line) + ':' + std::to_string(column);
  return (place.empty() ? "" : place + ": ") + severity + ": " + text;
}

InputError::InputError(std::vector<Problem> problems)
    : std::runtime_error(join(problems)), problems_(std::move(problems)) {}

InputError::InputError(const std::string& text) : InputError(std::vector<Problem>{Problem{{}, 0, 0, text}}) {}

StepFailure::StepFailure(Details details) : std::runtime_error(details.cause), details_(std::move(details)) {}

}  // namespace spume
