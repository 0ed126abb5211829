// SPDX-License-Identifier: MIT
// The stages of a step.
#include <algorithm>
#include <cmath>
#include <utility>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/wcsph/flow.hpp"
#include "spume/particles/bounded_shift.hpp"
#include "spume/particles/excess_step.hpp"
#include "spume/particles/settling.hpp"
#include "spume/particles/step_limits.hpp"

namespace spume::wcsph {
namespace {

// Sun et al. (2019): delta u = -2 U h grad C, of U / 2 at most.
constexpr double shifting_strength = 2, largest_shift = 0.5;

using Block = std::array<double, default_block>;  // of particles

}  // namespace

bool Flow::lists_hold(double dt) {
  if (features.displaced_bodies && boundary.bodies()->way_of_points(listed_time, time + dt) > skin / 2) return false;
  return list_life.last(dt, {read(listed), read(acceleration), read(shift)},
                        boundary.image_rules(arrangement.grid.support_radius()), particles.scratch());
}

void Flow::build_lists() {
  ScratchPool& scratch = particles.scratch();
  VectorScratch place_of_list;
  scratch.lease(place_of_list, dimensions, size());
  VectorField at{};
  for (int axis = 0; axis < dimensions; ++axis) at[axis] = &place_of_list[axis];
  const auto find_places = [&] {
    parallel_for(size(), [&](std::size_t i) {
      for (int axis = 0; axis < dimensions; ++axis) (*at[axis])[i] = listed_at(axis, i);
    });
  };
  find_places();
  arrangement.sort(particles, at);
  find_places();  // in the new order
  boundary.next_walls = boundary.walls;
  walls.take_points(listed_time);
  boundary.make_images(arrangement, particles, at, 1, {time, time, time}, false);
  arrangement.find_neighbours(particles, at, sizes);
  scratch.release(place_of_list);
  if (features.tension) tension->find_bands(arrangement, *phase_number);
  walls.find_entries(arrangement);
  list_life.remake();
  has_lists = true;
  ++list_builds;
}

// A restored state has the places of its lists: the same lists follow, with their neighbours in the same order.
void Flow::keep_lists(double dt) {
  if (!has_lists && started != 0) build_lists();
  const double way = dt * present_speed();
  has_moved = features.density_relaxation && steps > 0 && measured_way + way > skin / 2;
  if (has_lists && !(features.openings && openings->stale()) && lists_hold(dt)) return;
  if (has_lists)
    spill.remove({particles, arrangement.grid.support_radius(), features.several ? phase_number : nullptr,
                  openings == nullptr ? nullptr : &openings->column()},
                 time);
  if (features.openings && has_lists) openings->renew();
  listed_time = time;
  if (features.displaced_bodies) boundary.bodies()->move_to(time);
  parallel_for(size(), [&](std::size_t i) {
    Vec3 r = vector_at(particles.position, dimensions, i);
    apply_walls(i, r, nullptr, nullptr);
    for (int axis = 0; axis < dimensions; ++axis) {
      (*particles.position[axis])[i] = r[axis];
      (*listed[axis])[i] = static_cast<float>(r[axis] - arrangement.origin[axis]);
    }
  });
  build_lists();
  list_life.renew();
  if (lists_hold(dt)) return;
  throw StepFailure({.cause = "a particle would leave its lists of neighbours in one step",
                     .option = "time.courant",
                     .value = largest_speed});
}

void Flow::move_images(const std::array<const double*, 3>& at, double t) {
  walls.follow(t);
  boundary.move_images(arrangement, at, {t, t, t});
  walls.weigh(arrangement);
}

void Flow::apply_walls(std::size_t i, Vec3& r, Vec3* u, const Vec3* from) const {
  if (openings != nullptr)
    openings->apply_walls(boundary, i, r, u, from);
  else
    boundary.hold_liquid(boundary.walls, r, u, from);
}

void Flow::measure_volume() {
  move_images(read(particles.position), time);
  relaxation->measure();
  measured_way = 0;
}

void Flow::move_layers(double dt) {
  openings->set_velocities(time, dt);
}

void Flow::find_pressure_behind(double dt) {
  acoustic->find_pressures(
      {.arrangement = arrangement,
       .images = boundary.image_map(arrangement.images),
       .gravity = wall_gravity,
       .background = background,
       .time = time + dt,
       .velocity = [half = half_steps(dt)](int axis, std::size_t i) { return half.velocity_of(axis, i); }},
      next_excess, pressure, volume);
}

// Takes a block from the middle of the step to its end; whether walls have held one of it there. Velocities are found
// anew where they are wanted instead of being kept for half of a step.
bool Flow::arrive(const HalfSteps& half, std::size_t first, std::size_t last) {
  for (int axis = 0; axis < dimensions; ++axis) half.go_on(axis, first, last, place[axis].data());
  if (boundary.clear_of_sides(boundary.walls, read(place), first, last)) return false;
  bool any = false;
  for (std::size_t i = first; i < last; ++i) {
    const Vec3 free = vector_at(place, dimensions, i);
    Vec3 r = free, u{};
    for (int axis = 0; axis < dimensions; ++axis) u[axis] = half.velocity_of(axis, i);
    hold(i, r, u);
    any = any || r != free;
    for (int axis = 0; axis < dimensions; ++axis) place[axis][i] = r[axis];
  }
  return any;
}

// r' and u* of particle i held by the walls of the end of the step.
void Flow::hold(std::size_t i, Vec3& r, Vec3& u) const {
  if (boundary.clear_of_sides(r)) return;
  const Vec3 before = r, from = vector_at(particles.position, dimensions, i);
  apply_walls(i, r, &u, &from);
  // Particles go round periodic sides when lists are made, those of inflows keep to their columns: walls alone count.
  const Vec3 pushed = scene.domain.shortest(subtract(r, scene.domain.inside(before)));
  for (int axis = 0; axis < dimensions && !(features.openings && openings->leads(i)); ++axis)
    if (scene.domain.periodic(axis)) r[axis] = before[axis] + pushed[axis];
}

void Flow::drift(double dt) {
  // A step that was refused has left its forces leased, which the pressure force of this one would take for viscous
  // ones.
  release_leased();
  ScratchPool& scratch = particles.scratch();
  // Wall points take averages of it; without them the sweep finds it where it packs it.
  if (features.bodies) scratch.lease(half_velocity, dimensions, size());
  scratch.lease(place, dimensions, size());
  parallel_blocks(size(), default_block, [&, half = half_steps(dt)](std::size_t, std::size_t first, std::size_t last) {
    for (int axis = 0; axis < dimensions; ++axis) {
      if (features.bodies) half.velocities(axis, first, last, half_velocity[axis].data());
      half.middles(axis, first, last, place[axis].data());
    }
  });
  move_images(read(place), time + dt / 2);
}

void Flow::lease_properties() {
  ScratchPool& scratch = particles.scratch();
  scratch.lease(volume, size());
  scratch.lease(reduced_excess, size());
  if (needs_density()) scratch.lease(density, size());
  if (needs_viscosity()) scratch.lease(viscosity, size());
  const ReducedExcess properties{.dimensions = dimensions,
                                 .law = law_of_particles(),
                                 .excess = excess->data(),
                                 .gravity = wall_gravity,
                                 .origin = arrangement.origin,
                                 .place = read(place),
                                 .volume = volume.data(),
                                 .reduced = reduced_excess.data()};
  parallel_blocks(size(), default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    properties.find(first, last);
    for (std::size_t i = first; i < last && needs_density(); ++i) density[i] = phase_density[phase_of(i)];
    for (std::size_t i = first; i < last && needs_viscosity(); ++i) viscosity[i] = static_cast<float>(law(i).viscosity);
  });
}

