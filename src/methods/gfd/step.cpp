// SPDX-License-Identifier: MIT
// The step, as the list of its stages in the order of Joubert, Wilke and Pizette, section 2.3, with their equations.
// The same list is what `spume check` prints and what the ledger times. The stages up to the potentials also run at the
// start, for the reports of the initial state.
#include "spume/methods/gfd/gfd.hpp"
#include "spume/methods/stage.hpp"

namespace spume::gfd {
namespace {

using Arrays = std::vector<ArrayUse>;

const char* form_in_words(Diffusion diffusion) {
  switch (diffusion) {
    case Diffusion::split:
      return "(12) and (grad u)^T . grad mu: div(2 mu T)";
    case Diffusion::printed:
      return "(19): grad mu . 2 T + mu lap u";
    case Diffusion::mu_laplacian:
      return "(12): div(mu grad u)";
    case Diffusion::laplacian:
      return "mu lap u";
    case Diffusion::rotation_free:
      return "(12) and (grad u)^T . grad mu of its weights: div(2 mu T)";
    case Diffusion::hu_adams:
      return "(13): Hu and Adams";
  }
  return "";
}

}  // namespace

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
  const auto add = [&](StagePart part, const char* name, bool on, std::string reason, auto work, Arrays reads,
                       Arrays writes, bool sweeps = false) {
    plan.add({name, std::move(reason), on,
              [&f, work, sweeps](StageRun& run) {
                f.arrangement.packed.take_traffic();
                work(run);
                if (sweeps && run.pairs == 0) run.pairs = f.arrangement.pair_count();
                run.bytes += f.arrangement.packed.take_traffic();
              },
              std::move(reads), std::move(writes), part});
  };
  const std::string several = has.interfaces ? "several phases" : "one phase";

  // The arrangement at r^k
  add(both, "sort", true, "particles in cell order", [&](StageRun&) { f.arrangement.sort(p, p.position); }, {},
      {sorted});
  add(
      start, "packing", has.bodies, has.bodies ? "particles beside bodies evened out" : "no walls of bodies",
      [&](StageRun&) { f.pack(); }, {}, {p.position}, true);
  add(both, "images", has.images, "periodic sides, walls, solids or bodies",
      [&](StageRun& run) { f.make_images(run.dt); }, {p.position}, {images, f.boundary.velocity_rule().offset});
  add(both, "neighbours", true, "lists within the kernel support", [&](StageRun& run) { f.find_neighbours(run.dt); },
      {*f.phase_number}, {lists, f.phase});
  add(
      both, "stencils", true, "(10), (11) and kernel moments", [&](StageRun&) { f.measure_stencils(); }, {},
      {f.correction, f.offset, *f.laplacian_factor, f.moments.correction, f.moments.kernel_sum,
       f.moments.concentration_gradient},
      true);
  // Interfaces
  add(
      both, "bands", has.interfaces, several, [&](StageRun&) { f.find_bands(); }, {f.phase}, {band}, true);
  add(
      both, "properties", true, has.interfaces ? "(6), (7): colours, filtered density and viscosity" : several,
      [&](StageRun&) { f.blend_properties(); }, {f.phase, band}, {colours, *f.density, f.viscosity}, has.interfaces);
  add(
      both, "potentials", has.interfaces,
      has.interfaces ? "(14) to (17): tension and weight of the interfaces, pairwise" : several,
      [&](StageRun&) { f.find_potentials(); }, {colours, f.correction}, {colours}, true);
  add(start, "energy", true, "what the flow may hold",
      [&](StageRun&) {
        if (f.steps == 0) f.start_energy();
      },
      {p.position, p.velocity}, {});
  add(
      start, "initial diffusion", has.writes_diffusion,
      has.writes_diffusion ? "output.fields names it" : "output.fields does not name it",
      [&](StageRun&) { f.measure_diffusion(); }, {p.velocity, f.viscosity}, {f.diffusion}, true);
  // (20) u* from momentum diffusion and body forces
  add(
      step, "viscosity gradient", f.takes_viscosity_gradient(),
      !has.viscosity_jump            ? "one viscosity"
      : f.takes_viscosity_gradient() ? "(18)"
                                     : "momentum.diffusion does without",
      [&](StageRun&) { f.find_viscosity_gradient(); }, {f.viscosity, *f.density, f.correction}, {f.viscosity_gradient},
      true);
  add(
      step, "diffusion", has.viscosity, has.viscosity ? form_in_words(diffusion) : "inviscid",
      [&](StageRun&) { f.find_viscous_acceleration(); },
      {p.velocity, f.viscosity, f.viscosity_gradient, f.offset, *f.laplacian_factor},
      {f.viscous_acceleration, f.diffusion}, true);
  add(step, "prediction", true, "(20): velocity without pressure", [&](StageRun& run) { f.predict_velocity(run.dt); },
      {p.velocity, f.viscous_acceleration}, {f.intermediate_velocity});
  // Shifting of Xu, in the form of King (3.12)
  add(step, "shift", has.shifting, has.shifting ? "Fickian shifting" : "shifting.on = false",
      [&](StageRun&) { f.compute_shift(); }, {f.moments.concentration_gradient}, {f.displacement_by_shift()});
  add(
      step, "shift velocity", has.shift_correction, has.shift_correction ? "first order" : "not corrected",
      [&](StageRun&) { f.correct_for_shift(); }, {p.velocity, f.displacement_by_shift()}, {f.shift_velocity}, true);
  // (23), (24) the pressure that makes the velocity free of divergence
  add(
      step, "divergence", true, "right-hand side of (23)", [&](StageRun&) { f.find_divergence(); },
      {f.intermediate_velocity, f.correction}, {f.divergence}, true);
  add(step, "density relaxation", has.density_relaxation,
      has.density_relaxation ? "number density" : "pressure.density_relaxation is off",
      [&](StageRun& run) { f.relax_density(run.dt); }, {f.moments.kernel_sum}, {f.divergence});
  add(
      step, "matrix", true, "(24), with the jumps at the interfaces", [&](StageRun& run) { f.set_matrix(run.dt); },
      {f.divergence, colours, *f.density, f.offset, *f.laplacian_factor},
      {f.rows.diagonal, f.rows.right_hand_side, f.force_acceleration, f.reciprocal_density}, true);
  add(step, "preconditioner", f.solver.has_multigrid(),
      f.solver.has_multigrid() ? "cells with 1 / rho" : "pressure.preconditioner = \"jacobi\"",
      [&](StageRun&) { f.prepare_solver(); }, {p.position, f.rows.diagonal, f.reciprocal_density}, {});
  add(step, "pressure", true, "(23): BiCGStab",
      [&](StageRun& run) {
        f.solve_pressure();
        run.pairs = f.arrangement.pair_count() * f.solver.report().applications;
      },
      {*f.pressure, f.rows.diagonal, f.rows.right_hand_side}, {f.reduced_pressure});
  add(
      step, "projection", true, "(21), (22)", [&](StageRun& run) { f.project_velocity(run.dt); },
      {f.reduced_pressure, f.force_acceleration, f.intermediate_velocity}, {f.next_velocity}, true);
  // (25) r^{k+1}
  add(step, "acceptance", true, "(25): positions, limits", [&](StageRun& run) { f.accept(run.dt); },
      {f.next_velocity, f.displacement_by_shift(), f.shift_velocity, f.reduced_pressure},
      {p.position, p.velocity, *f.pressure});
  return plan;
}

}  // namespace spume::gfd
