// SPDX-License-Identifier: MIT
#include <signal.h>

#include <cmath>
#include <cstdio>
#include <new>

#include "spume/cli/terminal.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/run/report.hpp"
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

int execute(Simulation& simulation, bool quiet) {
  // A closed pipe must not stop the run.
  signal(SIGPIPE, SIG_IGN);
  const std::string start =
      start_table(simulation.loaded(), simulation.method(), thread_count(), simulation.folder().string());
  simulation.log(start);
  if (!quiet) std::printf("%s\n", start.c_str()), std::fflush(stdout);
  TerminalObserver observer(quiet);
  try {
    const RunState state = simulation.run(observer);
    observer.finish();
    const std::string closing = closing_text(simulation, state);
    simulation.log(closing);
    if (!quiet)
      std::printf("\n%s\n%sresults in %s\n", ledger_table(simulation.ledger(), simulation.wall_seconds()).c_str(),
                  closing.c_str(), simulation.folder().c_str());
    return state == RunState::finished ? exit_done : exit_interrupted;
  } catch (const FileError& error) {
    observer.finish();
    std::fprintf(stderr, "error: %s\n", error.what());
    return simulation.steps_this_run() > 0 ? exit_numerical : exit_input;
  } catch (const NumericalFailure& failure) {
    observer.finish();
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
  const auto simulation = Simulation::start(std::move(loaded), program.make_method, folder);
  return execute(*simulation, arguments.quiet);
}

int resume_verb(const RunArguments& arguments, const Program& program) {
  require_positive(arguments.until);
  const auto simulation = Simulation::resume(arguments.input, program.load_case, program.make_method, arguments.until);
  return execute(*simulation, arguments.quiet);
}

}  // namespace spume
