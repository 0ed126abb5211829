// SPDX-License-Identifier: MIT
// Pressures of probes averaged over time (probe.average).
//
// The pressure of a step is the impulse that the liquid receives in that step over its length: a jet that meets a wall
// gives the same impulse in one step of any length, so that the pressure of that step alone is of no meaning. With I(t)
// the sum of p dt up to t, a row at t holds
//
//   (I(t) - I(t - A)) / A,   A = probe.average, at the start the time since then,
//
// I being linear within a step. Rows that are A apart hold the whole impulse: their sum times A is I.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "spume/methods/method.hpp"
#include "spume/scene/case.hpp"

namespace spume {

class ProbeAverages {
 public:
  // `scalars`: those of the method's probes. Without a pressure among them there is nothing to average.
  ProbeAverages(const std::vector<ProbeOptions>& probes, const std::vector<ProbeScalar>& scalars);

  bool any() const { return !windows_.empty(); }
  // Takes up the pressures of a step of length dt that ends at the time of the method. Probes in the air feel none.
  void add_step(Method& method, double dt);
  // Of the probe with this index; `now` before the first step, and for a probe without an average.
  double pressure(std::size_t probe, double now) const;

  // The scalars of the probe with this index: `now`, but for an averaged pressure.
  std::vector<double> scalars(std::size_t probe, std::vector<double> now) const;

  // State between steps, of the k-th averaged probe: times and I at them, alternating.
  std::size_t size() const { return windows_.size(); }
  std::span<const double> saved(std::size_t k) const { return windows_[k].marks; }
  void restore(std::size_t k, std::span<const double> marks);

 private:
  struct Window {
    std::size_t probe = 0;
    ProbeOptions options;
    std::vector<double> marks;  // time, I; the first one at or before the start of the window
  };
  std::vector<Window> windows_;
  std::size_t scalar_ = 0;  // of the pressure
};

}  // namespace spume
