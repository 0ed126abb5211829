// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/particle_options.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "spume/core/error.hpp"
#include "spume/methods/spectral/flow.hpp"
#include "spume/physics/point_particles/particle_system.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::spectral {
namespace {

std::vector<std::array<double, 3>> read_positions(const LoadedCase& loaded) {
  const std::filesystem::path path =
      std::filesystem::path(loaded.options.path).parent_path() / loaded.options.get<ParticleCaseOptions>().file;
  std::ifstream file(path);
  if (!file) throw refusal(loaded.options, "particles.file", "particles.file " + path.string() + " cannot be read");
  std::vector<std::array<double, 3>> positions;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream text(line);
    std::array<double, 3> x;
    if (text >> x[0] >> x[1] >> x[2])
      positions.push_back(x);
    else if (!positions.empty())  // before the first position it is the line of column names
      throw InputError({Problem{path.string(), number, 1, "found '" + line + "'; expected three numbers x, y, z"}});
  }
  return positions;
}

// Seven particles and six growths for each reference particle.
double lyapunov_bytes(const LoadedCase& loaded) {
  return static_cast<double>(loaded.options.get<ParticleCaseOptions>().lyapunov) * (7.0 * (8 * 7 + 16) + 6 * 8);
}

void require_memory(const LoadedCase& loaded, const PointParticleOptions& options) {
  const double particles = suspension_bytes(loaded, options);
  const double needed = particles + flow_bytes(loaded.scene.grid, loaded.options.get<SpectralOptions>());
  const double machine = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (needed <= machine) return;
  if (const double followed = lyapunov_bytes(loaded); followed > 0.5 * needed) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "particles.lyapunov = %.4g reference particles and their shadows need %.3g GB, and this machine has "
                  "%.3g GB; some thousands are enough",
                  static_cast<double>(loaded.options.get<ParticleCaseOptions>().lyapunov), followed / 1e9,
                  machine / 1e9);
    throw refusal(loaded.options, "particles.lyapunov", text);
  }
  char text[200];
  std::snprintf(text, sizeof text,
                "flow and particles need %.3g GB, the particles %.3g of it, and this machine has %.3g GB; lower "
                "particles.count or resolution.grid",
                needed / 1e9, particles / 1e9, machine / 1e9);
  throw refusal(loaded.options,
                loaded.options.get<ParticleCaseOptions>().count > 0 ? "particles.count" : "particles.volume_fraction",
                text);
}

// With heavy particles no step may be stable: their force is then clipped below close packing.
void limit_clipping(const Case& options, PointParticleOptions& out) {
  const ParticleCaseOptions& in = options.get<ParticleCaseOptions>();
  const double bearable = stable_volume_fraction(out.motion, out.scheme, out.max_volume_fraction);
  if (bearable >= out.max_volume_fraction) return;
  if (in.max_volume_fraction != ParticleCaseOptions().max_volume_fraction) {
    char text[300];
    std::snprintf(text, sizeof text,
                  "particles.max_volume_fraction = %.4g lets the coupling of particles with beta = %.4g and the flow "
                  "grow with any step; expected at most %.3g; lower it, or leave it out",
                  out.max_volume_fraction, in.beta, bearable);
    throw refusal(options, "particles.max_volume_fraction", text);
  }
  out.max_volume_fraction = bearable;
}

// What the force of a particle would add to the velocity that it is proportional to, at rest: 3 pi times the mobility
// of the grid (0.089 / spacing) times the diameter, for the response time that belongs to the diameter. From 1 on
// particles that see each other and not themselves push each other off without bound.
double own_share(const PeriodicGrid& grid, const PointParticleOptions& out) {
  const SelfDisturbance disturbance({grid.spacing(0), grid.spacing(1), grid.spacing(2)}, out.kept_phase,
                                    out.motion.viscosity, out.spline_order);
  const auto mobility = disturbance.steady_mobility();
  const auto& diameters = out.placement.diameters;
  const double largest = *std::max_element(diameters.begin(), diameters.end());
  const double time = out.motion.response_time * std::pow(largest / diameters.front(), 2);
  return *std::max_element(mobility.begin(), mobility.end()) * 1.5 * sphere_volume(largest) / (out.motion.beta * time);
}

int bounded(std::int64_t value) {
  return static_cast<int>(std::min<std::int64_t>(value, 1 << 30));
}

double mean_volume(const PlacementOptions& placement) {
  double volume = 0, shares = 0;
  for (std::size_t d = 0; d < placement.diameters.size(); ++d) {
    const double share = placement.shares.empty() ? 1 : placement.shares[d];
    volume += share * sphere_volume(placement.diameters[d]);
    shares += share;
  }
  return volume / shares;
}

}  // namespace

