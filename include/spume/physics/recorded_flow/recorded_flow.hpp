// SPDX-License-Identifier: MIT
// A statistically steady flow as what it exchanges between cells: seconds of flow are recorded, days of biology follow.
//
// Particles are marked with the cell A that they are in, and counted in the cell B that they are in a lag later. The
// shares P_AB of what leaves A are the transition probabilities of a Markov chain (Ulam's method; compartment models
// take them from mean flows and an assumed diffusivity). Particles have one volume, so that mean flow and fluctuations
// of every resolved scale are in P as they were. With the stationary volumes V = V P a step of one lag is
//   V_B c_B' = sum_A V_A P_AB c_A
// which keeps amounts, uniform concentrations and the range of the values, to rounding, whatever the record.
//
// Sources of oxygen are recorded as the means of k_L A and of k_L A c* per cell: dc/dt = (k_L A c* - k_L A c) / V, in
// closed form over half a lag before the reactions, and over the other half behind them.
//
// What is left out: a particle forgets where in its cell it was, and flow that changes slower than the record.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "spume/core/saved_state.hpp"
#include "spume/physics/biokinetics/sludge.hpp"
#include "spume/physics/oxygen/oxygen.hpp"
#include "spume/physics/recorded_flow/options.hpp"
#include "spume/physics/scalars/scalars.hpp"

namespace spume {

class RecordedFlow {
 public:
  static constexpr double most_cells = 2000;  // 32 MB of counts
  static double cells_along(double length, double longest_side);

  // Adds the marks to the state of the particles. All outlive it. `oxygen`, `sludge`: null without.
  RecordedFlow(ParticleStore& particles, const Scene& scene, const RecordedFlowOptions& options, Scalars& scalars,
               oxygen::Oxygen* oxygen, biokinetics::Sludge* sludge);

  // Whether the record, complete at time t, carries what is dissolved.
  bool carries() const { return complete_; }
  bool records(double t) const { return !complete_ && t >= start_ * (1 - slack); }
  // The longest step from t on that meets the marks, at most dt; while the record carries, any.
  double step(double t, double dt) const;

  // A step of dt up to t, of particles as they are then; `bubbles`: null without.
  void record(double t, double dt, const oxygen::Supply* bubbles);
  // From t on over dt: as many whole lags as are due.
  void advance(double t, double dt);

  std::size_t cells() const { return volume_.size(); }
  // Of the cells that hold liquid, in their order.
  const std::vector<double>& volumes() const { return volume_; }
  const std::vector<double>& values(std::size_t scalar) const { return values_[scalar]; }
  std::string in_words() const;
  void add_columns(SeriesTable& series) const;
  double bytes() const;
  void save(StateWriter& writer) const;
  void load(StateReader& reader);

 private:
  static constexpr double slack = 1e-9;  // of sums of steps that shall fill a lag

  std::size_t cell_at(const Vec3& place) const;
  std::size_t cell_of(std::size_t particle) const;
  double amount(std::size_t scalar) const;
  Vec3 centre(std::size_t cell) const;
  double distance_between(const Vec3& a, const Vec3& b) const;
  void mark();
  void count();
  void record_supply(double dt, const oxygen::Supply* bubbles);
  void complete();
  std::vector<std::size_t> cells_that_last() const;
  void find_volumes(const std::vector<std::size_t>& kept);
  void read_particles();
  void write_particles();
  void one_lag(double t);
  void add_sources(double t);
  void mix();
  void transfer(double dt);

  ParticleStore& particles_;
  const Scene& scene_;
  const double start_, end_, lag_;
  Scalars& scalars_;
  oxygen::Oxygen* const oxygen_;
  biokinetics::Sludge* const sludge_;
  const int dimensions_;
  std::array<std::size_t, 3> count_{1, 1, 1};  // of cells along the axes
  Vec3 side_{};
  Array<std::int64_t>* marked_ = nullptr;  // per particle

  // State.
  bool complete_ = false;
  double next_mark_ = -1;  // negative: none yet
  double elapsed_ = 0;     // of the record of the sources
  double pending_ = 0;     // time that the record has not carried yet
  double given_ = 0;       // g of oxygen by the recorded sources
  std::int64_t windows_ = 0;
  Array<double> counts_;                     // particles from A to B at [A * cells + B]
  Array<double> conductance_, capacity_;     // per cell, integrals over elapsed_
  std::vector<std::vector<double>> values_;  // per scalar and cell that holds liquid

  // By the record.
  std::vector<double> volume_;
  std::vector<std::size_t> first_, from_;  // of what flows into cell B: from_[first_[B]] ...
  std::vector<double> share_;              // V_A P_AB / V_B
  std::vector<double> k_, g_;              // k_L A / V and k_L A c* / V
  std::vector<std::size_t> place_;         // per particle as it stands, its cell among those with liquid
  std::vector<double> particles_in_;       // per cell, their number
  std::vector<double> next_;
};

}  // namespace spume
