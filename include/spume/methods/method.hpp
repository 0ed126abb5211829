// SPDX-License-Identifier: MIT
// What the driver knows of a method: it advances, reports, saves and restores. It knows nothing of files.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "spume/core/array.hpp"
#include "spume/core/array_info.hpp"
#include "spume/core/ledger.hpp"
#include "spume/core/saved_state.hpp"
#include "spume/core/step_limit.hpp"
#include "spume/io/record_table.hpp"
#include "spume/io/samples.hpp"
#include "spume/io/series.hpp"
#include "spume/io/snapshot.hpp"
#include "spume/methods/stage.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

// A distribution of the present state: rows of values, written with the time in front to <name>.csv.
struct Distribution {
  std::string name;
  std::vector<SeriesColumn> columns;
  std::vector<double> values;  // row by row
};

// A statement about a column of series.csv that holds for a whole run whatever its solution, so that no reference is
// needed to judge it: what summary.json gives as a verdict. With x(t) the column, and what lies beside it, and
// s = max |scale column| + floor over the rows, the value held against the bound is
//   drift:   max |x(t) - x(0)| / |x(0)|
//   growth:  max (x(t) - x(0), 0) / s
//   largest: max |x(t)|
struct Invariant {
  enum class Kind { drift, growth, largest };
  std::string quantity;  // its name in summary.json
  Kind kind = Kind::largest;
  std::string column;
  double bound = 0;
  std::string scale_column = {};  // of growth
  double scale_floor = 0;
  std::function<double()> beside = {};  // of the present state, added to the column; lives as long as the method
};

class Method {
 public:
  virtual ~Method() = default;

  virtual std::vector<Stage> plan() const = 0;
  virtual std::vector<ArrayInfo> arrays() const = 0;
  virtual std::size_t particle_count() const = 0;

  // Makes the state that a fresh run starts from; not called before `load`. Throws InputError.
  virtual void start() {}

  virtual double time() const = 0;
  virtual std::int64_t step_count() const = 0;
  virtual StepLimit step_limit() const = 0;

  // Advances by dt. Throws StepFailure and leaves the state as it was before the call when the result is not
  // acceptable.
  virtual void step(double dt, Ledger& ledger) = 0;

  virtual std::vector<SeriesColumn> series_columns() const = 0;  // without step, t, dt: the driver adds those
  virtual void series_values(std::span<double> values) = 0;

  virtual std::vector<ParticleSnapshot> snapshot() = 0;             // pointers stay valid until the next step
  virtual std::vector<GridSnapshot> grid_snapshot() { return {}; }  // likewise
  virtual PointSample sample(const Vec3& position) = 0;
  // Height of the free surface above the bottom wall along the last axis through `position`: the highest
  // point where the kernel sum reaches 1/2; the bottom when the column is empty.
  virtual double elevation(const Vec3& position) = 0;
  // Length of that column that lies in liquid, in all its pieces.
  virtual double wetted_length(const Vec3& position) = 0;
  // Largest coordinate along `axis` where liquid of kernel sum 1/2 is found below `height` (the last axis).
  virtual double front(int axis, double height) = 0;
  // Over the plane where the coordinate along `axis` is `position`.
  virtual PlaneSample plane_average(int axis, double position) = 0;

  // Energy spectrum of the present state: E(k) at `wavenumber`, both resized; false when the method has none.
  virtual bool spectrum(std::vector<double>& /*wavenumber*/, std::vector<double>& /*energy*/) { return false; }

  // Distributions written at the times of spectra, and their names and columns without values.
  virtual std::vector<Distribution> distributions() { return {}; }
  virtual std::vector<Distribution> distribution_headings() const { return {}; }

  // What must hold in this scene; columns are those of series_columns().
  virtual std::vector<Invariant> invariants() const { return {}; }

  // What the user should know about the run as it stands, in words; each remark is given once.
  virtual std::vector<std::string> take_remarks() { return {}; }

  // Tables of its own, and the rows that the present state adds to one, row after row.
  virtual std::vector<RecordTable> tables() const { return {}; }
  virtual void table_rows(const std::string& /*name*/, std::vector<double>& /*rows*/) {}
  // What the log should know of the steps since the last call; "" for nothing.
  virtual std::string note() { return {}; }

  virtual void save(StateWriter& writer) const = 0;
  virtual void load(StateReader& reader) = 0;
};

}  // namespace spume
