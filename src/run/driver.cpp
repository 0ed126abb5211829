// SPDX-License-Identifier: MIT
#include "spume/run/driver.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <tuple>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/io/body_surfaces.hpp"
#include "spume/io/checkpoint.hpp"
#include "spume/io/file.hpp"
#include "spume/run/probes.hpp"
#include "spume/run/report.hpp"
#include "spume/run/signals.hpp"
#include "spume/scene/refusal.hpp"

namespace spume {
namespace {

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

// Mean of a step over the step that the method allows, over about so many steps, and the least with which a run goes
// on.
constexpr double pace_memory = 64;
constexpr double slowest_pace = 1.0 / 32;  // five halvings, at every one of those steps

std::string place_of(const StepFailure::Details& details, int dimensions) {
  std::string text;
  if (details.particle >= 0) {
    text = "particle " + std::to_string(details.particle) + " at (";
    for (int axis = 0; axis < dimensions; ++axis)
      text += (axis == 0 ? "" : ", ") + exact_number(details.position[axis]);
    text += "), ";
  }
  return text + "value " + short_number(details.value);
}

std::string failure_text(const StepFailure& failure, std::int64_t step, double t, int dimensions) {
  return "numerical failure at step " + std::to_string(step) + ", t = " + exact_number(t) + ": " +
         failure.details().cause + "\n  " + place_of(failure.details(), dimensions);
}

// `shorter`: how many times shorter than the method's own the refused step was. Options that shorten the step do not
// help where a step much shorter was refused as well.
std::string help_text(const StepFailure& failure, double shorter) {
  const std::string& option = failure.details().option;
  if (option.empty()) return "";
  if ((option == "time.courant" || option == "time.viscous") && shorter > 1.5)
    return "\n  a step " + short_number(shorter) +
           " times shorter than the method's own was refused too: its length is not the cause, the state at that "
           "place is";
  return "\n  most likely helps: change " + option;
}

// Quantities per step are divided by its length: far below the steps that the method takes they are lost.
void require_some_time(const Case& options, const Method& method) {
  const double least = 1e-9, end = options.time.end;
  const StepLimit limit = method.step_limit();
  // A liquid at rest may have no limit, or steps that follow the end: no unit makes sense of less than the last bound.
  const bool limited = limit.dt < 1e100;
  if ((!limited || end >= least * limit.dt) && end >= 1e-30) return;
  throw refusal(options, "time.end",
                "the end of the run, " + short_number(end) + ", is shorter than a billionth of the first step, " +
                    short_number(limit.dt) + " (" + limit.limited_by + "); give a later end");
}

std::string end_in_digits(double end) {
  char digits[32];
  const auto written = std::to_chars(digits, digits + sizeof digits, end);
  return {digits, written.ptr};
}

// The changes by hand that the state of a checkpoint has behind it, and those to come.
std::pair<std::vector<SteeringRow>, std::vector<SteeringRow>> rows_by_checkpoint(
    const std::filesystem::path& file, const std::filesystem::path& checkpoint) {
  if (!std::filesystem::exists(file)) return {};
  Array<std::int64_t> counters;
  CheckpointReader(checkpoint).i64("driver/counters", counters);
  std::pair<std::vector<SteeringRow>, std::vector<SteeringRow>> parts;
  for (SteeringRow& row : read_steering(file))
    (counters.empty() || row.step > counters[0] ? parts.second : parts.first).push_back(std::move(row));
  return parts;
}

}  // namespace

Schedule::Times schedule_times(const Case& options) {
  return {options.time.end, options.output.every, options.output.series_every, options.output.spectrum_every};
}

std::string until_override(double end) {
  return "--until time.end=" + end_in_digits(end);
}

Simulation::Simulation(std::unique_ptr<LoadedCase> loaded, std::unique_ptr<Method> method, RunFolder folder)
    : loaded_(std::move(loaded)),
      method_(std::move(method)),
      folder_(std::move(folder)),
      schedule_(schedule_times(loaded_->options)),
      case_file_(std::filesystem::absolute(loaded_->options.path).lexically_normal().string()) {
  loaded_->scene.particles = {};
}

Simulation::~Simulation() = default;

std::unique_ptr<Simulation> Simulation::start(LoadedCase loaded, const MethodFactory& make_method,
                                              const std::optional<std::filesystem::path>& folder) {
  auto owned = std::make_unique<LoadedCase>(std::move(loaded));
  auto method = make_method(*owned);
  require_probes(owned->options, *method);
  method->start();
  require_some_time(owned->options, *method);
  RunFolder made = RunFolder::create(owned->options.path, folder);
  write_text_atomically(made / "case.toml", owned->options.resolved);
  if (!owned->scene.bodies.empty()) write_body_surfaces(made / "bodies.vtp", owned->scene);
  return std::unique_ptr<Simulation>(new Simulation(std::move(owned), std::move(method), std::move(made)));
}

std::unique_ptr<Simulation> Simulation::resume(const std::filesystem::path& folder, const CaseLoader& load_case,
                                               const MethodFactory& make_method, std::optional<double> until) {
  RunFolder opened = RunFolder::open(folder);
  std::vector<std::string> overrides;
  if (until) overrides.push_back(until_override(*until));
  const auto checkpoint = opened / "checkpoint.h5";
  const auto steered = rows_by_checkpoint(opened / "steering.csv", checkpoint);
  const auto changes = steering_overrides(steered.first);
  overrides.insert(overrides.begin(), changes.begin(), changes.end());
  auto loaded = std::make_unique<LoadedCase>(load_case((opened / "case.toml").string(), overrides));
  loaded->resuming = true;
  auto method = make_method(*loaded);
  require_probes(loaded->options, *method);
  std::unique_ptr<Simulation> simulation(new Simulation(std::move(loaded), std::move(method), std::move(opened)));
  simulation->load_checkpoint(checkpoint);
  std::tie(simulation->steered_, simulation->due_) = steered;
  if (until) {
    write_text_atomically(simulation->folder_ / "case.toml", simulation->loaded_->options.resolved);
    // Among the changes by hand the last one holds.
    const bool steers_end = std::any_of(steered.first.begin(), steered.first.end(),
                                        [](const SteeringRow& row) { return row.key == "time.end"; });
    if (steers_end) simulation->note_steering("time.end", end_in_digits(*until));
  }
  return simulation;
}

double Simulation::wall_seconds() const {
  return seconds_between(started_, Clock::now());
}

RunState Simulation::run(Observer& observer) {
  const StopSignals signals;
  signals_ = &signals;
  started_ = checkpointed_ = Clock::now();
  marks_.fill({started_, method_->time(), 0});
  try {
    tell_warnings(observer);
    if (fresh_ && !prepare(observer)) return RunState::interrupted;
    for (const std::string& change : changes_) tell(observer, change);
    pass_on_remarks(observer);
    make_due_changes(observer);
    observer.between_steps(*this);
    while (!schedule_.finished(method_->time()) && !stop_requested()) {
      advance(observer);
      make_due_changes(observer);
      observer.between_steps(*this);
    }
    signals_ = nullptr;
    if (checkpoint_step_ != method_->step_count()) save_checkpoint();
    const bool finished = schedule_.finished(method_->time());
    if (!finished) {
      // After the checkpoint: a resumed run drops this snapshot again and stays equal to one that never stopped.
      recorder_->snapshot(*method_);
      tell(observer, "interrupted at step " + std::to_string(method_->step_count()) + ", t = " +
                         exact_number(method_->time()) + "; continue with: spume resume " + folder_.path().string());
    }
    recorder_->sync();
    if (finished) {
      tell_warnings(observer);
      tell_failed_verdicts(observer);
    }
    write_summary(finished ? "finished" : "interrupted", "");
    return finished ? RunState::finished : RunState::interrupted;
  } catch (const StepFailure& failure) {
    const std::string text =
        failure_text(failure, method_->step_count(), method_->time(), loaded_->scene.domain.dimensions) +
        help_text(failure, 1) + "\n  " + continuation();
    close_failed("numerical failure", text);
    throw NumericalFailure(text);
  } catch (const NumericalFailure& failure) {
    close_failed("numerical failure", failure.what());
    throw;
  } catch (const InputError& failure) {
    // Of a change by hand that is made again.
    close_failed("steering refused", failure.what());
    throw;
  } catch (const FileError& failure) {
    const std::string text = failure.what() + ("\n  " + continuation());
    close_failed("file error", text);
    throw FileError(text);
  }
}

// The state that is recorded first. False where the run was to stop meanwhile: there is nothing to resume from.
bool Simulation::prepare(Observer& observer) {
  method_->prepare(ledger_, [&](const HowFar& how_far) {
    observer.preparing(*this, how_far.words);
    return !stop_requested();
  });
  if (!stop_requested()) {
    record_start();
    return true;
  }
  const std::string text = "interrupted before the first step; there is nothing to continue from: start the run again";
  tell(observer, text);
  signals_ = nullptr;
  write_summary("interrupted", text);
  return false;
}

// Of the case. Told at the start, where the run can still be stopped, and again where the result is read.
void Simulation::tell_warnings(Observer& observer) {
  for (const Problem& one : loaded_->options.warnings) tell(observer, one.message("warning"));
}

std::vector<Verdict> Simulation::verdicts() const {
  std::vector<Verdict> all;
  if (watch_) all = watch_->verdicts();
  all.push_back(refused_steps(retries_, method_->step_count()));
  return all;
}

void Simulation::tell_failed_verdicts(Observer& observer) {
  for (const Verdict& one : verdicts())
    if (!one.pass())
      tell(observer,
           "verdict failed: " + one.quantity + " = " + short_number(one.value) + ", bound " + short_number(one.bound));
}

void Simulation::record_start() {
  recorder_ = std::make_unique<Recorder>(folder_.path(), *loaded_, *method_, std::nullopt);
  record_series(0);
  recorder_->snapshot(*method_);
  if (loaded_->options.output.spectrum_every > 0) recorder_->spectrum(*method_);
  // A record that fails, on a full disk, is redone from a checkpoint: the figures of a step are not part of the state
  // after it. So there is one from the start.
  save_checkpoint();
}

void Simulation::advance(Observer& observer) {
  StepLimit limit;
  const double dt = take_step(observer, limit);
  if (recorder_->averages().any()) {
    const auto scope = ledger_.time("averages of probes");
    recorder_->averages().add_step(*method_, dt);
  }
  record_due(dt);
  pass_on_remarks(observer);
  report_progress(observer, dt, limit);
  if (seconds_between(checkpointed_, Clock::now()) > loaded_->options.output.checkpoint_every) save_checkpoint();
}

double Simulation::take_step(Observer& observer, StepLimit& limit) {
  const double t = method_->time();
  for (int attempt = 1;; ++attempt) {
    limit = method_->step_limit();
    if (const double largest = loaded_->options.time.max_step; largest > 0 && limit.dt > largest)
      limit = {largest, "max_step"};
    const double allowed = control_.allowed(limit.dt);
    if (allowed < limit.dt) limit.limited_by = "a refused step";
    const double dt = schedule_.step(t, allowed);
    try {
      if (!(allowed > 0) || !(t + dt > t) || !std::isfinite(dt))
        throw StepFailure({"the time step is too small to advance the time", "time.courant", -1, {0, 0, 0}, limit.dt});
      const auto particles = static_cast<double>(method_->particle_count());
      method_->step(dt, ledger_);
      pace_ += (std::min(1.0, dt / schedule_.step(t, limit.dt)) - pace_) / pace_memory;
      control_.accepted(limit.dt);
      ++steps_this_run_;
      particle_steps_ += particles;
      return dt;
    } catch (const StepFailure& failure) {
      // Steps that are refused again and again would otherwise creep towards a time that they never reach.
      if (attempt > loaded_->options.time.max_retries || !(dt > 0) || pace_ < slowest_pace)
        give_up(failure, dt, attempt);
      ++retries_;
      control_.refused(dt);
      const std::string text = "step " + std::to_string(method_->step_count() + 1) + " at t = " + exact_number(t) +
                               " refused with dt = " + short_number(dt) + ": " + failure.details().cause + " (" +
                               place_of(failure.details(), loaded_->scene.domain.dimensions) +
                               "); trying dt = " + short_number(dt / 2);
      tell(observer, text);
    }
  }
}

void Simulation::give_up(const StepFailure& failure, double dt, int attempts) {
  std::string text =
      failure_text(failure, method_->step_count() + 1, method_->time(), loaded_->scene.domain.dimensions) +
      "\n  refused " + std::to_string(attempts) + (attempts == 1 ? " time" : " times") +
      ", the last time with dt = " + short_number(dt) + help_text(failure, method_->step_limit().dt / dt);
  try {
    // The order matters: a resumed run drops what was recorded after its checkpoint.
    if (checkpoint_step_ != method_->step_count()) save_checkpoint();
    recorder_->snapshot(*method_);
    recorder_->sync();
    text += "\n  the last good state, step " + std::to_string(method_->step_count()) + ", is in " +
            (folder_ / "checkpoint.h5").string() + " and is the last snapshot";
  } catch (const FileError& error) {
    text += "\n  the last good state could not be saved: " + std::string(error.what()) + "\n  " + continuation();
  }
  throw NumericalFailure(text);
}

std::string Simulation::continuation() const {
  if (!checkpoint_step_) return "there is no checkpoint to resume from";
  return "spume resume " + folder_.path().string() + " continues from the checkpoint of step " +
         std::to_string(*checkpoint_step_);
}

void Simulation::record_series(double dt) {
  recorder_->series(*method_, dt, retries_);
  if (!watch_) watch_.emplace(method_->invariants(), recorder_->series_columns());
  watch_->observe(recorder_->series_row());
}

void Simulation::record_due(double dt) {
  const Schedule::Due due = schedule_.arrive(method_->time());
  if (due.series) {
    const auto scope = ledger_.time("series and probes");
    record_series(dt);
  }
  if (due.output) {
    const auto scope = ledger_.time("snapshots", static_cast<double>(method_->particle_count()));
    recorder_->snapshot(*method_);
    recorder_->flush();
  }
  if (due.spectrum) {
    const auto scope = ledger_.time("spectra", static_cast<double>(method_->particle_count()));
    recorder_->spectrum(*method_);
  }
}

void Simulation::tell(Observer& observer, const std::string& text) {
  folder_.log(text);
  observer.note(text);
}

void Simulation::pass_on_remarks(Observer& observer) {
  for (const Remark& remark : method_->take_remarks()) {
    folder_.log(remark.text);
    if (!remark.log_only) observer.note(remark.text);
  }
}

void Simulation::report_progress(Observer& observer, double dt, const StepLimit& limit) {
  // The rate is that of the last one to two windows: two marks take turns as the start. Only shown: some steps of a
  // million particles (about a second each), so that the figure stands still, and short enough to follow the flow.
  constexpr double window = 5;  // seconds
  const auto now = Clock::now();
  if (seconds_between(marks_[1].wall, now) > window) {
    marks_[0] = marks_[1];
    marks_[1] = {now, method_->time(), particle_steps_};
  }
  const double wall = seconds_between(marks_[0].wall, now);
  Progress progress{method_->step_count(), method_->time(), schedule_.end(), dt, limit.limited_by, 0, 0};
  progress.particle_steps_per_second = (particle_steps_ - marks_[0].particle_steps) / wall;
  progress.remaining_seconds = (progress.end - progress.time) * wall / (progress.time - marks_[0].time);
  observer.progress(progress);
}

void Simulation::close_failed(const std::string& state, const std::string& text) {
  folder_.log(text);
  try {
    write_summary(state, text);
  } catch (const FileError&) {
    // The disk that refused a result refuses the summary too; the first error is the one to report.
  }
}

void Simulation::write_summary(const std::string& state, const std::string& message) {
  RunFigures figures;
  figures.state = state;
  figures.message = message;
  figures.time = method_->time();
  figures.end = schedule_.end();
  figures.steps = method_->step_count();
  figures.steps_this_run = steps_this_run_;
  figures.retries = retries_;
  figures.particles = method_->particle_count();
  figures.threads = thread_count();
  figures.wall_seconds = wall_seconds();
  figures.total_wall_seconds = earlier_wall_seconds_ + figures.wall_seconds;
  figures.particle_steps = particle_steps_;
  if (recorder_) figures.final_values = recorder_->last_row();
  figures.verdicts = verdicts();
  figures.case_file = case_file_;
  write_text_atomically(folder_ / "summary.json", summary_json(*loaded_, figures));
  write_text_atomically(folder_ / "ledger.json", ledger_json(ledger_, figures.wall_seconds));
  folder_.log(ledger_table(ledger_, figures.wall_seconds));
}

}  // namespace spume
