// SPDX-License-Identifier: MIT
// What particles suspended in a flow are, in lengths and times of the flow, counts and places.
#pragma once

#include "spume/physics/point_particles/coupling_stability.hpp"
#include "spume/physics/point_particles/kinds.hpp"
#include "spume/physics/point_particles/motion.hpp"
#include "spume/physics/point_particles/placement.hpp"

namespace spume {

// Of spheres in contact, the densest packing: pi / (3 sqrt 2).
inline constexpr double close_packing = 0.74048048969306104;
// Entries of four numbers for each are counted in 32 bits: 2^31 / 4, rounded down.
inline constexpr std::int64_t most_particles = 500'000'000;

// What ParticleSystem takes. Methods make it of what a case says, in scales of their flow, volume fractions and files.
struct PointParticleOptions {
  std::size_t count = 0;
  MotionModel motion;
  Coupling coupling = Coupling::one_way;
  MatchingMethod matching = MatchingMethod::rounds;
  // Matchings a step, each on the places that the one before left: with 1 a particle collides once a step, and how much
  // overlap stays depends on the step.
  int collision_sweeps = 1;
  PlacementOptions placement;  // diameters too
  int spline_order = 4;
  bool single_precision_records = true;
  double max_volume_fraction = close_packing;
  int sort_every = 8;  // steps between sorts of the particles by grid cell
  // Where in time the force is wanted, from the middle of the last step, in steps (lead: 1/2 for multistep schemes that
  // take it at the present time, 1 for a scheme that holds it over the coming step), and how the flow steps with it.
  CouplingScheme scheme;
  // Particles that act on the flow see it without their own disturbance (self_disturbance.hpp), which needs a
  // viscosity; `kept_phase` is the largest wavenumber that the flow keeps times the spacing, along each axis.
  bool remove_self_disturbance = false;
  std::array<double, 3> kept_phase{M_PI, M_PI, M_PI};
};

}  // namespace spume
