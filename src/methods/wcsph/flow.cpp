// SPDX-License-Identifier: MIT
// What exists for a scene, its equations of state, its first pressure, and quantities of the present state.
#include "spume/methods/wcsph/flow.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/parallel.hpp"
#include "spume/particles/column_pressure.hpp"
#include "spume/particles/expected_speed.hpp"
#include "spume/particles/options.hpp"

namespace spume::wcsph {
namespace {

double speed_of(const LoadedCase& loaded, bool falls = true) {
  const double given = loaded.options.get<CompressibilityOptions>().max_speed;
  return given > 0 ? given : spume::expected_speed(loaded.scene, loaded.options.time.end, falls);
}

// Particles under tension clump, and pressures below zero would let them: where no hydrostatic pressure keeps them
// above it, the dynamic one does. Shifting keeps the particles apart by itself, and a background pressure would only
// drive its noise: the vortices of cases/taylor_green_wcsph decay too fast by 16 % with it and by 1.4 % without.
double background_of(const LoadedCase& loaded, const Features& features, double speed,
                     const std::vector<PhaseLaw>& laws, const StillLiquid& still) {
  const double given = loaded.options.get<CompressibilityOptions>().background_pressure;
  if (given >= 0) return given;
  if (still && !features.shifting) return still.background();
  if (features.gravity || features.shifting || loaded.scene.free_surface) return 0;
  return dynamic_pressure(laws, speed);
}

}  // namespace

Features::Features(const LoadedCase& loaded)
    : BoundaryFeatures(loaded.scene.domain, loaded.scene.bodies, loaded.scene.openings),
      SoluteFeatures(loaded.options) {
  const Scene& scene = loaded.scene;
  several = scene.phases.size() > 1;
  gravity = gravity_across_sides(scene) != Vec3{};
  tension = several && scene.surface_tension > 0;
  viscosity =
      std::any_of(scene.phases.begin(), scene.phases.end(), [](const Phase& phase) { return phase.viscosity > 0; });
  friction = viscosity && no_slip;
  const CompressibilityOptions& smoothing = loaded.options.get<CompressibilityOptions>();
  diffusion = smoothing.density_filter == DensityFilter::delta && smoothing.diffusion > 0;
  shepard = smoothing.density_filter == DensityFilter::shepard;
  density_relaxation = scene.free_surface && smoothing.density_relaxation > 0;
  const InterfacePressure meeting = smoothing.interface_pressure;
  const bool undriven = !moving_bodies && !scene.body_force;
  const bool flows = liquids_flow(scene, moving_walls || !undriven), beside = !scene.bodies.empty();
  const bool evened = !scene.free_surface && (!several || tension || (flows && !beside));
  shifting = smoothing.shifting == Shifting::on || (smoothing.shifting == Shifting::automatic && evened);
  uneven = flows && beside && smoothing.shifting == Shifting::automatic;
  wall_rates = bodies && !shifting;
  const bool by_densities = several && !tension && meeting != InterfacePressure::mean;
  const bool in_layers = by_densities && !shifting && !scene.free_surface && undriven && lie_in_layers(scene);
  const std::string mean = tension        ? "surface tension"
                           : shifting     ? "shifting"
                           : by_densities ? ""
                                          : "compressibility.interface_pressure = \"mean\"";
  rest = StartAtRest(scene, {moving_bodies, oxygen, in_layers, smoothing.settling_rounds == 0, mean});
  weighted =
      by_densities && (in_layers || meeting == InterfacePressure::weighted || (shifting && still_liquid(scene, true)));
}

Flow::Flow(const LoadedCase& loaded_case)
    : loaded(loaded_case),
      options(loaded_case.options),
      scene(loaded_case.scene),
      features(loaded_case),
      resolution(scene.domain.dimensions, scene.spacing, options.resolution.kernel, options.resolution.smoothing_ratio),
      dimensions(scene.domain.dimensions),
      skin(options.get<ListOptions>().skin * scene.spacing),
      expected_speed(speed_of(loaded_case)),
      laws(phase_laws(scene, expected_speed)),
      phase_density(distinct_densities(laws)),
      wall_gravity(gravity_across_sides(scene)),
      still(still_liquid(scene, features.shifting)),
      lone_speed(speed_of(loaded_case, features.several || !still)),
      background(background_of(loaded_case, features, expected_speed, laws, still)),
      particles(dimensions, scene.particles),
      openings(features.openings ? std::make_unique<BufferLayers>(scene, resolution, skin, particles) : nullptr),
      boundary(scene.domain, scene.spacing, make_body_walls(scene, resolution), nullptr,
               openings == nullptr ? nullptr : &openings->gates()),
      spill(scene, boundary.walls),
      arrangement(scene.domain, resolution, particles.volume, particles.size(), skin),
      list_life(arrangement, particles, resolution.support_radius, skin, !features.bodies && !features.openings),
      walls(boundary, wall_gravity, particles.scratch(), features.wall_rates),
      contacts(boundary),
      parting(scene, boundary, resolution, particles.volume, expected_speed),
      solutes(particles, resolution, options, scene),
      solute_transport(
          {solutes, particles, arrangement, boundary, scene.spacing, features.shifting, scene.free_surface}) {
  // Averages behind walls and openings read lists one neighbour at a time.
  if (!features.bodies && !features.openings) arrangement.list.keep_narrow();
  arrangement.context.gradient_scale = dimensions / resolution.lattice.divergence_of_position;
  FieldSet& fields = particles.fields;
  particles.add_vector(acceleration, "acceleration", Lifetime::state);
  particles.add_vector(listed, "listed_place", Lifetime::state);
  if (features.shifting) particles.add_vector(shift, "shifting_velocity", Lifetime::state);
  excess = &fields.add<double>("density_excess", Lifetime::state);
  const bool numbered = features.several || features.openings;
  phase_number = numbered ? &fields.add<std::int64_t>("phase", Lifetime::state) : &no_numbers_;
  parallel_for(size(), [&](std::size_t i) {
    if (numbered) (*phase_number)[i] = scene.particles.phase[i];
    (*excess)[i] = 0;
    for (int axis = 0; axis < dimensions; ++axis) (*acceleration[axis])[i] = (*listed[axis])[i] = 0;
    for (int axis = 0; features.shifting && axis < dimensions; ++axis) (*shift[axis])[i] = 0;
  });
  if (features.tension) tension = std::make_unique<SurfaceTension>(scene, options.get<InterfaceOptions>().smoothing);
  if (features.gravity) start_density();
  if (features.density_relaxation)
    relaxation = std::make_unique<ExcessRelaxation>(
        ExcessRelaxation::Liquid{particles, arrangement, resolution, law_of_particles(), *excess, wall_gravity,
                                 openings == nullptr ? nullptr : &openings->column()},
        options.get<CompressibilityOptions>().density_relaxation);
  if (features.openings) {
    fill_layers();
    acoustic = std::make_unique<AcousticLayers>(scene, resolution, laws, particles, *phase_number, *openings);
  }
  find_signal();
}

void Flow::start_density() {
  const Array<double> weight = column_pressure(scene, particles, *phase_number);
  parallel_for(size(), [&](std::size_t i) { (*excess)[i] = law(i).excess(weight[i]); });
}

void Flow::fill_layers() {
  if (features.scalars) {
    std::vector<const Array<double>*> carried;
    for (std::size_t k = 0; k < solutes.count(); ++k) carried.push_back(&std::as_const(*solutes.scalars).values(k));
    openings->carry(std::move(carried));
    solutes.scalars->leave_out(openings->column());
  }
  openings->fill(*phase_number, {acceleration, shift});
  if (features.scalars) lead_scalars();
}

void Flow::lead_scalars() {
  const std::vector<Coming> coming = openings->coming();
  if (coming.empty()) return;
  solutes.scalars->lead(coming, time, options.time.end, resolution.support_radius);
  if (!solutes.scalars->follows()) return;
  const std::vector<std::int32_t> nearest = openings->nearest_liquid(coming);
  for (const Coming& one : coming) {
    const std::int32_t like = nearest[static_cast<std::size_t>(openings->column()[one.particle])];
    if (like >= 0) solutes.scalars->follow(one.particle, static_cast<std::size_t>(like));
  }
}

std::int64_t Flow::transport_scalars(double dt) {
  if (features.openings) lead_scalars();
  return solute_transport.transport(time, dt);
}

void Flow::start_tension() {
  tension->find_potentials(tension_now());
  parallel_for(size(), [&](std::size_t i) {
    (*excess)[i] = law(i).excess(law(i).pressure((*excess)[i]) + tension->mean_jump(phase_of(i)));
  });
}

double Flow::mass_spilt() const {
  double mass = 0;
  for (std::size_t n = 0; n < laws.size(); ++n) mass += laws[n].density * volume_spilt(n);
  return mass;
}

PhaseEnergies Flow::energies() const {
  return phase_energies({.particles = particles,
                         .law = law_of_particles(),
                         .excess = excess->data(),
                         .gravity = wall_gravity,
                         .left_out = layer(),
                         .reference_gradient = still.pressure_gradient(),
                         .reference_place = still.highest,
                         .background = background});
}

Fastest::State Flow::moving(const double* density_excess) const {
  return {.dimensions = dimensions,
          .law = law_of_particles(),
          .excess = density_excess,
          .velocity = read(particles.velocity),
          .acceleration = list_life.together() ? read(acceleration) : std::array<const float*, 3>{},
          .shift = list_life.together() ? read(shift) : std::array<const float*, 3>{}};
}

void Flow::find_signal() {
  take(parallel_reduce(
      size(), Fastest{},
      [state = moving(excess->data())](std::size_t first, std::size_t last) {
        Fastest fastest;
        fastest.take(state, first, last);
        return fastest;
      },
      Fastest::of_both));
}

void Flow::take(const Fastest& fastest) {
  signal = fastest.signal;
  strain = fastest.strain;
  largest_speed = std::sqrt(fastest.speed2);
  list_life.fastest = list_life.together() ? std::sqrt(fastest.transport2) : 0;
  list_life.most_accelerated = std::sqrt(fastest.acceleration2);
}

double Flow::leased_bytes() const {
  double sum = particles.fields.scratch().idle_bytes();
  const auto add = [&sum](const auto&... arrays) { ((sum += arrays.bytes()), ...); };
  for (const auto* vector : {&half_velocity, &place})
    for (const auto& array : *vector) add(array);
  for (const auto* vector : {&force, &flux, &concentration})
    for (const auto& array : *vector) add(array);
  add(next_excess, pressure, volume, reduced_excess, rate, diffusion, carried, density, viscosity);
  return sum + walls.leased_bytes();
}

}  // namespace spume::wcsph
