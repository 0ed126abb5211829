// SPDX-License-Identifier: MIT
// The step, as the list of its stages in the order of King et al. (2022), section 3.3, with their step numbers. The
// same list is the start, what `spume check` prints and what the ledger times.
#include "spume/methods/les_sph/step.hpp"

#include "spume/particles/packing.hpp"
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
  const AddStage add(plan, f);

  add(step, "openings", has.openings, why.openings, [&](StageRun&) { f.exchange_with_openings(); },
      {p.position, p.velocity}, {p.position, p.velocity});
  // (i) intermediate positions r* = r^n + dt u^n, in the order of cells
  add(both, "move", true, "particles to their intermediate positions",
      [&](StageRun& run) { f.move_to_intermediate_position(run.dt); }, {p.position, p.velocity}, {r});
  add(both, "sort", true, "particles in cell order", [&](StageRun&) { f.arrangement.sort(p, r); }, {}, {kept.sorted});
  add(
      start, "packing", has.bodies, why.packing,
      [&](StageRun&) { pack_beside_bodies(f.arrangement, p, f.boundary, f.resolution, r, has.free_surface, f.time); },
      {r}, {p.position, r}, true);
  add(
      start, "level", has.free_surface && f.boundary.has_obstacles(), why.level, [&](StageRun&) { f.level_surface(); },
      {r}, {p.position, r}, true);
  add(step, "advecting velocity", true, why.advection, [&](StageRun& run) { f.find_advecting_velocity(run.dt); },
      {p.velocity, f.acceleration}, {f.advecting_velocity});
  add(
      start, "bubble clouds", has.bubbles, why.bubbles, [&](StageRun&) { f.place_clouds(); }, {r},
      living({kept.bubbles, kept.images, f.volume_fraction(), kept.sizes}));
  add(
      both, "bubble motion", has.bubbles, why.bubbles, [&](StageRun& run) { f.move_bubbles(run.dt); },
      living({kept.bubbles, f.volume_fraction()}),
      living({kept.bubbles, f.sizes.length_ratio, f.sizes.support_radius}));
  // (ii) images at boundaries, neighbours and their moments
  add(both, "images", has.images, why.images, [&](StageRun& run) { f.make_images(run.dt); }, {r},
      {kept.images, f.boundary.velocity_rule().offset});
  add(
      both, "volume fraction", has.bubbles, why.bubbles, [&](StageRun&) { f.share_volume(); },
      living({kept.bubbles, r, f.sizes.length_ratio, f.sizes.support_radius}),
      living({kept.bubble_images, f.sizes.volume_fraction, f.sizes.volume_ratio}));
  add(both, "neighbours", true, "lists within the kernel support", [&](StageRun& run) { f.find_neighbours(run.dt); },
      {}, {kept.lists});
  add(
      both, "kernel moments", true, "gradient correction, div r, concentration",
      [&](StageRun&) { moments.measure(f.arrangement, p, f.resolution.spacing); }, {}, arrays_of(moments), true);
  add(both, "surface", has.free_surface, why.surface,
      [&](StageRun&) { f.surface->find(f.arrangement, p, moments, f.boundary, r); },
      {moments.divergence_of_position, moments.uncorrected, moments.normal}, {kept.surface});
  // (iii) the shift to r^{n+1}, taken with the last stage
  add(step, "shift", has.shifting, why.shift, [&](StageRun&) { f.compute_shift(); }, {moments.concentration_gradient},
      {f.displacement_by_shift()});
  add(
      start, "impulse", has.openings, why.impulse, [&](StageRun&) { f.set_in_motion(); }, {p.velocity}, {p.velocity},
      true);
  // (v) gradients of u^n, and what follows from them
  const Arrays gradients{f.strain, f.velocity_gradient, f.filtered_velocity, f.gradient_trace, f.shift_velocity};
  add(
      start, "first gradients", true, "strain and source of the first pressure",
      [&](StageRun&) { f.differentiate_velocity(true); }, {p.velocity, moments.correction}, gradients, true);
  add(
      step, "gradients", has.velocity_gradient, why.gradients, [&](StageRun&) { f.differentiate_velocity(false); },
      {f.advecting_velocity, moments.correction, f.displacement_by_shift()}, gradients, true);
  add(
      step, "shift curvature", has.shift_curvature, why.curvature, [&](StageRun&) { f.find_shift_curvature(); },
      {f.velocity_gradient, f.displacement_by_shift(), moments.correction}, {f.shift_velocity}, true);
  // (vi) closure of the unresolved stress; (vii) bubbles
  add(step, "eddy viscosity", has.eddy_viscosity, why.closure, [&](StageRun& run) { f.find_eddy_viscosity(run.dt); },
      {f.strain, f.velocity_gradient, f.filtered_velocity}, {f.eddy_viscosity()});
  add(
      step, "bubble forces", has.bubbles, why.integrator,
      [&](StageRun& run) { f.bubbles->exchange_momentum(run.dt, f.arrangement.packed); },
      living(seen_by_bubbles(f, kept)), living({kept.bubbles, f.bubble_exchange(), f.bubble_viscosity()}));
  // (viii) u* from forces and viscosity
  add(both, "forces", has.potential, why.forces, [&](StageRun& run) { f.find_potential(f.time + run.dt); }, {r},
      {f.potential, f.varying_force});
  add(
      both, "viscosity", has.viscosity, why.viscosity, [&](StageRun&) { f.find_viscous_acceleration(); },
      {f.advecting_velocity, moments.divergence_of_position, f.eddy_viscosity()}, {f.viscous_acceleration}, true);
  add(step, "prediction", true, "velocity without pressure", [&](StageRun& run) { f.predict_velocity(run.dt); },
      {f.advecting_velocity, f.viscous_acceleration}, {f.intermediate_velocity});
  add(step, "sponges", has.sponges, why.sponges, [&](StageRun& run) { f.damp_velocity(run.dt); },
      {r, f.intermediate_velocity}, {f.intermediate_velocity});
  add(start, "first forces", true, "acceleration without pressure", [&](StageRun&) { f.find_first_forces(); },
      {f.viscous_acceleration}, {f.intermediate_velocity});
  // (ix), (x) the pressure that makes the velocity at r^{n+1} free of divergence
  add(
      step, "divergence", true, why.divergence, [&](StageRun& run) { f.find_divergence(run.dt); },
      {f.intermediate_velocity, moments.correction, f.potential}, {f.divergence, f.potential_laplacian}, true);
  add(step, "centring", f.options.get<SchemeOptions>().centred, why.centring,
      [&](StageRun& run) { f.centre_divergence(run.dt); }, {f.gradient_trace}, {f.divergence});
  add(step, "density relaxation", has.density_relaxation, why.relaxation,
      [&](StageRun& run) { f.relax_density(run.dt); }, {moments.kernel_sum, moments.divergence_of_position},
      {f.divergence});
  add(
      start, "first source", true, "tr(grad u . grad u) - div f", [&](StageRun&) { f.set_first_source(); },
      {f.intermediate_velocity, moments.correction, f.gradient_trace, f.potential},
      {f.first_source, f.potential_laplacian}, true);
  add(
      both, "matrix", true, "rows and right-hand side",
      [&](StageRun& run) {
        f.give_pressures(f.time + run.dt);
        f.set_matrix();
      },
      read_by_matrix(f), arrays_of(f.rows));
  add(both, "preconditioner", f.solver.has_multigrid(), why.preconditioner, [&](StageRun&) { f.prepare_solver(); },
      {r, f.rows.diagonal}, {});
  add(start, "first pressure", true, why.pressure, solving(f, &Flow::solve_first_pressure),
      {f.rows.diagonal, f.potential}, {f.reduced_pressure, f.pressure});
  add(step, "pressure", true, why.pressure, solving(f, &Flow::solve_pressure),
      {f.rows.diagonal, f.potential, f.pressure}, {f.reduced_pressure});
  add(
      step, "projection", true, "pressure gradient", [&](StageRun& run) { f.project_velocity(run.dt); },
      {f.reduced_pressure, moments.correction, f.intermediate_velocity}, {f.next_velocity}, true);
  add(
      start, "first acceleration", f.acceleration[0] != nullptr, why.centring,
      [&](StageRun&) { f.set_first_acceleration(); }, {f.reduced_pressure, moments.correction}, {f.acceleration}, true);
  // (xi) r^{n+1}, u^{n+1}
  add(step, "acceptance", true, "limits, energy, final positions", [&](StageRun& run) { f.accept(run.dt); },
      {f.next_velocity, r, f.displacement_by_shift(), f.shift_velocity, f.reduced_pressure, f.potential, f.strain},
      {p.position, p.velocity, f.acceleration, f.pressure});
  add(
      step, "scalars", has.scalars, why.scalars,
      [&](StageRun& run) { run.pairs = f.arrangement.pair_count() * double(f.transport_scalars(run.dt)); },
      living_scalars(f, f.scalar_count()), living_scalars(f, f.scalar_count()), true);
  add(
      step, "oxygen", has.oxygen, why.oxygen, [&](StageRun& run) { f.transfer_oxygen(run.dt); },
      living_scalars(f, has.oxygen ? 1 : 0), living_scalars(f, has.oxygen ? 1 : 0));
  add(
      step, "reactions", has.biokinetics, why.reactions, [&](StageRun& run) { f.sludge->react(run.dt); },
      living_scalars(f, has.biokinetics ? std::size_t{biokinetics::asm1::components} : 0),
      living_scalars(f, has.biokinetics ? std::size_t{biokinetics::asm1::components} : 0));
  add(
      step, "bubble events", has.bubbles, why.events, [&](StageRun& run) { f.bubbles->accept(run.dt); },
      living({kept.bubbles, f.sizes.volume_fraction}), living({kept.bubbles, f.volume_fraction()}));
  return plan;
}

}  // namespace spume::les_sph
