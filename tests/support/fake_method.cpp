// SPDX-License-Identifier: MIT
#include "support/fake_method.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <new>
#include <sstream>
#include <thread>

#include "spume/core/error.hpp"

namespace spume::test {

namespace {

struct FakeBehaviour {
  std::int64_t particles = 50;
  double dt = 0.013;
  double largest_dt = 1e30;    // steps beyond it are refused
  double fails_from = 1e30;    // every step at or after this time is refused
  double sleep = 0;            // wall seconds per step
  double memory_until = 1e30;  // the memory ends with the first step at or after this time
  bool solvable = true;        // false: what it solves before the first step fails
  std::int64_t prepares = 0;   // rounds before the first record
  bool surface = true;         // false: it has no probes of a surface
};

class FakeMethod final : public Method, public FieldProbes, public SurfaceProbes {
 public:
  FakeMethod(const FakeBehaviour& behaviour, int dimensions) : behaviour_(behaviour), dimensions_(dimensions) {
    const auto n = static_cast<std::size_t>(behaviour.particles);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      position_[axis].resize(n);
      velocity_[axis].resize(n);
    }
    id_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 0.7 * static_cast<double>(i);
      position_[0][i] = std::cos(angle);
      position_[1][i] = std::sin(angle);
      position_[2][i] = dimensions == 3 ? 0.1 * static_cast<double>(i) : 0;
      id_[i] = static_cast<std::int64_t>(i);
    }
    turn_.resize(n);
  }

  const std::vector<Stage>& plan() const override { return stages_; }
  std::vector<ArrayInfo> arrays() const override {
    return {{"position", 24.0 * static_cast<double>(id_.size())}, {"velocity", 24.0 * static_cast<double>(id_.size())}};
  }
  std::size_t particle_count() const override { return id_.size(); }
  double time() const override { return time_; }
  std::int64_t step_count() const override { return step_; }
  StepLimit step_limit() const override {
    return {behaviour_.dt * (1 + 0.3 * std::sin(10 * time_)), std::sin(10 * time_) > 0 ? "courant" : "viscous"};
  }

  void prepare(Ledger& /*ledger*/, const GoOn& go_on) override {
    for (std::int64_t k = 0; k < behaviour_.prepares; ++k) {
      turn_[0] += 1;
      if (behaviour_.sleep > 0) std::this_thread::sleep_for(std::chrono::duration<double>(behaviour_.sleep));
      if (!go_on({"round " + std::to_string(k), static_cast<double>(k + 1) / static_cast<double>(behaviour_.prepares)}))
        return;
    }
  }

  void step(double dt, Ledger& ledger) override {
    const auto scope = ledger.time("turn", static_cast<double>(id_.size()), 0, 48.0 * static_cast<double>(id_.size()));
    if (behaviour_.sleep > 0) std::this_thread::sleep_for(std::chrono::duration<double>(behaviour_.sleep));
    if (time_ >= behaviour_.memory_until) throw std::bad_alloc();
    if (time_ >= behaviour_.fails_from || dt > behaviour_.largest_dt)
      throw StepFailure({"a particle moved further than its spacing", "time.courant", 7, {0.25, 0.5, 0}, 3.5});
    const double centre = 0.1 * std::sin(time_);
    for (std::size_t i = 0; i < id_.size(); ++i) {
      velocity_[0][i] = -position_[1][i];
      velocity_[1][i] = position_[0][i] - centre;
      for (std::size_t axis = 0; axis < 2; ++axis) position_[axis][i] += dt * velocity_[axis][i];
      turn_[i] = dt * velocity_[0][i];
    }
    time_ += dt;
    if (++step_ == 2) remarks_.push_back({"two steps are done", true});
  }

