// SPDX-License-Identifier: MIT
#include <sched.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>
#include <new>

#include "spume/cli/terminal.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/run/report.hpp"
#include "spume/view/live_view.hpp"
#include "verbs.hpp"

namespace spume {
namespace {

void require_positive(const std::optional<double>& until) {
  if (until && !(*until > 0 && std::isfinite(*until)))
    throw InputError("--until is " + short_number(*until) + "; give a time above 0");
}

std::string closing_text(const Simulation& simulation, RunState state) {
  const double wall = simulation.wall_seconds();
  char text[256];
  std::snprintf(text, sizeof text, "%s at t = %.6g after %lld steps in %s, %.3g M particle-steps/s\n",
                state == RunState::finished ? "finished" : "interrupted", simulation.method().time(),
                static_cast<long long>(simulation.steps_this_run()), human_duration(wall).c_str(),
                simulation.particle_steps() / wall / 1e6);
  return text;
}

// Tells viewers how the run ended, however that was.
class Ending {
 public:
  explicit Ending(std::optional<LiveView>& view) : view_(view) {}
  Ending(const Ending&) = delete;
  Ending& operator=(const Ending&) = delete;
  ~Ending() {
    if (view_) view_->finish(words, reason);
  }
  std::string words = "failed", reason;

 private:
  std::optional<LiveView>& view_;
};

// What steering the run takes, where it is possible.
SteeringMeans steering_means(const Program& program) {
  SteeringMeans means{program.load_case, program.make_method, {}};
  for (const OptionInfo& option : program.option_table())
    if (option.steerable) means.keys.push_back(option.section + '.' + option.key);
  return means;
}

// The server is made before the folder of the run: with a taken port nothing begins.
std::unique_ptr<Server> make_server(const RunArguments& arguments) {
  if (!arguments.view) return nullptr;
  // Threads begin on the processors of the one that starts them. This one may be bound to a single one, on which it
  // computes: those of the server go where there is time.
  cpu_set_t own;
  const bool known = sched_getaffinity(0, sizeof own, &own) == 0;
  release_to_all_places();
  auto server = std::make_unique<Server>(arguments.port);
  if (known) sched_setaffinity(0, sizeof own, &own);
  return server;
}

int execute(Simulation& simulation, const RunArguments& arguments, const Program& program, Server* server) {
  const bool quiet = arguments.quiet;
  // A closed pipe must not stop the run.
  std::signal(SIGPIPE, SIG_IGN);
  const std::string start =
      start_table(simulation.loaded(), simulation.method(), thread_count(), simulation.folder().string());
  simulation.log(start);
  if (!quiet) std::printf("%s\n", start.c_str()), std::fflush(stdout);
  TerminalObserver observer(quiet);
  std::optional<LiveView> view;
  if (server != nullptr) {
    view.emplace(*server, observer, program.option_table(), arguments.paused);
    std::printf("view at %s\nto look only: %s\n%s", server->address().c_str(), server->looking_address().c_str(),
                quiet ? "" : "\n");
    std::fflush(stdout);
  }
  Ending ending(view);
  try {
    const RunState state = simulation.run(view ? static_cast<Observer&>(*view) : observer);
    observer.finish();
    ending.words = state == RunState::finished ? "finished" : "interrupted";
    const std::string closing = closing_text(simulation, state);
    simulation.log(closing);
    // Without the notes of the run, what went wrong in it is told all the same.
    for (const Verdict& one : simulation.verdicts())
      if (quiet && !one.pass())
        std::fprintf(stderr, "verdict failed: %s = %s, bound %s\n", one.quantity.c_str(),
                     short_number(one.value).c_str(), short_number(one.bound).c_str());
    if (!quiet)
      std::printf("\n%s\n%sresults in %s\n", ledger_table(simulation.ledger(), simulation.wall_seconds()).c_str(),
                  closing.c_str(), simulation.folder().c_str());
    return state == RunState::finished ? exit_done : exit_interrupted;
  } catch (const FileError& error) {
    observer.finish();
    ending.reason = error.what();
    std::fprintf(stderr, "error: %s\n", error.what());
    return simulation.steps_this_run() > 0 ? exit_numerical : exit_input;
  } catch (const NumericalFailure& failure) {
    observer.finish();
    ending.reason = failure.what();
    std::fprintf(stderr, "error: %s\n", failure.what());
    return exit_numerical;
  } catch (const std::bad_alloc&) {
    observer.finish();
    std::fprintf(stderr, "error: not enough memory to go on at t = %g\n  %s\n", simulation.method().time(),
                 simulation.continuation().c_str());
    return exit_numerical;
  }
}

}  // namespace

int run_verb(const RunArguments& arguments, const Program& program) {
  require_positive(arguments.until);
  std::vector<std::string> overrides = arguments.overrides;
  if (arguments.until) overrides.push_back(until_override(*arguments.until));
  LoadedCase loaded = program.load_case(case_argument(arguments.input), overrides);
  std::optional<std::filesystem::path> folder;
  if (arguments.folder) folder = *arguments.folder;
  std::vector<SteeringRow> replayed;
  if (arguments.replay) replayed = read_steering(*arguments.replay);
  const std::unique_ptr<Server> server = make_server(arguments);
  const auto simulation = Simulation::start(std::move(loaded), program.make_method, folder);
  simulation->allow_steering(steering_means(program));
  if (arguments.replay) simulation->replay(replayed);
  return execute(*simulation, arguments, program, server.get());
}

int resume_verb(const RunArguments& arguments, const Program& program) {
  require_positive(arguments.until);
  const std::unique_ptr<Server> server = make_server(arguments);
  const auto simulation = Simulation::resume(arguments.input, program.load_case, program.make_method, arguments.until);
  simulation->allow_steering(steering_means(program));
  return execute(*simulation, arguments, program, server.get());
}

}  // namespace spume
