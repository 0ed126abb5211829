// SPDX-License-Identifier: MIT
#include "spume/run/schedule.hpp"

#include <algorithm>

namespace spume {

double Schedule::interval(int event) const {
  return std::array{times_.output_every, times_.series_every, times_.spectrum_every}[static_cast<std::size_t>(event)];
}

double Schedule::next_event() const {
  double next = times_.end;
  for (int event = 0; event < 3; ++event)
    if (interval(event) > 0)
      next = std::min(next, static_cast<double>(next_[static_cast<std::size_t>(event)]) * interval(event));
  return next;
}

double Schedule::step(double t, double limit) const {
  const double remaining = next_event() - t;
  // A limit may aim at the same time as the event and differ from it by rounding: half of what remains, and half of
  // that again, would make hundreds of steps of it.
  constexpr double rounding = 1e-9;
  if (remaining <= limit * (1 + rounding)) return remaining;
  if (remaining < 2 * limit) return remaining / 2;
  return limit;
}

Schedule::Due Schedule::arrive(double t) {
  std::array<bool, 3> due{};
  for (int event = 0; event < 3; ++event) {
    auto& next = next_[static_cast<std::size_t>(event)];
    const double every = interval(event);
    if (every <= 0) continue;
    const auto time = [&] { return static_cast<double>(next) * every; };
    while (time() <= t + tolerance(time())) {
      due[static_cast<std::size_t>(event)] = true;
      ++next;
    }
  }
  const bool end = finished(t);
  return {due[0] || end, due[1] || end || times_.series_every <= 0, due[2] || (end && times_.spectrum_every > 0), end};
}

void Schedule::continue_from(double t) {
  for (int event = 0; event < 3; ++event) {
    const double every = interval(event);
    auto& next = next_[static_cast<std::size_t>(event)];
    // Less the two that division and tolerance may be off by; arrive() counts from there.
    next = every > 0 ? std::max<std::int64_t>(1, static_cast<std::int64_t>(std::min(t / every, 1e15)) - 2) : 1;
  }
  arrive(t);
}

void StepControl::accepted(double limit) {
  cap_ *= 2;
  if (cap_ >= limit) cap_ = std::numeric_limits<double>::infinity();
}

}  // namespace spume
