// SPDX-License-Identifier: MIT
// What the driver asks of the method: steps and their limits, start, save and load.
#include "spume/methods/les_sph/les_sph.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "full_tanks.hpp"
#include "spume/core/error.hpp"
#include "spume/methods/les_sph/step.hpp"
#include "spume/particles/column_pressure.hpp"
#include "spume/scene/document.hpp"
#include "spume/scene/refusal.hpp"

namespace spume::les_sph {
namespace {

// Of the speed to the sound speed. The density changes by half its square: at 0.5 by an eighth, which a weakly
// compressible liquid leaves out; 0.1 is usual and keeps it within 1 % (Monaghan 1994).
constexpr double largest_mach = 0.5, usual_mach = 0.1;

// Of the support radius, which spray crosses in a step: a step across half of it is refused, a tenth less leaves room
// for what accelerates within the step.
constexpr double spray_stride = 0.45;

// In smoothing lengths: what a bubble crosses in a step, a quarter of the radius within which it sees the liquid. In a
// plume the liquid limits the step: 0.25 and 1 leave its bits.
constexpr double bubble_stride = 0.5;

// Of h^2 / nu: with cubics through no-slip surfaces the spectrum of the viscous sums ends at -9.2 / h^2, over jittered
// lattices in two and three dimensions and the particles beside a cylinder, in place of -7.5.
constexpr double most_viscous_beside_no_slip = 0.2;

// A liquid at rest without forces: the first steps follow the time scale of the run.
constexpr double steps_of_run_at_rest = 1000;

void refuse_high_mach(const Case& options, const Flow& flow) {
  const double c = flow.scene.fluid.sound_speed, speed = flow.speeds.largest;
  if (!(c > 0) || speed <= largest_mach * c) return;
  char text[300];
  std::snprintf(text, sizeof text,
                "the liquid starts with a speed of %.4g, which is %.3g of the sound speed %.4g; a weakly compressible "
                "liquid needs at most %.3g: raise the sound speed %.3g times (fluid.sound_speed, or fluid.mach lower), "
                "or leave it out for an incompressible liquid",
                speed, speed / c, c, largest_mach, speed / (usual_mach * c));
  throw refusal(options, options.places.count("fluid.mach") > 0 ? "fluid.mach" : "fluid.sound_speed", text);
}

void refuse_stirring_shift(const Case& options, const Flow& flow) {
  if (!flow.features.shifting || options.get<ShiftingOptions>().coefficient <= flow.largest_shift) return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "shifting.coefficient is %.3g; above %.3g the shift throws the particles of a lattice from side to side "
      "instead of evening them out: lower it (%.3g is usual)",
      options.get<ShiftingOptions>().coefficient, flow.largest_shift, ShiftingOptions{}.coefficient);
  throw refusal(options, "shifting.coefficient", text);
}

}  // namespace

LesSph::LesSph(const LoadedCase& loaded)
    : flow_(loaded), plan_(make_plan(flow_)), snapshot_(snapshot_table(output_fields(), loaded.options, flow_)) {
  refuse_high_mach(loaded.options, flow_);
  refuse_stirring_shift(loaded.options, flow_);
  if (flow_.floating != nullptr) flow_.speed_of_bodies = speed_of_bodies(loaded.scene, loaded.options.time.end);
  if (flow_.features.scalars) flow_.solutes.scalars->add_fields(snapshot_);
  declare_series();
  if (tells_energy() && WorkOfBodies::any(flow_.scene)) work_of_bodies_.emplace(flow_.scene);
  if (flow_.features.moves_in_full_tank && !flow_.features.removes_drift &&
      loaded.options.places.count("shifting.remove_drift") > 0 && loaded.options.get<ShiftingOptions>().remove_drift)
    remarks_.push_back(
        {"shifting.remove_drift = true has no effect where a body moves among liquid that fills its "
         "domain: what it would take off closes the void behind the body",
         false});
  declare_saved();
  if (flow_.features.bodies)
    body_forces_ = std::make_unique<const BodyForces>(flow_.scene, flow_.resolution, *flow_.boundary.bodies());
}

