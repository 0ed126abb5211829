// SPDX-License-Identifier: MIT
#include "spume/methods/spectral/suspension.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/physics/point_particles/clustering.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::spectral {
namespace {

PeriodicGrid grid_of(const LoadedCase& loaded) {
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

// Heavy particles may be too crowded for any step: their force is then clipped below close packing.
void limit_clipping(const Case& options, PointParticleOptions& out) {
  const ParticleCaseOptions& in = options.get<ParticleCaseOptions>();
  const double bearable = stable_volume_fraction(out.motion, out.scheme, out.most_volume_fraction);
  if (bearable >= out.most_volume_fraction) return;
  if (in.max_volume_fraction != ParticleCaseOptions().max_volume_fraction) {
    char text[300];
    std::snprintf(text, sizeof text,
                  "particles.max_volume_fraction = %.4g lets the coupling of particles with beta = %.4g and the flow "
                  "grow with any step; expected at most %.3g; lower it, or leave it out",
                  out.most_volume_fraction, in.beta, bearable);
    throw refusal(options, "particles.max_volume_fraction", text);
  }
  out.most_volume_fraction = bearable;
}

ParticleSystem system_for(const LoadedCase& loaded) {
  const PointParticleOptions options = particle_options(loaded);
  try {
    return {grid_of(loaded), options};
  } catch (const InputError& error) {
    throw refusal(loaded.options, "particles", error);
  }
}

// Shortest and longest distance of the pair statistics, in grid spacings, and the range of the dimension.
constexpr double pair_range[2] = {0.05, 4};
constexpr double dimension_range[2] = {0.1, 1};
constexpr std::size_t pair_centres = 20000;
constexpr int overlap_bins = 20;

}  // namespace

double suspension_bytes(const LoadedCase& loaded, const PointParticleOptions& options) {
  const PeriodicGrid grid = grid_of(loaded);
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
  const Domain& domain = loaded.scene.domain;
  PointParticleOptions out;
  double volume = 1;
  std::array<double, 3> length{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    length[axis] = domain.upper[axis] - domain.lower[axis];
    volume *= length[axis];
  }

  PlacementOptions& placement = out.placement;
  placement.diameters = in.diameters;
  if (in.diameter > 0) placement.diameters = {in.diameter};
  if (in.diameter_over_eta > 0) placement.diameters = {in.diameter_over_eta * std::pow(nu * nu * nu / injection, 0.25)};
  placement.shares = in.shares;
  placement.seed = loaded.scene.seed;
  placement.clusters = static_cast<int>(std::min<std::int64_t>(in.clusters, 1 << 30));
  placement.cluster_radius = in.cluster_radius;
  switch (in.placement) {
    case ParticlePlacement::random:
      placement.kind = Placement::random;
      break;
    case ParticlePlacement::lattice:
      placement.kind = Placement::lattice;
      break;
    case ParticlePlacement::clustered:
      placement.kind = Placement::clustered;
      break;
    case ParticlePlacement::file:
      if (loaded.resuming) break;
      placement.kind = Placement::given;
      placement.given = read_positions(loaded);
      break;
  }

  out.count = static_cast<std::size_t>(in.count);
  if (in.volume_fraction > 0) {
    double mean = 0, shares = 0;
    for (std::size_t d = 0; d < placement.diameters.size(); ++d) {
      const double share = placement.shares.empty() ? 1 : placement.shares[d];
      mean += share * sphere_volume(placement.diameters[d]);
      shares += share;
    }
    out.count = static_cast<std::size_t>(std::llround(in.volume_fraction * volume * shares / mean));
    if (placement.kind == Placement::lattice) {
      const auto counts = lattice_counts(out.count, length);
      out.count = counts[0] * counts[1] * counts[2];
    }
  }
  if (placement.kind == Placement::given && out.count > placement.given.size())
    throw refusal(loaded.options, "particles.file",
                  "particles.file holds " + std::to_string(placement.given.size()) + " positions for " +
                      std::to_string(out.count) + " particles");

  MotionModel& motion = out.motion;
  motion.beta = in.beta;
  motion.viscosity = nu;
  motion.frozen = in.frozen;
  motion.drag = in.drag == ParticleDrag::stokes ? DragLaw::stokes : DragLaw::schiller_naumann;
  for (std::size_t axis = 0; axis < in.gravity.size(); ++axis) motion.gravity[axis] = in.gravity[axis];
  if (in.response_time > 0)
    motion.response_time = in.response_time;
  else if (in.stokes > 0)
    motion.response_time = in.stokes * std::sqrt(nu / injection);
  else
    motion.response_time = placement.diameters[0] * placement.diameters[0] / (12 * in.beta * nu);
  if (!(motion.response_time > 0) || !std::isfinite(motion.response_time))
    throw refusal(loaded.options, "particles",
                  "the response time diameter^2 / (12 beta nu) of the particles is not a finite number above 0; give "
                  "particles.response_time");

  out.coupling = in.coupling == ParticleCoupling::one_way    ? Coupling::one_way
                 : in.coupling == ParticleCoupling::two_way  ? Coupling::two_way
                 : in.coupling == ParticleCoupling::four_way ? Coupling::four_way
                                                             : Coupling::colliding;
  out.matching = in.matching_by_sorting ? MatchingMethod::sorting : MatchingMethod::rounds;
  out.collision_sweeps = static_cast<int>(in.collision_sweeps);
  out.spline_order = static_cast<int>(in.spline_order);
  out.single_precision_records = !in.double_records;
  out.most_volume_fraction = in.max_volume_fraction;
  out.sort_every = static_cast<int>(std::min<std::int64_t>(in.sort_every, 1 << 30));
  // Adams-Bashforth extrapolates from the forces at the ends of steps; the others hold the force over the coming step.
  if (loaded.options.get<SpectralOptions>().integrator != Integrator::ab2) out.scheme = {1, 0};
  if (acts_on_flow(out.coupling) && motion.beta > 0) limit_clipping(loaded.options, out);
  require_memory(loaded, out);
  return out;
}

template <class T>
Suspension<T>::Suspension(const LoadedCase& loaded, Flow<T>& flow)
    : loaded_(loaded), flow_(flow), grid_(grid_of(loaded)), system_(system_for(loaded)) {
  const auto& layout = flow.layout();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t modes = axis == 2 ? layout.modes_z : layout.points[axis];
    for (std::size_t k = 0; k < modes; ++k)
      prefilter_[axis].push_back(
          static_cast<T>(b_spline_prefilter(system_.options().spline_order, static_cast<int>(k), grid_.points[axis])));
  }
  for (auto& field : field_) field.resize(grid_.storage());
  follows_exponents_ = loaded.options.get<ParticleCaseOptions>().lyapunov > 0;
}

