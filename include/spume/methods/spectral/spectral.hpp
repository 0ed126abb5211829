// SPDX-License-Identifier: MIT
// The spectral method: direct numerical simulation of a periodic flow (de Wit et al. 2024, appendix A). In single or
// double precision, T.
#pragma once

#include <cmath>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "spume/methods/method.hpp"
#include "spume/methods/spectral/flow.hpp"
#include "spume/methods/spectral/suspension.hpp"

namespace spume::spectral {

template <class T>
class Spectral final : public Method, public FieldProbes {
 public:
  // A field on the grid that output.fields may name. `compute` gives its components at all points, one behind the
  // other.
  struct OutputField {
    const char* name;
    std::size_t components;
    bool standard;  // written although the case lists none
    void (Spectral::*compute)(Array<T>& values);
  };
  static std::span<const OutputField> output_fields();

  explicit Spectral(const LoadedCase& loaded);
  Spectral(const Spectral&) = delete;  // the plan holds its address

  const std::vector<Stage>& plan() const override { return plan_.stages(); }
  std::vector<ArrayInfo> arrays() const override;
  std::size_t particle_count() const override;  // points of the grid
  void start() override;
  double time() const override { return flow_.time(); }
  std::int64_t step_count() const override { return flow_.steps(); }
  StepLimit step_limit() const override;
  void step(double dt, Ledger& ledger) override;
  std::vector<SeriesColumn> series_columns() const override;
  void series_values(std::span<double> values) override;
  std::vector<ParticleSnapshot> snapshot() override;
  std::vector<GridSnapshot> grid_snapshot() override;
  double snapshot_bytes() const override;
  FieldProbes* field_probes() override { return this; }
  PointSample sample(const Vec3& position) override;
  PlaneSample plane_average(int axis, double position) override;
  std::vector<Invariant> invariants() const override;  // the energy, where nothing drives the flow
  std::vector<RecordTable> tables() const override;
  void table_rows(const std::string& name, std::vector<double>& rows) override;
  std::vector<Remark> take_remarks() override { return std::exchange(remarks_, {}); }
  void save(StateWriter& writer) const override;
  void load(StateReader& reader) override;

  Flow<T>& flow() { return flow_; }
  const Suspension<T>* suspension() const { return suspension_.get(); }

 private:
  Plan make_plan();
  void set_initial_state();
  const Array<std::complex<T>>& total_pressure();  // of the present state
  bool wants(const OutputField& field) const;
  const std::vector<Array<float>>& draw(const OutputField& field);  // once a snapshot
  std::array<T*, 3> components_of(Array<T>& values) const;
  void compute_velocity(Array<T>& values);
  void compute_vorticity(Array<T>& values);
  void compute_pressure(Array<T>& values);
  void ensure_started();

  const LoadedCase& loaded_;
  Flow<T> flow_;
  std::unique_ptr<Suspension<T>> suspension_;  // null without particles
  Plan plan_;
  bool started_ = false;
  std::map<std::string, std::vector<Array<float>>> drawn_;  // components of the fields of the last snapshot
  Array<std::complex<T>> total_pressure_;                   // for probes
  std::int64_t total_pressure_step_ = -1;
  // Energy and integrals at the last row of the series: what the balance is taken over.
  std::array<double, 4> row_{};  // energy, gain, dissipation, whether there was one
  bool warned_ = false;
  std::vector<Remark> remarks_;
};

}  // namespace spume::spectral
