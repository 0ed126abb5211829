// SPDX-License-Identifier: MIT
#include "spume/particles/absorbing_walls.hpp"

#include <cmath>

#include "spume/core/error.hpp"
#include "spume/scene/wave_absorption.hpp"

namespace spume {
namespace {

// Of the length of the domain. A level that stays off by e moves a wall by gain times drift times e, for good: a wall
// that is to follow a flood would leave its flume.
constexpr double farthest = 0.5;

constexpr int columns_across = 5;  // of the wall, in three dimensions: the correction is that of all of it

double inwards(int side) {
  return side == 0 ? 1 : -1;
}

}  // namespace

// A column is known to a tenth of a spacing, as particles pass it; the mean of some to less.
double AbsorbingWalls::mean_elevation(int side, double x, const std::function<double(const Vec3&)>& elevation) const {
  const int across = domain_.dimensions == 3 ? columns_across : 1;
  double sum = 0;
  for (int row = 0; row < across; ++row)
    for (int column = 0; column < gauge_columns; ++column) {
      Vec3 point{x + inwards(side) * (column + 0.5) * spacing_, 0, 0};
      if (across > 1) point[1] = domain_.lower[1] + (row + 0.5) / across * (domain_.upper[1] - domain_.lower[1]);
      sum += elevation(point);
    }
  return sum / (across * gauge_columns);
}

void AbsorbingWalls::measure(const std::array<double, 2>& x, double t,
                             const std::function<double(const Vec3&)>& elevation) {
  for (int side = 0; side < 2; ++side) {
    const auto& absorption = domain_.sides[0][side].absorption;
    if (!absorption) continue;
    const double wanted = absorption->elevation == nullptr ? 0 : (*absorption->elevation)(0, 0, 0, t);
    at_[side].excess = mean_elevation(side, x[static_cast<std::size_t>(side)], elevation) - absorption->still - wanted;
  }
}

double AbsorbingWalls::velocity_of(int side, const State& state) const {
  return inwards(side) * (state.smoothed - state.displacement / domain_.sides[0][side].absorption->law.drift);
}

void AbsorbingWalls::advance(double t, double dt) {
  time_ = t;
  for (int side = 0; side < 2; ++side) {
    if (!domain_.sides[0][side].absorption) continue;
    const AbsorptionLaw& law = domain_.sides[0][side].absorption->law;
    Wall& wall = at_[side];
    const double before = inwards(side) * velocity_of(side, wall.now), wanted = -law.gain * wall.excess;
    wall.next.smoothed = wanted + (wall.now.smoothed - wanted) * std::exp(-dt / law.smoothing);
    // By the trapezoidal rule, with the velocity at the end from the displacement there.
    wall.next.displacement =
        (wall.now.displacement + dt / 2 * (before + wall.next.smoothed)) / (1 + dt / (2 * law.drift));
    if (const double most = farthest * (domain_.upper[0] - domain_.lower[0]);
        !(std::abs(wall.next.displacement) <= most)) {
      StepFailure::Details details;
      details.cause = "a wall that absorbs waves follows a level that stays off, by more than half of the domain";
      details.option = "wavemaker.absorption";
      details.position[0] = side == 0 ? domain_.lower[0] : domain_.upper[0];
      details.value = wall.next.displacement;
      throw StepFailure(details);
    }
    wall.start = inwards(side) * before;
    wall.slope = dt > 0 ? (velocity_of(side, wall.next) - wall.start) / dt : 0;
    wall.way = inwards(side) * (wall.next.displacement - wall.now.displacement);
  }
}

void AbsorbingWalls::accept() {
  for (Wall& wall : at_) wall.now = wall.next;
}

void AbsorbingWalls::save(StateWriter& writer) const {
  writer.f64("absorbing_walls",
             std::array{at_[0].now.smoothed, at_[0].now.displacement, at_[1].now.smoothed, at_[1].now.displacement});
}

void AbsorbingWalls::load(StateReader& reader, double t) {
  Array<double> all;
  reader.f64("absorbing_walls", all);
  if (all.size() != 4) throw FileError("the checkpoint was written by another version of the method");
  for (std::size_t side = 0; side < 2; ++side) at_[side].now = at_[side].next = {all[2 * side], all[2 * side + 1]};
  advance(t, 0);
}

}  // namespace spume
