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
      interior(interior_weight(dimensions, options.get<SurfaceOptions>())),
      particles(dimensions, scene.particles),
      boundary(scene.domain, scene.spacing),
      energy(scene.domain, resolution),
      arrangement(scene.domain, resolution, particles.volume, particles.size()),
      moments(particles,
              {.kernel_sum = features.density_relaxation,
               .concentration_gradient = features.shifting,
               .normal = features.free_surface,
               .fading = features.free_surface ? CorrectionFading{}
                                               : correction_fading(dimensions, options.resolution.kernel,
                                                                   options.resolution.smoothing_ratio, interior)}),
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
        resolution, FreeSurface::Options{.interior = interior, .smooth_normals = features.shifting});
  if (features.shifting) shift = std::make_unique<Shift>(particles, resolution);
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
                                   .speeds = speeds};
    bubbles = std::make_unique<bubbles::BubbleCoupling>(particles, carrier, options.get<BubbleOptions>(),
                                                        options.get<BubbleSources>());
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

bool Flow::has_left(std::size_t i) const {
  const int up = dimensions - 1;
  const bool falls = scene.fluid.gravity[up] < 0;
  for (int axis = 0; axis < dimensions; ++axis) {
    const double x = (*particles.position[axis])[i], lower = boundary.walls[axis][0], upper = boundary.walls[axis][1];
    const double reach = upper - lower;
    const double below = axis == up && falls ? arrangement.grid.support_radius() * sizes.largest_length_ratio : reach;
    if (x < lower - below && scene.domain.sides[axis][0].kind == BoundaryKind::open) return true;
    if (axis == up && falls) continue;
    if (x > upper + reach && scene.domain.sides[axis][1].kind == BoundaryKind::open) return true;
  }
  return false;
}

std::size_t Flow::remove_left() {
  if (!features.open_sides) return 0;
  const double gone = parallel_sum(size(), [&](std::size_t i) { return has_left(i) ? 1.0 : 0.0; });
  if (gone == 0) return 0;
  const std::size_t before = size();
  Array<std::int32_t> kept;
  parallel_select(before, kept, [&](std::size_t i) { return !has_left(i); });
  particles.fields.permute(kept);
  left += static_cast<std::int64_t>(before - kept.size());
  return before - kept.size();
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
  add(gradient_trace, divergence, first_source, potential_laplacian, moments.laplacian_diagonal, moments.kernel_sum,
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
  if (sizes.variable && bubbles->viscosity().size() == size())
    max_eddy_viscosity = parallel_max(
        size(), 0.0, [&](std::size_t i) { return double{bubbles->viscosity()[i]} + eddy_viscosity_of(i); });
}

}  // namespace spume::les_sph
