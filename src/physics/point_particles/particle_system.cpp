// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/particle_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"

namespace spume {
namespace {

const PointParticleOptions& checked(const PeriodicGrid& grid, const PointParticleOptions& options) {
  const auto& diameters = options.placement.diameters;
  if (diameters.empty()) throw InputError("no particle diameter is given");
  if (!options.placement.shares.empty() && options.placement.shares.size() != diameters.size())
    throw InputError(std::to_string(options.placement.shares.size()) + " shares are given for " +
                     std::to_string(diameters.size()) + " diameters");
  const double shortest = std::min({grid.length[0], grid.length[1], grid.length[2]});
  for (const double d : diameters)
    if (!(d > 0) || !(2 * d < shortest))
      throw InputError("a particle diameter of " + std::to_string(d) +
                       " does not lie between 0 and half of the shortest side of the box, " + std::to_string(shortest));
  if (options.count > static_cast<std::size_t>(most_particles))
    throw InputError(std::to_string(options.count) + " particles; at most " + std::to_string(most_particles) +
                     " can be numbered");
  if (acts_on_flow(options.coupling) && !(options.motion.beta > 0))
    throw InputError("two-way coupling needs particles of finite density, beta > 0");
  return options;
}

double largest_of(const PointParticleOptions& options) {
  return *std::max_element(options.placement.diameters.begin(), options.placement.diameters.end());
}

ParticleArrays arrays_for(const PointParticleOptions& options) {
  const bool coupled = acts_on_flow(options.coupling);
  return {coupled, options.placement.diameters.size() > 1,
          coupled && options.remove_self_disturbance ? SelfDisturbance::bands : 0};
}

// A force held over the step belongs to the places in its middle: from those of its start it would be of first order.
bool holds_force(const PointParticleOptions& options) {
  return options.scheme.memory == 0 && !options.motion.frozen;
}

}  // namespace

ParticleSystem::ParticleSystem(const PeriodicGrid& grid, const PointParticleOptions& options)
    : grid_(grid), options_(checked(grid, options)), particles_(arrays_for(options)), clock_(4) {
  particles_.common_diameter = options.placement.diameters.front();
  particles_.fields.resize(options.count);
  place_particles(options.placement, grid.lower, grid.length, particles_);
  if (options.single_precision_records)
    field_ = SplineField<float>(grid, options.spline_order);
  else
    field_ = SplineField<double>(grid, options.spline_order);
  if (couples()) {
    deposition_ = LinearDeposition(grid);
    amounts_.resize(3 * options.count + 1);
    if (options.remove_self_disturbance)
      disturbance_.emplace(std::array<double, 3>{grid.spacing(0), grid.spacing(1), grid.spacing(2)}, options.kept_phase,
                           options.motion.viscosity, options.spline_order);
    if (holds_force(options))
      for (auto& coordinate : middle_) coordinate.resize(options.count);
    constexpr int fractions = 32;
    for (int k = 0; k <= fractions; ++k)
      stable_step_.push_back(
          stable_coupling_step(options.motion, options.scheme, options.max_volume_fraction * k / fractions));
  }
  const double volume = parallel_sum(size(), [&](std::size_t i) { return sphere_volume(particles_.diameter_of(i)); });
  volume_fraction_ = volume / (grid.length[0] * grid.length[1] * grid.length[2]);
}

double ParticleSystem::largest_diameter() const {
  return largest_of(options_);
}

void ParticleSystem::separate(int most_sweeps) {
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    if (cells().match(spheres(), options_.matching).pairs == 0) return;
    exclusion_.separate(spheres());
  }
}

void ParticleSystem::start() {
  if (!options_.motion.frozen)
    std::visit(
        [&](const auto& field) {
          gather(field, size(), particles_.positions(),
                 {particles_.velocity[0]->data(), particles_.velocity[1]->data(), particles_.velocity[2]->data()},
                 nullptr);
        },
        field_);
  motion_.mean_square_velocity = parallel_sum(size(),
                                              [&](std::size_t i) {
                                                double square = 0;
                                                for (const auto* v : particles_.velocity) square += (*v)[i] * (*v)[i];
                                                return square;
                                              }) /
                                 static_cast<double>(std::max<std::size_t>(size(), 1));
  amounts_.fill(0);  // no step was made yet: bubbles without a force, but with their volume
}

