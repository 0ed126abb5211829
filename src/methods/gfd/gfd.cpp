// SPDX-License-Identifier: MIT
#include "spume/methods/gfd/gfd.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/particles/interface_contour.hpp"

namespace spume::gfd {
namespace {

// A flow at rest without forces: the first steps follow the time scale of the run.
constexpr double steps_of_run_at_rest = 1000;
// What disorder makes of the number density of single particles, and so of a phase of few of them. In rising_bubble_2d
// the bubble stays within 0.3 % at 1/32.
constexpr double largest_volume_drift = 0.02;
// Of the momentum that the energy of the flow could have, and of that energy. A drop of 11 spacings in a wind, whose
// gas is 2, 10 and 100 times as light: momentum 0.003, 0.011 and 0.020 (0.006 at 22 spacings), no energy; vortices of
// two fluids 0.001; energy of capillary_wave 0.014, of the other cases 0.007 at most.
constexpr double largest_momentum_change = 0.05;
constexpr double largest_energy_growth = 0.03;
constexpr std::array<const char*, 3> momentum_columns{"momentum_x", "momentum_y", "momentum_z"};

}  // namespace

// Derived fields are those of the last step, at the positions that it started from.
const std::vector<OutputField<Flow>>& output_fields() {
  static const std::vector<OutputField<Flow>> fields{
      {"velocity", always, [](const Flow& f) { return f.particles.velocity; }},
      {"pressure", always, [](const Flow& f) { return f.pressure; }},
      {"phase", always, [](const Flow& f) { return f.phase_number; }},
      {"id", always, [](const Flow& f) { return f.particles.identifier; }},
      {"density", on_request, [](const Flow& f, std::size_t i) { return (*f.density)[i]; }},
      {"viscosity", on_request,
       [](const Flow& f, std::size_t i) { return f.viscosity == nullptr ? 0.0F : (*f.viscosity)[i]; }},
      {diffusion_field, on_request, [](const Flow& f) { return f.diffusion; }},
      {"colour", on_request,
       [](const Flow& f, std::size_t i) { return f.colours.empty() ? 0.0F : f.colours.back().value[i]; }},
      {"interface_potential", on_request, [](const Flow& f, std::size_t i) {
         return f.colours.empty() ? 0.0 : f.colours.back().mean_potential + f.colours.back().potential[i];
       }}};
  return fields;
}

Gfd::Gfd(const LoadedCase& loaded)
    : flow_(loaded),
      plan_(make_plan(flow_)),
      snapshot_(snapshot_table(output_fields(), loaded.options, flow_)),
      phase_sums_(flow_.particles, *flow_.phase_number, flow_.scene, flow_.left_out()) {
  if (flow_.features.openings) snapshot_.leave_out(flow_.openings->column());
  declare_series();
  saved_.add(flow_.time)
      .add(flow_.steps)
      .add(flow_.speeds.largest)
      .add(flow_.speeds.limiting)
      .add(flow_.energy_supply)
      .add(flow_.boundary.wall_speed)
      .add(flow_.solver.looks_for_enclosed);
  for (double& volume : flow_.first_volume) saved_.add(volume);
  if (!flow_.features.bodies) return;
  saved_.add(flow_.packed);
  body_forces_ = std::make_unique<const BodyForces>(flow_.scene, flow_.resolution, *flow_.boundary.bodies());
  if (WorkOfBodies::any(flow_.scene) && WorkOfBodies::tells_all(flow_.scene) && flow_.gains_no_energy(true))
    work_of_bodies_.emplace(flow_.scene).save_with(saved_);
}

void Gfd::ensure_arranged() {
  if (arranged_) return;
  plan_.run_start(static_cast<double>(flow_.size()), start_ledger_);
  arranged_ = true;
}

void Gfd::step(double dt, Ledger& ledger) {
  if (flow_.steps == 0) ensure_arranged();
  plan_.list(ledger);
  for (const Ledger::Entry& entry : start_ledger_.entries())
    ledger.count(entry.stage, entry.calls, entry.seconds, entry.particles, entry.pairs, entry.bytes);
  start_ledger_.clear();
  sampled_step_ = -1;
  arranged_ = true;
  try {
    plan_.run_step(dt, static_cast<double>(flow_.size()), ledger);
  } catch (...) {
    flow_.undo_exchange();
    throw;
  }
  if (work_of_bodies_ && WorkOfBodies::due(flow_.steps)) {
    const double n = static_cast<double>(flow_.size());
    const Ledger::Scope timed = ledger.time("work of bodies", n, 0, n * BodyForces::bytes_read(flow_.dimensions));
    forces_on_bodies();
  }
}

StepLimit Gfd::step_limit() const {
  const TimeOptions& options = flow_.options.time;
  const LimitOptions& limits = flow_.options.get<LimitOptions>();
  const double h = flow_.resolution.smoothing_length;
  double gravity2 = 0;
  for (const double g : flow_.scene.fluid.gravity) gravity2 += g * g;
  // From rest the speed that gravity gives over one smoothing length stands in for the largest speed; of implicit
  // steps, which follow transients no closer than they are long, the speed that the scene lets expect.
  const double speed = std::max({flow_.speeds.limiting, flow_.boundary.wall_speed, std::sqrt(std::sqrt(gravity2) * h),
                                 flow_.viscous.implicit ? flow_.viscous.speed : 0.0});
  SmallestStep step;
  if (speed > 0) step.bound(options.courant * h / speed, "courant");
  if (flow_.features.viscosity && !flow_.viscous.implicit) step.bound(flow_.viscous.limit, "viscous");
  if (flow_.features.tension) step.bound(limits.capillary * capillary_time(flow_.scene), "capillary");
  if (options.max_step > 0) step.bound(options.max_step, "max_step");
  if (speed == 0 && options.max_step == 0) step.bound(options.end / steps_of_run_at_rest, "end of run");
  return step.limit();
}

void Gfd::declare_series() {
  const Flow& flow = flow_;
  series_.prepare = [this] { phase_sums_.find(); };
  series_.add("kinetic_energy", "rho u^2 / 2, integral", [&flow] { return flow.kinetic_energy(); });
  if (flow.features.gravity)
    series_.add("potential_energy", "rho g z, integral", [&flow] { return flow.potential_energy(); });
  if (flow.features.interfaces)
    series_.add("interface_area", flow.dimensions == 3 ? "length^2" : "length",
                [&flow] { return interface_area(flow.colours); });
  if (flow.features.tension)
    series_.add("surface_energy", "sigma times the area", [&flow] { return surface_energy(flow.colours); });
  if (flow.colours.size() == 1)
    series_.add(flow.dimensions == 3 ? "sphericity" : "circularity",
                "surface of a ball of the volume of " + flow.scene.phases[1].name + " over the area",
                [&flow] { return flow.roundness(); });
  for (int axis = 0; axis < flow.dimensions; ++axis)
    series_.add(momentum_columns[static_cast<std::size_t>(axis)], "mass speed",
                [&flow, axis] { return flow.momentum(axis); });
  series_.add("max_speed", "speed", [&flow] { return flow.largest_speed(); });
  for (std::size_t n = 0; n < phase_sums_.size(); ++n) {
    const std::string& name = flow.scene.phases[n].name;
    if (!flow.features.openings)
      series_.add("volume_" + name,
                  flow.dimensions == 3 ? "length^3, share by kernel sums" : "length^2, share by kernel sums",
                  [&flow, n] { return flow.phase_volume[n]; });
    phase_sums_.add_columns(series_, n, name);
  }
  if (flow.features.openings) flow.openings->add_columns(series_);
  series_.add("max_divergence", "of the predicted velocity, 1 / time", [&flow] { return flow.max_divergence; });
  series_.add("pressure_iterations", "1", [&flow] { return double(flow.solver.report().iterations); });
  series_.add("pressure_residual", "relative", [&flow] { return flow.solver.report().relative_residual; });
  series_.add("pressure_tolerance", "relative, asked of the step", [&flow] { return flow.solver.report().tolerance; });
  add_wall_columns(series_, flow.boundary);
}

void Gfd::series_values(std::span<double> values) {
  ensure_arranged();
  series_.values(values);
}

std::vector<ParticleSnapshot> Gfd::snapshot_on_demand() {
  ensure_arranged();
  return {snapshot_.take("fluid", flow_.size(), flow_.particles.position, flow_.options.output.fields)};
}

SurfaceSnapshot Gfd::interface_surface() {
  ensure_arranged();
  return interface_contours(sampler(), *flow_.phase_number, flow_.scene.phases.size());
}

const PointSampler& Gfd::sampler() {
  ensure_arranged();
  if (sampled_step_ != flow_.steps) {
    sampler_.update({.arrangement = &flow_.arrangement,
                     .boundary = &flow_.boundary,
                     .particles = &flow_.particles,
                     .resolution = &flow_.resolution,
                     .scalars = {{flow_.pressure}},
                     .layer = flow_.left_out(),
                     .time = flow_.time});
    sampled_step_ = flow_.steps;
  }
  return sampler_;
}

std::vector<RecordTable> Gfd::tables() const {
  if (body_forces_ == nullptr) return {};
  return {body_forces_->table()};
}

void Gfd::table_rows(const std::string&, std::vector<double>& rows) {
  ensure_arranged();
  body_forces_->add_rows(flow_.time, forces_on_bodies(), rows);
}

std::vector<SurfaceForce> Gfd::forces_on_bodies() {
  BodyForces::Fields fields(flow_.arrangement, flow_.particles, flow_.boundary.walls);
  fields.viscosity = flow_.viscosity == nullptr ? nullptr : flow_.viscosity->data();
  fields.density = [this](std::size_t i) { return (*flow_.density)[i]; };
  fields.pressure = [this](std::size_t i) { return (*flow_.pressure)[i]; };
  std::vector<SurfaceForce> forces = body_forces_->measure(fields, flow_.time);
  if (work_of_bodies_)
    work_of_bodies_->add(flow_.time, forces, *flow_.boundary.bodies(),
                         [this] { return flow_.energy_without_potential() + flow_.potential_energy(); });
  return forces;
}

std::vector<Remark> Gfd::take_remarks() {
  std::string remark = flow_.solver.take_remark();
  if (remark.empty()) return {};
  return {{std::move(remark), false}};
}

std::vector<Invariant> Gfd::invariants() const {
  std::vector<Invariant> list;
  for (std::size_t n = 0; n < flow_.scene.phases.size(); ++n) {
    const std::string& name = flow_.scene.phases[n].name;
    if (flow_.features.openings)
      list.push_back({.quantity = "balance_" + name,
                      .kind = Invariant::Kind::drift,
                      .column = "volume_" + name,
                      .bound = 4 * std::numeric_limits<double>::epsilon(),  // of three products
                      .beside = [this, n] { return flow_.openings->net_outflow(n); }});
    else
      list.push_back({.quantity = "volume_" + name + "_drift",
                      .kind = Invariant::Kind::drift,
                      .column = "volume_" + name,
                      .bound = largest_volume_drift});
  }
  // Both hold of what is solved; what their discretisation makes of them is first order beside interfaces, where the
  // density is a blend (7).
  for (int axis = 0; axis < flow_.dimensions; ++axis)
    if (flow_.keeps_momentum(axis))
      list.push_back({.quantity = std::string(momentum_columns[static_cast<std::size_t>(axis)]) + "_change",
                      .kind = Invariant::Kind::change,
                      .column = momentum_columns[static_cast<std::size_t>(axis)],
                      .bound = largest_momentum_change,
                      .scale = [this] { return std::sqrt(2 * flow_.mass() * flow_.energy_without_potential()); }});
  if (flow_.gains_no_energy(work_of_bodies_.has_value()))
    list.push_back({.quantity = "energy_growth",
                    .kind = Invariant::Kind::growth,
                    .column = "kinetic_energy",
                    .bound = largest_energy_growth,
                    .scale_floor = 0.1 * flow_.weight * flow_.resolution.spacing,
                    .beside =
                        [this] {
                          return flow_.potential_energy() + surface_energy(flow_.colours) -
                                 (work_of_bodies_ ? work_of_bodies_->most() : 0.0);
                        },
                    .scale = [this] { return flow_.energy_without_potential(); }});
  list.push_back({.quantity = "pressure_residual",
                  .kind = Invariant::Kind::largest,
                  .column = "pressure_residual",
                  .bound = largest_measured_residual,
                  .scale_column = "pressure_tolerance"});
  return list;
}

std::vector<ArrayInfo> Gfd::arrays() const {
  std::vector<ArrayInfo> list = particle_arrays(flow_.particles, flow_.arrangement);
  list.push_back({"pressure solver", flow_.solver.bytes() + flow_.matrix.bytes()});
  if (const double bytes = flow_.implicit_diffusion.bytes(); bytes > 0) list.push_back({"implicit viscosity", bytes});
  if (flow_.features.openings) list.push_back({"openings", flow_.openings->bytes() + flow_.layers->bytes()});
  list.push_back({"leased within a step", flow_.leased_bytes()});
  double interfaces = flow_.bands.bytes() + flow_.phase.bytes() +
                      static_cast<double>(flow_.exchanged.capacity() * sizeof(flow_.exchanged[0]));
  for (const Colour& colour : flow_.colours) interfaces += colour.value.bytes() + colour.potential.bytes();
  list.push_back({"interfaces", interfaces});
  if (flow_.features.bodies) list.push_back({"wall points", flow_.boundary.bytes()});
  return list;
}

void Gfd::save(StateWriter& writer) const {
  const std::int64_t count[] = {static_cast<std::int64_t>(flow_.size())};
  saved_.save(writer);
  writer.i64("counters", count);
  flow_.boundary.save_walls(writer);
  if (flow_.features.openings) flow_.openings->save(writer);
  save_fields(flow_.particles.fields, writer);
}

void Gfd::load(StateReader& reader) {
  sampled_step_ = -1;
  arranged_ = false;
  Array<std::int64_t> count;
  saved_.load(reader);
  reader.i64("counters", count);
  flow_.boundary.load_walls(reader, flow_.time);
  if (flow_.features.openings) flow_.openings->load(reader);
  if (count.size() != 1) throw FileError("the checkpoint was written by another version of the method");
  load_fields(flow_.particles.fields, static_cast<std::size_t>(count[0]), "particle", reader);
}

}  // namespace spume::gfd
