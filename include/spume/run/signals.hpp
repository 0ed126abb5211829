// SPDX-License-Identifier: MIT
// SIGINT and SIGTERM as a wish to stop: the first is noted, the second ends the process at once (exit code 130).
#pragma once

#include <signal.h>  // NOLINT: sigaction is of POSIX, not of <csignal>

namespace spume {

// Handles the two signals while it lives. A file that grows beyond the user's limit becomes an ordinary write
// error instead of a deadly signal.
class StopSignals {
 public:
  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  ~StopSignals();
  bool requested() const;

 private:
  struct sigaction interrupt_ {
  }, terminate_{}, file_size_{};
};

}  // namespace spume
