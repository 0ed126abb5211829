// SPDX-License-Identifier: MIT
// Scalars that react: the components of a model in every particle, split from their transport. Within a step of the
// flow, some milliseconds, a reaction is a small change; with [biokinetics] interval reactions are made up for at once.
#pragma once

#include "spume/physics/biokinetics/integrator.hpp"
#include "spume/physics/biokinetics/options.hpp"
#include "spume/physics/scalars/scalars.hpp"

namespace spume::biokinetics {

class Sludge {
 public:
  Sludge(Scalars& scalars, const BiokineticsOptions& options);

  // A step of dt seconds; the particles react when an interval is full.
  void react(double dt);

  // The same over dt, whatever the interval, of cells with these volumes: values by the index of the scalar.
  void react_in_cells(double dt, std::vector<std::vector<double>>& values, const std::vector<double>& volumes);

  // Columns: uptake of oxygen, steps of the reactions.
  void add_columns(SeriesTable& series) const;
  void save(StateWriter& writer) const { saved_.save(writer); }
  void load(StateReader& reader) { saved_.load(reader); }

 private:
  void keep_left_out();
  void restore_left_out();

  Scalars& scalars_;
  const BiokineticsOptions& options_;
  const Integrator integrator_;
  std::vector<double*> values_;   // per component
  Array<std::int32_t> members_;   // of what belongs to no liquid
  std::vector<double> kept_;      // their values
  double pending_ = 0;            // seconds that have not reacted
  double uptake_ = 0, rate_ = 0;  // g of oxygen since the start; g/m^3/h of the last reaction
  double steps_ = 0;              // per particle, of the last reaction
  SavedNumbers saved_{"biokinetics"};
};

}  // namespace spume::biokinetics
