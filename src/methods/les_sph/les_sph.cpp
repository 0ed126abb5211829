// SPDX-License-Identifier: MIT
// The step, and what the driver asks of the method.
#include "spume/methods/les_sph/les_sph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/bubble_coupling.hpp"
#include "spume/methods/les_sph/free_surface.hpp"
#include "spume/methods/les_sph/number_density.hpp"
#include "spume/methods/les_sph/point_sampler.hpp"
#include "spume/methods/les_sph/pressure_system.hpp"
#include "spume/methods/les_sph/traffic.hpp"
#include "spume/operators/energy_spectrum.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::les_sph {
namespace {

// r* is sorted with the state but found anew by every step.
bool saved(const FieldSet::Field& field) {
  return field.lifetime == Lifetime::carried && field.name.rfind("intermediate_position", 0) != 0;
}

// Half the sound speed already means density changes of an eighth, which a weakly compressible liquid leaves out.
void refuse_high_mach(const Case& options, const Liquid& liquid) {
  const double c = liquid.scene.fluid.sound_speed;
  if (!(c > 0) || liquid.max_speed <= 0.5 * c) return;
  char text[300];
  std::snprintf(text, sizeof text,
                "the liquid starts with a speed of %.4g, which is %.3g of the sound speed %.4g; a weakly compressible "
                "liquid needs at most 0.5: raise the sound speed %.3g times (fluid.sound_speed, or fluid.mach lower), "
                "or leave it out for an incompressible liquid",
                liquid.max_speed, liquid.max_speed / c, c, liquid.max_speed / (0.1 * c));
  throw refusal(options, options.places.count("fluid.mach") > 0 ? "fluid.mach" : "fluid.sound_speed", text);
}

void refuse_stirring_shift(const Case& options, const Liquid& liquid) {
  if (!liquid.plan.shifting || options.get<ShiftingOptions>().coefficient <= liquid.largest_shift) return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "shifting.coefficient is %.3g; above %.3g the shift throws the particles of a lattice from side to side "
      "instead of evening them out: lower it (0.25 is usual)",
      options.get<ShiftingOptions>().coefficient, liquid.largest_shift);
  throw refusal(options, "shifting.coefficient", text);
}

// div(2 nu S) spreads the divergence of the velocity three times as fast as div(nu grad u) does.
double diffusion_rate(const Liquid& liquid) {
  return liquid.plan.viscous_stress ? 3 : 1;
}

// The step was chosen for the eddy viscosity of the step before; the first one knew none.
void refuse_unstable_diffusion(const Liquid& liquid, double dt) {
  const double largest =
      parallel_max(liquid.size(), 0.0, [&](std::size_t i) { return double{(*liquid.eddy_viscosity)[i]}; });
  const double viscosity = liquid.scene.fluid.kinematic_viscosity + largest;
  const double h = liquid.smoothing_length;
  // 0.29 h^2 / nu on a lattice in 3-D, 0.31 in 2-D.
  if (viscosity * diffusion_rate(liquid) * dt <= 0.3 * h * h) return;
  StepFailure::Details details;
  details.cause = "the eddy viscosity has grown beyond what the step is stable with";
  details.option = "time.viscous";
  details.value = largest;
  throw StepFailure(details);
}

}  // namespace

