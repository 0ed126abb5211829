// SPDX-License-Identifier: MIT
// What exists for a scene, and quantities of the present state.
#include "spume/methods/les_sph/flow.hpp"

#include <cmath>

#include "spume/core/parallel.hpp"

namespace spume::les_sph {
namespace {

ProjectionSolver::Options solver_options(const Case& options) {
  const PressureOptions& pressure = options.get<PressureOptions>();
  return {.method = pressure.solver == PressureSolver::cg ? KrylovMethod::conjugate_gradients : KrylovMethod::bicgstab,
          .multigrid = pressure.preconditioner == PreconditionerKind::multigrid,
          .mixed = pressure.precision == Precision::mixed,
          .tolerance = pressure.tolerance,
          .max_iterations = pressure.max_iterations,
          .cell_size = pressure.cell_ratio * options.spacing};
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
                                         options.resolution.smoothing_ratio,
                                         features.shifting && options.get<ShiftingOptions>().remove_drift)),
      dimensions(scene.domain.dimensions),
      particles(dimensions, scene.particles),
      boundary(scene.domain, scene.spacing),
      energy(scene.domain, resolution),
      arrangement(scene.domain, resolution, particles.volume, particles.size()),
      moments(particles, {.kernel_sum = features.density_relaxation,
                          .concentration_gradient = features.shifting,
                          .normal = features.free_surface}),
      solver(boundary, solver_options(options)) {
  FieldSet& fields = particles.fields;
  pressure = &fields.add<double>("pressure", Lifetime::state);
  if (options.get<SchemeOptions>().centred) particles.add_vector(acceleration, "acceleration", Lifetime::state);
  particles.add_vector(intermediate_position, "intermediate_position", Lifetime::sorted);
  reduced_pressure = &fields.add<double>("reduced_pressure", Lifetime::result);
  if (features.potential) potential = &fields.add<double>("potential", Lifetime::result);
  // Without a stage that differentiates the velocity this serves the first pressure only, and is released after it.
  strain = &fields.add<float>("strain", Lifetime::result);
  if (features.free_surface)
    surface = std::make_unique<FreeSurface>(
        resolution, FreeSurface::Options{.threshold = options.get<SurfaceOptions>().threshold,
                                         .blend_width = options.get<SurfaceOptions>().blend_width,
                                         .smooth_normals = features.shifting,
                                         .keep_smoothed_normals = features.bubbles});
  if (features.shifting) shift = std::make_unique<Shift>(particles, resolution);
  if (features.eddy_viscosity)
    closure = std::make_unique<turbulence::EddyViscosity>(particles, options.get<TurbulenceOptions>());
  if (features.bubbles) {
    const bubbles::Carrier carrier{.scene = scene,
                                   .arrangement = arrangement,
                                   .boundary = boundary,
                                   .particles = particles,
                                   .resolution = resolution,
                                   .sizes = sizes,
                                   .moments = moments,
                                   .surface = surface.get(),
                                   .intermediate_position = intermediate_position,
                                   .velocity = advecting_velocity,
                                   .velocity_gradient = velocity_gradient,
                                   .filtered_velocity = filtered_velocity,
                                   .filtered = features.test_filter,
                                   .eddy_viscosity = closure == nullptr ? nullptr : &closure->viscosity(),
                                   .strain = *strain,
                                   .shift = shift == nullptr ? nullptr : &shift->displacement,
                                   .time = time,
                                   .steps = steps,
                                   .speeds = speeds};
    bubbles = std::make_unique<bubbles::BubbleCoupling>(carrier, options.get<BubbleOptions>());
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

double Flow::mass_in_domain() const {
  const double inside = parallel_sum(size(), [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis) {
      const double x = (*particles.position[axis])[i];
      if (!(x >= boundary.walls[axis][0] && x <= boundary.walls[axis][1])) return 0.0;
    }
    return 1.0;
  });
  return particle_mass() * inside;
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
  add(gradient_trace, divergence, potential_laplacian, moments.laplacian_diagonal, moments.kernel_sum,
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
          .work = features.working_forces && dt > 0 ? work_of_step(dt) : 0,
          .unfollowed_work = features.bubbles || features.moving_walls};
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
  if (sizes.variable && bubbles->viscosity.size() == size())
    max_eddy_viscosity =
        parallel_max(size(), 0.0, [&](std::size_t i) { return double{bubbles->viscosity[i]} + eddy_viscosity_of(i); });
}

}  // namespace spume::les_sph
