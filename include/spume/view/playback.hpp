// SPDX-License-Identifier: MIT
// Shows what one run has left, or two beside each other, to the viewers of a server: each looks at the state that it
// asks for. What a place in the flow went through is read state by state while nobody waits for a picture.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "spume/view/played_run.hpp"
#include "spume/view/server.hpp"

namespace spume {

class Playback {
 public:
  // One or two runs.
  Playback(Server& server, std::vector<std::unique_ptr<PlayedRun>> runs);
  // Does what viewers wait for; returns after so long without anything to do.
  void serve(std::chrono::milliseconds longest);

 private:
  // The history of a place for a viewer.
  struct Trace {
    std::weak_ptr<Viewer> viewer;
    std::array<double, 3> place{};
    std::size_t next = 0;  // step
    std::chrono::steady_clock::time_point told{};
    std::vector<std::string> rows;  // that the viewer has yet to get, as JSON
  };

  bool refresh();  // whether there is more
  void show(const std::shared_ptr<Viewer>& viewer, const FrameWish& wish);
  std::vector<Packet> introduction() const;
  std::string hello() const;
  std::string state(std::size_t step) const;
  bool trace_a_step();

  Server& server_;
  std::vector<std::unique_ptr<PlayedRun>> runs_;
  FrameMaker frames_;
  std::int64_t edition_ = 0;  // of what viewers were told first; grows with the results
  std::chrono::steady_clock::time_point looked_{};
  std::map<const Viewer*, Trace> traces_;
};

}  // namespace spume