void LesSph::step(double dt, Ledger& ledger) {
  if (!liquid_.started) start(ledger);
  sampler_.reset();  // sorting changes what its bins refer to, also when the step is refused
  Liquid& liquid = liquid_;
  const Plan& plan = liquid.plan;
  const auto n = static_cast<double>(liquid.size());
  const auto stage = [&](const char* name, auto&& work) {
    const auto scope = ledger.time(name, n);
    work();
  };
  // With the traffic that is counted for the stage.
  const auto counted_stage = [&](const char* name, double pairs, auto&& bytes, auto&& work) {
    auto scope = ledger.time(name, n, pairs);
    work();
    scope.add_bytes(bytes(liquid));
  };
  const auto pair_stage = [&](const char* name, auto&& bytes, auto&& work) {
    counted_stage(name, static_cast<double>(liquid.list.pair_count()), bytes, work);
  };
  counted_stage("move", 0, traffic::move, [&] { move_to_intermediate(liquid, dt); });
  counted_stage("sort", 0, traffic::sort, [&] { sort_particles(liquid); });
  if (plan.bubbles) stage("bubble volume", [&] { bubbles_->move(liquid, dt); });
  if (plan.images) stage("images", [&] { make_images(liquid, dt); });
  if (plan.bubbles) stage("bubble volume", [&] { bubbles_->share_volume(liquid); });
  counted_stage("neighbours", 0, traffic::neighbours, [&] { find_neighbours(liquid); });
  if (plan.shifting || plan.density_relaxation) liquid.displacement = displacement_fraction(liquid, dt);
  liquid.records.take_traffic();
  pair_stage("geometry", traffic::geometry, [&] { measure_kernel_moments(liquid); });
  if (plan.free_surface) stage("surface", [&] { find_surface(liquid); });
  liquid.records.take_traffic();
  if (plan.shifting) counted_stage("shift", 0, traffic::shift, [&] { compute_shift(liquid); });
  if (plan.velocity_gradient) pair_stage("gradients", traffic::gradients, [&] { differentiate_velocity(liquid); });
  if (plan.shift_curvature)
    pair_stage("shift curvature", traffic::shift_curvature, [&] { find_shift_curvature(liquid); });
  if (plan.eddy_viscosity)
    counted_stage("eddy viscosity", 0, traffic::eddy_viscosity, [&] {
      find_eddy_viscosity(liquid, dt);
      refuse_unstable_diffusion(liquid, dt);
    });
  if (plan.bubbles) stage("bubble forces", [&] { bubbles_->exchange_momentum(liquid, dt); });
  liquid.records.take_traffic();
  pair_stage("prediction", traffic::prediction, [&] { predict_velocity(liquid, dt); });
  pressure_->solve_step(liquid, dt, ledger);
  pair_stage("projection", traffic::projection, [&] { project_velocity(liquid, dt); });
  counted_stage("accept", 0, traffic::accept, [&] { accept(liquid, dt); });
  if (plan.bubbles) stage("bubble events", [&] { bubbles_->accept(liquid, dt); });
}

LesSph::LesSph(const LoadedCase& loaded) : liquid_(loaded), pressure_(std::make_unique<PressureSystem>(liquid_)) {
  refuse_high_mach(loaded.options, liquid_);
  refuse_stirring_shift(loaded.options, liquid_);
  if (liquid_.plan.bubbles) bubbles_ = std::make_unique<BubbleCoupling>(liquid_);
}

LesSph::~LesSph() = default;

// A Helmholtz step needs p^n: without this solve the first step would start from zero pressure.
void LesSph::start(Ledger& ledger) {
  if (liquid_.size() > 0) {
    move_to_intermediate(liquid_, 0);
    sort_particles(liquid_);
    if (bubbles_) {
      bubbles_->start(liquid_);
      bubbles_->move(liquid_, 0);
    }
    if (liquid_.plan.images) make_images(liquid_, 0);
    if (bubbles_) bubbles_->share_volume(liquid_);
    find_neighbours(liquid_);
    measure_kernel_moments(liquid_);
    if (liquid_.plan.free_surface) find_surface(liquid_);
    differentiate_velocity(liquid_);
    if (bubbles_) liquid_.bubble_viscosity.resize(liquid_.size());
    predict_velocity(liquid_, 0);  // for the potential of the uniform acceleration
    pressure_->solve_initial(liquid_, ledger);
    start_energy(liquid_);
    if (!liquid_.plan.velocity_gradient) liquid_.strain->release();
  }
  liquid_.started = true;
}

void LesSph::ensure_started() {
  Ledger unrecorded;
  if (!liquid_.started) start(unrecorded);
}

std::vector<Stage> LesSph::plan() const {
  return liquid_.plan.stages(liquid_.loaded);
}

