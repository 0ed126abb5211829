// SPDX-License-Identifier: MIT
// The progress of a run on the terminal: one live line, or a plain line about every ten seconds when the output
// goes to a file or a pipe.
#pragma once

#include <chrono>

#include "spume/run/driver.hpp"

namespace spume {

class TerminalObserver final : public Observer {
 public:
  explicit TerminalObserver(bool quiet);
  void progress(const Progress& progress) override;
  void note(const std::string& text) override;
  void preparing(Simulation& simulation, const std::string& how_far) override;
  void finish();  // the live line with the last state stays; call once at the end

 private:
  bool due();
  void draw(const std::string& line);
  void flush();
  bool quiet_, live_;
  bool drawn_ = false;
  Progress last_;
  std::chrono::steady_clock::time_point shown_;
};

// "step 1200  t 0.412/1.000  dt 3.4e-4 (courant)  2.9 Mp-steps/s  ETA 02:31"
std::string progress_line(const Progress& progress);

}  // namespace spume
