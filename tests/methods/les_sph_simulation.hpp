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

#include "methods/method_run.hpp"
#include "methods/uncounted_stages.hpp"
#include "scene/helpers.hpp"
#include "spume/core/error.hpp"
#include "spume/methods/les_sph/les_sph.hpp"
#include "spume/methods/les_sph/step.hpp"

namespace spume::test {

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

struct Simulation : MethodRun<les_sph::LesSph> {
  using MethodRun::MethodRun;

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

inline std::string changed_by_a_refused_step(const std::string& text, const Overrides& overrides, double dt) {
  return changed_by_a_refused_step<les_sph::LesSph>(text, overrides, dt);
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
inline const std::string taylor_green_3d = periodic_cube("les-sph", "0.1") + R"toml([fluid]
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

// A plank on water, tilted.
inline std::string plank_on_water(double density, double end = 1) {
  return R"toml(method = "les-sph"
[time]
end = )toml" +
         std::to_string(end) + R"toml(
[domain]
lower = [-1, -0.5]
upper = [1, 0.5]
left = "free-slip"
right = "free-slip"
bottom = "free-slip"
[resolution]
spacing = 0.05
[fluid]
density = 1000
viscosity = 1e-3
gravity = 10
[[liquid]]
where = "-y"
[[body]]
shape = "box"
size = [0.8, 0.3]
rotation = [10]
density = )toml" +
         std::to_string(density) + R"toml(
wall = "no-slip"
)toml";
}

}  // namespace spume::test