PeriodicGrid flow_grid(const LoadedCase& loaded) {
  PeriodicGrid grid;
  const Domain& domain = loaded.scene.domain;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.lower[axis] = domain.lower[axis];
    grid.length[axis] = domain.upper[axis] - domain.lower[axis];
    grid.points[axis] = static_cast<int>(loaded.scene.grid[axis]);
  }
  grid.z_stride = loaded.scene.grid[2];
  return grid;
}

double suspension_bytes(const LoadedCase& loaded, const PointParticleOptions& options) {
  const PeriodicGrid grid = flow_grid(loaded);
  const double number = loaded.options.get<SpectralOptions>().precision == FieldPrecision::f64 ? 8 : 4;
  // Velocity or force on the points and, when the flow feels it, the force as modes.
  double fields = 3 * number * static_cast<double>(grid.storage());
  if (acts_on_flow(options.coupling))
    fields += 3 * mode_bytes(loaded.scene.grid, loaded.options.get<SpectralOptions>().precision);
  return ParticleSystem::estimated_bytes(grid, options) + lyapunov_bytes(loaded) + fields;
}

PointParticleOptions particle_options(const LoadedCase& loaded) {
  const ParticleCaseOptions& in = loaded.options.get<ParticleCaseOptions>();
  const double nu = loaded.scene.fluid.kinematic_viscosity, injection = loaded.options.get<ForcingOptions>().injection;
  const PeriodicGrid box = flow_grid(loaded);
  PointParticleOptions out;

  PlacementOptions& placement = out.placement;
  placement.kind = in.placement;
  if (placement.kind == Placement::file && loaded.resuming) placement.kind = Placement::random;  // places come later
  if (placement.kind == Placement::file) placement.given = read_positions(loaded);
  placement.diameters = in.diameters;
  if (in.diameter > 0) placement.diameters = {in.diameter};
  if (in.diameter_over_eta > 0) placement.diameters = {in.diameter_over_eta * std::pow(nu * nu * nu / injection, 0.25)};
  placement.shares = in.shares;
  placement.seed = loaded.scene.seed;
  placement.clusters = bounded(in.clusters);
  placement.cluster_radius = in.cluster_radius;

  out.count = static_cast<std::size_t>(in.count);
  if (in.volume_fraction > 0) {
    const double volume = box.length[0] * box.length[1] * box.length[2];
    out.count = static_cast<std::size_t>(std::llround(in.volume_fraction * volume / mean_volume(placement)));
    if (placement.kind == Placement::lattice) {
      const auto counts = lattice_counts(out.count, box.length);
      out.count = counts[0] * counts[1] * counts[2];
    }
  }
  if (placement.kind == Placement::file && out.count > placement.given.size())
    throw refusal(loaded.options, "particles.file",
                  "particles.file holds " + std::to_string(placement.given.size()) + " positions for " +
                      std::to_string(out.count) + " particles");

  MotionModel& motion = out.motion;
  motion.beta = in.beta;
  motion.viscosity = nu;
  motion.frozen = in.frozen;
  motion.drag = in.drag;
  std::copy(in.gravity.begin(), in.gravity.end(), motion.gravity.begin());
  motion.response_time = in.response_time > 0 ? in.response_time
                         : in.stokes > 0      ? in.stokes * std::sqrt(nu / injection)
                                              : placement.diameters[0] * placement.diameters[0] / (12 * in.beta * nu);
  if (!(motion.response_time > 0) || !std::isfinite(motion.response_time))
    throw refusal(loaded.options, "particles",
                  "the response time diameter^2 / (12 beta nu) of the particles is not a finite number above 0; give "
                  "particles.response_time");

  out.coupling = in.coupling;
  out.matching = in.matching_by_sorting ? MatchingMethod::sorting : MatchingMethod::rounds;
  out.collision_sweeps = static_cast<int>(in.collision_sweeps);
  out.spline_order = static_cast<int>(in.spline_order);
  out.single_precision_records = !in.double_records;
  out.max_volume_fraction = in.max_volume_fraction;
  out.sort_every = bounded(in.sort_every);
  // Adams-Bashforth extrapolates from the forces at the ends of steps; the others hold the force over the coming step.
  if (loaded.options.get<SpectralOptions>().integrator != Integrator::ab2) out.scheme = {1, 0};
  const bool cut = loaded.options.get<SpectralOptions>().dealiasing == Dealiasing::two_thirds;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto points = static_cast<double>(loaded.scene.grid[axis]);
    // Half a mode above the last that is kept.
    out.kept_phase[axis] = 2 * M_PI / points * ((cut ? std::ceil(points / 3) : points / 2) - 0.5);
  }
  out.remove_self_disturbance = in.remove_self_disturbance && acts_on_flow(out.coupling) && motion.beta > 0 &&
                                motion.viscosity > 0 && own_share(box, out) < 1;
  if (acts_on_flow(out.coupling) && motion.beta > 0) limit_clipping(loaded.options, out);
  require_memory(loaded, out);
  return out;
}

}  // namespace spume::spectral
