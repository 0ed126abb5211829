// SPDX-License-Identifier: MIT
// Particles suspended in a periodic flow: motion, collisions and what they give back to the fluid, for a flow solver
// that hands over its velocity once a step.
//
//   take_velocity(u), sort(), start()   velocity at the start; particles take the velocity of the fluid
//   repeat:
//     spread_force(f)            body force of the particles at the present time (two-way, four-way)
//     ... the flow solver steps by dt with f ...
//     sort()                     when sort_due(): neighbours in the box are neighbours in memory
//     take_velocity(u)           velocity at the end of the step
//     move(dt)                   the particles over the same step
//     collide()                  (four-way, colliding)
//
// Velocities come as B-spline coefficients: divided by b_spline_prefilter along every axis in Fourier space. The field
// of the step before is kept in the records, so the flow solver keeps no second snapshot.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "spume/operators/linear_deposition.hpp"
#include "spume/operators/spline_field.hpp"
#include "spume/physics/point_particles/exclusion.hpp"
#include "spume/physics/point_particles/motion.hpp"
#include "spume/physics/point_particles/options.hpp"
#include "spume/physics/point_particles/overlap.hpp"

namespace spume {

class ParticleSystem {
 public:
  // Throws InputError when the options contradict each other or the box: diameters that do not fit, a spline order that
  // does not exist, two-way coupling of infinitely heavy particles (beta = 0).
  ParticleSystem(const PeriodicGrid& grid, const PointParticleOptions& options);

  // The present velocity of the fluid; that of the call before becomes the previous one (both are the same after the
  // first call).
  template <class Source>
  void take_velocity(const std::array<const Source*, 3>& velocity);
  // Moves overlapping particles apart, as collide() does, until none is left or `most_sweeps` are made: random places
  // overlap. Before the first sort and start(). Precondition: collides().
  void separate(int most_sweeps);
  void start();
  bool sort_due() const;
  void sort();
  void move(double dt);
  void collide();  // precondition: collides()

  bool removes_self_disturbance() const { return disturbance_.has_value(); }
  bool couples() const { return acts_on_flow(options_.coupling); }
  // Frozen particles do not: exclusion would move them.
  bool collides() const { return excludes(options_.coupling) && !options_.motion.frozen; }
  // The longest step that the coupling is stable with, at the volume fractions that the force was last spread with
  // (before that, the mean); infinite without coupling.
  double longest_step() const;
  // Writes every point of `force`: acceleration of the fluid by the particles, for a flow step of dt; schemes that hold
  // the force over the step take it at the places of its middle. Precondition: couples().
  template <class Real>
  void spread_force(const std::array<Real*, 3>& force, double dt = 0);

  std::size_t size() const { return particles_.size(); }
  std::int64_t steps() const { return static_cast<std::int64_t>(clock_[1]); }
  double largest_diameter() const;
  double volume_fraction() const { return volume_fraction_; }
  const Particles& particles() const { return particles_; }
  const PointParticleOptions& options() const { return options_; }
  const MotionStatistics& motion() const { return motion_; }
  const ExclusionReport& exclusion() const { return exclusion_report_; }
  const DepositionReport& deposition() const { return deposition_report_; }
  // Of the present positions; builds the cells anew.
  SampledValue measure_overlap(std::size_t samples, std::uint32_t step);

  // Overlapping pairs of the present positions by overlap over touching distance: probability density in `bins` bins of
  // [0, 1]; zeros without overlaps.
  std::vector<double> overlap_histogram(int bins);

  // Numbers of the force that move() leaves to be spread, three a particle; empty without coupling.
  const Array<double>& amounts() const { return amounts_; }
  // Of the velocity as the particles see it.
  double record_bytes() const;
  // The field that particles see; null unless its records are in double precision.
  const SplineField<double>* double_field() const { return std::get_if<SplineField<double>>(&field_); }

  // The state between steps, to be saved and restored under these names; arrays have their sizes from the start.
  // take_velocity() comes before or after a restore.
  struct StateArray {
    std::string name;
    Array<double>* f64 = nullptr;
    Array<std::int64_t>* i64 = nullptr;
  };
  std::vector<StateArray> state();

  struct ArraySize {
    std::string name;
    double bytes;
    bool per_particle = true;  // else per point of the grid
  };
  std::vector<ArraySize> arrays() const;
  // Before any allocation: bytes that a system with these options holds.
  static double estimated_bytes(const PeriodicGrid& grid, const PointParticleOptions& options);

 private:
  Spheres spheres();
  Exclusion& cells();  // also without collisions, for measures
  // Work space for an order, valid until the next use of it; that of the collisions, where there are any.
  CellOrder& order() { return collides() ? cells().order() : order_; }

  PeriodicGrid grid_;
  PointParticleOptions options_;
  Particles particles_;
  std::variant<SplineField<double>, SplineField<float>> field_;
  LinearDeposition deposition_;
  std::optional<SelfDisturbance> disturbance_;
  std::array<Array<double>, 3> middle_;  // places at the middle of the coming step, for a force held over it
  Exclusion exclusion_;
  bool has_cells_ = false;
  CellOrder order_;
  Array<double> amounts_;  // per particle, force to be spread; and room for one number
  Array<double> clock_;    // length of the last step; steps made; largest volume fraction; rms slip of the last step
  std::vector<double> stable_step_;  // in response times, for volume fractions of k / (size - 1) of the largest
  double volume_fraction_ = 0;
  MotionStatistics motion_;
  ExclusionReport exclusion_report_;
  DepositionReport deposition_report_;
};

}  // namespace spume