void Flow::find_rates(double dt) {
  lease_properties();
  ScratchPool& scratch = particles.scratch();
  scratch.lease(rate, size());
  scratch.lease(diffusion, size());
  if (features.viscosity) scratch.lease(force, dimensions, size());
  if (features.shifting) {
    scratch.lease(carried, size());
    scratch.lease(flux, dimensions, size());
  }
  continuity_sweep(arrangement.context, arrangement.packed,
                   {.velocity = features.bodies ? read(half_velocity) : read(particles.velocity),
                    .acceleration = features.bodies ? std::array<const float*, 3>{} : read(acceleration),
                    .ahead = dt / 2,
                    .mirror = &boundary.volume_rule(),
                    .walls_move = features.wall_rates,
                    .friction = features.friction || features.wall_rates ? &boundary.velocity_rule() : nullptr,
                    .volume = volume.data(),
                    .excess = reduced_excess.data(),
                    .phase = needs_phase() ? density.data() : nullptr,
                    .weighted = features.weighted,
                    .viscosity = needs_viscosity() ? viscosity.data() : nullptr,
                    .common_viscosity = features.several ? 0 : static_cast<float>(laws[0].viscosity),
                    .shift = read(shift),
                    .reflection = &boundary.reflection()},
                   {.rate = rate.data(),
                    .diffusion = diffusion.data(),
                    .viscous = write(force),
                    .carried = carried.data(),
                    .flux = write(flux)});
  if (features.wall_rates) walls.add_rates(arrangement, read(half_velocity), volume.data(), rate.data());
  scratch.release(half_velocity);
  scratch.release(viscosity);
  scratch.release(reduced_excess);
}