template <class Source>
void ParticleSystem::take_velocity(const std::array<const Source*, 3>& velocity) {
  std::visit([&](auto& field) { field.fill(velocity); }, field_);
}

bool ParticleSystem::sort_due() const {
  return static_cast<std::int64_t>(clock_[1]) % options_.sort_every == 0;
}

void ParticleSystem::sort() {
  const auto x = particles_.positions();
  order().build({grid_.lower, grid_.length, grid_.points}, x[0], x[1], x[2], size());
  if (order().already_sorted()) return;
  particles_.fields.permute(order().order());
  // The step finds the forces anew; what the flow had follows only where the step asks what came of it.
  if (!disturbance_) return;
  const Array<std::int32_t>& from = order().order();
  ScratchArray<double> sorted(particles_.fields.scratch(), size());
  for (std::size_t c = 0; c < 3; ++c) {
    parallel_for(size(), [&](std::size_t i) { sorted[i] = amounts_[3 * static_cast<std::size_t>(from[i]) + c]; });
    parallel_for(size(), [&](std::size_t i) { amounts_[3 * i + c] = sorted[i]; });
  }
}

void ParticleSystem::move(double dt) {
  ForceOutput output;
  if (couples()) {
    output.amounts = amounts_.data();
    // From the middles of the last two steps to the time at which the force is wanted.
    output.extrapolation = clock_[1] > 0 ? options_.scheme.lead * dt / (0.5 * (dt + clock_[0])) : 0;
    if (disturbance_)
      // A is extrapolated by `lead` steps from F; the force of the step before is that of one step less.
      output.self = {&*disturbance_, disturbance_->step(options_.scheme, dt, clock_[0]), 1 - 1 / options_.scheme.lead};
  }
  motion_ = std::visit(
      [&](const auto& field) { return move_particles(options_.motion, field, dt, particles_, output); }, field_);
  clock_[0] = dt;
  clock_[1] += 1;
  clock_[3] = std::sqrt(motion_.mean_square_slip);
}

void ParticleSystem::collide() {
  exclusion_report_ = cells().match(spheres(), options_.matching);
  exclusion_.separate(spheres());
  std::size_t pairs = exclusion_report_.pairs;
  for (int sweep = 1; sweep < options_.collision_sweeps && pairs > 0; ++sweep) {
    pairs = exclusion_.match(spheres(), options_.matching).pairs;
    exclusion_.separate(spheres());
    exclusion_report_.pairs += pairs;
  }
}

double ParticleSystem::longest_step() const {
  if (!couples()) return std::numeric_limits<double>::infinity();
  const double last = static_cast<double>(stable_step_.size()) - 1;
  const double fraction = (clock_[2] > 0 ? clock_[2] : volume_fraction_) / options_.max_volume_fraction;
  const double steps = stable_step_[static_cast<std::size_t>(std::ceil(std::min(fraction, 1.0) * last))];
  const MotionModel& motion = options_.motion;
  const auto& diameters = options_.placement.diameters;
  const double smallest = *std::min_element(diameters.begin(), diameters.end());
  double response = motion.response_time * std::pow(smallest / diameters.front(), 2);
  // Few particles slip three times as fast as the root of the mean square.
  if (motion.drag == DragLaw::schiller_naumann)
    response /= schiller_naumann_factor(3 * clock_[3], smallest, motion.viscosity);
  return steps * response;
}

template <class Real>
void ParticleSystem::spread_force(const std::array<Real*, 3>& force, double dt) {
  std::array<const double*, 3> places = particles_.positions();
  if (holds_force(options_)) {
    parallel_for(size(), [&](std::size_t i) {
      for (int c = 0; c < 3; ++c)
        middle_[c][i] = wrap_periodic((*particles_.position[c])[i] + dt / 2 * (*particles_.velocity[c])[i],
                                      grid_.lower[c], grid_.length[c]);
    });
    places = {middle_[0].data(), middle_[1].data(), middle_[2].data()};
  }
  const DepositedParticles given{places, amounts_.data(),
                                 particles_.diameter == nullptr ? nullptr : particles_.diameter->data(),
                                 particles_.common_diameter};
  order().build(deposition_.cells(), given.position[0], given.position[1], given.position[2], size());
  deposition_report_ = deposition_.deposit<Real>(order(), given, options_.max_volume_fraction, force, nullptr);
  clock_[2] = deposition_report_.most_volume_fraction;
}

