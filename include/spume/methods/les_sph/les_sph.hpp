// SPDX-License-Identifier: MIT
// Semi-implicit, weakly compressible LES-SPH of a liquid with a free surface (King et al. 2022, sections 2.1 and
// 3.1 to 3.3): fractional step with an implicit isothermal pressure.
//
// Pressure is solved for as q = p - rho a . x, a being the uniform acceleration along axes that are not periodic:
// the hydrostatic part is then represented exactly, walls have zero normal gradient of q, and a liquid at rest
// stays at rest to rounding.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "spume/methods/les_sph/liquid.hpp"
#include "spume/methods/method.hpp"

namespace spume::les_sph {

class BubbleCoupling;
class PressureSystem;
class PointSampler;

class LesSph final : public Method, public FieldProbes, public SurfaceProbes {
 public:
  explicit LesSph(const LoadedCase& loaded);
  ~LesSph() override;

  const std::vector<Stage>& plan() const override { return stages_; }
  std::vector<ArrayInfo> arrays() const override;
  std::size_t particle_count() const override { return liquid_.size(); }
  double time() const override { return liquid_.time; }
  std::int64_t step_count() const override { return liquid_.steps; }
  StepLimit step_limit() const override;
  void step(double dt, Ledger& ledger) override;
  std::vector<SeriesColumn> series_columns() const override;
  void series_values(std::span<double> values) override;
  std::vector<ParticleSnapshot> snapshot() override;
  FieldProbes* field_probes() override { return this; }
  SurfaceProbes* surface_probes() override { return this; }
  PointSample sample(const Vec3& position) override;
  double elevation(const Vec3& position) override;
  double wetted_length(const Vec3& position) override;
  double front(int axis, double height) override;
  PlaneSample plane_average(int axis, double position) override;
  // The mass; where nothing but gravity does work, the energy; the residual of the pressure.
  std::vector<Invariant> invariants() const override;
  std::vector<RecordTable> tables() const override;
  void table_rows(const std::string& name, std::vector<double>& rows) override;
  std::vector<Remark> take_remarks() override;
  void save(StateWriter& writer) const override;
  void load(StateReader& reader) override;

  const Liquid& liquid() const { return liquid_; }
  const PressureSystem& pressure_system() const { return *pressure_; }
  const BubbleCoupling* bubble_coupling() const { return bubbles_.get(); }  // null without bubbles

 private:
  void start(Ledger& ledger);  // finds the pressure of the initial velocity field
  void ensure_started();
  PointSampler& sampler();
  bool periodic() const;  // in all directions: the flow has an energy spectrum
  void add_spectrum_rows(std::vector<double>& rows) const;

  Liquid liquid_;
  std::vector<Stage> stages_;
  std::map<std::string, Array<double>> snapshot_;  // derived fields of the last snapshot
  std::unique_ptr<PressureSystem> pressure_;
  std::unique_ptr<PointSampler> sampler_;
  std::unique_ptr<BubbleCoupling> bubbles_;
};

}  // namespace spume::les_sph
