// SPDX-License-Identifier: MIT
#include "spume/scene/refusal.hpp"

#include <utility>

namespace spume {

InputError refusal(const Case& options, const std::string& option, const std::string& text) {
  Problem problem{options.path, options.path.empty() ? 0 : 1, 1, text};
  for (std::string name = option; !name.empty();) {
    const auto found = options.places.find(name);
    if (found != options.places.end()) {
      problem = found->second;
      problem.text = text;
      break;
    }
    const std::size_t dot = name.rfind('.');
    name.resize(dot == std::string::npos ? 0 : dot);
  }
  return InputError(std::vector<Problem>{std::move(problem)});
}

InputError refusal(const Case& options, const std::string& option, const InputError& error) {
  std::vector<Problem> problems;
  for (const Problem& problem : error.problems())
    problems.push_back(problem.file.empty() ? refusal(options, option, problem.text).problems().front() : problem);
  return InputError(std::move(problems));
}

}  // namespace spume