Spheres ParticleSystem::spheres() {
  Spheres s;
  for (int c = 0; c < 3; ++c) s.position[c] = particles_.position[c]->data();
  s.diameter = particles_.diameter == nullptr ? nullptr : particles_.diameter->data();
  s.identifier = particles_.identifier->data();
  s.common_diameter = particles_.common_diameter;
  s.size = size();
  return s;
}

SampledValue ParticleSystem::measure_overlap(std::size_t samples, std::uint32_t step) {
  return overlap_ratio(cells(), spheres(), samples, options_.placement.seed, step);
}

std::vector<double> ParticleSystem::overlap_histogram(int bins) {
  return spume::overlap_histogram(cells(), spheres(), bins);
}

Exclusion& ParticleSystem::cells() {
  if (!has_cells_) exclusion_ = Exclusion(grid_.lower, grid_.length, largest_diameter());
  has_cells_ = true;
  return exclusion_;
}

double ParticleSystem::record_bytes() const {
  return std::visit([](const auto& field) { return field.bytes(); }, field_);
}

std::vector<ParticleSystem::StateArray> ParticleSystem::state() {
  std::vector<StateArray> out;
  for (const auto& field : particles_.fields.fields()) {
    StateArray array{"particle_" + field->name};
    if (auto* f64 = std::get_if<Array<double>>(&field->values)) array.f64 = f64;
    if (auto* i64 = std::get_if<Array<std::int64_t>>(&field->values)) array.i64 = i64;
    out.push_back(array);
  }
  out.push_back({"particle_clock", &clock_, nullptr});
  if (couples()) out.push_back({"particle_amounts", &amounts_, nullptr});
  return out;
}

std::vector<ParticleSystem::ArraySize> ParticleSystem::arrays() const {
  std::vector<ArraySize> out{{"particle state", particles_.fields.bytes()},
                             {"particle order", order_.bytes()},
                             {"velocity records", record_bytes(), false}};
  if (couples()) {
    double forces = 8.0 * static_cast<double>(amounts_.capacity());
    for (const auto& coordinate : middle_) forces += 8.0 * static_cast<double>(coordinate.capacity());
    out.push_back({"particle forces", forces});
    out.push_back({"force on the points", deposition_.bytes(), false});
  }
  if (has_cells_) out.push_back({"particle exclusion", exclusion_.bytes()});
  return out;
}

double ParticleSystem::estimated_bytes(const PeriodicGrid& grid, const PointParticleOptions& options) {
  const auto n = static_cast<double>(options.count);
  const bool couples = acts_on_flow(options.coupling), collides = excludes(options.coupling) && !options.motion.frozen;
  // State, room to sort a field in, and the order by cells, which collisions share.
  double per_particle = 8 * 7 + 8 + 18;
  if (options.placement.diameters.size() > 1) per_particle += 8;
  if (couples) per_particle += 8 * 3 + 8 * 3;
  if (couples && options.remove_self_disturbance) per_particle += 8 * 3 * SelfDisturbance::bands + 8 * 3;
  if (couples && holds_force(options)) per_particle += 8 * 3;
  if (collides) per_particle += 16 + 4 + 12 + 2;
  double points = 1;
  for (int axis = 0; axis < 3; ++axis) points *= grid.points[axis] + options.spline_order - 1;
  return per_particle * n + 4.0 * static_cast<double>(grid.point_count()) +
         points * (options.single_precision_records ? 32 : 64);
}

template void ParticleSystem::take_velocity(const std::array<const double*, 3>&);
template void ParticleSystem::take_velocity(const std::array<const float*, 3>&);
template void ParticleSystem::spread_force(const std::array<double*, 3>&, double);
template void ParticleSystem::spread_force(const std::array<float*, 3>&, double);

}  // namespace spume
