// SPDX-License-Identifier: MIT
#include "spume/methods/wcsph/wcsph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/particles/interface_contour.hpp"
#include "spume/particles/step_limits.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::wcsph {
namespace {

// Of h^2 / nu and of sqrt(h / g): Morris et al. (1997).
constexpr double viscous_limit = 0.125, force_limit = 0.25;
// Of a liquid with a free surface: twice the change of density that its sound speed is chosen for.
constexpr double largest_volume_drift = 0.02;
constexpr double largest_energy_growth = 0.03;  // as of gfd

}  // namespace

const std::vector<OutputField<Flow>>& output_fields() {
  static const std::vector<OutputField<Flow>> fields{
      {"velocity", always, [](const Flow& f) { return f.particles.velocity; }},
      {"pressure", always, [](const Flow& f, std::size_t i) { return f.law(i).pressure((*f.excess)[i]); }},
      {"phase", always, [](const Flow& f) { return f.phase_number; }},
      {"id", always, [](const Flow& f) { return f.particles.identifier; }},
      {"density", on_request, [](const Flow& f, std::size_t i) { return f.law(i).density * (1 + (*f.excess)[i]); }},
      {"acceleration", on_request, [](const Flow& f) { return f.acceleration; }}};
  return fields;
}

Wcsph::Wcsph(const LoadedCase& loaded)
    : flow_(loaded),
      plan_(make_plan(flow_)),
      snapshot_(snapshot_table(output_fields(), loaded.options, flow_)),
      phase_sums_(flow_.particles, *flow_.phase_number, flow_.scene,
                  flow_.openings == nullptr ? nullptr : &flow_.openings->column()),
      remarked_(flow_.laws.size(), false) {
  for (const PhaseLaw& law : flow_.laws)
    if (!(law.sound_speed > 0))
      throw refusal(loaded.options, "compressibility.max_speed",
                    "nothing tells how fast the flow will be: it starts at rest, without gravity, forces and moving "
                    "walls; set compressibility.max_speed");
  snapshot_.go_round(flow_.scene.domain);  // as particles do where lists are made
  phase_sums_.go_round(flow_.scene.domain);
  if (flow_.features.openings) {
    snapshot_.leave_out(flow_.openings->column());
    if (const auto fastest = flow_.acoustic->fastest_inflow(loaded.options.time.end); fastest.mach >= 1)
      throw refusal(loaded.options, fastest.name,
                    fastest.name + " lets its phase enter at " + brief(fastest.mach) +
                        " times its sound speed; expected a flow slower than sound: raise compressibility.max_speed");
  }
  declare_series();
  if (flow_.features.uneven) flow_.unsettled = uneven_liquids;
  if (flow_.features.scalars) flow_.solutes.scalars->add_fields(snapshot_);
  if (flow_.features.bodies)
    body_forces_ = std::make_unique<const BodyForces>(flow_.scene, flow_.resolution, *flow_.boundary.bodies());
  saved_.add(flow_.time).add(flow_.steps).add(flow_.started).add(flow_.signal).add(flow_.largest_speed);
  saved_.add(flow_.boundary.wall_speed).add(flow_.list_life.fastest).add(flow_.list_life.most_accelerated);
  saved_.add(flow_.arrangement.context.gradient_scale);
  if (flow_.features.tension) saved_.add(flow_.surface_energy);
  if (flow_.features.density_relaxation)
    saved_.add(flow_.relaxation->volume).add(flow_.relaxation->rest).add(flow_.measured_way);
}

// With the first forces, which are recorded.
void Wcsph::prepare(Ledger& ledger, const GoOn& go_on) {
  plan_.run_before(static_cast<double>(flow_.size()), ledger, go_on);
  if (!flow_.solutes.record_carries()) find_first_forces(ledger);
}

void Wcsph::find_first_forces(Ledger& ledger) {
  if (flow_.started == 0) plan_.run_start(static_cast<double>(flow_.size()), ledger);
  flow_.started = 1;
}

void Wcsph::step(double dt, Ledger& ledger) {
  sampled_step_ = -1;  // sorting changes what the bins of the sampler refer to, also when the step is refused
  if (flow_.solutes.record_carries()) return plan_.run_recorded(dt, static_cast<double>(flow_.size()), ledger);
  find_first_forces(ledger);
  plan_.run_step(dt, static_cast<double>(flow_.size()), ledger);
}

