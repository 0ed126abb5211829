// SPDX-License-Identifier: MIT
// Particles in the flow of the spectral method: the fields that pass between the two, once a step each way.
//
// Before the flow's step the force of the particles goes to its modes; after it the velocity at the end of the step
// comes back, divided by the prefilter of the splines. The mean of the force is left out: a mean pressure gradient
// holds it, as the vector potential of the paper has no mean either.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "spume/methods/method.hpp"
#include "spume/methods/spectral/flow.hpp"
#include "spume/methods/spectral/flow_fields.hpp"
#include "spume/physics/point_particles/lyapunov.hpp"
#include "spume/physics/point_particles/particle_system.hpp"

namespace spume::spectral {

template <class T>
class Suspension {
 public:
  // Allocates what the coupling needs; `flow` must outlive it.
  Suspension(const LoadedCase& loaded, Flow<T>& flow);

  // The parts of a step, in this order; the sort, the motion and the collisions are those of system().
  void spread_force(StageRun& run);  // of the particles to the points
  void force_to_modes();             // hands the flow its force
  void velocity_to_points();         // of the flow, divided by the prefilter of the splines
  void fill_records();               // of the velocity, for the particles
  void follow_exponents(StageRun& run);
  // After velocity_to_points and fill_records of the flow's initial state.
  void separate_particles();  // of the start
  void start_particles();

  // True before the first step of particles that act on the flow. It is made twice: the second time with the force that
  // the first found, from the state that copy_state gave.
  bool lacks_force() const { return system_.couples() && system_.steps() == 0 && !has_first_force_; }
  struct StateCopy {
    std::vector<Array<double>> f64;
    std::vector<Array<std::int64_t>> i64;
  };
  StateCopy copy_state() const;
  void take_back_first_step(const StateCopy& start);

  // The shorter of the flow's limit and that of the coupling.
  StepLimit limited(const StepLimit& flow) const;
  // Throws InputError when the coupling would need steps far below those of the flow.
  void require_possible(const StepLimit& flow) const;

  void add_arrays(std::vector<ArrayInfo>& list) const;
  void add_columns(std::vector<SeriesColumn>& list) const;
  // In the order of add_columns.
  void values(std::span<double> row);
  std::vector<Invariant> invariants() const;
  ParticleSnapshot snapshot();
  void add_tables(std::vector<RecordTable>& list) const;
  void table_rows(const std::string& name, std::vector<double>& rows);

  void save(StateWriter& writer) const;
  void load(StateReader& reader);  // after that of the flow

  const ParticleSystem& system() const { return system_; }
  ParticleSystem& system() { return system_; }
  const std::array<Array<T>, 3>& field() const { return field_; }
  const Modes<T>& force() const { return force_; }
  bool follows_exponents() const { return follows_exponents_; }

 private:
  struct Column {
    SeriesColumn heading;
    std::function<double()> read;
  };
  void make_columns();
  double dimension(double spacing) const;  // of the set that the particles cluster on
  void measure();                          // what columns read and no step leaves behind
  std::array<T*, 3> values_on_points();
  std::vector<ParticleSystem::StateArray> state() const;

  const LoadedCase& loaded_;
  Flow<T>& flow_;
  PeriodicGrid grid_;
  Multiplier<T> prefilter_;
  mutable ParticleSystem system_;
  std::array<Array<T>, 3> field_;  // velocity, then force, on the points
  Modes<T> force_;
  bool follows_exponents_ = false;
  bool has_first_force_ = false;
  mutable LyapunovTracker tracker_;
  std::vector<Column> columns_;
  struct {
    double dimension = 0, box_variance = 0;
    SampledValue overlap;
    std::array<double, 6> stretching{};
  } measured_;
};

}  // namespace spume::spectral