void Flow::advance_density(double dt) {
  ScratchPool& scratch = particles.scratch();
  scratch.lease(next_excess, size());
  scratch.lease(pressure, size());
  const double smoothing =
      features.diffusion ? options.get<CompressibilityOptions>().diffusion * resolution.smoothing_length : 0;
  if (features.displaced_bodies) boundary.bodies()->follow_points(time + dt);
  const ExcessStep excess_step{.dt = dt,
                               .dimensions = dimensions,
                               .law = law_of_particles(),
                               .excess = excess->data(),
                               .left_out = layer(),
                               .rate = rate.data(),
                               .spread = diffusion.data(),
                               .diffusion = smoothing,
                               .lack = features.density_relaxation ? relaxation->lack() : nullptr,
                               .share = features.density_relaxation ? relaxation->share_of(dt * present_speed()) : 0,
                               .carried = carried.data(),
                               .shift = read(shift),
                               .gravity = wall_gravity,
                               .background = background,
                               .next = next_excess.data(),
                               .pressure = pressure.data(),
                               .volume = volume.data()};
  const HalfSteps half = half_steps(dt);
  held.resize(block_count(size(), default_block));
  parallel_blocks(size(), default_block, [&](std::size_t block, std::size_t first, std::size_t last) {
    excess_step.advance(first, last);
    held[block] = arrive(half, first, last) ? 1 : 0;
  });
  scratch.release(rate);
  scratch.release(diffusion);
  scratch.release(carried);
  move_images(read(place), time + dt);
}

void Flow::filter_density() {
  ScratchPool& scratch = particles.scratch();
  ScratchArray<float> filtered(scratch, size());
  if (!needs_density()) {
    scratch.lease(density, size());
    density.fill(phase_density[0]);
  }
  density_filter_sweep(arrangement.context, arrangement.packed, volume.data(), density.data(), filtered.data());
  parallel_for(size(), [&](std::size_t i) {
    next_excess[i] = filtered[i];
    pressure[i] = static_cast<float>(pressure_at(filtered[i], i));
    volume[i] = 1 / (1 + filtered[i]);
  });
}

void Flow::find_pressure_force() {
  walls.find_pressure(arrangement, pressure.data(), density.data(), still);
  still.subtract(read(place), size(), pressure.data());
  ScratchPool& scratch = particles.scratch();
  const auto viscous = read(force);  // null without viscosity
  scratch.lease(force, dimensions, size());
  if (features.shifting) scratch.lease(concentration, dimensions, size());
  pressure_force_sweep(arrangement.context, arrangement.packed,
                       {.pressure = pressure.data(),
                        .left_out = still.pressure_gradient(),
                        .volume = volume.data(),
                        .density = density.data(),
                        .several = features.several,
                        .weighted = features.weighted,
                        .repulsion = static_cast<float>(options.get<CompressibilityOptions>().repulsion),
                        .others = viscous,
                        .gravity = wall_gravity,
                        .position = read(place),
                        .wall_pressure = walls.pressure(),
                        .wall_density = walls.density(),
                        .wall_position = walls.place()},
                       write(force), write(concentration));
  if (scene.free_surface) parting.add_forces(size(), parted(read(place)), write(force));
}

