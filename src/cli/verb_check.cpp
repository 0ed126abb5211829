// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "spume/core/error.hpp"
#include "spume/core/machine.hpp"
#include "spume/core/parallel.hpp"
#include "spume/run/body_report.hpp"
#include "spume/run/probes.hpp"
#include "spume/run/report.hpp"
#include "verbs.hpp"

namespace spume {
namespace {

double seconds_of_step(Method& method, double dt) {
  Ledger ledger;
  const auto start = std::chrono::steady_clock::now();
  method.step(dt, ledger);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// At most, of what prepares the first step: from some of its rounds.
double seconds_of_preparation(Method& method) {
  constexpr int rounds = 5;  // the first one allocates
  Ledger ledger;
  const auto start = std::chrono::steady_clock::now();
  double share = 0;
  int told = 0;
  method.prepare(ledger, [&](const HowFar& how_far) {
    share = how_far.share;
    return ++told < rounds;
  });
  return share > 0 ? std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / share : 0;
}

// The longest step that a run takes: no longer than the way to the next row or snapshot.
double longest_step(const Case& options) {
  double longest = options.time.end;
  for (const double every : {options.time.max_step, options.output.every, options.output.series_every})
    if (every > 0) longest = std::min(longest, every);
  return longest;
}

// From trial steps after the first, which also allocates: as many as a second allows, as lists are made in some alone.
std::string time_estimate(const LoadedCase& loaded, Method& method) {
  constexpr int most_steps = 20;
  constexpr double long_enough = 1;  // seconds
  const double longest = longest_step(loaded.options);
  double seconds = 0, way = 0, before = 0;
  int steps = 0;
  try {
    before = seconds_of_preparation(method);
    seconds_of_step(method, std::min(longest, method.step_limit().dt));
    while (steps < most_steps && seconds < long_enough) {
      const double dt = std::min(longest, method.step_limit().dt);
      seconds += seconds_of_step(method, dt);
      way += dt;
      ++steps;
    }
  } catch (const StepFailure& failure) {
    if (steps == 0) return "unknown time (the first steps are refused: " + failure.details().cause + ")";
  }
  const double all = std::max(1.0, std::round(steps * loaded.options.time.end / way));
  return human_duration(seconds / steps * all) + " for about " + short_number(all) + " steps like the first ones at " +
         short_number(static_cast<double>(method.particle_count()) * steps / seconds / 1e6) + " Mparticle-steps/s" +
         (before > 0 ? ", with at most " + human_duration(before) + " before the first one" : "");
}

}  // namespace

int check_verb(const RunArguments& arguments, const Program& program) {
  LoadedCase loaded = program.load_case(case_argument(arguments.input), arguments.overrides);
  const auto method = program.make_method(loaded);
  require_probes(loaded.options, *method);
  method->start();
  loaded.scene.particles = {};
  std::printf("%s\nplan\n%s\n", start_table(loaded, *method, thread_count()).c_str(),
              plan_table(method->plan()).c_str());
  if (!loaded.scene.bodies.empty()) std::printf("bodies\n%s\n", body_table(loaded.scene).c_str());
  for (const Problem& unused : loaded.options.warnings) std::printf("%s\n", unused.message("warning").c_str());
  if (!loaded.options.warnings.empty()) std::printf("\n");
  std::fflush(stdout);
  const std::string time = time_estimate(loaded, *method);
  // Neighbour lists and scratch arrays have their size only after a step.
  const auto arrays = method->arrays();
  const double bytes = needed_bytes(loaded, *method, static_cast<double>(peak_resident_bytes()));
  const double memory = machine_memory_bytes();
  std::printf("arrays\n%s\nneeds %s and %s; machine has %s\n",
              array_table(arrays, method->particle_count(), loaded.scene.grid[0] > 0).c_str(),
              human_bytes(bytes).c_str(), time.c_str(), human_bytes(memory).c_str());
  if (bytes > memory)
    std::printf(
        "the memory of this machine is too small for the case; increase resolution.spacing or lower resolution.grid\n");
  return exit_done;
}

}  // namespace spume