void LesSph::step(double dt, Ledger& ledger) {
  if (!flow_.started) start(ledger);
  plan_.list(ledger);
  for (const Ledger::Entry& entry : start_ledger_.entries())
    ledger.count(entry.stage, entry.calls, entry.seconds, entry.particles, entry.pairs, entry.bytes);
  start_ledger_.clear();
  if (flow_.solutes.record_carries()) {
    plan_.run_recorded(dt, static_cast<double>(flow_.size()), ledger);
    return;
  }
  flow_.remove_left();
  if (std::string remark = flow_.spill.take_remark(); !remark.empty()) remarks_.push_back({std::move(remark), false});
  sampled_step_ = -1;  // sorting changes what the bins of the sampler refer to, also when the step is refused
  plan_.run_step(dt, static_cast<double>(flow_.size()), ledger);
  if (work_of_bodies_ && WorkOfBodies::due(flow_.steps)) {
    const double n = static_cast<double>(flow_.size());
    const Ledger::Scope timed = ledger.time("work of bodies", n, 0, n * BodyForces::bytes_read(flow_.dimensions));
    forces_on_bodies();
  }
  remark_bodies_that_collide();
  if (flow_.solutes.record_carries()) keep_last_flow();
}

void LesSph::remark_bodies_that_collide() {
  if (flow_.floating == nullptr || collided_) return;
  const std::optional<std::size_t> body = body_forces_->floats_through(flow_.boundary.walls);
  if (!body) return;
  collided_ = true;
  const Body& through = flow_.scene.bodies[*body];
  char text[240];
  std::snprintf(text, sizeof text, "the body '%s' goes through a wall or another body at t = %.4g: %s",
                through.name.c_str(), flow_.time,
                flow_.floating->overlaps_at_start(*through.motion)
                    ? "bodies that overlap at the start do not touch; move them apart, or hold it with free"
                    : "places of its surface a spacing apart touch, within a step as they turn in a short one; shorten "
                      "time.max_step, or refine resolution.spacing");
  remarks_.push_back({text, false});
}

// A Helmholtz step needs p^n: without this solve the first step would start from zero pressure.
void LesSph::start(Ledger& ledger) {
  if (flow_.size() > 0) {
    plan_.run_start(static_cast<double>(flow_.size()), ledger);
    if (flow_.floating != nullptr) flow_.floating->accept(0);
    flow_.boundary.accept();
    if (flow_.features.openings) flow_.boundary.follow(read(flow_.particles.velocity));
    flow_.volume = flow_.particles.volume * static_cast<double>(flow_.size());
    flow_.energy.start(flow_.energy_balance(0), flow_.particles, flow_.stored_energy());
    if (!flow_.features.velocity_gradient) flow_.strain->release();
    if (std::string remark = remark_on_gaps_in_full_tank(flow_); !remark.empty())
      remarks_.push_back({std::move(remark), false});
    remark_surface_at_bodies();
    remark_edges_at_surface();
    remark_wide_kernel();
    remark_bubbles_beside_thin_bodies();
  }
  flow_.started = true;
}

