// SPDX-License-Identifier: MIT
// What exists for a scene, and quantities of the present state.
#include "spume/methods/les_sph/flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/parallel.hpp"
#include "spume/core/unrolled.hpp"
#include "spume/core/vectors.hpp"

namespace spume::les_sph {
namespace {

// A free surface has mirrored liquid. At the edges of a solid box images are missing as neighbours are beside a void,
// though the liquid is full there; bodies have wall points round their edges. What moves with a tank, a body around the
// liquid, has a pressure of one gradient, which a faded correction misses in its corners: liquid in a tank that is
// pushed lagged by a tenth. Without the fading seven of nine tanks ended that a paddle stirs, four to eight spacings
// thick, in the void behind its tips; with it none.
// Without density relaxation voids stay, and the solve of a cavity at Re = 100 and 1/20 fails with the fading.
CorrectionFading fading_beside_voids(const Case& options, const Scene& scene, const Features& features) {
  const bool tank_moves = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                      [](const Body& body) { return body.motion && !body.inside; });
  if (scene.free_surface || !scene.domain.boxes.empty() || tank_moves || !features.density_relaxation) return {};
  const int dimensions = scene.domain.dimensions;
  return correction_fading(dimensions, options.resolution.kernel, options.resolution.smoothing_ratio,
                           interior_weight(dimensions, options.get<SurfaceOptions>()));
}

std::unique_ptr<OpenSides> make_openings(const Scene& scene, const Resolution& resolution) {
  if (scene.openings.empty()) return nullptr;
  return std::make_unique<OpenSides>(scene, resolution, scene.particles.volume);
}

// What the sums of a row read: bounds of the liquid, gravity across axes with sides.
struct TotalsInput {
  std::array<const double*, 3> position{}, velocity{};
  const float* strain = nullptr;
  const float* eddy_viscosity = nullptr;  // null: none
  Vec3 gravity{};
  std::array<std::array<double, 2>, 3> bounds{};
};

// Per mass of a particle, in one pass: a pass for each sum takes four times as long.
template <int dimensions>
FlowTotals totals_of(const TotalsInput& input, std::size_t first, std::size_t last) {
  FlowTotals sum;
  for (std::size_t i = first; i < last; ++i) {
    double speed2 = 0, potential = 0;
    bool inside = true;
    unrolled<dimensions>([&](auto axis) {
      const double x = input.position[axis][i], u = input.velocity[axis][i];
      speed2 += u * u;
      potential -= input.gravity[axis] * x;
      inside = inside & (x >= input.bounds[axis][0]) & (x <= input.bounds[axis][1]);
      sum.momentum[axis] += u;
    });
    sum.kinetic += speed2 / 2;
    sum.potential += potential;
    sum.mass += inside ? 1.0 : 0.0;
  }
  for (std::size_t i = first; i < last && input.eddy_viscosity != nullptr; ++i) {
    const double strain = input.strain[i];
    sum.unresolved_dissipation += input.eddy_viscosity[i] * strain * strain;
  }
  return sum;
}

}  // namespace

