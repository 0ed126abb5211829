// SPDX-License-Identifier: MIT
// The simulation driver: one case, one method, one folder, from the start or a checkpoint to the end.
//
// Steps follow the method's limit, shortened so that they land on output, series, spectrum and end times. A refused
// step (StepFailure) is retried with half its length up to time.max_retries times in a row.
#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spume/core/error.hpp"
#include "spume/core/ledger.hpp"
#include "spume/methods/method.hpp"
#include "spume/run/folder.hpp"
#include "spume/run/recorder.hpp"
#include "spume/run/schedule.hpp"
#include "spume/run/steering.hpp"
#include "spume/run/verdicts.hpp"
#include "spume/scene/case.hpp"

namespace spume {

using MethodFactory = std::function<std::unique_ptr<Method>(const LoadedCase&)>;
using CaseLoader = std::function<LoadedCase(const std::string& path, const std::vector<std::string>& overrides)>;

// What a CaseLoader gets for --until: the end as a value of the case, so that a resumed run has the same end.
std::string until_override(double end);

Schedule::Times schedule_times(const Case& options);

// How a run stands, for the progress line.
struct Progress {
  std::int64_t step = 0;
  double time = 0, end = 0, dt = 0;
  std::string limited_by;
  double particle_steps_per_second = 0;  // over the last seconds
  double remaining_seconds = 0;          // of wall time; not finite while unknown
};

class Simulation;
class StopSignals;

// Whoever watches a run. Called on the driver's thread after every step, and for every event in words.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void progress(const Progress& progress) = 0;
  virtual void note(const std::string& text) = 0;
  // Before the first step, how far what prepares it has come. May ask the run to stop.
  virtual void preparing(Simulation& /*simulation*/, const std::string& /*how_far*/) {}
  // Before every step, and once after the last: may look at the state and steer the run, which waits meanwhile.
  virtual void between_steps(Simulation& /*simulation*/) {}
};

// What steering a run takes: how to make a case and its method anew, and the options that may change.
struct SteeringMeans {
  CaseLoader load_case;
  MethodFactory make_method;
  std::vector<std::string> keys;  // "section.key"
};

enum class RunState { finished, interrupted };

class Simulation {
 public:
  // Makes the method first and the folder only when that succeeded. Throws InputError (also for a probe of a kind that
  // the method does not have), FileError.
  static std::unique_ptr<Simulation> start(LoadedCase loaded, const MethodFactory& make_method,
                                           const std::optional<std::filesystem::path>& folder);
  // Continues the run in `folder` from its checkpoint, bit for bit as if it had never stopped. `until` replaces
  // time.end, also in the folder's case.toml. Throws InputError (no run there, `until` not after the checkpoint, a case
  // that no longer fits the checkpoint), FileError (unreadable checkpoint or results).
  static std::unique_ptr<Simulation> resume(const std::filesystem::path& folder, const CaseLoader& load_case,
                                            const MethodFactory& make_method, std::optional<double> until);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;
  ~Simulation();

  // Runs to the end, or until SIGINT or SIGTERM. Throws NumericalFailure after leaving a snapshot and a checkpoint
  // of the last good state, FileError when a result cannot be written: the last checkpoint then stays, and a resumed
  // run does the steps since again.
  RunState run(Observer& observer);

  // Before run(): from now on steer() is possible.
  void allow_steering(SteeringMeans means) { means_ = std::move(means); }
  // Before run(): the changes that another run noted are made again after the same steps, beside those that this run
  // has yet to make. Throws InputError for an option that cannot be steered.
  void replay(const std::vector<SteeringRow>& rows);

  // What follows is for an observer, between two steps.