template <class T>
std::array<const T*, 3> Suspension<T>::velocity(Ledger& ledger) {
  const auto scope = ledger.time("velocity at points", static_cast<double>(grid_.point_count()));
  real_velocity(flow_, flow_.potential(), prefilter_, {field_[0].data(), field_[1].data(), field_[2].data()},
                grid_.z_stride);
  return read();
}

template <class T>
void Suspension<T>::start() {
  Ledger untimed;
  system_.begin(velocity(untimed));
  if (follows_exponents_)
    tracker_ = LyapunovTracker(
        *system_.double_field(), static_cast<std::size_t>(loaded_.options.get<ParticleCaseOptions>().lyapunov),
        system_.options().motion.response_time, system_.particles().common_diameter, loaded_.scene.seed + 1);
}

template <class T>
void Suspension<T>::before_step(Ledger& ledger) {
  if (!system_.couples()) return;
  system_.template feedback<T>({field_[0].data(), field_[1].data(), field_[2].data()}, ledger);
  const auto scope = ledger.time("force to modes", static_cast<double>(grid_.point_count()));
  force_modes(flow_, read(), grid_.z_stride, force_);
  if (!loaded_.options.get<ParticleCaseOptions>().mean_force_moves_fluid)
    for (auto& component : force_) component[0] = 0;
  flow_.set_force({force_[0].data(), force_[1].data(), force_[2].data()});
}

template <class T>
void Suspension<T>::after_step(double dt, Ledger& ledger) {
  system_.advance(dt, velocity(ledger), ledger);
  if (!follows_exponents_) return;
  const auto scope = ledger.time("Lyapunov exponents", static_cast<double>(tracker_.size()));
  tracker_.advance(system_.options().motion, *system_.double_field(), dt);
}

template <class T>
StepLimit Suspension<T>::limited(const StepLimit& flow) const {
  const double longest = system_.longest_step();
  return longest < flow.dt ? StepLimit{longest, "particle coupling"} : flow;
}

template <class T>
void Suspension<T>::require_possible(const StepLimit& flow) const {
  const double longest = system_.longest_step();
  if (longest * 1000 > flow.dt) return;
  const MotionModel& motion = system_.options().motion;
  char text[400];
  std::snprintf(
      text, sizeof text,
      "particles.response_time = %.3g with a mass loading of %.3g (volume fraction %.3g, density ratio %.3g): "
      "the coupling with the flow is stable with steps of %.3g alone, the flow takes %.3g; expected steps of "
      "at least a thousandth of that; raise the response time, lower the volume fraction, or take "
      "particles.coupling = \"one-way\"",
      motion.response_time, system_.volume_fraction() * motion.density_ratio(), system_.volume_fraction(),
      motion.density_ratio(), longest, flow.dt);
  throw refusal(loaded_.options,
                loaded_.options.get<ParticleCaseOptions>().stokes > 0 ? "particles.stokes" : "particles.response_time",
                text);
}