void LesSph::remark_surface_at_bodies() {
  if (flow_.surface == nullptr || flow_.boundary.bodies() == nullptr) return;
  const Array<std::int32_t>& surface = flow_.surface->surface_particles;
  const double reach = flow_.resolution.support_radius;
  // Water that meets the program's own flap stays still.
  std::vector<const Body*> bodies;
  for (const Body& body : flow_.boundary.bodies()->bodies())
    if (body.wall != BoundaryKind::open && body.kind != "flap") bodies.push_back(&body);
  const auto is_near = [&](const Vec3& place) {
    const auto near = [&](const Body* body) { return body->solid->distance(place) < reach; };
    return flow_.boundary.bodies()->nearer_than(place, reach) && std::any_of(bodies.begin(), bodies.end(), near);
  };
  const double beside = parallel_sum(surface.size(), [&](std::size_t k) {
    const Vec3 place = vector_at(flow_.particles.position, flow_.dimensions, static_cast<std::size_t>(surface[k]));
    const bool around = flow_.surface->has_planes_around(static_cast<std::size_t>(surface[k]));
    return !around && is_near(place) ? 1.0 : 0.0;
  });
  if (beside == 0) return;
  const bool alone = bodies.size() == 1;
  const std::string where = alone ? "beside the body" : "between bodies";
  const std::string cure = alone ? "part it by five spacings from the walls of the domain, or let it reach them"
                                 : "join the bodies, or part them by five spacings";
  remarks_.push_back({std::to_string(static_cast<long long>(beside)) +
                          (beside == 1 ? " particle at the start counts" : " particles at the start count") +
                          " as a free surface " + where +
                          ": where a gap too narrow for particles meets the surface still water does not stay still "
                          "(0.5 sqrt(g H) over a ball that touches a wall there); " +
                          cure,
                      false});
}

// Whether no particle stands within 45 degrees above one; upright faces of liquid have some.
bool LesSph::lies_on_top(std::int32_t particle, const Vec3& up) const {
  const auto i = static_cast<std::size_t>(particle);
  const NeighbourList& list = flow_.arrangement.list;
  for (const std::int32_t j : list.of(i)) {
    Vec3 way{};
    for (int axis = 0; axis < flow_.dimensions; ++axis)
      way[axis] = double{list.coordinate(axis)[j]} - list.coordinate(axis)[i];
    const bool stands = j < static_cast<std::int32_t>(list.particles());
    if (stands && dot(way, up) > length(way) / std::sqrt(2.0)) return false;
  }
  return true;
}

// Of the highest place of a body. A slanted plate whose edge ends within 1.2 spacings of the surface stirs still water
// by 0.02 to 0.28 sqrt(g H), one that ends 1.5 spacings below it or above by 5e-4 and 5e-5.
void LesSph::remark_edges_at_surface() {
  constexpr double beside = 1.25, near = 3;  // spacings
  const BodyWalls* walls = flow_.boundary.bodies();
  const Vec3 gravity = gravity_across_sides(flow_.scene);
  if (flow_.surface == nullptr || walls == nullptr || gravity == Vec3{}) return;
  const Vec3 up = multiply(-1 / length(gravity), gravity);
  std::vector<double> tops(walls->bodies().size(), -INFINITY);
  for (const WallPoint& point : walls->all_points()) {
    if (point.past_edge) continue;
    double& top = tops[walls->nearest_wall(point.foot).body];
    top = std::max(top, dot(up, point.foot));
  }
  const double spacing = flow_.scene.spacing;
  std::vector<bool> ends(tops.size(), false);
  for (const std::int32_t i : flow_.surface->surface_particles) {
    const Vec3 place = vector_at(flow_.particles.position, flow_.dimensions, static_cast<std::size_t>(i));
    if (!walls->nearer_than(place, near * spacing)) continue;
    // Feet of wall points stand half a spacing from an edge at most.
    const std::size_t body = walls->nearest_wall(place).body;
    if (std::abs(tops[body] - dot(up, place) - spacing / 2) < beside * spacing && lies_on_top(i, up)) ends[body] = true;
  }
  for (std::size_t b = 0; b < tops.size(); ++b) {
    if (!ends[b]) continue;
    remarks_.push_back({"body \"" + walls->bodies()[b].name +
                            "\" ends within about a spacing of the surface, where still water does not stay still (up "
                            "to 0.3 sqrt(g H)): end it two spacings above or below, or lower resolution.spacing",
                        false});
  }
}