  std::vector<SeriesColumn> series_columns() const override {
    return {{"radius", "m"}, {"moment", "m2"}, {"turn", "m"}};
  }
  void series_values(std::span<double> values) override {
    if (!behaviour_.solvable)
      throw StepFailure({"the pressure solve did not converge", "pressure.tolerance", -1, {0, 0, 0}, 2});
    values[0] = std::hypot(position_[0][0], position_[1][0]);
    values[1] = 0;
    for (std::size_t i = 0; i < id_.size(); ++i) values[1] += position_[0][i] * position_[0][i];
    values[2] = turn_[0];
  }
  // Of a turn about the origin; the centre oscillates, so that it does not hold.
  std::vector<Invariant> invariants() const override {
    return {{.quantity = "radius_drift", .kind = Invariant::Kind::drift, .column = "radius", .bound = 1e-3}};
  }
  std::vector<ParticleSnapshot> snapshot() override {
    ParticleSnapshot fluid{
        "fluid", id_.size(), {}, {{"velocity", {}, {}}, {"pressure", {}, {}}, {"id", {}, {}}, {"turn", {}, {}}}};
    for (int axis = 0; axis < dimensions_; ++axis) {
      fluid.position.push_back(position_[axis].data());
      fluid.fields[0].f64.push_back(velocity_[axis].data());
    }
    fluid.fields[1].f64.push_back(position_[0].data());
    fluid.fields[2].i64.push_back(id_.data());
    fluid.fields[3].f64.push_back(turn_.data());
    return {fluid};
  }
  FieldProbes* field_probes() override { return this; }
  SurfaceProbes* surface_probes() override { return behaviour_.surface ? this : nullptr; }
  PointSample sample(const Vec3& at) override { return {{at[0] + time_}, {position_[0][0], at[1], at[2]}, 1}; }
  double elevation(const Vec3& at) override { return at[0] + position_[1][0]; }
  double wetted_length(const Vec3& at) override { return at[0] - position_[1][0]; }
  double front(int axis, double height) override {
    return *std::max_element(position_[axis].begin(), position_[axis].end()) + height;
  }
  PlaneSample plane_average(int axis, double position) override {
    return {position, {time_}, {static_cast<double>(axis), position, 3}};
  }
  // One table of each kind, and one that never gets a row.
  std::vector<RecordTable> tables() const override {
    return {spectrum_table(),
            {"turns", "turns of the points", {{"t", "time"}, {"turn", "m"}}, RecordTable::When::series},
            {"places", "places of the points", {{"t", "time"}, {"id", ""}, {"x", "m"}}, RecordTable::When::output},
            {"nothing", "no rows", {{"t", "time"}}, RecordTable::When::output}};
  }
  void table_rows(const std::string& name, std::vector<double>& rows) override {
    if (name == "spectrum")
      add_spectrum(time_, std::vector<double>{1, 2}, std::vector<double>{time_, position_[0][1]}, rows);
    else if (name == "turns")
      rows.insert(rows.end(), {time_, turn_[0]});
    else if (name == "places")
      for (std::size_t i = 0; i < 2; ++i) rows.insert(rows.end(), {time_, static_cast<double>(i), position_[0][i]});
  }
  // At the start, for all to see, and after the second step, for the log.
  std::vector<Remark> take_remarks() override {
    std::vector<Remark> given;
    std::swap(given, remarks_);
    return given;
  }
  void save(StateWriter& writer) const override {
    const std::int64_t step[] = {step_};
    const double time[] = {time_};
    writer.i64("step", step);
    writer.f64("time", time);
    writer.i64("id", id_);
    for (int axis = 0; axis < 3; ++axis) {
      writer.f64("position_" + std::to_string(axis), position_[axis]);
      writer.f64("velocity/" + std::to_string(axis), velocity_[axis]);
    }
  }
  void load(StateReader& reader) override {
    Array<std::int64_t> step;
    Array<double> time;
    reader.i64("step", step);
    reader.f64("time", time);
    reader.i64("id", id_);
    for (int axis = 0; axis < 3; ++axis) {
      reader.f64("position_" + std::to_string(axis), position_[axis]);
      reader.f64("velocity/" + std::to_string(axis), velocity_[axis]);
    }
    step_ = step[0];
    time_ = time[0];
  }

 private:
  FakeBehaviour behaviour_;
  std::vector<Stage> stages_ = {{.name = "aim", .reason = "always", .part = StagePart::start},
                                {.name = "turn", .reason = "always", .part = StagePart::both},
                                {.name = "bubbles", .reason = "the case has no [bubbles]", .on = false}};
  std::vector<Remark> remarks_ = {{"the points are ready"}};
  int dimensions_;
  double time_ = 0;
  std::int64_t step_ = 0;
  Array<double> position_[3], velocity_[3];
  Array<std::int64_t> id_;
  Array<double> turn_;  // a figure of the last step, which no checkpoint holds
};

}  // namespace

