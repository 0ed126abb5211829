// SPDX-License-Identifier: MIT
#include "spume/run/signals.hpp"

#include <unistd.h>

namespace spume {
namespace {

volatile sig_atomic_t stop_requested = 0;

extern "C" void note_stop(int) {
  if (stop_requested != 0) _exit(130);
  stop_requested = 1;
}

}  // namespace

StopSignals::StopSignals() {
  stop_requested = 0;
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  action.sa_handler = note_stop;
  sigaction(SIGINT, &action, &interrupt_);
  sigaction(SIGTERM, &action, &terminate_);
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, &file_size_);
}

StopSignals::~StopSignals() {
  sigaction(SIGINT, &interrupt_, nullptr);
  sigaction(SIGTERM, &terminate_, nullptr);
  sigaction(SIGXFSZ, &file_size_, nullptr);
}

bool StopSignals::requested() const {
  return stop_requested != 0;
}

}  // namespace spume