// Ripples grow below a surface that a wide kernel finds: water 10 spacings deep, at rest, moved after 20 s with 0.1
// sqrt(g H) at 1.3 with the quintic spline and after 30 s with 0.01 at 1.6 with Wendland's, and with 3e-7 at 1.2
// and 1.5.
void LesSph::remark_wide_kernel() {
  const Resolution& resolution = flow_.resolution;
  const double widest = resolution.kernel == KernelKind::quintic_spline ? 1.2 : 1.5;
  if (flow_.surface == nullptr || !flow_.features.potential || resolution.smoothing_ratio <= widest) return;
  remarks_.push_back(
      {"resolution.smoothing_ratio = " + brief(resolution.smoothing_ratio) +
           " is wide for this kernel below a free surface: liquid at rest moves by itself in the end; take " +
           brief(widest) + " at most",
       false});
}

// Particles do not, but what bubbles give and take is weighed by distance alone.
void LesSph::remark_bubbles_beside_thin_bodies() {
  const BodyWalls* bodies = flow_.boundary.bodies();
  if (!flow_.features.bubbles || bodies == nullptr || bodies->thin() == nullptr) return;
  remarks_.push_back({"bubbles act through bodies thinner than five spacings, " + brief(5 * flow_.scene.spacing) +
                          ", on the liquid beyond; lower resolution.spacing where they rise beside one",
                      false});
}

void LesSph::ensure_started() {
  if (!flow_.started) start(start_ledger_);
}

StepLimit LesSph::step_limit() const {
  if (flow_.solutes.record_carries()) return {flow_.solutes.recorded->step(flow_.time, 0), "outputs"};
  const double h = flow_.resolution.smoothing_length;
  const TimeOptions& options = flow_.options.time;
  double most_diffusion = flow_.options.get<SchemeOptions>().viscous;
  if (flow_.features.no_slip_bodies || flow_.features.wall_bends)
    most_diffusion = std::min(most_diffusion, most_viscous_beside_no_slip);
  Vec3 force = flow_.scene.fluid.gravity;
  if (flow_.features.uniform_body_force) {
    const Vec3 beside = (*flow_.scene.body_force)(flow_.arrangement.origin, flow_.time);
    for (int axis = 0; axis < flow_.dimensions; ++axis) force[axis] += beside[axis];
  }
  double acceleration2 = 0;
  for (const double a : force) acceleration2 += a * a;
  const bool varying_force = flow_.features.body_force && !flow_.features.uniform_body_force;
  acceleration2 = std::max(acceleration2, flow_.largest_body_force * flow_.largest_body_force);
  // From rest the speed that the force gives over one smoothing length stands in for the largest speed, and beside a
  // moving wall that of the wall.
  const double speed = std::max({flow_.speeds.limiting, flow_.boundary.wall_speed,
                                 flow_.floating == nullptr ? 0.0 : flow_.floating->largest_speed(),
                                 std::sqrt(std::sqrt(acceleration2) * h)});
  SmallestStep step;
  if (speed > 0) step.bound(options.courant * h / speed, "courant");
  if (flow_.floating != nullptr && flow_.floating->step_of_impact() > 0)
    step.bound(flow_.floating->step_of_impact(), "impact");
  if (flow_.floating != nullptr) step.bound(flow_.floating->longest_step(), "contacts");
  // Spray does not count to that speed, but a step that takes any particle across half its support is refused.
  if (flow_.speeds.largest > 0)
    step.bound(spray_stride * flow_.arrangement.grid.support_radius() / flow_.speeds.largest, "spray");
  const double viscosity = flow_.viscosity() + flow_.max_eddy_viscosity;
  // The explicit sum of div(2 nu S) is stable up to 0.108 h^2 / nu on a lattice in 3-D and 0.112 in 2-D, that of
  // div(nu grad u) up to 0.29 and 0.31.
  if (viscosity > 0) step.bound(most_diffusion * h * h / (flow_.diffusion_rate() * viscosity), "viscous");
  if (flow_.bubbles != nullptr && flow_.bubbles->max_speed() > 0)
    step.bound(bubble_stride * h / flow_.bubbles->max_speed(), "bubbles");
  if (options.max_step > 0) step.bound(options.max_step, "max_step");
  // A force that varies in space is known at the end of the last step only, and may have risen since. Of two steps one
  // may have been cut short to meet an output time.
  if (varying_force && flow_.steps > 0)
    step.bound(2 * std::max(flow_.last_steps[0], flow_.last_steps[1]), "growth of the step");
  if (speed == 0 && options.max_step == 0) step.bound(options.end / steps_of_run_at_rest, "end of run");
  if (flow_.solutes.recorded != nullptr)
    step.bound(flow_.solutes.recorded->step(flow_.time, step.limit().dt), "recorded_flow.lag");
  return step.limit();
}

