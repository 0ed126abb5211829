// SPDX-License-Identifier: MIT
// The checkpoint of a run: what the driver adds to the state of the method, and how a run continues from it.
#include <span>

#include "spume/core/error.hpp"
#include "spume/run/driver.hpp"
#include "spume/run/report.hpp"
#include "spume/run/state_file.hpp"
#include "spume/run/version.hpp"
#include "spume/scene/refusal.hpp"
#include "spume/scene/resolved_case.hpp"

namespace spume {
namespace {

// The state of a checkpoint lives in its own box, at its own spacing. Walls may change their velocity.
bool fixed_by_the_state(const std::string& name) {
  if (name.starts_with("domain.wall_velocity.")) return false;
  return name == "method" || name.starts_with("domain.") || name == "resolution.spacing" ||
         name.starts_with("resolution.grid");
}

std::string given_or_not(const std::string& value) {
  return value.empty() ? "not set" : value;
}

// Probes that a changed case has added start anew.
void restore_averages(const CheckpointReader& file, ProbeAverages& averages) {
  for (std::size_t k = 0; k < averages.size(); ++k) {
    const std::string name = "driver/average/" + std::to_string(k);
    if (!file.has(name)) continue;
    Array<double> marks;
    file.f64(name, marks);
    averages.restore(k, marks);
  }
}

}  // namespace

void Simulation::save_checkpoint() {
  const auto scope = ledger_.time("checkpoints", static_cast<double>(method_->particle_count()));
  recorder_->sync();
  CheckpointWriter file(folder_ / "checkpoint.h5",
                        {program_version(), program_commit(), loaded_->options.resolved, case_file_});
  const auto next = schedule_.next();
  const double clock[] = {method_->time(), control_.cap(), earlier_wall_seconds_ + wall_seconds()};
  const std::int64_t counters[] = {method_->step_count(), retries_, next[0], next[1], next[2]};
  file.f64("driver/clock", clock);
  file.i64("driver/counters", counters);
  if (watch_) file.f64("driver/invariants", watch_->seen());
  const ProbeAverages& averages = recorder_->averages();
  for (std::size_t k = 0; k < averages.size(); ++k) file.f64("driver/average/" + std::to_string(k), averages.saved(k));
  for (const auto& [name, count] : recorder_->extent()) file.i64("driver/extent/" + name, std::span(&count, 1));
  CheckpointStateWriter writer(file, "method/");
  method_->save(writer);
  file.commit();
  checkpoint_step_ = method_->step_count();
  checkpointed_ = Clock::now();
}

void Simulation::compare_with_checkpoint(const std::string& case_text) {
  for (const auto& [name, before, now] : changed_values(case_text, loaded_->options.resolved)) {
    const std::string difference = name + " = " + given_or_not(now) + ", at the checkpoint " + given_or_not(before);
    if (fixed_by_the_state(name))
      throw refusal(loaded_->options, name,
                    "the checkpoint in '" + folder_.path().string() + "' does not fit the changed case: " + difference +
                        "; restore the value, or start a new run");
    changes_.push_back("the case has changed since the checkpoint: " + difference);
  }
  loaded_->options.resolved = with_origins_of(case_text, loaded_->options.resolved);
}

void Simulation::load_checkpoint(const std::filesystem::path& path) {
  const CheckpointReader file(path);
  Array<double> clock;
  Array<std::int64_t> counters;
  file.f64("driver/clock", clock);
  file.i64("driver/counters", counters);
  if (clock.size() < 3 || counters.size() != 5)
    throw FileError("cannot read checkpoint '" + path.string() + "': the driver's state has another size");
  if (schedule_.finished(clock[0]))
    throw InputError("the run in '" + folder_.path().string() + "' is already at t = " + exact_number(clock[0]) +
                     "; give a later time with --until");
  compare_with_checkpoint(file.origin().case_text);
  CheckpointStateReader reader(file, "method/");
  method_->load(reader);
  control_.set_cap(clock[1]);
  earlier_wall_seconds_ = clock[2];
  retries_ = counters[1];
  schedule_.continue_from(clock[0]);
  if (method_->time() != clock[0] || method_->step_count() != counters[0])
    throw FileError("cannot read checkpoint '" + path.string() + "': method and driver disagree about the step");

  Recorder::Extent extent;
  const std::string prefix = "driver/extent/";
  for (const auto& entry : file.entries()) {
    if (!entry.name.starts_with(prefix)) continue;
    Array<std::int64_t> count;
    file.i64(entry.name, count);
    extent[entry.name.substr(prefix.size())] = count.empty() ? 0 : count[0];
  }
  folder_.log("continuing from step " + std::to_string(counters[0]) + ", t = " + exact_number(clock[0]));
  recorder_ = std::make_unique<Recorder>(folder_.path(), *loaded_, *method_, extent);
  restore_averages(file, recorder_->averages());
  watch_.emplace(method_->invariants(), recorder_->series_columns());
  if (file.has("driver/invariants")) {
    Array<double> seen;
    file.f64("driver/invariants", seen);
    watch_->restore(seen);
  }
  if (!file.origin().case_file.empty()) case_file_ = file.origin().case_file;
  checkpoint_step_ = counters[0];
  fresh_ = false;
}

}  // namespace spume
