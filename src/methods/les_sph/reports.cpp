// SPDX-License-Identifier: MIT
// What a run records of the method: one entry per column, field and invariant.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "spume/methods/les_sph/les_sph.hpp"
#include "spume/operators/energy_spectrum.hpp"

namespace spume::les_sph {
namespace {

// 0.033 in taylor_green_2d at 1/20 and 0.023 at 1/50, whose lattice becomes disordered; 0.0015 in a cavity.
constexpr double largest_volume_drift = 0.05;
// Breaking waves and collapsing columns stay within 0.004, a channel and a weir with openings within 0.001 and 0.003,
// scenes of pillars and stirred tanks within 0.016.
constexpr double largest_volume_drift_below_surface = 0.02;
// 9e-5 in taylor_green_2d at 1/20 and 1/50.
constexpr double largest_momentum_change = 1e-3;

// nu |S|^2 of a particle.
double dissipated(const Flow& flow, std::size_t i, double viscosity) {
  const double strain = (*flow.strain)[i];
  return viscosity * strain * strain;
}

constexpr FieldNeed with_closure{has_closure, "a turbulence.model other than \"none\""};
constexpr FieldNeed with_bubbles{has_bubbles, "a section [bubbles]"};
constexpr FieldNeed with_gradient{
    needs_velocity_gradient,
    "a velocity gradient, which turbulence.model, shifting.velocity_correction, time.centred "
    "or [bubbles] make"};

}  // namespace

// Derived fields are those of the last step, in the units of the case; zero before the first.
const std::vector<OutputField<Flow>>& output_fields() {
  static const std::vector<OutputField<Flow>> fields{
      {"velocity", always, [](const Flow& f) { return f.particles.velocity; }},
      {"pressure", always, [](const Flow& f) { return f.pressure; }},
      {"id", always, [](const Flow& f) { return f.particles.identifier; }},
      {"dissipation", has_closure,
       [](const Flow& f, std::size_t i) { return dissipated(f, i, f.viscosity() + f.eddy_viscosity_of(i)); },
       with_gradient},
      {"unresolved_dissipation", on_request,
       [](const Flow& f, std::size_t i) { return dissipated(f, i, f.eddy_viscosity_of(i)); }, with_closure},
      {"eddy_viscosity", on_request, [](const Flow& f, std::size_t i) { return f.eddy_viscosity_of(i); }, with_closure},
      {"divergence_of_position", on_request,
       [](const Flow& f, std::size_t i) { return (*f.moments.divergence_of_position)[i]; }},
      {"volume_fraction", always, [](const Flow& f) { return f.volume_fraction(); }, with_bubbles}};
  return fields;
}

void LesSph::declare_series() {
  const Flow& flow = flow_;
  series_.prepare = [this, &flow] { row_ = flow.totals(); };
  series_.add("kinetic_energy", "rho u^2 / 2, integral", [this] { return row_.kinetic; });
  series_.add("potential_energy", "rho g z, integral", [this] { return row_.potential; });
  series_.add("total_energy", "kinetic + potential", [this] { return row_.kinetic + row_.potential; });
  if (flow.features.working_forces || flow.features.sponges)
    series_.add("work",
                flow.features.sponges ? "of forces.body, of gravity along periodic axes and of sponges, since the start"
                                      : "of forces.body and of gravity along periodic axes, since the start",
                [&flow] { return flow.work; });
  series_.add("dissipation", "rho (nu + nu_t) |S|^2, integral", [&flow] { return flow.dissipation; });
  if (flow.features.eddy_viscosity)
    series_.add("unresolved_dissipation", "rho nu_t |S|^2, integral", [this] { return row_.unresolved_dissipation; });
  series_.add("max_speed", "speed", [&flow] { return flow.speeds.largest; });
  series_.add("mass", "mass, of the particles in the domain and above an open top", [this] { return row_.mass; });
  if (flow.features.openings) {
    const char* const unit = flow.dimensions == 3 ? "length^3, since the start" : "length^2, since the start";
    series_.add("volume_in", unit,
                [&flow] { return flow.particles.volume * static_cast<double>(flow.boundary.openings()->entered()); });
    series_.add("volume_out", unit,
                [&flow] { return flow.particles.volume * static_cast<double>(flow.boundary.openings()->left()); });
  }
  if (flow.spill.possible())
    series_.add("mass_removed", "mass, that left through open sides for good",
                [&flow] { return flow.particle_mass() * static_cast<double>(flow.spill.count()); });
  if (flow.features.density_relaxation)
    series_.add("volume", flow.dimensions == 3 ? "length^3, by kernel sums" : "length^2, by kernel sums",
                [&flow] { return flow.volume; });
  const char* const momentum[3] = {"momentum_x", "momentum_y", "momentum_z"};
  for (int axis = 0; axis < flow.dimensions; ++axis)
    series_.add(momentum[axis], "mass times speed",
                [this, axis] { return row_.momentum[static_cast<std::size_t>(axis)]; });
  series_.add("max_divergence", "of the predicted velocity, 1 / time", [&flow] { return flow.max_divergence; });
  series_.add("pressure_iterations", "1", [&flow] { return double(flow.solver.report().iterations); });
  series_.add("pressure_residual", "relative", [&flow] { return flow.solver.report().relative_residual; });
  series_.add("pressure_tolerance", "relative, asked of the step", [&flow] { return flow.solver.report().tolerance; });
  series_.add("surface_particles", "1", [&flow] {
    return flow.surface == nullptr ? 0.0 : static_cast<double>(flow.surface->surface_particles.size());
  });
  add_wall_columns(series_, flow.boundary);
  if (flow.bubbles != nullptr) flow.bubbles->add_columns(series_);
  flow_columns_ = series_.columns().size();
  flow.solutes.add_columns(series_, flow.bubbles.get());
}

// What its columns tell is not saved, nor found again by a run that is resumed: the flow stands still.
void LesSph::keep_last_flow() {
  std::vector<double> row(series_.columns().size());
  series_.values(row);
  last_flow_.assign(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(flow_columns_));
}

void LesSph::series_values(std::span<double> values) {
  ensure_started();
  series_.values(values);
  std::copy(last_flow_.begin(), last_flow_.end(), values.begin());
}

std::vector<ParticleSnapshot> LesSph::snapshot_on_demand() {
  ensure_started();
  std::vector<ParticleSnapshot> families{
      snapshot_.take("fluid", flow_.size(), flow_.particles.position, flow_.options.output.fields)};
  if (flow_.bubbles != nullptr && !flow_.bubbles->population().empty()) families.push_back(flow_.bubbles->snapshot());
  return families;
}

bool LesSph::tells_energy() const {
  const Features& has = flow_.features;
  const bool slides = std::any_of(flow_.scene.bodies.begin(), flow_.scene.bodies.end(),
                                  [](const Body& body) { return body.velocity.has_value(); });
  return !has.moving_walls && !has.openings && !has.bubbles && !slides &&
         (!has.moving_bodies || WorkOfBodies::tells_all(flow_.scene));
}

std::vector<Invariant> LesSph::invariants() const {
  const Features& has = flow_.features;
  // A particle keeps its mass: what is lost has left the domain.
  std::vector<Invariant> list{{.quantity = "mass_drift",
                               .kind = Invariant::Kind::drift,
                               .column = "mass",
                               .bound = std::numeric_limits<double>::epsilon()}};
  if (has.openings)
    list.back().beside = [this] {
      const OpenSides& openings = *flow_.boundary.openings();
      return flow_.particle_mass() * static_cast<double>(openings.left() - openings.entered());
    };
  // Liquid that fills its domain takes its volume: a void presses the other particles together. Below a surface nothing
  // tells it but the level of the liquid. Bubbles lower the kernel sums of the liquid around them.
  if (has.density_relaxation && !has.bubbles && (has.closed || !flow_.spill.possible())) {
    list.push_back({.quantity = "volume_drift",
                    .kind = Invariant::Kind::drift,
                    .column = "volume",
                    .bound = has.closed ? largest_volume_drift : largest_volume_drift_below_surface});
    if (has.openings)
      list.back().beside = [this] {
        const OpenSides& openings = *flow_.boundary.openings();
        return flow_.particles.volume * static_cast<double>(openings.left() - openings.entered());
      };
  }
  // Without forces, walls and solids the momentum stays. The corrected gradient is not antisymmetric, so that it drifts
  // by the truncation error.
  if (periodic() && !has.potential && !has.bubbles && !flow_.boundary.has_obstacles()) {
    const double mass = flow_.particle_mass() * static_cast<double>(flow_.size());
    const char* const momentum[3] = {"momentum_x", "momentum_y", "momentum_z"};
    for (int axis = 0; axis < flow_.dimensions; ++axis)
      list.push_back({.quantity = std::string(momentum[axis]) + "_change",
                      .kind = Invariant::Kind::change,
                      .column = momentum[axis],
                      .bound = largest_momentum_change,
                      .scale_column = "max_speed",
                      .scale_factor = mass});
  }
  // The energy, with what a compressible liquid stores in its pressure, cannot grow by more than the forces work. By
  // its discretisation a resolved run gains a few thousandths of its largest kinetic energy (breaking_wave 0.17 % at
  // 1/50), and the rearrangement of particles lifts liquid by a fraction of a spacing: 5e-4 in standing_wave, whose
  // waves are lower than a spacing and hold less than that would. Hence the bound, and the floor of the scale.
  // Bodies that float have some of it. A ball of 4 spacings of radius that rises from the floor makes 11 % of what
  // moves, of 10 spacings 2 %; cases/floating_box 0.6 %. What flings a body out of its tank makes all of it.
  // Bodies with a given motion do work, which the forces on them tell: of the oil of cases/sloshing in space within
  // 0.001 of the largest kinetic energy, and where it gained ten times that along a no-slip wall 0.7 was beyond them.
  if (tells_energy()) {
    Invariant energy{.quantity = "energy_growth",
                     .kind = Invariant::Kind::growth,
                     .column = "total_energy",
                     .bound = has.moving_bodies ? 0.05 : 0.01,
                     .scale_column = "kinetic_energy",
                     .scale_floor = 0.1 * flow_.weight * flow_.resolution.spacing};
    const bool stores = has.working_forces || has.sponges || flow_.scene.fluid.sound_speed > 0;
    const FloatingBodies* floating = flow_.floating.get();
    if (stores || has.moving_bodies)
      energy.beside = [this, stores, floating] {
        return (stores ? flow_.stored_energy() - flow_.work : 0.0) +
               (floating != nullptr ? floating->kinetic_energy() + floating->potential_energy() : 0.0) -
               (work_of_bodies_ ? work_of_bodies_->most() : 0.0);
      };
    if (floating != nullptr) energy.scale = [this, floating] { return row_.kinetic + floating->kinetic_energy(); };
    list.push_back(std::move(energy));
  }
  list.push_back({.quantity = "pressure_residual",
                  .kind = Invariant::Kind::largest,
                  .column = "pressure_residual",
                  .bound = largest_measured_residual,
                  .scale_column = "pressure_tolerance"});
  return list;
}

std::vector<ArrayInfo> LesSph::arrays() const {
  std::vector<ArrayInfo> list = particle_arrays(flow_.particles, flow_.arrangement);
  list.push_back({"pressure solver", flow_.solver.bytes()});
  list.push_back({"gradient corrections left out", flow_.moments.uncorrected.bytes()});
  list.push_back({"leased within a step", flow_.leased_bytes()});
  if (flow_.wall_bends != nullptr) list.push_back({"wall bends", flow_.wall_bends->bytes()});
  if (flow_.boundary.bodies() != nullptr) list.push_back({"wall points", flow_.boundary.bytes()});
  if (flow_.features.moving_walls && flow_.boundary.bodies() == nullptr)
    list.push_back({"velocities of images", flow_.boundary.bytes()});
  if (flow_.surface != nullptr) list.push_back({"surface", flow_.surface->bytes() + flow_.surface_source.bytes()});
  if (flow_.shift != nullptr) list.push_back({"layers of the shift", flow_.shift->bytes()});
  if (flow_.bubbles == nullptr) return list;
  list.push_back({"sizes of particles", flow_.sizes.bytes() + flow_.bubbles->viscosity().bytes()});
  for (const ArrayInfo& array : flow_.bubbles->arrays()) list.push_back(array);
  return list;
}

std::vector<RecordTable> LesSph::tables() const {
  std::vector<RecordTable> list;
  if (periodic()) list.push_back(spectrum_table());
  if (body_forces_ != nullptr) list.push_back(body_forces_->table());
  if (flow_.bubbles != nullptr)
    for (RecordTable& table : flow_.bubbles->tables()) list.push_back(std::move(table));
  return list;
}

void LesSph::table_rows(const std::string& name, std::vector<double>& rows) {
  ensure_started();
  if (name == "spectrum")
    add_spectrum_rows(rows);
  else if (name == "bodies")
    add_force_rows(rows);
  else if (flow_.bubbles != nullptr)
    flow_.bubbles->table_rows(name, rows);
}

std::vector<Remark> LesSph::take_remarks() {
  std::vector<Remark> remarks = std::exchange(remarks_, {});
  const std::string text = flow_.bubbles != nullptr ? flow_.bubbles->note() : std::string();
  if (!text.empty()) remarks.push_back({text, true});
  if (std::string remark = flow_.solver.take_remark(); !remark.empty()) remarks.push_back({std::move(remark), false});
  return remarks;
}

void LesSph::add_force_rows(std::vector<double>& rows) {
  body_forces_->add_rows(flow_.time, forces_on_bodies(), rows);
}

std::vector<SurfaceForce> LesSph::forces_on_bodies() {
  BodyForces::Fields fields(flow_.arrangement, flow_.particles, flow_.boundary.walls);
  fields.dynamic_viscosity = flow_.density() * flow_.viscosity();
  fields.density = [this](std::size_t) { return flow_.density(); };
  fields.pressure = [this](std::size_t i) { return (*flow_.pressure)[i]; };
  std::vector<SurfaceForce> forces = body_forces_->measure(fields, flow_.time);
  if (work_of_bodies_ && !flow_.solutes.record_carries())
    work_of_bodies_->add(flow_.time, forces, *flow_.boundary.bodies(), [this] {
      const FlowTotals totals = flow_.totals();
      return totals.kinetic + totals.potential;
    });
  return forces;
}

bool LesSph::periodic() const {
  for (int axis = 0; axis < flow_.dimensions; ++axis)
    if (!flow_.scene.domain.periodic(axis)) return false;
  return true;
}

void LesSph::add_spectrum_rows(std::vector<double>& rows) const {
  const Domain& domain = flow_.scene.domain;
  ParticleSpectrumInput input;
  input.dimensions = flow_.dimensions;
  input.lower = domain.lower;
  input.upper = domain.upper;
  input.spacing = flow_.resolution.spacing;
  for (int axis = 0; axis < flow_.dimensions; ++axis) {
    input.position[axis] = *flow_.particles.position[axis];
    input.velocity[axis] = *flow_.particles.velocity[axis];
  }
  const ParticleSpectrum result = energy_spectrum(input);
  add_spectrum(flow_.time, result.spectrum.wavenumber, result.spectrum.energy, rows);
}

}  // namespace spume::les_sph
