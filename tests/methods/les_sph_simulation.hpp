// SPDX-License-Identifier: MIT
// les-sph on tiny cases: a case from text, its method, and its state in the order of the identifiers.
#pragma once

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "methods/uncounted_stages.hpp"
#include "scene/helpers.hpp"
#include "spume/core/error.hpp"
#include "spume/methods/les_sph/les_sph.hpp"
#include "spume/methods/les_sph/step.hpp"

namespace spume::test {

using Overrides = std::vector<std::string>;

// One wavelength of deep water in two dimensions, 50 particles long; what follows says where the liquid is.
inline const std::string wave_tank = R"toml(method = "les-sph"
[domain]
lower = [0, -0.5]
upper = [1, 0.5]
x = "periodic"
bottom = "free-slip"
[resolution]
spacing = 0.02
[fluid]
reynolds = 4e4
froude = 1
mach = 0.05
)toml";

// One value per particle and component, by identifier.
struct State {
  int dimensions = 0;
  std::vector<Vec3> position, velocity;
  std::vector<double> pressure;
  bool operator==(const State&) const = default;
};

// One thread for a test that counts allocations: threads keep room of their own for lists, a few blocks long, and which
// of them meets its first large block when is a matter of chance.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

struct Simulation {
  LoadedCase loaded;
  les_sph::LesSph method;
  Ledger ledger;

  explicit Simulation(const std::string& text, const Overrides& overrides = {})
      : loaded(load_text(text, overrides)), method(loaded) {}
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  void steps(int count, double dt) {
    for (int k = 0; k < count; ++k) method.step(dt, ledger);
  }
  State state() const {
    const les_sph::Flow& flow = method.flow();
    State s;
    s.dimensions = flow.dimensions;
    s.position.resize(flow.size());
    s.velocity.resize(flow.size());
    s.pressure.resize(flow.size());
    for (std::size_t i = 0; i < flow.size(); ++i) {
      const auto k = static_cast<std::size_t>((*flow.particles.identifier)[i]);
      s.position[k] = vector_at(flow.particles.position, flow.dimensions, i);
      s.velocity[k] = vector_at(flow.particles.velocity, flow.dimensions, i);
      s.pressure[k] = (*flow.pressure)[i];
    }
    return s;
  }
  std::map<std::string, double> series() {
    const auto columns = method.series_columns();
    std::vector<double> values(columns.size());
    method.series_values(values);
    std::map<std::string, double> result;
    for (std::size_t k = 0; k < columns.size(); ++k) result[columns[k].name] = values[k];
    return result;
  }
};

// A flow whose stages a test runs one after the other.
struct StagedFlow {
  LoadedCase loaded;
  les_sph::Flow flow;
  Plan plan;

  explicit StagedFlow(const std::string& text, const Overrides& overrides = {})
      : loaded(load_text(text, overrides)), flow(loaded), plan(les_sph::make_plan(flow)) {}
  StagedFlow(const StagedFlow&) = delete;
  StagedFlow& operator=(const StagedFlow&) = delete;

  // Runs the stages of a step that come before `last`, or those of the start.
  void run_before(const std::string& last, double dt) { run_stages(plan.stages(), last, dt); }
  void start_before(const std::string& last) { run_stages(plan.stages(), last, 0, StagePart::start); }
  static void run_stages(const std::vector<Stage>& stages, const std::string& last, double dt,
                         StagePart part = StagePart::step) {
    for (const Stage& stage : stages) {
      if (stage.name == last) return;
      StageRun run{.dt = dt};
      if (stage.on && (stage.part == part || stage.part == StagePart::both)) stage.work(run);
    }
    throw std::logic_error("no stage '" + last + "'");
  }
};

inline double max_speed(const State& s) {
  double most = 0;
  for (const Vec3& u : s.velocity) most = std::max(most, std::hypot(u[0], u[1], u[2]));
  return most;
}

// A checkpoint in memory.
class MemoryState final : public StateWriter, public StateReader {
 public:
  void f64(const std::string& name, std::span<const double> values) override {
    f64_[name] = {values.begin(), values.end()};
  }
  void i64(const std::string& name, std::span<const std::int64_t> values) override {
    i64_[name] = {values.begin(), values.end()};
  }
  void f64(const std::string& name, Array<double>& values) override { copy(f64_, name, values); }
  void i64(const std::string& name, Array<std::int64_t>& values) override { copy(i64_, name, values); }