std::vector<ArrayInfo> LesSph::arrays() const {
  std::vector<ArrayInfo> list;
  for (const auto& field : liquid_.fields.fields())
    list.push_back(
        {field->name,
         std::visit([](const auto& array) { return static_cast<double>(array.capacity() * sizeof(array[0])); },
                    field->values)});
  list.push_back({"cell table", liquid_.table.bytes()});
  list.push_back({"images", liquid_.images.bytes()});
  list.push_back({"neighbour lists", liquid_.list.bytes()});
  list.push_back({"sweep records", liquid_.records.bytes()});
  list.push_back({"pressure system", pressure_->bytes()});
  list.push_back({"gradient corrections left out", liquid_.uncorrected.bytes()});
  if (liquid_.dynamic_closure()) {
    double products = 0;
    for (const auto& array : liquid_.test_filter_scratch) products += array.bytes();
    list.push_back({"test filter", products});
  }
  if (liquid_.plan.moving_walls) {
    double velocities = 0;
    for (const auto* rule : {&liquid_.velocity_rule, &liquid_.mirror_rule})
      for (const auto& array : rule->offset) velocities += array.bytes();
    list.push_back({"velocities of images", velocities});
  }
  if (bubbles_) {
    double sizes = 0;
    for (const auto* array : {&liquid_.next_volume_fraction, &liquid_.length_ratio, &liquid_.volume_ratio,
                              &liquid_.support_radius, &liquid_.bubble_viscosity})
      sizes += array->bytes();
    list.push_back({"sizes of particles", sizes});
  }
  if (liquid_.plan.free_surface) {
    double surface = liquid_.layer_shift.bytes();
    for (const auto* flags : {&liquid_.at_surface, &liquid_.pressure_fixed, &liquid_.beside_edge})
      surface += flags->bytes();
    for (const auto* values : {&liquid_.interior_weight, &liquid_.surface_depth}) surface += values->bytes();
    for (const auto* numbers : {&liquid_.surface_particles, &liquid_.near_surface, &liquid_.upper_particles})
      surface += numbers->bytes();
    list.push_back({"surface", surface});
  }
  if (bubbles_)
    for (const ArrayInfo& array : bubbles_->arrays()) list.push_back(array);
  return list;
}

StepLimit LesSph::step_limit() const {
  const double h = liquid_.smoothing_length;
  const TimeOptions& options = liquid_.options.time;
  Vec3 force = liquid_.scene.fluid.gravity;
  if (liquid_.scene.body_force && liquid_.uniform_body_force) {
    const Vec3 beside = (*liquid_.scene.body_force)(liquid_.origin, liquid_.time);
    for (int axis = 0; axis < liquid_.dimensions; ++axis) force[axis] += beside[axis];
  }
  double acceleration2 = 0;
  for (const double a : force) acceleration2 += a * a;
  const bool varying_force = liquid_.scene.body_force && !liquid_.uniform_body_force;
  acceleration2 = std::max(acceleration2, liquid_.largest_body_force * liquid_.largest_body_force);
  // From rest the speed that the force gives over one smoothing length stands in for the largest speed, and beside a
  // moving wall that of the wall.
  const double speed = std::max({liquid_.limiting_speed, liquid_.wall_speed, std::sqrt(std::sqrt(acceleration2) * h)});
  StepLimit limit{1e300, "nothing"};
  const auto bound = [&](double dt, const char* name) {
    if (dt < limit.dt) limit = {dt, name};
  };
  if (speed > 0) bound(options.courant * h / speed, "courant");
  // Spray does not count to that speed, but a step that takes any particle across half its support is refused.
  if (liquid_.max_speed > 0) bound(0.45 * liquid_.grid.support_radius() / liquid_.max_speed, "spray");
  const double viscosity = liquid_.scene.fluid.kinematic_viscosity + liquid_.max_eddy_viscosity;
  // The explicit sum of div(2 nu S) is stable up to 0.108 h^2 / nu on a lattice in 3-D and 0.112 in 2-D, that of
  // div(nu grad u) up to 0.29 and 0.31.
  if (viscosity > 0)
    bound(liquid_.options.get<SchemeOptions>().viscous * h * h / (diffusion_rate(liquid_) * viscosity), "viscous");
  // A bubble crosses at most half a smoothing length.
  if (bubbles_ && bubbles_->max_speed() > 0) bound(0.5 * h / bubbles_->max_speed(), "bubbles");
  if (options.max_step > 0) bound(options.max_step, "max_step");
  // A force that varies in space is known at the end of the last step only, and may have risen since. Of two steps one
  // may have been cut short to meet an output time.
  if (varying_force && liquid_.steps > 0)
    bound(2 * std::max(liquid_.last_steps[0], liquid_.last_steps[1]), "growth of the step");
  // A force on a liquid at rest: the first steps follow the time scale of the run.
  if (speed == 0 && options.max_step == 0) bound(options.end / 1000, "end of run");
  return limit;
}

