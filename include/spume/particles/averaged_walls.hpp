// SPDX-License-Identifier: MIT
// Walls of bodies for weakly compressible SPH: every wall point has averages of the liquid around it
// (operators/wall_averages.hpp), and what the points add to the sums of pressure and viscosity is what the liquid does
// to the bodies.
#pragma once

#include <vector>

#include "spume/operators/wall_averages.hpp"
#include "spume/particles/boundary.hpp"
#include "spume/particles/still_liquid.hpp"

namespace spume {

class AveragedWalls {
 public:
  // Boundary and scratch memory outlive it. Without walls of bodies it does nothing. Gravity: across sides, which the
  // pressure at walls follows. `rates`: for add_rates().
  AveragedWalls(Boundary& boundary, const Vec3& gravity, ScratchPool& scratch, bool rates)
      : boundary_(boundary), gravity_(gravity), scratch_(scratch), rates_(rates) {}

  // Around new lists: take_points() before their images are made, find_entries() behind them.
  void take_points(double t);
  void find_entries(const Arrangement& arrangement);
  // Points where their bodies are at time t, for images that move after them; then weigh().
  void follow(double t);
  void weigh(const Arrangement& arrangement);

  // What the rate of density has beside walls that move in it (ContinuityFields::walls_move). Volumes over those at
  // rest.
  void add_rates(const Arrangement& arrangement, const std::array<const double*, 3>& velocity, const float* volume,
                 float* rate) const;
  // Pressure and density of every point, by those of the liquid as it is now; leased until release().
  // Of whole pressures; what is found is without that of the still liquid.
  void find_pressure(const Arrangement& arrangement, const float* pressure, const float* density,
                     const StillLiquid& still = {});
  void release();
  const double* pressure() const { return pressure_.data(); }
  const double* density() const { return density_.data(); }
  std::array<const double*, 3> place() const;
  // Particles near walls.
  const std::vector<std::int32_t>& near() const { return averages_.near(); }

  // On each body of the scene, by the pressures found last.
  struct Liquid {
    std::array<const double*, 3> velocity{};
    const float* pressure = nullptr;   // without that of the still liquid
    Vec3 left_out{};                   // its gradient
    const float* volume = nullptr;     // over that at rest
    const float* viscosity = nullptr;  // null: inviscid
    bool friction = false;             // at no-slip walls
  };
  std::vector<SurfaceForce> forces(const Arrangement& arrangement, const Liquid& liquid) const;

  double bytes() const { return averages_.bytes(); }
  double leased_bytes() const { return pressure_.bytes() + density_.bytes(); }

 private:
  Boundary& boundary_;
  const Vec3 gravity_;
  ScratchPool& scratch_;
  const bool rates_;
  WallAverages averages_;
  Array<double> pressure_, density_;
};

}  // namespace spume