template <class T>
void Suspension<T>::add_stages(std::vector<Stage>& list) const {
  const auto add = [&list](std::string name, bool on, std::string reason) {
    list.push_back({.name = std::move(name), .reason = std::move(reason), .on = on});
  };
  const bool couples = system_.couples(), collides = system_.collides();
  const char* const no_feedback =
      excludes(system_.options().coupling) ? "particles.coupling = \"colliding\"" : "particles.coupling = \"one-way\"";
  char spread[100];
  std::snprintf(spread, sizeof spread, "force spread to eight points, clipped above %.3g, projected",
                system_.options().most_volume_fraction);
  add("particle feedback", couples, couples ? spread : no_feedback);
  add("velocity at points", true, "divided by the prefilter of the splines");
  add("particle sort", true, "every " + std::to_string(system_.options().sort_every) + " steps");
  add("particle motion", !system_.options().motion.frozen,
      system_.options().motion.frozen ? "particles.frozen" : "Maxey-Riley, exponential in the drag");
  add("particle exclusion", collides,
      collides                          ? "strongest overlaps, one per particle"
      : system_.options().motion.frozen ? "particles.frozen"
                                        : "particles.coupling is neither \"four-way\" nor \"colliding\"");
  add("Lyapunov exponents", follows_exponents_, follows_exponents_ ? "shadow trajectories" : "particles.lyapunov = 0");
}

template <class T>
void Suspension<T>::add_arrays(std::vector<ArrayInfo>& list) const {
  for (const auto& array : system_.arrays())
    list.push_back({array.name, array.bytes, array.per_particle ? system_.size() : 0});
  double fields = 0;
  for (const auto& field : field_) fields += static_cast<double>(field.capacity() * sizeof(T));
  for (const auto& modes : force_) fields += static_cast<double>(modes.capacity() * sizeof(std::complex<T>));
  list.push_back({"fields between flow and particles", fields});
}

template <class T>
void Suspension<T>::add_columns(std::vector<SeriesColumn>& list) const {
  list.insert(list.end(), {{"particle_rms_velocity", "speed"},
                           {"particle_rms_acceleration", "acceleration"},
                           {"particle_rms_slip", "speed against the fluid"},
                           {"correlation_dimension", "1"},
                           {"box_count_variance", "over that of random places"}});
  if (loaded_.options.get<ParticleCaseOptions>().overlap_samples > 0)
    list.insert(list.end(), {{"overlap_ratio", "of the volume of the particles"}, {"overlap_ratio_error", "standard"}});
  if (system_.couples())
    list.insert(list.end(), {{"particle_work", "power of the force on the flow, mean"},
                             {"clipped_force", "of |f|, by the volume fraction"},
                             {"max_volume_fraction", "at a point"}});
  if (system_.collides())
    list.insert(list.end(), {{"overlapping", "of the particles, before the collisions"},
                             {"collisions", "pairs moved apart in the step, of the particles"}});
  if (follows_exponents_) {
    for (int k = 1; k <= 6; ++k) list.push_back({"stretching_" + std::to_string(k), "log of growth since the start"});
    list.push_back({"kaplan_yorke_dimension", "since the start"});
  }
}

template <class T>
void Suspension<T>::values(std::vector<double>& row) {
  const MotionStatistics& motion = system_.motion();
  const auto x = system_.particles().positions();
  const auto n = static_cast<double>(std::max<std::size_t>(system_.size(), 1));
  const double spacing = std::min({grid_.spacing(0), grid_.spacing(1), grid_.spacing(2)});
  const PairStatistics pairs = pair_statistics(grid_.lower, grid_.length, x, system_.size(), pair_range[0] * spacing,
                                               dimension_range[1] * spacing, 16, pair_centres / 4);
  const PeriodicCells boxes = PeriodicCells::with_side(grid_.lower, grid_.length, 4 * spacing * (1 - 1e-12), 1e18);
  row.insert(row.end(), {std::sqrt(motion.mean_square_velocity), std::sqrt(motion.mean_square_acceleration),
                         std::sqrt(motion.mean_square_slip),
                         correlation_dimension(pairs, dimension_range[0] * spacing, dimension_range[1] * spacing),
                         box_count_variance(boxes, x, system_.size())});
  if (const auto samples = loaded_.options.get<ParticleCaseOptions>().overlap_samples; samples > 0) {
    const SampledValue overlap =
        system_.measure_overlap(static_cast<std::size_t>(samples), static_cast<std::uint32_t>(flow_.steps()));
    row.insert(row.end(), {overlap.value, overlap.standard_error});
  }
  if (system_.couples()) {
    const DepositionReport& report = system_.deposition();
    row.insert(row.end(), {flow_.budget().work, report.force > 0 ? report.clipped_force / report.force : 0,
                           report.most_volume_fraction});
  }
  if (system_.collides())
    row.insert(row.end(), {static_cast<double>(system_.exclusion().overlapping) / n,
                           static_cast<double>(system_.exclusion().pairs) / n});
  if (follows_exponents_) {
    const auto growth = tracker_.stretching();
    row.insert(row.end(), growth.begin(), growth.end());
    row.push_back(flow_.steps() > 0 ? kaplan_yorke_dimension(growth) : 6);
  }
}