  // Sets an option to a value, given as TOML. Throws InputError for an option or a value that the run cannot take, and
  // goes on as before; FileError when the change cannot be saved.
  void steer(const std::string& key, const std::string& value);
  void snapshot_now();
  void checkpoint_now() { save_checkpoint(); }
  void request_stop() { stop_ = true; }  // as SIGINT does
  bool stop_requested() const;
  bool finished() const { return schedule_.finished(method_->time()); }
  void note_pause(std::chrono::steady_clock::duration length);  // in which the run stood still: no part of its pace
  std::vector<ParticleSnapshot> particles() { return method_->snapshot_on_demand(); }
  std::vector<GridSnapshot> grids() { return method_->grid_snapshot(); }
  std::span<const SeriesColumn> series_columns() const {  // empty before the first record
    return recorder_ == nullptr ? std::span<const SeriesColumn>() : recorder_->series_columns();
  }
  std::span<const double> series_row() const { return recorder_->series_row(); }  // the last one; empty before it
  Ledger::Scope time_stage(std::string_view stage) { return ledger_.time(stage); }

  const LoadedCase& loaded() const { return *loaded_; }
  const Method& method() const { return *method_; }
  const std::filesystem::path& folder() const { return folder_.path(); }
  const Ledger& ledger() const { return ledger_; }
  void log(const std::string& text) { folder_.log(text); }
  std::int64_t steps_this_run() const { return steps_this_run_; }
  double wall_seconds() const;       // since run() began
  std::string continuation() const;  // from where the run can be continued, in words
  double particle_steps() const { return particle_steps_; }
  std::vector<Verdict> verdicts() const;

 private:
  using Clock = std::chrono::steady_clock;
  Simulation(std::unique_ptr<LoadedCase> loaded, std::unique_ptr<Method> method, RunFolder folder);

  void tell_warnings(Observer& observer);
  void tell_failed_verdicts(Observer& observer);
  bool prepare(Observer& observer);
  void record_start();
  void advance(Observer& observer);                        // one step, and what is due after it
  double take_step(Observer& observer, StepLimit& limit);  // the length of the accepted step
  void record_due(double dt);
  void record_series(double dt);
  void tell(Observer& observer, const std::string& text);  // the log too
  void pass_on_remarks(Observer& observer);
  void report_progress(Observer& observer, double dt, const StepLimit& limit);
  [[noreturn]] void give_up(const StepFailure& failure, double dt, int attempts);
  void close_failed(const std::string& state, const std::string& text);
  void write_summary(const std::string& state, const std::string& message);

  void save_checkpoint();
  void load_checkpoint(const std::filesystem::path& path);
  bool steerable(const std::string& key) const;
  void change_case(const std::string& key, const std::string& value);
  void make_due_changes(Observer& observer);
  void note_steering(const std::string& key, const std::string& value);
  void write_steering_file() const;
  void compare_with_checkpoint(const std::string& case_text);

  std::unique_ptr<LoadedCase> loaded_;
  std::unique_ptr<Method> method_;
  RunFolder folder_;
  Schedule schedule_;
  StepControl control_;
  std::unique_ptr<Recorder> recorder_;
  std::optional<InvariantWatch> watch_;
  std::string case_file_;  // that the run was started with, absolute; a resumed run reads the copy in its folder
  Ledger ledger_;
  bool fresh_ = true;
  std::vector<std::string> changes_;  // of the case since the checkpoint, in words
  SteeringMeans means_;
  std::vector<SteeringRow> steered_, due_;  // changes that were made, and those that a replay has yet to make
  const StopSignals* signals_ = nullptr;    // while it runs
  bool stop_ = false;
  std::int64_t retries_ = 0;
  double pace_ = 1;  // mean of recent steps over those that the method allows; refused steps lower it
  std::int64_t steps_this_run_ = 0;
  double particle_steps_ = 0;
  double earlier_wall_seconds_ = 0;
  std::optional<std::int64_t> checkpoint_step_;
  Clock::time_point started_ = Clock::now(), checkpointed_ = started_;
  struct Mark {  // start of the window over which the rate is measured
    Clock::time_point wall;
    double time = 0;
    double particle_steps = 0;
  };
  std::array<Mark, 2> marks_;
};

}  // namespace spume