std::vector<Invariant> LesSph::invariants() const {
  const Plan& plan = liquid_.plan;
  const double density = liquid_.scene.fluid.density;
  // The mass is one product of the constant mass of a particle and their number.
  std::vector<Invariant> list{{.quantity = "mass_drift",
                               .kind = Invariant::Kind::drift,
                               .column = "mass",
                               .bound = std::numeric_limits<double>::epsilon()}};
  double weight = 0;
  bool has_height = true;
  for (int axis = 0; axis < liquid_.dimensions; ++axis) {
    const double g = std::abs(liquid_.scene.fluid.gravity[axis]);
    weight += density * liquid_.volume * static_cast<double>(liquid_.size()) * g;
    if (g > 0 && liquid_.scene.domain.periodic(axis)) has_height = false;
  }
  // Without anything but gravity the energy, with what a compressible liquid stores in its pressure, cannot grow. By
  // its discretisation a resolved run gains a few thousandths of its largest kinetic energy (breaking_wave 0.17 % at
  // 1/50), and the rearrangement of particles lifts liquid by a fraction of a spacing: 5e-4 in standing_wave, whose
  // waves are lower than a spacing and hold less than that would. Hence the bound, and the floor of the scale.
  if (!plan.moving_walls && !plan.body_force && !plan.bubbles && has_height) {
    Invariant energy{.quantity = "energy_growth",
                     .kind = Invariant::Kind::growth,
                     .column = "total_energy",
                     .bound = 0.01,
                     .scale_column = "kinetic_energy",
                     .scale_floor = 0.1 * weight * liquid_.scene.spacing};
    if (plan.compressible) energy.beside = [this] { return stored_energy(liquid_); };
    list.push_back(std::move(energy));
  }
  list.push_back({.quantity = "pressure_residual",
                  .kind = Invariant::Kind::largest,
                  .column = "pressure_residual",
                  .bound = liquid_.options.get<PressureOptions>().tolerance});
  return list;
}

std::vector<SeriesColumn> LesSph::series_columns() const {
  std::vector<SeriesColumn> columns{{"kinetic_energy", "rho u^2 / 2, integral"},
                                    {"potential_energy", "rho g z, integral"},
                                    {"total_energy", "kinetic + potential"},
                                    {"dissipation", "rho (nu + nu_t) |S|^2, integral"}};
  if (liquid_.plan.eddy_viscosity) columns.push_back({"unresolved_dissipation", "rho nu_t |S|^2, integral"});
  columns.push_back({"max_speed", "speed"});
  columns.push_back({"mass", "mass"});
  const char* const momentum[3] = {"momentum_x", "momentum_y", "momentum_z"};
  for (int axis = 0; axis < liquid_.dimensions; ++axis) columns.push_back({momentum[axis], "mass times speed"});
  columns.push_back({"max_divergence", "of the predicted velocity, 1 / time"});
  columns.push_back({"pressure_iterations", "1"});
  columns.push_back({"pressure_residual", "relative"});
  columns.push_back({"surface_particles", "1"});
  if (bubbles_) bubbles_->add_columns(columns);
  return columns;
}

void LesSph::series_values(std::span<double> values) {
  ensure_started();
  const Liquid& liquid = liquid_;
  const int d = liquid.dimensions;
  const std::size_t n = liquid.size();
  const double mass = liquid.scene.fluid.density * liquid.volume;
  const Vec3& gravity = liquid.scene.fluid.gravity;
  const double kinetic = mass * parallel_sum(n, [&](std::size_t i) {
                           double speed2 = 0;
                           for (int axis = 0; axis < d; ++axis)
                             speed2 += (*liquid.velocity[axis])[i] * (*liquid.velocity[axis])[i];
                           return speed2 / 2;
                         });
  const double potential = mass * parallel_sum(n, [&](std::size_t i) {
                             double sum = 0;
                             for (int axis = 0; axis < d; ++axis) sum -= gravity[axis] * (*liquid.position[axis])[i];
                             return sum;
                           });
  std::size_t k = 0;
  const auto put = [&](double value) { values[k++] = value; };
  put(kinetic);
  put(potential);
  put(kinetic + potential);
  put(liquid.dissipation);
  if (liquid.plan.eddy_viscosity)
    put(mass * parallel_sum(n, [&](std::size_t i) {
          const double strain = (*liquid.strain)[i];
          return double{(*liquid.eddy_viscosity)[i]} * strain * strain;
        }));
  put(liquid.max_speed);
  put(mass * static_cast<double>(n));
  for (int axis = 0; axis < d; ++axis)
    put(mass * parallel_sum(n, [&](std::size_t i) { return (*liquid.velocity[axis])[i]; }));
  put(liquid.max_divergence);
  put(pressure_->report().iterations);
  put(pressure_->report().relative_residual);
  put(static_cast<double>(liquid.surface_particles.size()));
  if (!bubbles_) return;
  std::vector<double> of_bubbles;
  bubbles_->put_values(liquid, of_bubbles);
  for (const double value : of_bubbles) put(value);
}