template <class T>
ParticleSnapshot Suspension<T>::family() {
  const Particles& particles = system_.particles();
  const auto x = particles.positions(), v = particles.velocities();
  ParticleSnapshot family;
  family.name = "bubbles";
  family.size = particles.size();
  family.position = {x[0], x[1], x[2]};
  family.fields.push_back({"velocity", {v[0], v[1], v[2]}, {}});
  family.fields.push_back({"id", {}, {particles.identifier->data()}});
  if (particles.diameter != nullptr) family.fields.push_back({"diameter", {particles.diameter->data()}, {}});
  return family;
}

template <class T>
void Suspension<T>::add_headings(std::vector<Distribution>& tables) const {
  tables.push_back({"particle_pairs",
                    {{"distance", "length"},
                     {"radial_distribution", "pairs over those of random places"},
                     {"correlation", "particles within the distance of a particle"}},
                    {}});
  tables.push_back({"particle_boxes",
                    {{"side", "length"},
                     {"mean_count", "particles in a box"},
                     {"variance", "of the count, over that of random places"}},
                    {}});
  tables.push_back(
      {"particle_overlaps", {{"overlap", "of the touching distance"}, {"pairs", "probability density"}}, {}});
}

template <class T>
void Suspension<T>::add_distributions(std::vector<Distribution>& tables) {
  const std::size_t first = tables.size();
  add_headings(tables);
  const double spacing = std::min({grid_.spacing(0), grid_.spacing(1), grid_.spacing(2)});
  const double shortest = std::min({grid_.length[0], grid_.length[1], grid_.length[2]});
  const PairStatistics pairs =
      pair_statistics(grid_.lower, grid_.length, system_.particles().positions(), system_.size(),
                      pair_range[0] * spacing, std::min(pair_range[1] * spacing, 0.45 * shortest), 32, pair_centres);
  for (std::size_t b = 0; b + 1 < pairs.radius.size(); ++b)
    tables[first].values.insert(tables[first].values.end(), {std::sqrt(pairs.radius[b] * pairs.radius[b + 1]),
                                                             pairs.radial_distribution[b], pairs.correlation[b + 1]});
  for (const BoxCount& box :
       box_counts(grid_.lower, grid_.length, system_.particles().positions(), system_.size(), spacing))
    tables[first + 1].values.insert(tables[first + 1].values.end(), {box.side, box.mean, box.variance});
  const std::vector<double> overlaps = system_.overlap_histogram(overlap_bins);
  for (int b = 0; b < overlap_bins; ++b)
    tables[first + 2].values.insert(tables[first + 2].values.end(),
                                    {(b + 0.5) / overlap_bins, overlaps[static_cast<std::size_t>(b)]});
}

template <class T>
std::vector<ParticleSystem::StateArray> Suspension<T>::tracker_state() const {
  std::vector<ParticleSystem::StateArray> out;
  if (!follows_exponents_) return out;
  for (const auto& field : tracker_.particles().fields.fields())
    if (auto* f64 = std::get_if<Array<double>>(&field->values))
      out.push_back({"lyapunov_" + field->name, f64, nullptr});
  out.push_back({"lyapunov_growth", &tracker_.growth(), nullptr});
  return out;
}

template <class T>
void Suspension<T>::save(StateWriter& writer) const {
  for (const auto& array : system_.state()) {
    if (array.f64 != nullptr) writer.f64(array.name, *array.f64);
    if (array.i64 != nullptr) writer.i64(array.name, *array.i64);
  }
  for (const auto& array : tracker_state()) writer.f64(array.name, *array.f64);
}

template <class T>
void Suspension<T>::load(StateReader& reader) {
  start();
  for (const auto& array : system_.state()) {
    if (array.f64 != nullptr) reader.f64(array.name, *array.f64);
    if (array.i64 != nullptr) reader.i64(array.name, *array.i64);
  }
  system_.restored();
  for (const auto& array : tracker_state()) {
    const std::size_t wanted = array.f64->size();
    reader.f64(array.name, *array.f64);
    if (array.f64->size() != wanted) throw FileError("the checkpoint follows another number of reference particles");
  }
}

template class Suspension<double>;
template class Suspension<float>;

}  // namespace spume::spectral
