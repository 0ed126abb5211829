// SPDX-License-Identifier: MIT
// Changes by hand: the run continues from a checkpoint of this moment with the changed case, in the same process. What
// a change does is therefore what a resumed run with the same change does, and no method knows of it.
#include <algorithm>
#include <new>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/run/driver.hpp"
#include "spume/run/probes.hpp"
#include "spume/run/report.hpp"
#include "spume/run/signals.hpp"

namespace spume {

void Simulation::change_case(const std::string& key, const std::string& value) {
  std::vector<std::string> overrides = steering_overrides(steered_);
  overrides.push_back(key + "=" + value);
  auto loaded = std::make_unique<LoadedCase>(means_.load_case((folder_ / "case.toml").string(), overrides));
  loaded->resuming = true;
  auto method = means_.make_method(*loaded);
  require_probes(loaded->options, *method);
  loaded->scene.particles = {};
  save_checkpoint();

  // Until the state is loaded the run can go on as before.
  struct {
    std::unique_ptr<LoadedCase> loaded;
    std::unique_ptr<Method> method;
    std::unique_ptr<Recorder> recorder;
  } before{std::move(loaded_), std::move(method_), std::move(recorder_)};
  const auto schedule = schedule_;
  const auto control = control_;
  const auto watch = watch_;
  const auto retries = retries_;
  const double earlier_wall = earlier_wall_seconds_;
  const auto go_on_as_before = [&] {
    recorder_ = std::move(before.recorder);
    method_ = std::move(before.method);
    loaded_ = std::move(before.loaded);
    schedule_ = schedule;
    control_ = control;
    watch_ = watch;
    retries_ = retries;
    earlier_wall_seconds_ = earlier_wall;
    changes_.clear();
  };
  loaded_ = std::move(loaded);
  method_ = std::move(method);
  schedule_ = Schedule(schedule_times(loaded_->options));
  try {
    load_checkpoint(folder_ / "checkpoint.h5");
  } catch (const FileError& failure) {
    go_on_as_before();
    throw InputError(key + " = " + value + " needs another state than that of this run: " + failure.what());
  } catch (...) {
    go_on_as_before();
    throw;
  }
  earlier_wall_seconds_ = earlier_wall;  // the file counts what this process has run as earlier
  changes_.clear();
}

bool Simulation::steerable(const std::string& key) const {
  return std::find(means_.keys.begin(), means_.keys.end(), steered_option(key)) != means_.keys.end();
}

void Simulation::steer(const std::string& key, const std::string& value) {
  if (!steerable(key)) throw InputError("'" + key + "' cannot be changed while a run goes on");
  if (value.empty() || value.find_first_of("\r\n") != std::string::npos)
    throw InputError("'" + key + "' needs a value on one line");
  try {
    change_case(key, value);
  } catch (const std::bad_alloc&) {
    throw InputError("not enough memory to change " + key + ", which needs a second copy of the state for a moment");
  }
  note_steering(key, value);
}

void Simulation::note_steering(const std::string& key, const std::string& value) {
  steered_.push_back({method_->step_count(), method_->time(), key, value});
  write_steering_file();
  folder_.log("steered after step " + std::to_string(steered_.back().step) +
              ", t = " + exact_number(steered_.back().time) + ": " + key + (value.empty() ? "" : " = " + value));
}

void Simulation::write_steering_file() const {
  std::vector<SteeringRow> rows = steered_;
  rows.insert(rows.end(), due_.begin(), due_.end());
  write_steering(folder_ / "steering.csv", rows);
}

void Simulation::snapshot_now() {
  recorder_->snapshot(*method_);
  recorder_->flush();
  note_steering(snapshot_key, "");
  // A run that is resumed keeps the snapshot.
  save_checkpoint();
}

void Simulation::replay(const std::vector<SteeringRow>& rows) {
  for (const SteeringRow& row : rows)
    if (row.key != snapshot_key && !steerable(row.key))
      throw InputError("'" + row.key + "' of the replay cannot be changed while a run goes on");
  due_.insert(due_.end(), rows.begin(), rows.end());
  std::stable_sort(due_.begin(), due_.end(),
                   [](const SteeringRow& a, const SteeringRow& b) { return a.step < b.step; });
  write_steering_file();
}

void Simulation::make_due_changes(Observer& observer) {
  while (!due_.empty() && due_.front().step <= method_->step_count()) {
    const SteeringRow row = due_.front();
    due_.erase(due_.begin());
    if (row.step < method_->step_count() || row.time != method_->time())
      tell(observer, "the replay has departed from its run: " + row.key + " was changed after step " +
                         std::to_string(row.step) + " at t = " + exact_number(row.time) + ", which is now step " +
                         std::to_string(method_->step_count()) + " at t = " + exact_number(method_->time()));
    if (row.key == snapshot_key)
      snapshot_now();
    else
      steer(row.key, row.value);
    observer.note("replayed after step " + std::to_string(row.step) + ": " + row.key +
                  (row.value.empty() ? "" : " = " + row.value));
  }
}

bool Simulation::stop_requested() const {
  return stop_ || (signals_ != nullptr && signals_->requested());
}

void Simulation::note_pause(std::chrono::steady_clock::duration length) {
  for (Mark& mark : marks_) mark.wall += length;
}

}  // namespace spume