std::vector<ParticleSnapshot> LesSph::snapshot() {
  ensure_started();
  ParticleSnapshot fluid;
  fluid.name = "fluid";
  fluid.size = liquid_.size();
  ParticleField velocity{"velocity", {}, {}};
  for (int axis = 0; axis < liquid_.dimensions; ++axis) {
    fluid.position.push_back(liquid_.position[axis]->data());
    velocity.f64.push_back(liquid_.velocity[axis]->data());
  }
  const auto& wanted = liquid_.options.output.fields;
  const auto want = [&](const char* name, bool standard) {
    return wanted.empty() ? standard : std::find(wanted.begin(), wanted.end(), name) != wanted.end();
  };
  if (want("velocity", true)) fluid.fields.push_back(velocity);
  if (want("pressure", true)) fluid.fields.push_back({"pressure", {liquid_.pressure->data()}, {}});
  if (want("id", true)) fluid.fields.push_back({"id", {}, {liquid_.identifier->data()}});
  // Fields of the last step, in the units of the case; zero before the first.
  const auto add_derived = [&](const char* name, bool standard, auto&& value) {
    if (!want(name, standard)) return;
    Array<double>& values = snapshot_[name];
    values.resize(liquid_.size());
    parallel_for(liquid_.size(), [&](std::size_t i) { values[i] = value(i); });
    fluid.fields.push_back({name, {values.data()}, {}});
  };
  const double nu = liquid_.scene.fluid.kinematic_viscosity;
  const auto eddy = [&](std::size_t i) {
    return liquid_.eddy_viscosity == nullptr ? 0.0 : double{(*liquid_.eddy_viscosity)[i]};
  };
  if (liquid_.plan.velocity_gradient)
    add_derived("dissipation", liquid_.plan.eddy_viscosity, [&](std::size_t i) {
      const double strain = (*liquid_.strain)[i];
      return (nu + eddy(i)) * strain * strain;
    });
  if (liquid_.plan.eddy_viscosity) {
    add_derived("unresolved_dissipation", false, [&](std::size_t i) {
      const double strain = (*liquid_.strain)[i];
      return eddy(i) * strain * strain;
    });
    add_derived("eddy_viscosity", false, eddy);
  }
  add_derived("divergence_of_position", false,
              [&](std::size_t i) { return double{(*liquid_.divergence_of_position)[i]}; });
  if (!bubbles_) return {fluid};
  if (want("volume_fraction", true)) fluid.fields.push_back({"volume_fraction", {liquid_.volume_fraction->data()}, {}});
  if (bubbles_->population().empty()) return {fluid};
  return {fluid, bubbles_->family(liquid_)};
}

std::vector<RecordTable> LesSph::tables() const {
  return bubbles_ ? bubbles_->tables() : std::vector<RecordTable>{};
}

void LesSph::table_rows(const std::string& name, std::vector<double>& rows) {
  ensure_started();
  if (bubbles_) bubbles_->table_rows(liquid_, name, rows);
}

std::string LesSph::note() {
  return bubbles_ ? bubbles_->note() : std::string();
}

PointSampler& LesSph::sampler() {
  ensure_started();
  if (!sampler_) sampler_ = std::make_unique<PointSampler>();
  if (sampler_->step() != liquid_.steps) sampler_->update(liquid_);
  return *sampler_;
}

PointSample LesSph::sample(const Vec3& position) {
  return sampler().sample(liquid_, position);
}
double LesSph::elevation(const Vec3& position) {
  return sampler().elevation(liquid_, position);
}
double LesSph::wetted_length(const Vec3& position) {
  return sampler().wetted_length(liquid_, position);
}
double LesSph::front(int axis, double height) {
  return sampler().front(liquid_, axis, height);
}

