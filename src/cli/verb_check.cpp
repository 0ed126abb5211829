// SPDX-License-Identifier: MIT
#include <chrono>
#include <cstdio>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
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

// The second of two trial steps stands for the rest: the first one also builds what later steps reuse.
void print_estimate(const LoadedCase& loaded, Method& method, double bytes) {
  const double end = loaded.options.time.end, memory = machine_memory_bytes();
  std::string time = "unknown time";
  try {
    seconds_of_step(method, method.step_limit().dt);
    const StepLimit limit = method.step_limit();
    const double seconds = seconds_of_step(method, limit.dt), steps = end / limit.dt;
    time = human_duration(seconds * steps) + " for about " + short_number(steps) + " steps at " +
           short_number(static_cast<double>(method.particle_count()) / seconds / 1e6) + " Mparticle-steps/s";
  } catch (const StepFailure& failure) {
    time += " (the first steps are refused: " + failure.details().cause + ")";
  }
  std::printf("\nneeds %s and %s; machine has %s\n", human_bytes(bytes).c_str(), time.c_str(),
              human_bytes(memory).c_str());
  if (bytes > memory) std::printf("this machine's memory is too small for the case: increase resolution.spacing\n");
}

}  // namespace

int check_verb(const RunArguments& arguments, const Programme& programme) {
  LoadedCase loaded = programme.load_case(arguments.input, arguments.overrides);
  const auto method = programme.make_method(loaded);
  loaded.scene.particles = {};
  const auto arrays = method->arrays();
  double bytes = 0;
  for (const auto& array : arrays) bytes += array.bytes;
  std::printf("%s\nplan\n%s\narrays\n%s", start_table(loaded, *method, thread_count()).c_str(),
              plan_table(method->plan()).c_str(), array_table(arrays, method->particle_count()).c_str());
  std::fflush(stdout);
  print_estimate(loaded, *method, bytes);
  return exit_done;
}

}  // namespace spume