WallParting::Liquid Flow::parted(const std::array<const double*, 3>& at) const {
  return {.law = law_of_particles(),
          .place = at,
          .volume = volume.data(),
          .gradient_scale = arrangement.context.gradient_scale};
}

// At rest under the forces that a step finds.
void Flow::settle(const GoOn& go_on) {
  const auto with_forces = [this](const Settling::UseForces& use) {
    keep_lists(0);
    drift(0);
    lease_properties();
    particles.scratch().lease(pressure, size());
    parallel_for(size(), [&](std::size_t i) { pressure[i] = static_cast<float>(pressure_at((*excess)[i], i)); });
    find_pressure_force();
    use({pressure.data(), force});
    release_leased();
  };
  unsettled = Settling{.scene = scene,
                       .boundary = boundary,
                       .resolution = resolution,
                       .particles = particles,
                       .arrangement = arrangement,
                       .law = law_of_particles(),
                       .excess = *excess,
                       .gravity = wall_gravity,
                       .still = still,
                       .of_sides = scene.free_surface ? parting.stress() : 0,
                       .chosen = features.rest.chosen,
                       .most_rounds = options.get<CompressibilityOptions>().settling_rounds,
                       .with_forces = with_forces}
                  .settle(go_on);
  keep_lists(0);
  if (features.density_relaxation) relaxation->take_as_rest();
  if (features.scalars) solutes.scalars->set_initial();
  has_lists = false;  // the first step makes its own
  strain = infinite;
}

void Flow::add_tension() {
  tension->find_potentials(tension_now());
  tension->add_force(tension_now(), write(force));
}

void Flow::accept(double dt) {
  const bool tears = openings != nullptr && features.several && !features.shifting;
  refuse_burst(particles, {particles.position, next_excess.data(), force},
               tears ? "compressibility.shifting" : "compressibility.max_speed");
  solute_transport.keep_shift(shift, dt);
  // Contacts and openings change the new state.
  const bool final = !features.bodies && !features.openings;
  const HalfSteps half = half_steps(dt);
  const Fastest::State state = moving(next_excess.data());
  const Fastest fastest = parallel_reduce(
      size(), Fastest{},
      [&](std::size_t first, std::size_t last) {
        const VectorExpression given = scene.body_force ? scene.body_force->clone() : VectorExpression();
        Fastest so_far;
        for (std::size_t from = first, to = first; from < last; from = to) {
          to = std::min(last, (from / default_block + 1) * default_block);
          accept_block(half, given, from, to);
          if (final) so_far.take(state, from, to);
        }
        return so_far;
      },
      Fastest::of_both);
  // A copy would move 64 bytes a particle.
  for (int axis = 0; axis < dimensions; ++axis) particles.position[axis]->swap(place[axis]);
  excess->swap(next_excess);
  if (features.bodies) contacts.bear(walls.near(), {particles, acceleration, law_of_particles(), dt});
  release_leased();
  boundary.accept();
  if (features.openings) {
    acoustic->follow(dt);
    const std::vector<double> amounts = features.scalars ? solutes.scalars->amounts() : std::vector<double>();
    openings->accept();
    if (features.scalars) solutes.scalars->count_openings(amounts);
  }
  if (features.tension) surface_energy = tension->energy();
  list_life.accept();
  if (features.density_relaxation) measured_way += dt * present_speed();
  time += dt;
  if (dt > 0) ++steps;
  final ? take(fastest) : find_signal();
}

