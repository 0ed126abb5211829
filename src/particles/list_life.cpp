// SPDX-License-Identifier: MIT
#include "spume/particles/list_life.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

constexpr int longest_wait = 15;  // in lists

}  // namespace

bool ListLife::last(double dt, const Motion& motion, const ImageRules& rules, ScratchPool& scratch) {
  next_slack_ = slack_ - 2 * dt * (fastest + dt / 2 * most_accelerated);
  if (together_ && dt > 0 && next_slack_ >= 0) return true;
  const int dimensions = particles_.dimensions;
  const std::size_t n = particles_.size();
  // Who asks for the bound needs every way.
  const bool asks = together_ && waiting_ == 0;
  FloatVectorScratch way;
  if (asks) scratch.lease(way, dimensions, n);
  struct Longest {
    double way2 = 0, step2 = 0;
  };
  const Longest longest = parallel_reduce(
      n, Longest{},
      // Copies, since every store of a way would have pointers behind references read again.
      [dt, dimensions, asks, motion, u = read(particles_.velocity), r = read(particles_.position), ways = write(way),
       origin = arrangement_.origin](std::size_t first, std::size_t last) {
        Longest so_far;
        for (std::size_t i = first; i < last; ++i) {
          double way2 = 0, step2 = 0;
          for (int axis = 0; axis < dimensions; ++axis) {
            double speed = u[axis][i] + dt / 2 * motion.acceleration[axis][i];
            if (motion.shift[axis] != nullptr) speed += motion.shift[axis][i];
            const double listed = origin[axis] + double{motion.listed[axis][i]};
            const double whole = r[axis][i] + dt * speed - listed;
            if (asks) ways[axis][i] = static_cast<float>(whole);
            way2 += whole * whole;
            step2 += dt * speed * dt * speed;
          }
          so_far = {larger_or_nan(so_far.way2, way2), larger_or_nan(so_far.step2, step2)};
        }
        return so_far;
      },
      [](const Longest& a, const Longest& b) {
        return Longest{larger_or_nan(a.way2, b.way2), larger_or_nan(a.step2, b.step2)};
      });
  next_slack_ = skin_ - 2 * std::sqrt(longest.way2);
  if (next_slack_ < 0 && asks) {
    ++asked_;
    // Two that pass each other are nearer in the middle of the step than at its ends: by a^2 / (8 R), a the way of one
    // against the other in the step.
    const double passing = longest.step2 / (2 * support_radius_);
    const double nearest = list_skin_.nearest({.grid = arrangement_.grid,
                                               .particles = arrangement_.table,
                                               .images = arrangement_.images,
                                               .rules = rules,
                                               .origin = arrangement_.origin,
                                               .place = motion.listed,
                                               .way = read(way)},
                                              std::sqrt(longest.way2));
    next_slack_ = nearest - passing - support_radius_;
    if (next_slack_ >= 0) {
      helped_ = true;
      waited_ = 0;
    } else if (!helped_) {
      waited_ = std::min(2 * waited_ + 1, longest_wait);
      waiting_ = waited_ + 1;  // these, and so many more
    }
  }
  if (asks) scratch.release(way);
  if (dt == 0) slack_ = next_slack_;
  return next_slack_ >= 0;
}

std::vector<double> ListLife::state(double beside) const {
  return {slack_, helped_ ? 1.0 : 0.0, static_cast<double>(waiting_), static_cast<double>(waited_), beside};
}

void ListLife::restore(const double* state) {
  slack_ = state[0];
  helped_ = state[1] != 0;
  waiting_ = static_cast<int>(state[2]);
  waited_ = static_cast<int>(state[3]);
}

}  // namespace spume
