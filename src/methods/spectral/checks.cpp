// SPDX-License-Identifier: MIT
// What a case of the spectral method must satisfy beyond types and ranges.
#include <algorithm>
#include <cmath>

#include "spume/methods/spectral/options.hpp"
#include "spume/scene/draft.hpp"

namespace spume {
namespace {

const char* const axis_names[3] = {"x", "y", "z"};

void check_box(const Draft& draft, Problems& problems) {
  const Node* place = draft.node("domain");
  if (!place || draft.dimensions == 0) return;
  if (draft.dimensions != 3) {
    problems.add(*draft.node("domain.lower"), "method \"spectral\" solves three dimensions; give three entries");
    return;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = axis_names[axis];
    if (draft.periodic[axis] || !draft.usable("domain." + name)) continue;
    problems.add_key(*place, "method \"spectral\" needs a box that is periodic in " + name + "; add  " + name +
                                 " = \"periodic\"  to [domain]");
  }
}

// Points per axis, or none when the grid is at fault.
std::vector<std::int64_t> check_grid(const Draft& draft, Problems& problems) {
  if (!draft.usable("resolution.grid") || draft.grid.empty()) return {};
  const Node& node = *draft.node("resolution.grid");
  if (draft.grid.size() != 1 && draft.grid.size() != 3) {
    problems.add(node, "resolution.grid must be one number or three, found " + std::to_string(draft.grid.size()));
    return {};
  }
  for (const std::int64_t points : draft.grid) {
    if (points % 2 == 0) continue;
    problems.add(node, "resolution.grid must hold even numbers, found " + std::to_string(points) + "; take " +
                           std::to_string(points + 1));
    return {};
  }
  return draft.grid.size() == 3 ? draft.grid : std::vector<std::int64_t>(3, draft.grid[0]);
}

bool shell_holds_modes(const Draft& draft, const std::vector<std::int64_t>& grid) {
  const ForcingOptions& forcing = draft.options.get<ForcingOptions>();
  double longest = 0;
  for (std::size_t a = 0; a < 3; ++a) longest = std::max(longest, draft.upper[a] - draft.lower[a]);
  std::array<double, 3> unit{};
  std::array<std::int64_t, 3> last{};
  for (std::size_t a = 0; a < 3; ++a) {
    unit[a] = longest / (draft.upper[a] - draft.lower[a]);
    last[a] = std::min<std::int64_t>(grid[a] / 2 - 1,
                                     static_cast<std::int64_t>((forcing.wavenumber + forcing.width) / unit[a]) + 1);
  }
  for (std::int64_t i = 0; i <= last[0]; ++i)
    for (std::int64_t j = 0; j <= last[1]; ++j)
      for (std::int64_t k = 0; k <= last[2]; ++k) {
        const double wavenumber = std::hypot(static_cast<double>(i) * unit[0], static_cast<double>(j) * unit[1],
                                             static_cast<double>(k) * unit[2]);
        if (wavenumber > 0 && wavenumber >= forcing.wavenumber && wavenumber < forcing.wavenumber + forcing.width)
          return true;
      }
  return false;
}

void check_forcing(const Draft& draft, const std::vector<std::int64_t>& grid, Problems& problems) {
  const ForcingOptions& forcing = draft.options.get<ForcingOptions>();
  const Node* section = draft.node("forcing");
  if (!section || !draft.usable("forcing.kind")) return;
  const auto belongs_to = [&](const char* key, ForcingKind kind, const char* word) {
    const Node* node = draft.node(std::string("forcing.") + key);
    if (node && forcing.kind != kind)
      problems.add_key(*node, std::string("forcing.") + key + " belongs to forcing.kind = \"" + word + "\"");
  };
  for (const char* key : {"wavenumber", "width", "injection"}) belongs_to(key, ForcingKind::shell, "shell");
  belongs_to("rate", ForcingKind::linear, "linear");
  if (forcing.kind == ForcingKind::shell && !(forcing.injection > 0) && draft.usable("forcing.injection"))
    problems.add(*section, "missing key 'injection' in [forcing]; add  injection = <number>  # energy/mass/time, > 0");
  if (forcing.kind == ForcingKind::linear && !(forcing.rate > 0) && draft.usable("forcing.rate"))
    problems.add(*section, "missing key 'rate' in [forcing]; add  rate = <number>  # 1/time, > 0");
  if (forcing.kind != ForcingKind::shell || grid.empty() || draft.dimensions != 3) return;
  if (!shell_holds_modes(draft, grid))
    problems.add(*section, "the forced shell " + brief(forcing.wavenumber) + " <= |k| < " +
                               brief(forcing.wavenumber + forcing.width) +
                               " (in 2 pi / longest length) holds no mode of the grid; lower forcing.wavenumber or "
                               "widen the shell");
}

void check_initial(const Draft& draft, const std::vector<std::int64_t>& grid, Problems& problems) {
  const Node* section = draft.node("initial");
  if (!section || !draft.usable("initial.kind")) return;
  const InitialOptions& initial = draft.options.get<InitialOptions>();
  const bool waves = initial.kind == InitialKind::taylor_green || initial.kind == InitialKind::abc;
  const auto companion = [&](const char* key, bool wanted, bool required, const char* kinds, const char* example) {
    const std::string name = std::string("initial.") + key;
    const Node* node = draft.node(name);
    if (node && !wanted) problems.add_key(*node, name + " belongs to initial.kind = " + kinds + "; remove it");
    if (!node && required)
      problems.add(*section, std::string("missing key '") + key + "' in [initial]; add  " + key + " = " + example);
  };
  companion("amplitude", waves, false, "\"taylor-green\" or \"abc\"", "");
  companion("wavenumber", waves, false, "\"taylor-green\" or \"abc\"", "");
  const bool expressions = initial.kind == InitialKind::expressions, random = initial.kind == InitialKind::random;
  companion("velocity", expressions, expressions, "\"expressions\"",
            "[\"<expression>\", \"<expression>\", \"<expression>\"]");
  companion("spectrum", random, random, "\"random\"", "\"<expression of k>\"");
  companion("energy", random, random, "\"random\"", "<number>  # mean kinetic energy per mass");
  const bool file = initial.kind == InitialKind::checkpoint;
  companion("file", file, file, "\"checkpoint\"", "\"<path of a checkpoint.h5>\"");
  if (const Node* node = draft.node("initial.velocity"); node && draft.initial_velocity.size() != 3)
    problems.add(*node, "initial.velocity must have 3 entries, found " + std::to_string(draft.initial_velocity.size()));
  const std::size_t amplitudes = initial.kind == InitialKind::abc ? 3 : 1;
  if (const Node* node = draft.node("initial.amplitude");
      node && waves && draft.usable("initial.amplitude") && initial.amplitude.size() != amplitudes)
    problems.add(*node, "initial.amplitude must have " + std::to_string(amplitudes) +
                            (amplitudes == 1 ? " entry" : " entries") + " for this kind, found " +
                            std::to_string(initial.amplitude.size()));
  if (!waves || grid.empty()) return;
  const std::int64_t fewest = *std::min_element(grid.begin(), grid.end());
  if (initial.wavenumber >= fewest / 2) {
    const Node* node = draft.node("initial.wavenumber");
    problems.add(node ? *node : *section, "initial.wavenumber = " + std::to_string(initial.wavenumber) +
                                              " is not on the grid, whose largest is " +
                                              std::to_string(fewest / 2 - 1));
  }
}

}  // namespace

void check_spectral(const Draft& draft, Problems& problems) {
  check_box(draft, problems);
  const std::vector<std::int64_t> grid = check_grid(draft, problems);
  check_forcing(draft, grid, problems);
  check_initial(draft, grid, problems);
  const FluidDraft& fluid = draft.fluid;
  const bool viscous = fluid.reynolds || (fluid.viscosity && *fluid.viscosity > 0);
  if (draft.options.get<SpectralOptions>().integrator == Integrator::ab2 && !viscous &&
      draft.usable("fluid.reynolds") && draft.usable("fluid.viscosity")) {
    const Node* place = draft.node("fluid");
    const std::string text =
        "Adams-Bashforth 2 is unstable without viscosity; give fluid.reynolds, or set spectral.integrator = \"rk4\"";
    if (place)
      problems.add_key(*place, text);
    else
      problems.add(Place{1, 1}, text);
  }
  for (std::size_t k = 0; k < draft.probes.size(); ++k) {
    const ProbeKind kind = draft.probes[k].options.kind;
    const std::string name = "probe." + std::to_string(k) + ".kind";
    if (kind == ProbeKind::point || kind == ProbeKind::line || kind == ProbeKind::plane) continue;
    problems.add(*draft.node(name), name +
                                        " needs a free surface, which method \"spectral\" does not have; use "
                                        "\"point\", \"line\" or \"plane\"");
  }
}

}  // namespace spume