StepLimit Wcsph::step_limit() const {
  if (flow_.solutes.record_carries()) return {flow_.solutes.recorded->step(flow_.time, 0), "outputs"};
  const TimeOptions& options = flow_.options.time;
  const double h = flow_.resolution.smoothing_length;
  SmallestStep step;
  step.bound(options.courant * h / (flow_.signal + flow_.boundary.wall_speed), "courant");
  if (const double nu = largest_kinematic_viscosity(flow_.laws); nu > 0)
    step.bound(viscous_limit * h * h / nu, "viscous");
  const double gravity = length(flow_.scene.fluid.gravity);
  if (gravity > 0) step.bound(force_limit * std::sqrt(h / gravity), "body force");
  if (flow_.features.tension) step.bound(capillary_time(flow_.scene), "capillary");
  if (options.max_step > 0) step.bound(options.max_step, "max_step");
  if (flow_.solutes.recorded != nullptr)
    step.bound(flow_.solutes.recorded->step(flow_.time, step.limit().dt), "recorded_flow.lag");
  return step.limit();
}

void Wcsph::declare_series() {
  const Flow& flow = flow_;
  series_.prepare = [this] {
    phase_sums_.find();
    energies_ = flow_.energies();
  };
  series_.add("kinetic_energy", "rho u^2 / 2, integral", [this] { return energies_.kinetic; });
  if (flow.features.gravity)
    series_.add("potential_energy", "rho g z, integral", [this] { return energies_.potential; });
  series_.add("compression_energy", "rho e, integral", [this] { return energies_.compression; });
  if (flow.features.tension)
    series_.add("surface_energy", "sigma times the area", [&flow] { return flow.surface_energy; });
  if (flow.features.density_relaxation)
    series_.add("volume", flow.dimensions == 3 ? "length^3, by kernel sums" : "length^2, by kernel sums",
                [&flow] { return flow.relaxation->volume; });
  series_.add("max_speed", "speed",
              [this] { return flow_.features.openings ? energies_.largest_speed : flow_.largest_speed; });
  for (std::size_t n = 0; n < phase_sums_.size(); ++n) {
    const std::string& name = flow.scene.phases[n].name;
    series_.add("density_change_" + name, "1, largest", [&flow, n] { return flow.largest_excess(n); });
    phase_sums_.add_columns(series_, n, name);
  }
  if (flow.features.openings) flow.openings->add_columns(series_);
  if (flow.spill.possible())
    series_.add("mass_removed", "mass, that left through open sides for good", [&flow] { return flow.mass_spilt(); });
  flow.solutes.add_columns(series_, nullptr);
}

std::vector<ParticleSnapshot> Wcsph::snapshot_on_demand() {
  return {snapshot_.take("fluid", flow_.size(), flow_.particles.position, flow_.options.output.fields)};
}

std::vector<Remark> Wcsph::take_remarks() {
  std::vector<Remark> remarks;
  if (std::string remark = flow_.spill.take_remark(); !remark.empty()) remarks.push_back({std::move(remark)});
  if (!flow_.unsettled.empty()) remarks.push_back({std::exchange(flow_.unsettled, {})});
  for (std::size_t n = 0; n < flow_.laws.size() && !(flow_.strain < 1); ++n) {
    if (remarked_[n]) continue;
    const double change = flow_.largest_excess(n), range = flow_.laws[n].largest_change();
    if (!(remarked_[n] = change > range)) continue;
    remarks.push_back({"the density of " + flow_.scene.phases[n].name + " has changed by " + brief(100 * change) +
                       " %, where " + brief(100 * range) +
                       " % is what its sound speed allows for: raise compressibility.max_speed above " +
                       brief(flow_.expected_speed) + " m/s"});
  }
  return remarks;
}

std::vector<Invariant> Wcsph::invariants() const {
  std::vector<Invariant> list;
  if (flow_.features.density_relaxation && !flow_.features.openings)
    list.push_back({.quantity = "volume_drift",
                    .kind = Invariant::Kind::drift,
                    .column = "volume",
                    .bound = largest_volume_drift,
                    .beside = [this] { return flow_.volume_spilt(); }});
  // To the rounding of three products.
  for (std::size_t n = 0; n < flow_.laws.size() && flow_.features.openings; ++n)
    list.push_back({.quantity = "balance_" + flow_.scene.phases[n].name,
                    .kind = Invariant::Kind::drift,
                    .column = "volume_" + flow_.scene.phases[n].name,
                    .bound = 4 * std::numeric_limits<double>::epsilon(),
                    .beside = [this, n] { return flow_.openings->net_outflow(n) + flow_.volume_spilt(n); }});
  if (!flow_.driven())
    list.push_back({.quantity = "energy_growth",
                    .kind = Invariant::Kind::growth,
                    .column = "kinetic_energy",
                    .bound = largest_energy_growth,
                    .scale_floor = 0.1 * flow_.mass() * length(flow_.wall_gravity) * flow_.scene.spacing,
                    .beside = [this] { return energies_.stored() + flow_.surface_energy; },
                    .scale = [this] { return energies_.kinetic + flow_.surface_energy; }});
  return list;
}

