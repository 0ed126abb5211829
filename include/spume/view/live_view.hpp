// SPDX-License-Identifier: MIT
// The live view as an observer of a run: between two steps it hands frames to the viewers that wait for one, at most
// ten a second, and does what they asked for. It passes everything on to the observer that it stands before.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "spume/run/driver.hpp"
#include "spume/scene/options.hpp"
#include "spume/view/history.hpp"
#include "spume/view/server.hpp"

namespace spume {

class LiveView final : public Observer {
 public:
  // `options`: those of the program, of which the steerable ones are offered. `paused`: the first step waits for a
  // viewer.
  LiveView(Server& server, Observer& next, std::vector<OptionInfo> options, bool paused);

  void progress(const Progress& progress) override;
  void note(const std::string& text) override;
  // Tells viewers in words and lets them stop the run; what else they ask for waits for the first step.
  void preparing(Simulation& simulation, const std::string& how_far) override;
  void between_steps(Simulation& simulation) override;
  // The last state, "finished", "interrupted" or "failed", and for the last the reason. Waits a second at most until
  // viewers have it.
  void finish(const std::string& state, const std::string& reason = {});

 private:
  using Clock = std::chrono::steady_clock;

  void obey(Simulation& simulation);
  void obey(Simulation& simulation, const ViewMessage& message);
  void serve(Simulation& simulation);
  void add_row(Simulation& simulation);
  bool knows_all(const Viewer& viewer, const FrameWish& wish, const Simulation& simulation) const;
  std::vector<Packet> texts_for(Viewer& viewer, const Simulation& simulation);
  std::vector<Packet> packets_for(Viewer& viewer, const FrameWish& wish, Simulation& simulation);
  std::string hello(const Simulation& simulation, bool may_steer) const;
  std::string state() const;
  std::string series_for(Viewer& viewer) const;
  std::string lines_for(Viewer& viewer) const;

  Server& server_;
  Observer& next_;
  std::vector<OptionInfo> options_;
  Progress progress_;
  std::string words_ = "running", how_far_;  // before the first step
  bool paused_;
  int steps_wanted_ = 0;            // while paused
  std::int64_t hello_edition_ = 0;  // of plan and options, which a change by hand may alter
  FrameMaker frames_;
  SeriesHistory history_;
  double last_row_step_ = -1;
  std::vector<ViewMessage> waiting_;  // for the first step
  std::deque<std::string> lines_;
  std::int64_t lines_told_ = 0;  // number of the first line in lines_
  Clock::time_point next_frame_{};
};

}  // namespace spume
