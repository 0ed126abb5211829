// SPDX-License-Identifier: MIT
#include <chrono>
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

// From the second of two trial steps: the first also allocates and builds what later steps reuse.
std::string time_estimate(const LoadedCase& loaded, Method& method) {
  try {
    const double before = seconds_of_preparation(method);
    seconds_of_step(method, method.step_limit().dt);
    const StepLimit limit = method.step_limit();
    const double seconds = seconds_of_step(method, limit.dt), steps = loaded.options.time.end / limit.dt;
    return human_duration(seconds * steps) + " for about " + short_number(steps) + " steps at " +
           short_number(static_cast<double>(method.particle_count()) / seconds / 1e6) + " Mparticle-steps/s" +
           (before > 0 ? ", with at most " + human_duration(before) + " before the first one" : "");
  } catch (const StepFailure& failure) {
    return "unknown time (the first steps are refused: " + failure.details().cause + ")";
  }
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