LoadedCase load_fake_case(const std::string& path, const std::vector<std::string>& overrides) {
  toml::table table;
  try {
    table = toml::parse_file(path);
    for (const auto& line : overrides) {
      std::string assignment = line;
      for (const std::string prefix : {"--until ", "time."})
        if (assignment.starts_with(prefix)) assignment.erase(0, prefix.size());
      for (const auto& [key, value] : toml::parse(assignment)) table.insert_or_assign(key, value);
    }
  } catch (const toml::parse_error& error) {
    throw InputError({Problem{path, static_cast<int>(error.source().begin.line),
                              static_cast<int>(error.source().begin.column), std::string(error.description())}});
  }
  const auto number = [&](const char* key, double fallback) { return table[key].value<double>().value_or(fallback); };
  if (!table.contains("end")) throw InputError({Problem{path, 1, 1, "missing key 'end'"}});
  LoadedCase loaded;
  Case& options = loaded.options;
  options.path = path;
  options.title = table["title"].value<std::string>().value_or("Turning points");
  options.method = "fake";
  options.time.end = number("end", 0);
  options.time.max_retries = static_cast<int>(number("max_retries", 4));
  options.output.every = number("every", 0);
  options.output.series_every = number("series_every", 0);
  options.output.spectrum_every = number("spectrum_every", 0);
  options.output.checkpoint_every = number("checkpoint_every", 300);
  loaded.scene.domain.dimensions = static_cast<int>(number("dimensions", 2));
  loaded.scene.domain.upper = {1, 1, 1};
  loaded.scene.spacing = 0.1;
  loaded.probe_scalars = {{"pressure", "pressure"}};
  if (table["probes"].value<bool>().value_or(false))
    options.probes = {{"tip", ProbeKind::point, {0.5, 0.25, 0}, {}, 2, 0, 0},
                      {"gauge", ProbeKind::elevation, {0.5, 0, 0}, {}, 2, 0, 0},
                      {"toe", ProbeKind::front, {}, {}, 2, 0, 0.2},
                      {"gate", ProbeKind::plane, {0.5, 0.75, 0}, {}, 2, 1, 0},
                      {"cut", ProbeKind::line, {0, 0, 0}, {3, 4, 0}, 3, 0, 0}};
  if (const auto* idle = table.get("idle"))
    options.warnings = {{path, static_cast<int>(idle->source().begin.line), 1, "idle has no effect"}};
  for (ProbeOptions& probe : options.probes)
    if (probe.kind == ProbeKind::point || probe.kind == ProbeKind::plane) probe.average = number("average", 0);
  std::ostringstream text;
  text << table << '\n';
  options.resolved = text.str();
  return loaded;
}

std::unique_ptr<Method> make_fake_method(const LoadedCase& loaded) {
  const toml::table table = toml::parse(loaded.options.resolved);
  FakeBehaviour behaviour;
  behaviour.particles = table["particles"].value<std::int64_t>().value_or(behaviour.particles);
  behaviour.dt = table["dt"].value<double>().value_or(behaviour.dt);
  behaviour.largest_dt = table["largest_dt"].value<double>().value_or(behaviour.largest_dt);
  behaviour.fails_from = table["fails_from"].value<double>().value_or(behaviour.fails_from);
  behaviour.memory_until = table["memory_until"].value<double>().value_or(behaviour.memory_until);
  behaviour.prepares = table["prepares"].value<std::int64_t>().value_or(behaviour.prepares);
  behaviour.solvable = table["solvable"].value<bool>().value_or(behaviour.solvable);
  behaviour.surface = table["surface"].value<bool>().value_or(behaviour.surface);
  behaviour.sleep = table["sleep"].value<double>().value_or(behaviour.sleep);
  if (behaviour.particles < 0) throw InputError("the method needs particles");
  if (behaviour.particles > 1'000'000'000'000) throw std::bad_alloc();
  return std::make_unique<FakeMethod>(behaviour, loaded.scene.domain.dimensions);
}

}  // namespace spume::test
