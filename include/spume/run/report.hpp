// SPDX-License-Identifier: MIT
// Tables about a run as text, and the same figures as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "spume/core/ledger.hpp"
#include "spume/methods/method.hpp"
#include "spume/run/verdicts.hpp"
#include "spume/scene/case.hpp"

namespace spume {

std::string human_bytes(double bytes);       // "11.2 GB"
std::string human_duration(double seconds);  // "02:31", "2:10:05"
std::string short_number(double value);      // "%.4g"
std::string exact_number(double value);      // "%.10g"

std::int64_t peak_resident_bytes();  // of this process

// Of memory that a run needs at its peak, where the process has taken `resident` for what the method has made so far.
double needed_bytes(const LoadedCase& loaded, const Method& method, double resident);

// Case, box, particles, spacing, groups, step limit and what binds, stages, threads, estimated memory, seed, commit,
// and the folder of the results when there is one.
std::string start_table(const LoadedCase& loaded, const Method& method, int threads, const std::string& folder = {});
// The stages in their order: on or off, and why; stages that only the start runs are marked.
std::string plan_table(const std::vector<Stage>& plan);
// Bytes per particle of the liquid or, with `on_grid`, per point; those of suspended particles per particle, with a
// sum.
std::string array_table(const std::vector<ArrayInfo>& arrays, std::size_t count, bool on_grid);

// Calls, seconds, share of the wall time, ns per particle or per pair, GB/s. Where pairs are counted, the cost
// is per pair.
std::string ledger_table(const Ledger& ledger, double wall_seconds);
std::string ledger_json(const Ledger& ledger, double wall_seconds);

struct RunFigures {
  std::string state;    // "finished", "interrupted", "numerical failure", "file error"
  std::string message;  // why the run ended, empty when it finished
  double time = 0, end = 0;
  std::int64_t steps = 0, steps_this_run = 0, retries = 0;
  std::size_t particles = 0;
  int threads = 1;
  double wall_seconds = 0;                                   // of this process
  double total_wall_seconds = 0;                             // of all processes that worked on the run
  double particle_steps = 0;                                 // of this process
  std::vector<std::pair<std::string, double>> final_values;  // last row of series.csv
  std::vector<Verdict> verdicts;
  std::string case_file;  // that the run was started with, absolute
};
std::string summary_json(const LoadedCase& loaded, const RunFigures& figures);

}  // namespace spume
