// SPDX-License-Identifier: MIT
// Semi-implicit, weakly compressible LES-SPH of a liquid with a free surface (King et al. 2022, sections 2.1 and
// 3.1 to 3.3): fractional step with an implicit isothermal pressure.
//
// Pressure is solved for as q = p - rho a . x, a being the uniform acceleration along axes that are not periodic:
// the hydrostatic part is then represented exactly, walls have zero normal gradient of q, and a liquid at rest
// stays at rest to rounding.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "spume/methods/les_sph/flow.hpp"
#include "spume/methods/method.hpp"
#include "spume/particles/body_forces.hpp"
#include "spume/particles/output_fields.hpp"
#include "spume/particles/point_sampler.hpp"
#include "spume/particles/reports.hpp"
#include "spume/particles/work_of_bodies.hpp"

namespace spume::les_sph {

const std::vector<OutputField<Flow>>& output_fields();

class LesSph final : public Method, public FieldProbes, public SurfaceProbes {
 public:
  explicit LesSph(const LoadedCase& loaded);

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
  FieldProbes* field_probes() override { return this; }
  SurfaceProbes* surface_probes() override { return this; }
  PointSample sample(const Vec3& position) override { return sampler().sample(position); }
  Vec3 carried(std::size_t motion, const Vec3& start) const override {
    return flow_.boundary.bodies()->moving(motion).place.now(start);
  }
  double elevation(const Vec3& position) override { return sampler().elevation(position); }
  double wetted_length(const Vec3& position) override { return sampler().wetted_length(position); }
  double front(int axis, double height) override { return sampler().front(axis, height); }
  PlaneSample plane_average(int axis, double position) override { return sampler().plane_average(axis, position); }
  // The mass; where nothing but gravity does work, the energy; the residual of the pressure.
  std::vector<Invariant> invariants() const override;
  std::vector<RecordTable> tables() const override;
  void table_rows(const std::string& name, std::vector<double>& rows) override;
  std::vector<Remark> take_remarks() override;
  void save(StateWriter& writer) const override;
  void load(StateReader& reader) override;

  const Flow& flow() const { return flow_; }

 private:
  void start(Ledger& ledger);  // finds the pressure of the initial velocity field
  void ensure_started();
  // Says where walls of bodies are less accurate than elsewhere.
  void remark_surface_at_bodies();
  void remark_edges_at_surface();
  bool lies_on_top(std::int32_t particle, const Vec3& up) const;
  void remark_wide_kernel();
  void remark_bubbles_beside_thin_bodies();
  void remark_bodies_that_collide();
  void declare_series();
  void keep_last_flow();
  void declare_saved();
  bool periodic() const;  // in all directions: the flow has an energy spectrum
  void add_spectrum_rows(std::vector<double>& rows) const;
  void add_force_rows(std::vector<double>& rows);
  std::vector<SurfaceForce> forces_on_bodies();  // which the work of those that move is summed of
  bool tells_energy() const;                     // all that gives energy to the liquid is followed
  const PointSampler& sampler();

  std::vector<Remark> remarks_;  // not yet passed on
  bool collided_ = false;        // was remarked on
  Ledger start_ledger_;          // of a start that came before the first step
  Flow flow_;
  Plan plan_;
  SeriesTable series_;
  std::size_t flow_columns_ = 0;   // of them, the first, those of the flow
  std::vector<double> last_flow_;  // their values at the last step of the flow, while a record carries
  SnapshotTable snapshot_;
  SavedNumbers saved_{"scalars"};
  FlowTotals row_;                                 // of the row of the series that is being read
  std::unique_ptr<const BodyForces> body_forces_;  // null without walls of bodies
  std::optional<WorkOfBodies> work_of_bodies_;     // of those that move as given, where it can be told
  PointSampler sampler_;
  std::int64_t sampled_step_ = -1;  // that the sampler has binned
};

}  // namespace spume::les_sph
