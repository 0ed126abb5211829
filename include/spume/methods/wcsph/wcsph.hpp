// SPDX-License-Identifier: MIT
// Multiphase weakly compressible SPH (Meister and Rauch 2015, Monaghan 2013): what the driver knows of it.
#pragma once

#include <vector>

#include "spume/methods/method.hpp"
#include "spume/methods/wcsph/flow.hpp"
#include "spume/particles/body_forces.hpp"
#include "spume/particles/output_fields.hpp"
#include "spume/particles/phase_sums.hpp"
#include "spume/particles/point_sampler.hpp"
#include "spume/particles/reports.hpp"

namespace spume::wcsph {

// The stages of a flow, which outlives the plan.
Plan make_plan(Flow& flow);

const std::vector<OutputField<Flow>>& output_fields();

class Wcsph final : public Method, public FieldProbes, public SurfaceProbes {
 public:
  explicit Wcsph(const LoadedCase& loaded);

  const std::vector<Stage>& plan() const override { return plan_.stages(); }
  std::vector<ArrayInfo> arrays() const override;
  std::size_t particle_count() const override { return flow_.size(); }
  double time() const override { return flow_.time; }
  std::int64_t step_count() const override { return flow_.steps; }
  StepLimit step_limit() const override;
  void prepare(Ledger& ledger, const GoOn& go_on) override;
  void step(double dt, Ledger& ledger) override;
  std::vector<SeriesColumn> series_columns() const override { return series_.columns(); }
  void series_values(std::span<double> values) override { series_.values(values); }
  std::vector<ParticleSnapshot> snapshot() override { return completed(snapshot_on_demand()); }
  std::vector<ParticleSnapshot> snapshot_on_demand() override;
  SurfaceSnapshot interface_surface() override;
  std::vector<RecordTable> tables() const override;  // bodies.csv
  void table_rows(const std::string& name, std::vector<double>& rows) override;
  FieldProbes* field_probes() override { return this; }
  PointSample sample(const Vec3& position) override { return sampler().sample(position); }
  PlaneSample plane_average(int axis, double position) override { return sampler().plane_average(axis, position); }
  SurfaceProbes* surface_probes() override { return flow_.scene.free_surface ? this : nullptr; }
  double elevation(const Vec3& position) override { return sampler().elevation(position); }
  double wetted_length(const Vec3& position) override { return sampler().wetted_length(position); }
  double front(int axis, double height) override { return sampler().front(axis, height); }
  Vec3 carried(std::size_t motion, const Vec3& start) const override {
    return given_place(flow_.scene.motions[motion], flow_.time).now(start);
  }
  // A phase that leaves the range of its sound speed.
  std::vector<Remark> take_remarks() override;
  std::vector<Invariant> invariants() const override;
  void save(StateWriter& writer) const override;
  void load(StateReader& reader) override;

  const Flow& flow() const { return flow_; }

 private:
  void find_first_forces(Ledger& ledger);
  void declare_series();
  const PointSampler& sampler();

  Flow flow_;
  Plan plan_;
  SeriesTable series_;
  SnapshotTable snapshot_;
  SavedNumbers saved_{"scalars"};
  PhaseSums phase_sums_;  // of the row of the series that is being read
  PhaseEnergies energies_;
  PointSampler sampler_;
  Array<double> sampled_pressure_;
  std::int64_t sampled_step_ = -1;                 // that the sampler has binned
  std::unique_ptr<const BodyForces> body_forces_;  // its table; null without bodies
  std::vector<bool> remarked_;                     // of the phases
};

}  // namespace spume::wcsph
