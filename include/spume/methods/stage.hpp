// SPDX-License-Identifier: MIT
// The plan of a method: the ordered list of stages that a scene needs. The step and the start run that list, `spume
// check` prints it and the ledger times it, so that they cannot disagree. Nothing of weight happens outside a stage.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/go_on.hpp"
#include "spume/core/ledger.hpp"

namespace spume {

// Arrays that a stage reads or writes, with their present size in bytes: what the traffic of the stage is counted from.
// Null pointers, of arrays that this scene does not have, count nothing. The arrays outlive the use.
class ArrayUse {
 public:
  template <class T>
  ArrayUse(const Array<T>& array) : ArrayUse(&array) {}  // NOLINT: a list of arrays reads as one
  template <class T>
  ArrayUse(const Array<T>* array)  // NOLINT
      : bytes_([array] { return array == nullptr ? 0.0 : static_cast<double>(array->size() * sizeof(T)); }) {}
  explicit ArrayUse(std::function<double()> bytes) : bytes_(std::move(bytes)) {}  // of arrays that another class keeps
  template <class T, std::size_t count>
  ArrayUse(const std::array<Array<T>, count>& arrays) : ArrayUse(&arrays) {}  // NOLINT
  template <class T, std::size_t count>
  ArrayUse(const std::array<Array<T>, count>* arrays)  // NOLINT
      : bytes_([arrays] {
          double sum = 0;
          if (arrays != nullptr)
            for (const Array<T>& array : *arrays) sum += static_cast<double>(array.size() * sizeof(T));
          return sum;
        }) {}
  template <class T, std::size_t count>
  ArrayUse(const std::array<Array<T>*, count>& arrays)  // NOLINT
      : ArrayUse(to_const(arrays, std::make_index_sequence<count>())) {}
  template <class T, std::size_t count>
  ArrayUse(const std::array<const Array<T>*, count>& arrays)  // NOLINT
      : bytes_([arrays] {
          double sum = 0;
          for (const Array<T>* array : arrays)
            if (array != nullptr) sum += static_cast<double>(array->size() * sizeof(T));
          return sum;
        }) {}
  double bytes() const { return bytes_(); }

 private:
  template <class T, std::size_t count, std::size_t... k>
  static std::array<const Array<T>*, count> to_const(const std::array<Array<T>*, count>& arrays,
                                                     std::index_sequence<k...>) {
    return {arrays[k]...};
  }
  std::function<double()> bytes_;
};

using Arrays = std::vector<ArrayUse>;

// One run of a stage: the step it belongs to (0 at the start), and what the stage counted itself.
struct StageRun {
  double dt = 0;
  double particles = 0;  // that the ledger divides the time by; a stage that handles others than the step says so
  double pairs = 0;      // particle pairs handled
  double bytes = 0;      // traffic beside the arrays that the stage names, such as that of its sweeps
  GoOn go_on = {};       // of what comes before the first record
};

// Steps, the start, both of these; what makes the state that is recorded first, before the start; or the steps in which
// a recorded flow carries what is dissolved.
enum class StagePart { step, start, both, before, recorded };
inline bool of_the_start(StagePart part) {
  return part == StagePart::start || part == StagePart::before;
}

// One stage: what it is called, why it runs or not, and what it does. Off stages have no work. A stage that is on and
// not wanted in every step, such as a sort every so many steps, says when it is due.
struct Stage {
  std::string name;
  std::string reason;
  bool on = true;
  std::function<void(StageRun&)> work = {};
  Arrays reads = {}, writes = {};
  StagePart part = StagePart::step;
  std::function<bool()> due = {};  // asked before each run; none: always
};

class Plan {
 public:
  // Throws std::logic_error for a name that is there already, or a stage that is on and has no work.
  void add(Stage stage);
  // The stages that `body` adds run one after another, again and again while `more` answers true; it is asked before
  // each pass. Loops may hold loops. Throws std::logic_error for a body that adds no stage.
  void repeat(std::function<bool()> more, const std::function<void()>& body);
  const std::vector<Stage>& stages() const { return stages_; }
  // Lists the stages that are on in the ledger, in the order of the plan. Runs do so themselves.
  void list(Ledger& ledger) const;

  // Runs the stages of the step, or of the start, that are on, each timed under its name. `particles`: how many the
  // ledger divides the time by. What a stage throws passes through.
  void run_step(double dt, double particles, Ledger& ledger) const { run({StagePart::step, dt, particles, ledger}); }
  void run_start(double particles, Ledger& ledger) const { run({StagePart::start, 0, particles, ledger}); }
  void run_before(double particles, Ledger& ledger, const GoOn& go_on) const {
    run({StagePart::before, 0, particles, ledger, go_on});
  }
  void run_recorded(double dt, double particles, Ledger& ledger) const {
    run({StagePart::recorded, dt, particles, ledger});
  }

 private:
  struct Run {
    StagePart part;
    double dt, particles;
    Ledger& ledger;
    GoOn go_on = {};
  };
  struct Loop {
    std::size_t first, last;  // of its stages; one past the last
    std::function<bool()> more;
  };
  void run(const Run& run) const {
    list(run.ledger);
    run_range(run, 0, stages_.size(), 0);
  }
  void run_range(const Run& run, std::size_t first, std::size_t last, std::size_t loop) const;
  void run_stage(const Run& run, const Stage& stage) const;
  std::vector<Stage> stages_;
  std::vector<Loop> loops_;  // in the order in which they begin
};

}  // namespace spume
