// SPDX-License-Identifier: MIT
// The case: everything a case file says, typed, validated, with defaults filled in. Members are declared as options
// in src/scene/options_*.cpp, which take the default from the member's initialiser. What only some methods know stands
// in groups of options that these declare (spume/scene/method_declaration.hpp): options.get<PressureOptions>().
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "spume/core/error.hpp"
#include "spume/core/kernel_kind.hpp"
#include "spume/scene/option_groups.hpp"
#include "spume/scene/scene.hpp"

namespace spume {

struct ResolutionOptions {
  double smoothing_ratio = 1.3;  // h / spacing
  KernelKind kernel = KernelKind::wendland_c2;
};

// Radius of the kernel's support over the spacing.
inline double support_ratio(const ResolutionOptions& resolution) {
  return (resolution.kernel == KernelKind::wendland_c2 ? 2 : 3) * resolution.smoothing_ratio;
}

struct TimeOptions {
  double end = 0;
  double courant = 0;   // 0: not given; load_case then asks the method
  double max_step = 0;  // 0: none
  // Each halves the step: what is refused at 1/64 of it is not refused for its length, and another half does not help.
  int max_retries = 6;
};

struct OutputOptions {
  double every = 0;         // snapshot interval in time; 0: start and end only
  double series_every = 0;  // 0: every step
  // Wall seconds: the work that a kill may cost. Writing a million particles takes 0.36 s, a thousandth of it.
  double checkpoint_every = 300;
  double spectrum_every = 0;        // 0: no spectra
  std::vector<std::string> fields;  // empty: the method's standard set
  bool h5part_view = true;
  bool interface = false;  // surfaces between phases
};

enum class ProbeKind { point, elevation, wetted, front, line, plane };

struct ProbeOptions {
  std::string name;
  ProbeKind kind = ProbeKind::point;
  Vec3 position{};    // point; foot of the column for elevation and wetted; start of a line; a point of a plane
  Vec3 end{};         // end of a line
  int samples = 2;    // points of a line
  int axis = 0;       // front; normal of a plane
  double height = 0;  // front: looks below this height
  // Point and plane: time over which the pressure is averaged; 0: the pressure of the last step.
  double average = 0;
  // Point and line: the body that carries it, and its motion among those of the scene; none: it stands still.
  std::string moves_with = {};
  std::optional<std::size_t> motion = {};
};

enum class Units { unsaid, si, none };

struct Case : OptionGroups {
  std::string path;  // the file as given
  std::string title;
  std::string method;
  double spacing = 0;
  std::uint64_t seed = 1;
  Units units = Units::unsaid;  // of its numbers, for labels
  ResolutionOptions resolution;
  TimeOptions time;
  OutputOptions output;
  std::vector<ProbeOptions> probes;
  std::map<std::string, std::string> groups;  // derived and given groups and constants, as text, for the start-up table
  std::map<std::string, Problem> places;      // of what the case gives, by "section.key" and "section"; without a text
  std::vector<Problem> warnings;  // what the case sets and another of its values makes useless, with the place
  std::string resolved;           // the case as TOML with defaults filled in and the origin of each value in comments
};

// A scalar that point, line and plane probes record.
struct ProbeScalar {
  std::string name;  // of its columns
  std::string unit;
};

// A case and the scene that it describes.
struct LoadedCase {
  Case options;
  Scene scene;
  // That a run holds at least once its first steps are done, per particle or point of the grid: the method's estimate
  // for this case.
  double bytes_per_particle = 0;
  std::vector<ProbeScalar> probe_scalars;  // of the method: what probes record beside the velocity
  bool resuming = false;  // the state comes from a checkpoint: files that only the start reads may be gone
};

}  // namespace spume
