// SPDX-License-Identifier: MIT
// Particles in the flow of the spectral method: the fields that pass between the two, once a step each way.
//
// Before the flow's step the force of the particles goes to its modes; after it the velocity at the end of the step
// comes back, divided by the prefilter of the splines. The mean of the force is left out: a mean pressure gradient
// holds it, as the vector potential of the paper has no mean either.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "spume/methods/method.hpp"
#include "spume/methods/spectral/flow.hpp"
#include "spume/methods/spectral/flow_fields.hpp"
#include "spume/physics/point_particles/lyapunov.hpp"
#include "spume/physics/point_particles/particle_system.hpp"

namespace spume::spectral {

// What the particles of a case are: counts from volume fractions, lengths and times from Kolmogorov scales. Throws
// InputError for what no option alone shows: an unreadable file of positions, too little memory.
PointParticleOptions particle_options(const LoadedCase& loaded);

// Memory of the particles and of the fields between them and the flow, in bytes, before anything is allocated; that of
// the flow (flow_bytes) not included.
double suspension_bytes(const LoadedCase& loaded, const PointParticleOptions& options);

template <class T>
class Suspension {
 public:
  // Allocates what the coupling needs; `flow` must outlive it.
  Suspension(const LoadedCase& loaded, Flow<T>& flow);

  void start();                      // with the flow's initial state
  void before_step(Ledger& ledger);  // hands the flow its force
  void after_step(double dt, Ledger& ledger);

  // The shorter of the flow's limit and that of the coupling.
  StepLimit limited(const StepLimit& flow) const;
  // Throws InputError when the coupling would need steps far below those of the flow.
  void require_possible(const StepLimit& flow) const;

  void add_stages(std::vector<Stage>& list) const;
  void add_arrays(std::vector<ArrayInfo>& list) const;
  void add_columns(std::vector<SeriesColumn>& list) const;
  // In the order of add_columns.
  void values(std::vector<double>& row);
  ParticleSnapshot family();
  void add_tables(std::vector<RecordTable>& list) const;
  void table_rows(const std::string& name, std::vector<double>& rows);

  void save(StateWriter& writer) const;
  void load(StateReader& reader);  // after that of the flow

  const ParticleSystem& system() const { return system_; }

 private:
  std::array<const T*, 3> velocity(Ledger& ledger);
  std::array<const T*, 3> read() const { return {field_[0].data(), field_[1].data(), field_[2].data()}; }
  std::vector<ParticleSystem::StateArray> tracker_state() const;

  const LoadedCase& loaded_;
  Flow<T>& flow_;
  PeriodicGrid grid_;
  Multiplier<T> prefilter_;
  mutable ParticleSystem system_;
  std::array<Array<T>, 3> field_;  // velocity, then force, on the points
  Modes<T> force_;
  bool follows_exponents_ = false;
  mutable LyapunovTracker tracker_;
};

}  // namespace spume::spectral
