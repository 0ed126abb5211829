// SPDX-License-Identifier: MIT
// When things happen: which step to take so that the run lands on every output time, and what is due there.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace spume {

// Event k of an interval happens at k * interval, computed by one multiplication, so that no error accumulates.
// Interval 0: no such events. Series rows with interval 0 are written at every step and bind no step.
class Schedule {
 public:
  struct Times {
    double end = 0;
    double output_every = 0;
    double series_every = 0;
    double spectrum_every = 0;
  };
  struct Due {
    bool output = false;
    bool series = false;
    bool spectrum = false;
    bool end = false;
  };

  explicit Schedule(const Times& times) : times_(times) {}

  double end() const { return times_.end; }
  bool finished(double t) const { return t >= times_.end - tolerance(times_.end); }
  double next_event() const;

  // The largest step <= limit that reaches the next event in equal steps when it is less than two limits away:
  // no sliver of a step is left before an event.
  double step(double t, double limit) const;

  // What is due at time t; events up to t count as done from now on. The end makes output, series and spectrum due.
  Due arrive(double t);

  // Numbers of the next events (output, series, spectrum), for the checkpoint.
  std::array<std::int64_t, 3> next() const { return next_; }
  // For a run that continues at time t: the next events are the first ones after it, whatever the intervals were
  // before.
  void continue_from(double t);

 private:
  // Events closer than this coincide: k1 * a and k2 * b that mean the same time differ by rounding, or by that of a
  // case that writes ten digits. A step of 8e-10 between two such events ended a run: what a step adds to the velocity
  // is divided by its length there.
  static double tolerance(double t) { return 1e-9 * (t < 0 ? -t : t); }
  double interval(int event) const;
  Times times_;
  std::array<std::int64_t, 3> next_ = {1, 1, 1};
};

// The step that may be tried: the method's limit, unless a refused step has put a cap on it. A refusal halves the
// step; after an accepted one the cap doubles, until the limit binds again.
class StepControl {
 public:
  double allowed(double limit) const { return limit < cap_ ? limit : cap_; }
  void refused(double dt) { cap_ = dt / 2; }
  void accepted(double limit);
  double cap() const { return cap_; }  // infinite without a refusal
  void set_cap(double cap) { cap_ = cap; }

 private:
  double cap_ = std::numeric_limits<double>::infinity();
};

}  // namespace spume