  // Every number of the state; arrays of particles and of bubbles in the order of their identifiers, as a step may sort
  // them without changing the state.
  std::map<std::string, std::vector<double>> in_order_of_identifiers() const {
    std::map<std::string, std::vector<double>> state = f64_;
    for (const auto& [name, values] : i64_) state[name].assign(values.begin(), values.end());
    for (const std::string family : {"", "bubble_"}) {
      const auto found = i64_.find(family + "identifier");
      if (found == i64_.end()) continue;
      const std::vector<std::int64_t>& identifier = found->second;
      std::vector<std::size_t> order(identifier.size());
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
      std::sort(order.begin(), order.end(),
                [&](std::size_t a, std::size_t b) { return identifier[a] < identifier[b]; });
      for (auto& [name, values] : state) {
        if (values.size() != order.size() || name.starts_with("bubble_") != (family == "bubble_")) continue;
        std::vector<double> sorted(values.size());
        for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = values[order[i]];
        values = sorted;
      }
    }
    return state;
  }

 private:
  template <class T>
  static void copy(const std::map<std::string, std::vector<T>>& from, const std::string& name, Array<T>& values) {
    const auto found = from.find(name);
    if (found == from.end()) throw FileError("no array '" + name + "'");
    values.resize(found->second.size());
    std::copy(found->second.begin(), found->second.end(), values.begin());
  }
  std::map<std::string, std::vector<double>> f64_;
  std::map<std::string, std::vector<std::int64_t>> i64_;
};

// Runs some steps, then one whose pressure cannot converge: what is wrong with the state after it, nothing or a name.
inline std::string changed_by_a_refused_step(const std::string& text, const Overrides& overrides, double dt) {
  Simulation run(text, overrides);
  run.steps(3, dt);
  MemoryState saved;
  run.method.save(saved);
  Overrides impossible = overrides;
  impossible.insert(impossible.end(), {"pressure.max_iterations=1", "pressure.tolerance=1e-14"});
  Simulation strict(text, impossible);
  strict.method.load(saved);
  EXPECT_THROW(strict.steps(1, dt), StepFailure);
  MemoryState after;
  strict.method.save(after);
  const auto a = saved.in_order_of_identifiers(), b = after.in_order_of_identifiers();
  EXPECT_GT(a.size(), 5U);
  std::string changed;
  for (const auto& [name, values] : a)
    if (b.at(name) != values) changed += name + " ";
  return changed;
}

// --- cases, all about one unit across

// Vortices in a doubly periodic square, 20 x 20 particles.
inline const std::string taylor_green = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
x = "periodic"
y = "periodic"
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
[[liquid]]
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
[time]
end = 1
)toml";

// Vortices in a triply periodic cube, 10^3 particles.
inline const std::string taylor_green_3d = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [1, 1, 1]
x = "periodic"
y = "periodic"
z = "periodic"
[resolution]
spacing = 0.1
[fluid]
reynolds = 100
[[liquid]]
velocity = ["sin(2*pi*x)*cos(2*pi*y)*cos(2*pi*z)", "-cos(2*pi*x)*sin(2*pi*y)*cos(2*pi*z)", "0"]
[time]
end = 1
)toml";

// A square box full of liquid.
inline const std::string closed_box = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
left = "no-slip"
right = "no-slip"
bottom = "no-slip"
top = "no-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
froude = 1
[[liquid]]
[time]
end = 1
max_step = 0.005
)toml";

// A square box of liquid under a moving lid.
inline const std::string cavity = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1]
left = "no-slip"
right = "no-slip"
bottom = "no-slip"
top = "no-slip"
[domain.wall_velocity]
top = ["1", "0"]
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
[[liquid]]
[time]
end = 20
)toml";

// A stream along x between two walls.
inline const std::string channel = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [0.5, 1]
x = "periodic"
bottom = "no-slip"
top = "no-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 100
[[liquid]]
velocity = ["1", "0"]
[time]
end = 1
)toml";

// Still water in a tank; the uppermost particles lie on the surface.
inline const std::string tank = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [1, 1.5]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 1000
froude = 1
[[liquid]]
where = "1 - y"
conform = true
[time]
end = 1
max_step = 0.005
)toml";

inline const std::string dam_break = R"toml(method = "les-sph"
[domain]
lower = [0, 0]
upper = [2, 1.5]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.05
[fluid]
reynolds = 1e4
froude = 1
mach = 0.05
[[liquid]]
lower = [0, 0]
upper = [0.5, 1]
[turbulence]
model = "mixed-scale"
[time]
end = 1
)toml";

inline const std::string dam_break_3d = R"toml(method = "les-sph"
[domain]
lower = [0, 0, 0]
upper = [1, 0.7, 1]
left = "free-slip"
right = "free-slip"
front = "free-slip"
back = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.1
[fluid]
reynolds = 1e4
froude = 1
[[liquid]]
lower = [0, 0, 0]
upper = [0.5, 0.7, 0.8]
[time]
end = 1
)toml";

// A spinning square without walls or gravity.
inline const std::string square_patch = R"toml(method = "les-sph"
[domain]
lower = [-1, -1]
upper = [1, 1]
[resolution]
spacing = 0.05
[fluid]
mach = 0
[[liquid]]
lower = [-0.5, -0.5]
upper = [0.5, 0.5]
velocity = ["y", "-x"]
[time]
end = 1
)toml";

}  // namespace spume::test