Flow::Flow(const LoadedCase& loaded_case)
    : loaded(loaded_case),
      options(loaded_case.options),
      scene(loaded_case.scene),
      features(loaded_case),
      resolution(scene.domain.dimensions, scene.spacing, options.resolution.kernel, options.resolution.smoothing_ratio),
      force_potential(features.body_force && !features.uniform_body_force
                          ? ForcePotential::find(*scene.body_force, scene.domain, scene.spacing, options.time.end)
                          : std::nullopt),
      largest_shift(largest_stable_shift(scene.domain.dimensions, options.resolution.kernel,
                                         options.resolution.smoothing_ratio, features.removes_drift)),
      dimensions(scene.domain.dimensions),
      fading(fading_beside_voids(options, scene, features)),
      particles(dimensions, scene.particles),
      boundary(scene.domain, scene.spacing, make_body_walls(scene, resolution), make_openings(scene, resolution)),
      spill(scene, boundary.walls),
      energy(scene.domain, resolution),
      arrangement(scene.domain, resolution, particles.volume, particles.size()),
      moments(particles, {.kernel_sum = features.density_relaxation,
                          .concentration_gradient = features.shifting,
                          .normal = features.free_surface,
                          .fading = fading}),
      solver(boundary, projection_options(options.get<PressureOptions>(), options.spacing)),
      solutes(particles, resolution, options, scene) {
  FieldSet& fields = particles.fields;
  pressure = &fields.add<double>("pressure", Lifetime::state);
  if (options.get<SchemeOptions>().centred) particles.add_vector(acceleration, "acceleration", Lifetime::state);
  particles.add_vector(intermediate_position, "intermediate_position", Lifetime::sorted);
  reduced_pressure = &fields.add<double>("reduced_pressure", Lifetime::result);
  if (features.potential) potential = &fields.add<double>("potential", Lifetime::result);
  // Without a stage that differentiates the velocity this serves the first pressure only, and is released after it.
  strain = &fields.add<float>("strain", Lifetime::result);
  boundary.find_nearest_images = features.bubbles;
  if (features.free_surface && boundary.has_obstacles()) start_columns = std::make_unique<StartColumns>(scene);
  if (features.starts_at_rest) {
    rest.share = &fields.add<float>("rest_share", Lifetime::state);
    rest.lift = &fields.add<float>("rest_lift", Lifetime::state);
  }
  if (features.free_surface)
    surface = std::make_unique<FreeSurface>(
        resolution, FreeSurface::Options{.interior = interior_weight(dimensions, options.get<SurfaceOptions>()),
                                         .smooth_normals = features.shifting});
  if (surface != nullptr) surface->lift = rest.lift;
  if (std::any_of(scene.motions.begin(), scene.motions.end(), [](const BodyMotion& motion) { return motion.floats; }))
    floating =
        std::make_unique<FloatingBodies>(scene, resolution, *boundary.bodies(), options.get<SchemeOptions>().centred);
  if (features.absorbing_walls) gauge = std::make_unique<PointSampler>();
  if (features.shifting) shift = std::make_unique<Shift>(particles, resolution);
  if (features.wall_bends) wall_bends = std::make_unique<WallBends>(boundary, resolution);
  if (features.eddy_viscosity)
    closure = std::make_unique<turbulence::EddyViscosity>(particles, options.get<TurbulenceOptions>());
  if (features.bubbles) {
    particles.add_vector(material_acceleration, "material_acceleration", Lifetime::state);
    const bubbles::Carrier carrier{.scene = scene,
                                   .arrangement = arrangement,
                                   .boundary = boundary,
                                   .resolution = resolution,
                                   .sizes = sizes,
                                   .particle_volume = particles.volume,
                                   .identifier = *particles.identifier,
                                   .position = constant(particles.position),
                                   .velocity = constant(particles.velocity),
                                   .advecting_velocity = advecting_velocity,
                                   .intermediate_position = constant(intermediate_position),
                                   .material_acceleration = constant(material_acceleration),
                                   .velocity_gradient = velocity_gradient,
                                   .strain = *strain,
                                   .filtered_velocity = features.test_filter ? &filtered_velocity : nullptr,
                                   .eddy_viscosity = eddy_viscosity(),
                                   .normal = constant(moments.normal),
                                   .surface = surface.get(),
                                   .shift = constant(displacement_by_shift()),
                                   .time = time,
                                   .steps = steps,
                                   .speeds = speeds,
                                   .gas = features.oxygen ? &solutes.oxygen->gas() : nullptr,
                                   .dissolved = features.oxygen ? &solutes.oxygen->dissolved() : nullptr};
    bubbles = std::make_unique<bubbles::BubbleCoupling>(particles, carrier, options.get<BubbleOptions>(),
                                                        options.get<BubbleSources>());
  }
  find_extremes();
  weight = weight_at_start();
}

