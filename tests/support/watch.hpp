// SPDX-License-Identifier: MIT
// An observer of whole runs.
#pragma once

#include <signal.h>

#include <cstdint>
#include <string>
#include <vector>

#include "spume/run/driver.hpp"

namespace spume::test {

// Watches a run; asks it to stop after a step, as a user would.
class Watch final : public Observer {
 public:
  explicit Watch(std::int64_t stop_after = -1) : stop_after_(stop_after) {}
  void progress(const Progress& progress) override {
    steps.push_back(progress.dt);
    limits.push_back(progress.limited_by);
    last = progress;
    if (progress.step == stop_after_) raise(SIGINT);
  }
  void note(const std::string& text) override { notes.push_back(text); }
  std::vector<double> steps;
  std::vector<std::string> notes, limits;
  Progress last;

 private:
  std::int64_t stop_after_;
};

}  // namespace spume::test
