// SPDX-License-Identifier: MIT
// The work that bodies with a given motion do on the liquid, from the forces of the liquid on them at samples:
//
//   W = -sum_b int (F_b . V_b + T_b . omega_b) dt,   T_b about the pivot,
//
// by the trapezoidal rule from one to the next. It judges a run by its energy where walls move: what the liquid has
// beyond this work, and beyond what the work may be off by, has come from nowhere.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "spume/operators/surface_force.hpp"
#include "spume/particles/body_walls.hpp"
#include "spume/particles/reports.hpp"

namespace spume {

class WorkOfBodies {
 public:
  explicit WorkOfBodies(const Scene& scene);

  // Whether bodies move as given.
  static bool any(const Scene& scene);
  // Whether the forces on these tell all of the work that bodies do: not of surfaces that slide along themselves, of
  // bodies that come, go or grow, and of those that may push others that float.
  static bool tells_all(const Scene& scene);

  // Whether a sample belongs after so many steps: every fourth, which resolves motions that steps resolve for a quarter
  // of the 5 to 9 % of a step that the forces take (a paddle of 6 x 24 spacings in a tank of 62 x 40), and each of the
  // first, in which the push of a sudden start dies away.
  static bool due(std::int64_t steps) { return steps < 16 || steps % 4 == 0; }

  // The forces of a sample, per [[body]] entry, torques about the origin, where the bodies are, and the energy of the
  // liquid, which is asked for with the first two. Bodies that set out at a speed push at once, which no sample holds:
  // what the liquid gains until the second is uncertain then. One at a time that has been changes nothing.
  void add(double t, const std::vector<SurfaceForce>& forces, const BodyWalls& walls,
           const std::function<double()>& energy);

  double done() const { return done_; }
  // What the work may be off by. Of the rule: e, what it gives over two intervals less what it gives without the sample
  // between them; |sum e| of a power that varies smoothly, of which the rule errs by a third, and 3 sqrt(sum e^2) of
  // one that scatters from sample to sample. Of the forces: 5 % of int |P| dt.
  double uncertainty() const;
  // That they may have done.
  double most() const { return done_ + uncertainty(); }

  void save_with(SavedNumbers& saved);

 private:
  struct Sample {
    double time = 0, power = 0;
  };
  bool any_moves(const BodyWalls& walls) const;
  double power(const std::vector<SurfaceForce>& forces, const BodyWalls& walls) const;

  std::vector<std::size_t> bodies_;  // with a given motion
  double done_ = 0, gross_ = 0;
  double off_ = 0, scatter2_ = 0;  // sum e, sum e^2
  double samples_ = 0;
  Sample last_, before_;
  double set_out_ = 0, first_energy_ = 0, start_ = 0;  // 1: at a speed; gained until the second sample
};

}  // namespace spume
