// SPDX-License-Identifier: MIT
// The error types of the program. Numerical code throws them; only src/cli prints and chooses exit codes.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace spume {

// One problem of an input file, in the form "file:line:col: error: text".
struct Problem {
  std::string file;
  int line = 0;    // 1-based; 0 when the problem has no line (a command-line override, a missing file)
  int column = 0;  // 1-based
  std::string text;

  std::string message(const std::string& severity = "error") const;
};

// Bad input: every problem found, in file order. Exit code 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Problem> problems);
  explicit InputError(const std::string& text);
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

// A file that cannot be created, written or read (disk full, permission, damaged). Exit code 2 before the
// first step and 3 after it; `what()` names the file and the system's reason.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A step that cannot be accepted: the driver restores the state and retries with half the step.
// `cause` is one sentence in words; `option` names the case key that most likely helps.
class StepFailure : public std::runtime_error {
 public:
  struct Details {
    std::string cause;
    std::string option;
    std::int64_t particle = -1;  // stable identifier, -1 when no single particle is to blame
    double position[3] = {0, 0, 0};
    double value = 0;
  };
  explicit StepFailure(Details details);
  const Details& details() const { return details_; }

 private:
  Details details_;
};

// A run that gave up after repeated step failures. Exit code 3.
class NumericalFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace spume
