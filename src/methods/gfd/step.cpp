// SPDX-License-Identifier: MIT
// The step, as the list of its stages in the order of Joubert, Wilke and Pizette, section 2.3, with their equations.
// The same list is what `spume check` prints and what the ledger times. The stages up to the potentials also run at the
// start, for the reports of the initial state.
#include "spume/methods/gfd/gfd.hpp"
#include "stage_list.hpp"

namespace spume::gfd {

using enum StagePart;
Plan make_plan(Flow& f) {
  Plan plan;
  const Features& has = f.features;
  ParticleStore& p = f.particles;
  const Diffusion diffusion = f.options.get<MomentumOptions>().diffusion;
  const ArrayUse images([&f] { return f.arrangement.image_traffic(); });
  const ArrayUse lists([&f] { return f.arrangement.list_traffic(f.sizes); });
  const ArrayUse sorted([&f] { return f.arrangement.sort_traffic(f.particles); });
  const ArrayUse band([&f] { return f.bands.bytes(); });
  const ArrayUse colours([&f] {
    double sum = 0;
    for (const Colour& colour : f.colours) sum += colour.value.bytes() + colour.potential.bytes();
    return sum;
  });
  const ArrayUse factors([&f] { return f.solver.factor_bytes(); });
  const char* const openings = has.openings ? "particles enter and leave" : "no inflow, no outflow";
  const ParticleStages stages(plan, f);
  const std::string several = has.interfaces ? "several phases" : "one phase";

  // The arrangement at r^k
  stages.add(step, "openings", has.openings, openings, &Flow::renew_layers, {p.position}, {p.velocity});
  stages.add(both, "sort", true, "particles in cell order", &Flow::sort_particles, {}, {sorted});
  stages.sweep(start, "packing", has.bodies, has.bodies ? "particles beside bodies evened out" : "no walls of bodies",
               &Flow::pack, {}, {p.position});
  stages.add(both, "images", has.images, "periodic sides, walls, solids or bodies", &Flow::make_images, {p.position},
             {images, f.boundary.velocity_rule().offset});
  stages.add(both, "neighbours", true, "lists within the kernel support", &Flow::find_neighbours, {*f.phase_number},
             {lists, f.phase});
  stages.add(step, "layers", has.openings, openings, &Flow::find_layers, {p.position, f.phase}, {p.velocity});
  stages.sweep(both, "stencils", true, "(10), (11) and kernel moments", &Flow::measure_stencils, {},
               {f.correction, f.offset, *f.laplacian_factor, f.moments.kernel_sum, f.moments.concentration_gradient});
  // Interfaces
  stages.sweep(both, "bands", has.interfaces, several, &Flow::find_bands, {f.phase}, {band});
  stages.add(both, "properties", true, has.interfaces ? "(6), (7): colours, filtered density and viscosity" : several,
             blending(f), {f.phase, band}, {colours, *f.density, f.viscosity});
  const char* const jump = has.density_jump ? "momentum of the mass that the filter passes on" : "one density";
  const ArrayUse last([&f] { return f.last_density == nullptr ? 0.0 : f.last_density->bytes(); });
  stages.sweep(start, "first mass exchange", has.density_jump, jump, &Flow::exchange_first_mass,
               {p.velocity, *f.density, last, band}, {p.velocity, last});
  stages.sweep(step, "mass exchange", has.density_jump, jump, &Flow::exchange_mass,
               {p.velocity, *f.density, last, band}, {p.velocity});
  stages.sweep(both, "potentials", has.interfaces,
               has.interfaces ? "(14) to (17): tension and weight of the interfaces, pairwise" : several,
               &Flow::find_potentials, {colours, f.correction}, {colours});
  const bool at_rest = (has.gravity || has.interfaces) && !has.openings;
  stages.add(start, "pressure at rest", at_rest,
             at_rest        ? "of weight and tension, until the first step finds it"
             : has.openings ? "openings give it its datum"
                            : "none",
             &Flow::start_pressure, {p.position, f.phase}, {*f.pressure});
  stages.add(start, "energy", true, "what the flow may hold", &Flow::start_energy, {p.position, p.velocity}, {});
  stages.sweep(start, "initial diffusion", has.writes_diffusion,
               has.writes_diffusion ? "output.fields names it" : "output.fields does not name it",
               &Flow::measure_diffusion, {p.velocity, f.viscosity}, {f.diffusion});
  // (20) u* from momentum diffusion and body forces
  stages.sweep(step, "viscosity gradient", f.takes_viscosity_gradient(),
               !has.viscosity_jump            ? "one viscosity"
               : f.takes_viscosity_gradient() ? "(18)"
                                              : "momentum.diffusion does without",
               &Flow::find_viscosity_gradient, {f.viscosity, *f.density, f.correction}, {f.viscosity_gradient});
  stages.sweep(step, "diffusion", has.viscosity, has.viscosity ? in_words(diffusion) : "inviscid",
               &Flow::find_viscous_acceleration,
               {p.velocity, f.viscosity, f.viscosity_gradient, f.offset, *f.laplacian_factor},
               {f.viscous_acceleration, f.diffusion});
  stages.add(step, "prediction", true, "(20): velocity without pressure", &Flow::predict_velocity,
             {p.velocity, f.viscous_acceleration}, {f.intermediate_velocity});
  stages.add(step, "implicit viscosity", f.viscous.implicit, f.viscous.reason, implicitly(f),
             {f.intermediate_velocity, *f.pressure, f.viscosity, f.offset, *f.laplacian_factor},
             {f.intermediate_velocity});
  stages.add(step, "prediction in layers", has.openings, openings, &Flow::predict_layers, {f.intermediate_velocity},
             {f.intermediate_velocity});
  // Shifting of Xu, in the form of King (3.12)
  stages.add(step, "shift", has.shifting, has.shifting ? "Fickian shifting" : "shifting.on = false",
             &Flow::compute_shift, {f.moments.concentration_gradient}, {f.displacement_by_shift()});
  stages.sweep(step, "shift velocity", has.shift_correction, has.shift_correction ? "first order" : "not corrected",
               &Flow::correct_for_shift, {p.velocity, f.displacement_by_shift(), f.correction}, {f.shift_velocity});
  // (23), (24) the pressure that makes the velocity free of divergence
  stages.sweep(step, "divergence", true, "right-hand side of (23)", &Flow::find_divergence,
               {f.intermediate_velocity, f.correction}, {f.divergence});
  stages.add(step, "density relaxation", has.density_relaxation,
             has.density_relaxation ? "number density" : "pressure.density_relaxation is off", &Flow::relax_density,
             {f.moments.kernel_sum}, {f.divergence});
  stages.sweep(step, "matrix", true, "(24), with the jumps at the interfaces", &Flow::set_matrix,
               {f.divergence, colours, *f.density, f.offset, *f.laplacian_factor},
               {f.rows.diagonal, f.rows.right_hand_side, f.force_acceleration, f.reciprocal_density});
  const bool direct = f.solver.direct() != nullptr;
  stages.add(step, "preconditioner", f.solver.has_multigrid(),
             f.solver.has_multigrid() ? "cells with 1 / rho"
             : direct                 ? "the solver is direct"
                                      : "pressure.preconditioner = \"jacobi\"",
             &Flow::prepare_solver, {p.position, f.rows.diagonal, f.reciprocal_density}, {});
  stages.add(step, "factorisation", direct, direct ? "UMFPACK" : "the solver is iterative", factorising(f),
             {f.rows.diagonal}, {factors});
  stages.add(step, "pressure", true, direct ? "(23): by the factors" : "(23): BiCGStab", solving(f),
             {*f.pressure, f.rows.diagonal, f.rows.right_hand_side, factors}, {f.reduced_pressure});
  stages.sweep(step, "projection", true, "(21), (22)", &Flow::project_velocity,
               {f.reduced_pressure, f.force_acceleration, f.intermediate_velocity}, {f.next_velocity});
  // (25) r^{k+1}
  stages.add(step, "acceptance", true, "(25): positions, limits", &Flow::accept,
             {f.next_velocity, f.displacement_by_shift(), f.shift_velocity, f.reduced_pressure},
             {p.position, p.velocity, *f.pressure, last});
  return plan;
}

}  // namespace spume::gfd
