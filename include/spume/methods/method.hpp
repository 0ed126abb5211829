// SPDX-License-Identifier: MIT
// What the driver knows of a method: it advances, reports, saves and restores. It knows nothing of files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "spume/core/ledger.hpp"
#include "spume/core/saved_state.hpp"
#include "spume/io/series.hpp"
#include "spume/io/snapshot.hpp"
#include "spume/methods/probes.hpp"
#include "spume/methods/records.hpp"
#include "spume/methods/stage.hpp"

namespace spume {

class Method {
 public:
  virtual ~Method() = default;

  // Stages in their order, those that are off included; the same for the life of the method.
  virtual const std::vector<Stage>& plan() const = 0;
  virtual std::vector<ArrayInfo> arrays() const = 0;
  virtual std::size_t particle_count() const = 0;

  // Makes the state that a fresh run starts from; not called before `load`. Throws InputError.
  virtual void start() {}

  // Called once, after start() and before anything is recorded or stepped; not before `load`. May take as long as many
  // steps and says meanwhile how far it is.
  virtual void prepare(Ledger& /*ledger*/, const GoOn& /*go_on*/) {}

  virtual double time() const = 0;
  virtual std::int64_t step_count() const = 0;
  virtual StepLimit step_limit() const = 0;

  // Advances by dt. Throws StepFailure and leaves the state as it was before the call when the result is not
  // acceptable.
  virtual void step(double dt, Ledger& ledger) = 0;

  virtual std::vector<SeriesColumn> series_columns() const = 0;  // without step, t, dt: the driver adds those
  virtual void series_values(std::span<double> values) = 0;

  virtual std::vector<ParticleSnapshot> snapshot() = 0;  // pointers stay valid until the next step
  // The same, where fields that are computed for it may wait until they are asked for.
  virtual std::vector<ParticleSnapshot> snapshot_on_demand() { return snapshot(); }
  virtual std::vector<GridSnapshot> grid_snapshot() { return {}; }  // likewise
  // Of memory that a snapshot is yet to make, beside arrays().
  virtual double snapshot_bytes() const { return 0; }

  // Surfaces between phases, for a case that asks for them.
  virtual SurfaceSnapshot interface_surface() { return {}; }

  // Null where the method has no such probes: a case that wants them is refused.
  virtual FieldProbes* field_probes() { return nullptr; }
  virtual SurfaceProbes* surface_probes() { return nullptr; }

  // Every table that the method may fill, and the rows that the present state adds to one of them: values row by row,
  // appended to `rows`.
  virtual std::vector<RecordTable> tables() const { return {}; }
  virtual void table_rows(const std::string& /*name*/, std::vector<double>& /*rows*/) {}

  // Remarks since the last call; each is given once.
  virtual std::vector<Remark> take_remarks() { return {}; }

  // What must hold in this scene; columns are those of series_columns().
  virtual std::vector<Invariant> invariants() const { return {}; }

  virtual void save(StateWriter& writer) const = 0;
  virtual void load(StateReader& reader) = 0;
};

}  // namespace spume
