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
  // Outlived by the scene.
  explicit WorkOfBodies(const Scene& scene);

  // Whether these forces tell all of the work that bodies do: not of surfaces that slide along themselves, of bodies
  // that come, go or grow, and of those that may push others that float.
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
  // sum |dP| dt / 2 over the intervals, which no power that stays between the values of its samples can pass, and 5 %
  // of int |P| dt for the forces.
  double uncertainty() const;
  // That they may have done.
  double most() const { return done_ + uncertainty(); }

  void save_with(SavedNumbers& saved);

 private:
  bool any_moves(const BodyWalls& walls) const;
  double power(const std::vector<SurfaceForce>& forces, const BodyWalls& walls) const;

  std::vector<std::size_t> bodies_;  // with a given motion
  double done_ = 0, gross_ = 0, rule_ = 0;
  double samples_ = 0, time_ = 0, power_ = 0;  // of the last
  double set_out_ = 0, first_energy_ = 0;      // 1: at a speed
};

}  // namespace spume
