// SPDX-License-Identifier: MIT
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>

#include "spume/run/signals.hpp"
#include "spume/view/playback.hpp"
#include "verbs.hpp"

namespace spume {

int view_verb(const ViewArguments& arguments) {
  std::vector<std::unique_ptr<PlayedRun>> runs;
  for (const std::string& path : arguments.paths) runs.push_back(std::make_unique<PlayedRun>(path));
  signal(SIGPIPE, SIG_IGN);
  release_to_all_places();  // before the server starts its threads
  Server server(arguments.port);
  Playback playback(server, std::move(runs));
  const StopSignals signals;
  std::printf("view at %s\nCtrl-C ends it\n", server.looking_address().c_str());
  std::fflush(stdout);
  while (!signals.requested()) playback.serve(std::chrono::milliseconds(100));
  return exit_done;
}

}  // namespace spume