std::vector<ArrayInfo> Wcsph::arrays() const {
  std::vector<ArrayInfo> list = particle_arrays(flow_.particles, flow_.arrangement);
  if (flow_.features.bodies) list.push_back({"wall points", flow_.boundary.bytes() + flow_.walls.bytes()});
  list.push_back({"blocks of lists", flow_.list_life.bytes()});
  if (flow_.features.tension) list.push_back({"interfaces", flow_.tension->bytes()});
  if (flow_.features.openings) list.push_back({"openings", flow_.openings->bytes() + flow_.acoustic->bytes()});
  list.push_back({"leased within a step", flow_.leased_bytes()});
  return list;
}

SurfaceSnapshot Wcsph::interface_surface() {
  return interface_contours(sampler(), *flow_.phase_number, flow_.scene.phases.size());
}

const PointSampler& Wcsph::sampler() {
  if (sampled_step_ == flow_.steps) return sampler_;
  sampled_pressure_.resize(flow_.size());
  parallel_for(flow_.size(), [&](std::size_t i) { sampled_pressure_[i] = flow_.law(i).pressure((*flow_.excess)[i]); });
  // With several phases no one density tells the hydrostatic part.
  sampler_.update({.arrangement = &flow_.arrangement,
                   .boundary = &flow_.boundary,
                   .particles = &flow_.particles,
                   .resolution = &flow_.resolution,
                   .scalars = {{&sampled_pressure_, flow_.features.several ? 0 : flow_.laws[0].density}},
                   .uniform_acceleration = flow_.wall_gravity,
                   .layer = flow_.openings == nullptr ? nullptr : &flow_.openings->column(),
                   .time = flow_.time});
  sampled_step_ = flow_.steps;
  return sampler_;
}

std::vector<RecordTable> Wcsph::tables() const {
  return body_forces_ == nullptr ? std::vector<RecordTable>() : std::vector{body_forces_->table()};
}

void Wcsph::table_rows(const std::string&, std::vector<double>& rows) {
  if (flow_.solutes.record_carries()) return;  // bodies and liquid stand where the record ended
  sampled_step_ = -1;
  std::vector<SurfaceForce> forces = flow_.forces_on_bodies();
  BodyForces::Fields fields(flow_.arrangement, flow_.particles, flow_.boundary.walls);
  fields.density = [this](std::size_t i) { return flow_.law(i).density; };
  fields.pressure = [this](std::size_t i) { return flow_.law(i).pressure((*flow_.excess)[i]); };
  body_forces_->add_pressure(flow_.still, fields.sides, forces);
  body_forces_->integrate_beside_gaps(fields, forces);
  body_forces_->add_rows(flow_.time, forces, rows);
}

void Wcsph::save(StateWriter& writer) const {
  const std::int64_t count[] = {static_cast<std::int64_t>(flow_.size())};
  saved_.save(writer);
  writer.f64("lists", flow_.list_life.state(flow_.listed_time));
  writer.i64("counters", count);
  flow_.spill.save(writer);
  flow_.boundary.save_walls(writer);
  if (flow_.features.openings) {
    flow_.acoustic->save(writer);
    flow_.openings->save(writer);
  }
  save_fields(flow_.particles.fields, writer);
  flow_.solutes.save(writer);
}

void Wcsph::load(StateReader& reader) {
  Array<std::int64_t> count;
  Array<double> lists;
  saved_.load(reader);
  reader.f64("lists", lists);
  reader.i64("counters", count);
  flow_.spill.load(reader);
  flow_.boundary.load_walls(reader, flow_.time);
  if (flow_.features.openings) {
    flow_.acoustic->load(reader);
    flow_.openings->load(reader);
  }
  if (count.size() != 1 || lists.size() != ListLife::state_size + 1)
    throw FileError("the checkpoint was written by another version of the method");
  load_fields(flow_.particles.fields, static_cast<std::size_t>(count[0]), "particle", reader);
  flow_.solutes.load(reader);
  flow_.list_life.restore(lists.data());
  flow_.listed_time = lists[ListLife::state_size];
  flow_.has_lists = false;
  flow_.strain = infinite;
  sampled_step_ = -1;
}

}  // namespace spume::wcsph
