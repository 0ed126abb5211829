// SPDX-License-Identifier: MIT
// What exists for a scene, and quantities of the present state.
#include "spume/methods/les_sph/flow.hpp"

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

// A free surface has mirrored liquid. At the edges of a solid images are missing as neighbours are beside a void,
// though the liquid is full there.
CorrectionFading fading_beside_voids(const Case& options, const Scene& scene) {
  if (scene.free_surface || !scene.domain.boxes.empty()) return {};
  const int dimensions = scene.domain.dimensions;
  return correction_fading(dimensions, options.resolution.kernel, options.resolution.smoothing_ratio,
                           interior_weight(dimensions, options.get<SurfaceOptions>()));
}

}  // namespace

Flow::Flow(const LoadedCase& loaded_case)
    : loaded(loaded_case),
      options(loaded_case.options),
      scene(loaded_case.scene),
      features(loaded_case),
      resolution(scene.domain.dimensions, scene.spacing, options.resolution.kernel, options.resolution.smoothing_ratio),
      largest_shift(largest_stable_shift(scene.domain.dimensions, options.resolution.kernel,
                                         options.resolution.smoothing_ratio,
                                         features.shifting && options.get<ShiftingOptions>().remove_drift)),
      dimensions(scene.domain.dimensions),
      fading(fading_beside_voids(options, scene)),
      particles(dimensions, scene.particles),
      boundary(scene.domain, scene.spacing),
      energy(scene.domain, resolution),
      arrangement(scene.domain, resolution, particles.volume, particles.size()),
      moments(particles, {.kernel_sum = features.density_relaxation,
                          .concentration_gradient = features.shifting,
                          .normal = features.free_surface,
                          .fading = fading}),
      solver(boundary, solver_options(options)) {
  FieldSet& fields = particles.fields;
  pressure = &fields.add<double>("pressure", Lifetime::state);
  particles.add_vector(intermediate_position, "intermediate_position", Lifetime::sorted);
  reduced_pressure = &fields.add<double>("reduced_pressure", Lifetime::result);
  if (features.potential) potential = &fields.add<double>("potential", Lifetime::result);
  // Without a stage that differentiates the velocity this serves the first pressure only, and is released after it.
  strain = &fields.add<float>("strain", Lifetime::result);
  if (features.free_surface)
    surface = std::make_unique<FreeSurface>(
        resolution, FreeSurface::Options{.interior = interior_weight(dimensions, options.get<SurfaceOptions>()),
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
       {&filtered_velocity, &shift_velocity, &viscous_acceleration, &moments.concentration_gradient})
    for (const auto& array : *vector) add(array);
  for (const auto* vector : {&intermediate_velocity, &next_velocity})
    for (const auto& array : *vector) add(array);
  add(gradient_trace, divergence, potential_laplacian, moments.laplacian_diagonal, moments.kernel_sum,
      rows.diagonal_shift, rows.diagonal, rows.weight, rows.row, rows.right_hand_side);
  return sum;
}

EnergyBalance Flow::energy_balance() const {
  EnergyBalance balance{.particle_mass = particle_mass(),
                        .gravity = scene.fluid.gravity,
                        .unfollowed_work = features.bubbles || features.moving_walls};
  for (std::size_t axis = 0; axis < 3; ++axis)
    balance.acceleration[axis] = uniform_acceleration[axis] + periodic_acceleration[axis];
  return balance;
}

void Flow::find_extremes() {
  speeds = find_speeds(arrangement, particles);
  max_eddy_viscosity = closure != nullptr && started ? closure->largest(size()) : 0;
  if (sizes.variable && bubbles->viscosity.size() == size())
    max_eddy_viscosity =
        parallel_max(size(), 0.0, [&](std::size_t i) { return double{bubbles->viscosity[i]} + eddy_viscosity_of(i); });
}

}  // namespace spume::les_sph
