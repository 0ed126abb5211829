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
  explicit Watch(std::int64_t stop_after = -1, std::string stop_at = {})
      : stop_after_(stop_after), stop_at_(std::move(stop_at)) {}
  void progress(const Progress& progress) override {
    steps.push_back(progress.dt);
    limits.push_back(progress.limited_by);
    last = progress;
    if (progress.step == stop_after_) raise(SIGINT);
  }
  void note(const std::string& text) override { notes.push_back(text); }
  void preparing(Simulation& /*simulation*/, const std::string& how_far) override {
    prepared.push_back(how_far);
    if (how_far == stop_at_) raise(SIGINT);
  }
  std::vector<double> steps;
  std::vector<std::string> notes, limits, prepared;
  Progress last;

 private:
  std::int64_t stop_after_;
  std::string stop_at_;  // of what is told before the first step
};

}  // namespace spume::test