double Flow::potential_at(const Vec3& r) const {
  double sum = 0;
  for (int axis = 0; axis < dimensions; ++axis)
    sum -= uniform_acceleration[axis] * (r[axis] - arrangement.origin[axis]);
  return sum;
}

double Flow::stored_energy() const {
  const double c = scene.fluid.sound_speed;
  if (!(c > 0)) return 0;
  return particles.volume / (2 * density() * c * c) *
         parallel_sum(size(), [&](std::size_t i) { return (*pressure)[i] * (*pressure)[i]; });
}

double Flow::weight_at_start() const {
  double weight = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    const Vec3 r = vector_at(particles.position, dimensions, i);
    const Vec3 force = features.body_force ? (*scene.body_force)(r, 0) : Vec3{};
    for (int axis = 0; axis < dimensions; ++axis) weight += std::abs(scene.fluid.gravity[axis]) + std::abs(force[axis]);
  }
  return particle_mass() * weight;
}

// A wall holds particles back; what stands a hair beyond one, as it moves, has not left. Behind openings liquid goes
// on.
FlowTotals Flow::totals() const {
  const int up = dimensions - 1;
  std::array<std::array<double, 2>, 3> bounds = boundary.walls;
  for (int axis = 0; axis < dimensions; ++axis)
    for (int end = 0; end < 2; ++end) {
      const bool opens = std::any_of(scene.openings.begin(), scene.openings.end(),
                                     [&](const Opening& o) { return o.axis == axis && o.side == end; });
      if (opens)
        bounds[axis][end] = end == 0 ? -infinite : infinite;
      else if (scene.domain.sides[axis][end].bounds_liquid())
        bounds[axis][end] += (end == 0 ? -1 : 1) * scene.spacing;
    }
  const bool falls_back = scene.fluid.gravity[up] < 0 && scene.domain.sides[up][1].kind == BoundaryKind::open;
  Vec3 gravity = scene.fluid.gravity;
  for (int axis = 0; axis < dimensions; ++axis)
    if (scene.domain.periodic(axis)) gravity[axis] = 0;  // there is no height
  if (falls_back) bounds[up][1] = infinite;
  const TotalsInput input{.position = read(particles.position),
                          .velocity = read(particles.velocity),
                          .strain = strain->data(),
                          .eddy_viscosity = closure == nullptr ? nullptr : closure->viscosity().data(),
                          .gravity = gravity,
                          .bounds = bounds};
  FlowTotals totals = parallel_reduce(
      size(), FlowTotals{},
      [&](std::size_t first, std::size_t last) {
        return dimensions == 3 ? totals_of<3>(input, first, last) : totals_of<2>(input, first, last);
      },
      [](FlowTotals a, const FlowTotals& b) {
        a.kinetic += b.kinetic;
        a.potential += b.potential;
        a.unresolved_dissipation += b.unresolved_dissipation;
        a.mass += b.mass;
        a.momentum = add(a.momentum, b.momentum);
        return a;
      });
  for (double* sum : {&totals.kinetic, &totals.potential, &totals.unresolved_dissipation, &totals.mass})
    *sum *= particle_mass();
  totals.momentum = multiply(particle_mass(), totals.momentum);
  return totals;
}

void Flow::exchange_with_openings() {
  const EnergyBalance balance = energy_balance(0);
  const double before = energy.held(balance, particles);
  const std::int64_t next = boundary.openings()->next_identifier(), entered = boundary.openings()->entered();
  const std::vector<double> amounts = solutes.scalars != nullptr ? solutes.scalars->amounts() : std::vector<double>();
  if (boundary.openings()->exchange(particles, time)) energy.supply += energy.held(balance, particles) - before;
  if (solutes.scalars == nullptr) return;
  // What enters is numbered before what comes back through outflows.
  solutes.scalars->enter(next, next + boundary.openings()->entered() - entered, time);
  solutes.scalars->count_openings(amounts);
}