const PointSampler& LesSph::sampler() {
  ensure_started();
  if (sampled_step_ != flow_.steps) {
    sampler_.update({.arrangement = &flow_.arrangement,
                     .boundary = &flow_.boundary,
                     .particles = &flow_.particles,
                     .resolution = &flow_.resolution,
                     .scalars = {{flow_.pressure, flow_.density()}},
                     .volume_fraction = flow_.volume_fraction(),
                     .uniform_acceleration = flow_.uniform_acceleration,
                     .time = flow_.time});
    sampled_step_ = flow_.steps;
  }
  return sampler_;
}

void LesSph::declare_saved() {
  saved_.add(flow_.time)
      .add(flow_.speeds.largest)
      .add(flow_.speeds.limiting)
      .add(flow_.max_eddy_viscosity)
      .add(flow_.max_divergence)
      .add(flow_.dissipation)
      .add(flow_.energy.supply)
      .add(flow_.work)
      .add(flow_.boundary.wall_speed)
      .add(flow_.largest_body_force)
      .add(flow_.last_steps[0])
      .add(flow_.last_steps[1])
      .add(flow_.solver.looks_for_enclosed);
  if (work_of_bodies_) work_of_bodies_->save_with(saved_);
}

void LesSph::save(StateWriter& writer) const {
  const std::int64_t counters[] = {flow_.steps, flow_.started ? 1 : 0, static_cast<std::int64_t>(flow_.size())};
  saved_.save(writer);
  writer.i64("counters", counters);
  flow_.spill.save(writer);
  flow_.boundary.save_walls(writer);
  save_fields(flow_.particles.fields, writer);
  if (flow_.features.openings) flow_.boundary.openings()->save(writer);
  if (flow_.bubbles != nullptr) flow_.bubbles->save(writer);
  if (flow_.floating != nullptr) flow_.floating->save(writer);
  flow_.solutes.save(writer);
  if (flow_.solutes.record_carries()) writer.f64("last_flow", last_flow_);
}

void LesSph::load(StateReader& reader) {
  sampled_step_ = -1;
  Array<std::int64_t> counters;
  saved_.load(reader);
  reader.i64("counters", counters);
  if (flow_.floating != nullptr) flow_.floating->load(reader);
  flow_.boundary.load_walls(reader, flow_.time);
  flow_.spill.load(reader);
  if (counters.size() != 3) throw FileError("the checkpoint was written by another version of the method");
  load_fields(flow_.particles.fields, static_cast<std::size_t>(counters[2]), "particle", reader);
  flow_.steps = counters[0];
  flow_.started = counters[1] != 0;
  if (flow_.started) flow_.start_columns.reset();
  flow_.find_uniform_acceleration(flow_.time);  // samples before the next step need it
  if (flow_.features.openings) flow_.boundary.openings()->load(reader);
  if (flow_.bubbles != nullptr) flow_.bubbles->load(reader);
  flow_.solutes.load(reader);
  if (!flow_.solutes.record_carries()) return;
  Array<double> last;
  reader.f64("last_flow", last);
  if (last.size() != flow_columns_) throw FileError("the checkpoint was written by another version of the method");
  last_flow_.assign(last.data(), last.data() + last.size());
}

}  // namespace spume::les_sph