// Of particles that one block of `held` speaks of.
void Flow::accept_block(const HalfSteps& half, const VectorExpression& given, std::size_t first, std::size_t last) {
  const auto velocity = write(particles.velocity);
  for (int axis = 0; axis < dimensions; ++axis) half.velocities(axis, first, last, velocity[axis]);
  for (std::size_t i = first; i < last && held[first / default_block] != 0; ++i) {
    Vec3 u = vector_at(particles.velocity, dimensions, i), r{};
    for (int axis = 0; axis < dimensions; ++axis) r[axis] = half.end_of(axis, i, u[axis]);
    if (r == vector_at(place, dimensions, i)) continue;  // where no wall has moved the particle none has held it
    hold(i, r, u);
    for (int axis = 0; axis < dimensions; ++axis) velocity[axis][i] = u[axis];
  }
  const std::size_t n = last - first;
  Block specific_volume, forced;
  law_of_particles().each_run(first, last, [&](const PhaseLaw& own, std::size_t from, std::size_t to) {
    const double* const s = next_excess.data() + first;
    for (std::size_t k = from - first; k < to - first; ++k) specific_volume[k] = 1 / (own.density * (1 + s[k]));
  });
  std::array<Vec3, default_block> everywhere;
  for (std::size_t k = 0; k < n && scene.body_force; ++k)
    everywhere[k] = given(scene.domain.inside(vector_at(place, dimensions, first + k)), time + half.dt);
  for (int axis = 0; axis < dimensions; ++axis) {
    const double g = scene.fluid.gravity[axis];
    forced.fill(g);
    for (std::size_t k = 0; k < n && still; ++k)
      forced[k] -= still.lost_share(specific_volume[k]) * still.gravity[axis];
    for (std::size_t k = 0; k < n && scene.body_force; ++k) forced[k] += everywhere[k][axis];
    const float* const f = force[axis].data() + first;
    for (std::size_t k = 0; k < n; ++k) forced[k] += specific_volume[k] * f[k];
    for (std::size_t k = 0; k < n && features.shifting; ++k) forced[k] += flux[axis][first + k];
    for (std::size_t k = 0; k < n && features.openings; ++k) forced[k] = in_domain(first + k) ? forced[k] : 0;
    half.finish(first, last, forced.data(), acceleration[axis]->data(), velocity[axis]);
  }
  if (features.shifting)
    BoundedShift{.dimensions = dimensions,
                 .strength = shifting_strength * shift_speed(),
                 .bound = largest_shift * shift_speed(),
                 .concentration = read(concentration),
                 .left_out = layer(),
                 .shift = write(shift)}
        .find(first, last);
}

void Flow::release_leased() {
  ScratchPool& scratch = particles.scratch();
  for (auto* vector : {&half_velocity, &place}) scratch.release(*vector);
  for (auto* vector : {&force, &flux, &concentration}) scratch.release(*vector);
  scratch.release(next_excess);
  walls.release();
  for (auto* array : {&pressure, &volume, &density, &viscosity, &reduced_excess}) scratch.release(*array);
}

std::vector<SurfaceForce> Flow::forces_on_bodies() {
  if (!has_lists) build_lists();
  move_images(read(particles.position), time);
  for (auto* array : {&volume, &density, &viscosity, &pressure}) particles.scratch().lease(*array, size());
  parallel_for(size(), [&](std::size_t i) {
    volume[i] = static_cast<float>(1 / (1 + (*excess)[i]));
    density[i] = static_cast<float>(law(i).density);
    viscosity[i] = static_cast<float>(law(i).viscosity);
    pressure[i] = static_cast<float>(pressure_at((*excess)[i], i));
  });
  walls.find_pressure(arrangement, pressure.data(), density.data(), still);
  still.subtract(read(particles.position), size(), pressure.data());
  std::vector<SurfaceForce> forces =
      walls.forces(arrangement, {.velocity = read(particles.velocity),
                                 .pressure = pressure.data(),
                                 .left_out = still.pressure_gradient(),
                                 .volume = volume.data(),
                                 .viscosity = features.viscosity ? viscosity.data() : nullptr,
                                 .friction = features.friction});
  contacts.add_to_bodies(forces);
  if (scene.free_surface) parting.add_to_bodies(size(), parted(read(particles.position)), forces);
  release_leased();
  return forces;
}

}  // namespace spume::wcsph