PlaneSample LesSph::plane_average(int axis, double position) {
  return sampler().plane_average(liquid_, axis, position);
}

bool LesSph::spectrum(std::vector<double>& wavenumber, std::vector<double>& energy) {
  const Domain& domain = liquid_.scene.domain;
  for (int axis = 0; axis < liquid_.dimensions; ++axis)
    if (!domain.periodic(axis)) return false;
  ParticleSpectrumInput input;
  input.dimensions = liquid_.dimensions;
  input.lower = domain.lower;
  input.upper = domain.upper;
  input.spacing = liquid_.scene.spacing;
  for (int axis = 0; axis < liquid_.dimensions; ++axis) {
    input.position[axis] = *liquid_.position[axis];
    input.velocity[axis] = *liquid_.velocity[axis];
  }
  const ParticleSpectrum result = energy_spectrum(input);
  wavenumber = result.spectrum.wavenumber;
  energy = result.spectrum.energy;
  return true;
}

void LesSph::save(StateWriter& writer) const {
  const double scalars[] = {liquid_.time,
                            liquid_.max_speed,
                            liquid_.limiting_speed,
                            liquid_.max_eddy_viscosity,
                            liquid_.max_divergence,
                            liquid_.dissipation,
                            liquid_.energy_supply,
                            liquid_.wall_speed,
                            liquid_.largest_body_force,
                            liquid_.last_steps[0],
                            liquid_.last_steps[1]};
  const std::int64_t counters[] = {liquid_.steps, liquid_.started ? 1 : 0, static_cast<std::int64_t>(liquid_.size())};
  writer.f64("scalars", scalars);
  writer.i64("counters", counters);
  const auto& w = liquid_.walls;
  const double walls[] = {w[0][0], w[0][1], w[1][0], w[1][1], w[2][0], w[2][1]};
  writer.f64("walls", walls);
  for (const auto& field : liquid_.fields.fields()) {
    if (!saved(*field)) continue;
    if (const auto* f64 = std::get_if<Array<double>>(&field->values)) writer.f64(field->name, *f64);
    if (const auto* i64 = std::get_if<Array<std::int64_t>>(&field->values)) writer.i64(field->name, *i64);
  }
  if (bubbles_) bubbles_->save(writer);
}

void LesSph::load(StateReader& reader) {
  sampler_.reset();
  Array<double> scalars, walls;
  Array<std::int64_t> counters;
  reader.f64("scalars", scalars);
  reader.i64("counters", counters);
  reader.f64("walls", walls);
  if (scalars.size() != 11 || counters.size() != 3 || walls.size() != 6)
    throw FileError("the checkpoint was written by another version of the method");
  const auto n = static_cast<std::size_t>(counters[2]);
  liquid_.fields.resize(n);
  for (const auto& field : liquid_.fields.fields()) {
    if (!saved(*field)) continue;
    if (auto* f64 = std::get_if<Array<double>>(&field->values)) reader.f64(field->name, *f64);
    if (auto* i64 = std::get_if<Array<std::int64_t>>(&field->values)) reader.i64(field->name, *i64);
    if (std::visit([](const auto& array) { return array.size(); }, field->values) != n)
      throw FileError("the checkpoint's array '" + field->name + "' does not have one value per particle");
  }
  liquid_.time = scalars[0];
  liquid_.max_speed = scalars[1];
  liquid_.limiting_speed = scalars[2];
  liquid_.max_eddy_viscosity = scalars[3];
  liquid_.max_divergence = scalars[4];
  liquid_.dissipation = scalars[5];
  liquid_.energy_supply = scalars[6];
  liquid_.wall_speed = scalars[7];
  liquid_.largest_body_force = scalars[8];
  liquid_.last_steps = {scalars[9], scalars[10]};
  liquid_.steps = counters[0];
  liquid_.started = counters[1] != 0;
  for (int axis = 0; axis < 3; ++axis) liquid_.walls[axis] = {walls[2 * axis], walls[2 * axis + 1]};
  find_uniform_acceleration(liquid_, liquid_.time);  // samples before the next step need it
  if (bubbles_) bubbles_->load(reader);
}

}  // namespace spume::les_sph
