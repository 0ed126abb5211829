// SPDX-License-Identifier: MIT
// The step, as the list of its stages in the order of King et al. (2022), section 3.3, with their step numbers. The
// same list is the start, what `spume check` prints and what the ledger times.
#include "spume/methods/les_sph/step.hpp"

#include "spume/methods/solute_stages.hpp"
#include "stage_list.hpp"

namespace spume::les_sph {

using enum StagePart;
Plan make_plan(Flow& f) {
  Plan plan;
  const Features& has = f.features;
  const Reasons why(f.loaded, has, f.force_potential.has_value());
  ParticleStore& p = f.particles;
  MomentFields& moments = f.moments;
  const auto& r = f.intermediate_position;
  const KeptArrays kept(f);
  const auto living = [&f](Arrays arrays) { return while_bubbles_live(f, std::move(arrays)); };
  const ArrayUse factors([&f] { return f.solver.factor_bytes(); });
  const ParticleStages stages(plan, f);

  stages.add(step, "openings", has.openings, why.openings, &Flow::exchange_with_openings, {p.position, p.velocity},
             {p.position, p.velocity});
  stages.add(step, "absorption", has.absorbing_walls, why.absorption, &Flow::measure_waves, {p.position}, {});
  // (i) intermediate positions r* = r^n + dt u^n, in the order of cells
  stages.add(both, "move", true, "particles to their intermediate positions", &Flow::move_to_intermediate_position,
             {p.position, p.velocity}, {r});
  stages.add(both, "sort", true, "particles in cell order", &Flow::sort_particles, {}, {kept.sorted});
  stages.sweep(start, "packing", f.boundary.has_obstacles(), why.packing, &Flow::pack, {r}, {p.position, r});
  stages.sweep(start, "level", has.free_surface && f.boundary.has_obstacles(), why.level, &Flow::level_surface, {r},
               {p.position, r});
  stages.add(step, "advecting velocity", true, why.advection, &Flow::find_advecting_velocity,
             {p.velocity, f.acceleration}, {f.advecting_velocity});
  stages.add(start, "bubble clouds", has.bubbles, why.bubbles, &Flow::place_clouds, {r},
             living({kept.bubbles, kept.images, f.volume_fraction(), kept.sizes}));
  stages.add(both, "bubble motion", has.bubbles, why.bubbles, &Flow::move_bubbles,
             living({kept.bubbles, f.volume_fraction()}),
             living({kept.bubbles, f.sizes.length_ratio, f.sizes.support_radius}));
  // (ii) images at boundaries, neighbours and their moments
  stages.add(both, "images", has.images, why.images, &Flow::make_images, {r},
             {kept.images, f.boundary.velocity_rule().offset});
  stages.add(both, "volume fraction", has.bubbles, why.bubbles, &Flow::share_volume,
             living({kept.bubbles, r, f.sizes.length_ratio, f.sizes.support_radius}),
             living({kept.bubble_images, f.sizes.volume_fraction, f.sizes.volume_ratio}));
  stages.add(both, "neighbours", true, "lists within the kernel support", &Flow::find_neighbours, {}, {kept.lists});
  stages.sweep(both, "kernel moments", true, "gradient correction, div r, concentration", &Flow::measure_moments, {},
               arrays_of(moments));
  stages.add(both, "surface", has.free_surface, why.surface, &Flow::find_surface,
             {moments.divergence_of_position, moments.uncorrected, moments.normal}, {kept.surface});
  stages.add(start, "balance", has.starts_at_rest, why.balance, &Flow::balance_rest, {r, p.velocity, kept.surface},
             {f.rest.share, f.rest.lift});
  stages.add(step, "ripples", has.free_surface && has.potential, why.ripples, &Flow::find_ripples,
             {p.velocity, moments.normal}, {kept.surface});
  // (iii) the shift to r^{n+1}, taken with the last stage
  stages.add(step, "shift", has.shifting, why.shift, &Flow::compute_shift, {moments.concentration_gradient},
             {f.displacement_by_shift()});
  stages.sweep(start, "impulse", has.openings, why.impulse, &Flow::set_in_motion, {p.velocity}, {p.velocity});
  // (v) gradients of u^n, and what follows from them
  const Arrays gradients{f.strain, f.velocity_gradient, f.filtered_velocity, f.gradient_trace, f.shift_velocity};
  stages.sweep(start, "first gradients", true, "strain and source of the first pressure",
               &Flow::differentiate_first_velocity, {p.velocity, moments.correction}, gradients);
  stages.add(step, "gradients", has.velocity_gradient, why.gradients, differentiating(f),
             {f.advecting_velocity, moments.correction, f.displacement_by_shift()}, gradients);
  stages.sweep(step, "shift curvature", has.shift_curvature, why.curvature, &Flow::find_shift_curvature,
               {f.velocity_gradient, f.displacement_by_shift(), moments.correction}, {f.shift_velocity});
  // (vi) closure of the unresolved stress; (vii) bubbles
  stages.add(step, "eddy viscosity", has.eddy_viscosity, why.closure, &Flow::find_eddy_viscosity,
             {f.strain, f.velocity_gradient, f.filtered_velocity}, {f.eddy_viscosity()});
  stages.add(step, "bubble forces", has.bubbles, why.integrator, &Flow::exchange_with_bubbles,
             living(seen_by_bubbles(f, kept)), living({kept.bubbles, f.bubble_exchange(), f.bubble_viscosity()}));
  // (viii) u* from forces and viscosity
  stages.add(both, "forces", has.potential, why.forces, &Flow::find_potential, {r}, {f.potential, f.varying_force});
  stages.add(both, "wall bends", has.wall_bends, why.bends, &Flow::find_wall_bends, {r, f.advecting_velocity},
             {kept.bends});
  stages.sweep(both, "viscosity", has.viscosity, why.viscosity, &Flow::find_viscous_acceleration, read_by_viscosity(f),
               {f.viscous_acceleration});
  stages.add(step, "prediction", true, "velocity without pressure", &Flow::predict_velocity,
             {f.advecting_velocity, f.viscous_acceleration}, {f.intermediate_velocity});
  stages.add(step, "sponges", has.sponges, why.sponges, &Flow::damp_velocity, {r, f.intermediate_velocity},
             {f.intermediate_velocity});
  stages.add(start, "first forces", true, "acceleration without pressure", &Flow::find_first_forces,
             {f.viscous_acceleration}, {f.intermediate_velocity});
  // (ix), (x) the pressure that makes the velocity at r^{n+1} free of divergence
  stages.sweep(step, "divergence", true, why.divergence, &Flow::find_divergence,
               {f.intermediate_velocity, moments.correction, f.potential}, {f.divergence, f.potential_laplacian});
  stages.add(step, "centring", f.options.get<SchemeOptions>().centred, why.centring, &Flow::centre_divergence,
             {f.gradient_trace}, {f.divergence});
  stages.add(step, "density relaxation", has.density_relaxation, why.relaxation, &Flow::relax_density,
             {moments.kernel_sum, moments.divergence_of_position}, {f.divergence});
  stages.sweep(start, "first source", true, "tr(grad u . grad u) - div f", &Flow::set_first_source,
               {f.intermediate_velocity, moments.correction, f.gradient_trace, f.potential},
               {f.first_source, f.potential_laplacian});
  stages.add(both, "matrix", true, "rows and right-hand side", &Flow::find_matrix, read_by_matrix(f),
             arrays_of(f.rows));
  stages.add(both, "preconditioner", f.solver.has_multigrid(), why.preconditioner, &Flow::prepare_solver,
             {r, f.rows.diagonal}, {});
  stages.add(both, "factorisation", f.solver.direct() != nullptr, why.factorisation, factorising(f), {f.rows.diagonal},
             {factors});
  stages.add(start, "first pressure", true, why.pressure, solving(f, &Flow::solve_first_pressure),
             {f.rows.diagonal, f.potential, factors}, {f.reduced_pressure, f.pressure});
  stages.add(step, "pressure", true, why.pressure, solving(f, &Flow::solve_pressure),
             {f.rows.diagonal, f.potential, f.pressure, factors}, {f.reduced_pressure});
  stages.sweep(step, "projection", true, "pressure gradient", &Flow::project_velocity,
               {f.reduced_pressure, moments.correction, f.intermediate_velocity}, {f.next_velocity});
  stages.sweep(start, "first acceleration", f.acceleration[0] != nullptr, why.centring, &Flow::set_first_acceleration,
               {f.reduced_pressure, moments.correction}, {f.acceleration});
  // (xi) r^{n+1}, u^{n+1}
  stages.add(
      step, "acceptance", true, "limits, energy, final positions", &Flow::accept,
      {f.next_velocity, r, f.displacement_by_shift(), f.shift_velocity, f.reduced_pressure, f.potential, f.strain},
      {p.position, p.velocity, f.acceleration, f.pressure});
  add_solute_stages(stages, f, has, why.oxygen, [&f]() -> const oxygen::Supply* { return f.bubbles.get(); });
  stages.add(step, "bubble events", has.bubbles, why.events, &Flow::accept_bubbles,
             living({kept.bubbles, f.sizes.volume_fraction}), living({kept.bubbles, f.volume_fraction()}));
  return plan;
}

}  // namespace spume::les_sph
