// SPDX-License-Identifier: MIT
// Incompressible flow of several phases by generalised finite differences (Joubert, Wilke and Pizette): what the driver
// knows of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spume/methods/gfd/flow.hpp"
#include "spume/methods/method.hpp"
#include "spume/particles/body_forces.hpp"
#include "spume/particles/output_fields.hpp"
#include "spume/particles/phase_sums.hpp"
#include "spume/particles/point_sampler.hpp"
#include "spume/particles/work_of_bodies.hpp"

namespace spume::gfd {

// The stages of a flow, which outlives the plan.
Plan make_plan(Flow& flow);

const std::vector<OutputField<Flow>>& output_fields();

class Gfd final : public Method, public FieldProbes {
 public:
  explicit Gfd(const LoadedCase& loaded);

  const std::vector<Stage>& plan() const override { return plan_.stages(); }
  std::vector<ArrayInfo> arrays() const override;
  std::size_t particle_count() const override { return flow_.size(); }
  double time() const override { return flow_.time; }
  std::int64_t step_count() const override { return flow_.steps; }
  StepLimit step_limit() const override;
  void step(double dt, Ledger& ledger) override;
  std::vector<SeriesColumn> series_columns() const override { return series_.columns(); }
  void series_values(std::span<double> values) override;
  std::vector<ParticleSnapshot> snapshot() override { return completed(snapshot_on_demand()); }
  std::vector<ParticleSnapshot> snapshot_on_demand() override;
  SurfaceSnapshot interface_surface() override;
  std::vector<RecordTable> tables() const override;  // forces on bodies
  void table_rows(const std::string& name, std::vector<double>& rows) override;
  FieldProbes* field_probes() override { return this; }
  Vec3 carried(std::size_t motion, const Vec3& start) const override {
    return flow_.boundary.bodies()->moving(motion).place.now(start);
  }
  PointSample sample(const Vec3& position) override { return sampler().sample(position); }
  PlaneSample plane_average(int axis, double position) override { return sampler().plane_average(axis, position); }
  std::vector<Remark> take_remarks() override;
  // The volume of each phase; momentum and energy where nothing else gives any; the residual of the pressure.
  std::vector<Invariant> invariants() const override;
  void save(StateWriter& writer) const override;
  void load(StateReader& reader) override;

  const Flow& flow() const { return flow_; }

 private:
  // Finds the arrangement and the interfaces of a state that no step has left, for who looks at it.
  void ensure_arranged();
  void declare_series();
  std::vector<SurfaceForce> forces_on_bodies();  // which the work of those that move is summed of
  const PointSampler& sampler();

  Ledger start_ledger_;  // of an arrangement that came before the first step
  Flow flow_;
  Plan plan_;
  SeriesTable series_;
  SnapshotTable snapshot_;
  SavedNumbers saved_{"scalars"};
  PhaseSums phase_sums_;  // of the row of the series that is being read
  PointSampler sampler_;
  std::unique_ptr<const BodyForces> body_forces_;  // null without walls of bodies
  std::optional<WorkOfBodies> work_of_bodies_;     // where bodies move and it can be told
  bool arranged_ = false;
  std::int64_t sampled_step_ = -1;
};

}  // namespace spume::gfd