std::size_t Flow::remove_left() {
  return spill.remove({.particles = particles, .reach = arrangement.grid.support_radius() * sizes.largest_length_ratio},
                      time);
}

double Flow::leased_bytes() const {
  double sum = particles.fields.scratch().idle_bytes();
  const auto add = [&sum](const auto&... arrays) { ((sum += arrays.bytes()), ...); };
  for (const auto& array : velocity_gradient) add(array);
  for (const auto* vector :
       {&filtered_velocity, &shift_velocity, &viscous_acceleration, &varying_force, &moments.concentration_gradient})
    for (const auto& array : *vector) add(array);
  for (const auto* vector : {&advecting_velocity, &intermediate_velocity, &next_velocity})
    for (const auto& array : *vector) add(array);
  add(gradient_trace, divergence, first_source, potential_laplacian, moments.laplacian_diagonal, moments.kernel_sum,
      rows.diagonal_shift, rows.diagonal, rows.weight, rows.row, rows.right_hand_side);
  return sum;
}

EnergyBalance Flow::energy_balance(double dt) const {
  double strength2 = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double a = uniform_acceleration[axis] + periodic_acceleration[axis];
    strength2 += a * a;
  }
  return {.particle_mass = particle_mass(),
          .gravity = scene.fluid.gravity,
          .largest_acceleration = std::sqrt(strength2) + next_largest_body_force,
          .work = dt > 0 ? (features.working_forces ? work_of_step(dt) : 0) + work_of_sponges : 0,
          .unfollowed_work = features.bubbles || features.moving_walls || features.moving_bodies || features.openings};
}

// By the midpoint rule along the way of each particle, which its shift is a part of: exact for forces that are linear
// in space.
double Flow::work_of_step(double dt) const {
  Vec3 uniform{};
  for (int axis = 0; axis < dimensions; ++axis)
    if (scene.domain.periodic(axis)) uniform[axis] = scene.fluid.gravity[axis];
  const double t = time + dt / 2;
  if (features.uniform_body_force) {
    const Vec3 force = (*scene.body_force)(arrangement.origin, t);
    for (int axis = 0; axis < dimensions; ++axis) uniform[axis] += force[axis];
  }
  const bool varying = features.body_force && !features.uniform_body_force;
  return particle_mass() * parallel_reduce(
                               size(), 0.0,
                               [&](std::size_t first, std::size_t last) {
                                 const VectorExpression force =
                                     varying ? scene.body_force->clone() : VectorExpression();
                                 double sum = 0;
                                 for (std::size_t i = first; i < last; ++i) {
                                   const Vec3 u = advecting_velocity_of(i, dt);
                                   Vec3 way{}, middle{}, acting = uniform;
                                   for (int axis = 0; axis < dimensions; ++axis) {
                                     const double shifted = shift == nullptr ? 0.0 : (*shift->displacement[axis])[i];
                                     way[axis] = dt * u[axis] + shifted;
                                     middle[axis] = (*intermediate_position[axis])[i] + shifted - way[axis] / 2;
                                   }
                                   if (varying) {
                                     const Vec3 f = force(middle, t);
                                     for (std::size_t axis = 0; axis < 3; ++axis) acting[axis] += f[axis];
                                   }
                                   for (std::size_t axis = 0; axis < 3; ++axis) sum += acting[axis] * way[axis];
                                 }
                                 return sum;
                               },
                               [](double a, double b) { return a + b; });
}

void Flow::find_extremes() {
  speeds = find_speeds(arrangement, particles);
  max_eddy_viscosity = closure != nullptr && started ? closure->largest(size()) : 0;
  if (sizes.variable && bubbles->viscosity().size() == size())
    max_eddy_viscosity = parallel_max(
        size(), 0.0, [&](std::size_t i) { return double{bubbles->viscosity()[i]} + eddy_viscosity_of(i); });
}

}  // namespace spume::les_sph
