// SPDX-License-Identifier: MIT
// Left and right walls that take up waves (scene/wave_absorption.hpp): what they move with beside the velocity that the
// scene gives them. The correction is linear in time over a step, from the elevation at its start.
#pragma once

#include <array>
#include <functional>

#include "spume/core/saved_state.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

class AbsorbingWalls {
 public:
  // `domain` outlives this.
  AbsorbingWalls(const Domain& domain, double spacing) : domain_(domain), spacing_(spacing) {}

  static bool any(const Domain& domain) {
    return domain.sides[0][0].absorption.has_value() || domain.sides[0][1].absorption.has_value();
  }

  // At the start of a step: `elevation` of the surface at a point, walls at the places `x`.
  void measure(const std::array<double, 2>& x, double t, const std::function<double(const Vec3&)>& elevation);
  // The correction of a step; the state stays as it is until accept().
  void advance(double t, double dt);
  void accept();

  // Of the correction, along x: the velocity at a time of the step, and the way over it.
  double velocity(int side, double t) const { return at_[side].start + at_[side].slope * (t - time_); }
  double way(int side) const { return at_[side].way; }
  // What the last measurement found beyond the waves that the wall makes.
  double excess(int side) const { return at_[side].excess; }
  double displacement(int side) const { return at_[side].now.displacement; }

  void save(StateWriter& writer) const;
  void load(StateReader& reader, double t);

 private:
  // The u and X of the law, into the liquid.
  struct State {
    double smoothed = 0, displacement = 0;
  };
  struct Wall {
    State now, next;
    double excess = 0;
    double start = 0, slope = 0, way = 0;  // of the velocity along x over a step
  };
  double mean_elevation(int side, double x, const std::function<double(const Vec3&)>& elevation) const;
  double velocity_of(int side, const State& state) const;

  const Domain& domain_;
  double spacing_;
  double time_ = 0;  // start of the step
  std::array<Wall, 2> at_;
};

}  // namespace spume
