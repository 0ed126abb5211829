// SPDX-License-Identifier: MIT
// The velocities of a step and its pressure.
#include <algorithm>
#include <cmath>
#include <limits>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/gfd/flow.hpp"
#include "spume/operators/gfd_gradient.hpp"
#include "spume/operators/interface_jump.hpp"
#include "spume/operators/sph_diffusion.hpp"
#include "spume/particles/blocks.hpp"
#include "spume/particles/number_density.hpp"

namespace spume::gfd {
namespace {

MomentumDiffusion form_of(Diffusion diffusion) {
  switch (diffusion) {
    case Diffusion::printed:
      return MomentumDiffusion::printed;
    case Diffusion::mu_laplacian:
      return MomentumDiffusion::mu_laplacian;
    case Diffusion::laplacian:
      return MomentumDiffusion::laplacian;
    case Diffusion::rotation_free:
      return MomentumDiffusion::rotation_free;
    default:
      return MomentumDiffusion::split;
  }
}

}  // namespace

void Flow::find_viscous_acceleration() {
  ScratchPool& scratch = particles.scratch();
  scratch.lease(viscous_acceleration, dimensions, size());
  const Diffusion form = options.get<MomentumOptions>().diffusion;
  DiffusionProperties properties = diffusion_properties();
  if (form == Diffusion::hu_adams) {
    ScratchArray<float> volume(scratch, size());
    volume.fill(static_cast<float>(particles.volume));
    hu_adams_sweep(arrangement.context, arrangement.packed, read(particles.velocity), boundary.velocity_rule(),
                   volume.data(), properties, write(viscous_acceleration));
  } else {
    properties.viscosity_gradient = read(viscosity_gradient);
    gfd_stress_sweep(arrangement.context, arrangement.packed, read(particles.velocity), boundary.velocity_rule(),
                     stencils(), form_of(form), properties, write(viscous_acceleration));
  }
  scratch.release(viscosity_gradient);
  if (!features.writes_diffusion) return;
  parallel_for(size(), [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis) (*diffusion[axis])[i] = viscous_acceleration[axis][i];
  });
}

void Flow::measure_diffusion() {
  if (!features.viscosity) {
    for (int axis = 0; axis < dimensions; ++axis) diffusion[axis]->fill(0.0);
    return;
  }
  if (takes_viscosity_gradient()) find_viscosity_gradient();
  find_viscous_acceleration();
  particles.scratch().release(viscous_acceleration);
}

void Flow::predict_velocity(double dt) {
  particles.scratch().lease(intermediate_velocity, dimensions, size());
  Vec3 periodic{};
  for (int axis = 0; axis < dimensions; ++axis)
    if (scene.domain.periodic(axis)) periodic[axis] = scene.fluid.gravity[axis];
  parallel_blocks(size(), default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    const VectorExpression force = features.forces && scene.body_force ? scene.body_force->clone() : VectorExpression();
    for (std::size_t i = first; i < last; ++i) {
      Vec3 acting = periodic;
      if (scene.body_force) {
        const Vec3 f = force(vector_at(particles.position, dimensions, i), time);
        for (std::size_t axis = 0; axis < 3; ++axis) acting[axis] += f[axis];
      }
      for (int axis = 0; axis < dimensions; ++axis) {
        const double viscous = features.viscosity ? viscous_acceleration[axis][i] : 0.0;
        intermediate_velocity[axis][i] = (*particles.velocity[axis])[i] + dt * (viscous + acting[axis]);
      }
    }
  });
  particles.scratch().release(viscous_acceleration);
}

// Backward Euler. The pressure and the forces of the last step are among what the velocity is predicted by, and the
// projection finds the change of that pressure: what diffuses has then no dt grad p to lose. A projection of the whole
// pressure leaves a divergence of dt (<lap p / rho> - div <grad p / rho>) in each step, which slows a drop of 100 times
// the viscosity by 38 % at 30 times the explicit limit (viscous_drop).
void Flow::diffuse_implicitly(double dt) {
  const std::size_t n = size();
  ScratchPool& scratch = particles.scratch();
  Array<float>& change = implicit_diffusion.change();
  change.resize(n * static_cast<std::size_t>(dimensions));
  incremental = steps > 0;
  if (incremental) {
    ScratchArray<double> last(scratch, n);
    parallel_for(n, [&](std::size_t i) { last[i] = kept_pressure * last_reduced(i); });
    FloatVectorScratch gradient, force;
    scratch.lease(gradient, dimensions, n);
    scratch.lease(force, dimensions, n);
    for (int axis = 0; axis < dimensions; ++axis) force[axis].fill(0.0F);
    gfd_gradient_over_density_sweep(arrangement.context, arrangement.packed, last.data(), 0, density_property(),
                                    stencils().correction, write(gradient));
    add_interface_forces({write(force), nullptr});
    for (int axis = 0; axis < dimensions; ++axis)
      parallel_for(n, [&](std::size_t i) {
        intermediate_velocity[axis][i] += dt * (double{force[axis][i]} - gradient[axis][i]);
      });
    scratch.release(gradient);
    scratch.release(force);
    arrangement.context.image_pressure = nullptr;  // of the whole pressure, not of its change
  }
  for (int axis = 0; axis < dimensions; ++axis) {
    float* of_axis = change.data() + static_cast<std::size_t>(axis) * n;
    parallel_for(n, [&, of_axis](std::size_t i) {
      of_axis[i] = static_cast<float>(intermediate_velocity[axis][i] - (*particles.velocity[axis])[i]);
    });
  }
  implicit_diffusion.solve(
      {arrangement.context, arrangement.packed, boundary.velocity_rule(), stencils(), diffusion_properties(), dt},
      scratch);
  if (!implicit_diffusion.report().converged) refuse_unconverged_diffusion();
  for (int axis = 0; axis < dimensions; ++axis) {
    const float* of_axis = change.data() + static_cast<std::size_t>(axis) * n;
    parallel_for(n, [&, of_axis](std::size_t i) { intermediate_velocity[axis][i] += of_axis[i]; });
  }
}

// The jumps are those of the sharp phases. Those of the filtered colours, as wide again as the support, make the
// interface softer: a capillary wave of 32 spacings is then 4.8 % too slow, in place of 2.8 %.
void Flow::add_interface_forces(const InterfaceForce& out) {
  for (const Colour& colour : colours) {
    ScratchArray<float> sharp(particles.scratch(), size());
    parallel_for(size(), [&](std::size_t i) { sharp[i] = static_cast<float>(colour.is(phase[i])); });
    interface_jump_sweep(arrangement.context, arrangement.packed, bands.facing(arrangement.context),
                         {sharp.data(), colour.potential.data(), density->data()}, stencils(), out);
  }
}

void Flow::predict_layers(double dt) {
  layers->predict(read(particles.velocity), write(intermediate_velocity), dt, *density);
}

DiffusionProperties Flow::diffusion_properties() const {
  return {{viscosity->data(), features.viscosity_jump ? bands.varies() : nullptr}, density->data()};
}

void Flow::find_divergence() {
  particles.scratch().lease(divergence, size());
  gfd_divergence_sweep(arrangement.context, arrangement.packed, read(intermediate_velocity), boundary.volume_rule(),
                       stencils().correction, divergence.data());
  max_divergence =
      parallel_max(size(), 0.0, [&](std::size_t i) { return in_domain(i) ? std::abs(divergence[i]) : 0.0; });
}

void Flow::relax_density(double dt) {
  volume_ratio = even_out_density({.steps = options.get<PressureOptions>().density_relaxation,
                                   .displacement = displacement,
                                   .dt = dt,
                                   .left_out = left_out()},
                                  arrangement, boundary, particles.position, resolution, moments, nullptr, divergence);
  // What it lets be from particle to particle adds up over a phase: a bubble that rises by its diameter shrinks by 0.5
  // %. The volume of a whole phase has no such disorder and need not wait as long: it closes its excess while the
  // particles move by a support, over which their neighbours change. Half of that halves what is open, 0.104 % of the
  // bubble of rising_bubble_2d, and feeds oscillations: the drop of oscillating_drop, 1:1, grows by 0.002 a radian.
  const double steps_to_close = resolution.support_radius / (full_displacement * resolution.smoothing_length);
  const double rate = displacement / (steps_to_close * dt);
  for (std::size_t n = 0; n < phase_volume.size() && features.interfaces; ++n) {
    // With openings of what there is of the phase now.
    const double whole = features.openings ? particles.volume * static_cast<double>(particles_of(n)) : first_volume[n];
    if (features.openings && !(whole > 0)) continue;
    const double excess = phase_volume[n] / whole - 1;
    parallel_for(size(), [&](std::size_t i) {
      if (phase[i] == n) divergence[i] += rate * excess;
    });
  }
}

// In full: there is no surface that it could lift. Less what neighbours share of it, it leaves disorder of several
// spacings at the interface, which lets the pressure gain energy: a drop without viscosity gained 3 % of its amplitude
// in a radian and a wave with viscosity lost 7 % less than it should.
void Flow::compute_shift() {
  ShiftInput input = shift_input(options.get<ShiftingOptions>(), largest_shift, displacement);
  input.remove_drift = false;
  shift->compute(arrangement, particles, input, sizes, moments, nullptr, boundary.reflection());
}

void Flow::correct_for_shift() {
  particles.scratch().lease(shift_velocity, dimensions, size());
  gfd_change_sweep(arrangement.context, arrangement.packed, read(particles.velocity), boundary.velocity_rule(),
                   stencils().correction, read(shift->displacement), write(shift_velocity));
}

// (23) for pi, times the particle volume, with the jumps of the potentials on the right-hand side.
void Flow::set_matrix(double dt) {
  const std::size_t n = size();
  ScratchPool& scratch = particles.scratch();
  scratch.release(moments.kernel_sum);
  scratch.lease(rows.right_hand_side, n);
  rows.source_norm = std::sqrt(parallel_sum(n, [&](std::size_t i) {
    const double value = in_domain(i) ? -particles.volume * divergence[i] / dt : 0.0;
    rows.right_hand_side[i] = value;
    return value * value;
  }));
  scratch.release(divergence);
  ScratchArray<double> source(scratch, n);  // of the forces at interfaces
  source.fill(0.0);
  scratch.lease(force_acceleration, features.interfaces ? dimensions : 0, n);
  for (int axis = 0; axis < dimensions && features.interfaces; ++axis) force_acceleration[axis].fill(0.0F);
  if (!incremental) add_interface_forces({write(force_acceleration), source.data()});
  for (Array<float>* array : {&rows.diagonal, &reciprocal_density}) scratch.lease(*array, n);
  GfdPressureMatrix pairs{stencils(), density_property()};
  if (features.openings) {
    layers->give_pressures(time + dt, read(particles.velocity),
                           [&](const Vec3& place, std::size_t i) { return -hydrostatic_part(place, phase[i]); });
    rows.pressure_fixed = &layers->masked();
    pairs.masked = layers->masked().data();
    pairs.tied = &layers->tied();
  }
  matrix.bind(arrangement.context, arrangement.packed, pairs, rows.diagonal);
  rows.singular = !features.outflow;
  rows.unsymmetric = true;
  parallel_for(n, [&](std::size_t i) {
    reciprocal_density[i] = 1 / (*density)[i];
    if (!in_domain(i)) rows.diagonal[i] = 0;
  });
  rows.coefficient = reciprocal_density.data();
  rows.reference_norm = std::sqrt(parallel_sum(n, [&](std::size_t i) {
    if (in_domain(i)) rows.right_hand_side[i] -= particles.volume * source[i];
    return rows.right_hand_side[i] * rows.right_hand_side[i];
  }));
  if (incremental) rows.reference_norm = std::hypot(rows.reference_norm, last_norm());
}

// What the last pressure brings to the right-hand side of the whole one.
double Flow::last_norm() {
  const std::size_t n = size();
  ScratchArray<double> last(particles.scratch(), n), zero(particles.scratch(), n), product(particles.scratch(), n);
  zero.fill(0.0);
  parallel_for(n, [&](std::size_t i) { last[i] = kept_pressure * last_reduced(i); });
  matrix.residual(last, zero, product, false);
  return std::sqrt(parallel_sum(n, [&](std::size_t i) { return product[i] * product[i]; }));
}

// Of the residual where the last pi is the difference of the pressure and its hydrostatic part, each known to eps / 2
// of itself: 2 eps between two particles. Liquid at rest has no other residual.
double Flow::guess_rounding() const {
  constexpr double of_two = 2 * std::numeric_limits<double>::epsilon();
  return of_two * std::sqrt(parallel_sum(size(), [&](std::size_t i) {
           const double row = rows.diagonal[i] * hydrostatic_part(i);
           return row * row;
         }));
}

void Flow::prepare_solver() {
  solver.prepare(rows, particles, particles.position, boundary);
}

void Flow::solve_pressure() {
  ScratchPool& scratch = particles.scratch();
  scratch.lease(reduced_pressure, size());
  const bool warm_start = options.get<PressureOptions>().warm_start && steps > 0 && !incremental;
  parallel_for(size(), [&](std::size_t i) { reduced_pressure[i] = warm_start ? last_reduced(i) : 0.0; });
  if (arrangement.context.image_pressure != nullptr || features.openings)
    rows.reference_norm = std::hypot(rows.reference_norm, given_norm(matrix, particles));
  rows.rounding_norm = warm_start ? guess_rounding() : 0;
  rows.measured = steps % steps_between_measured == 0;
  solver.solve(rows, matrix, particles, reduced_pressure);
  if (features.openings) layers->tied().extend(reduced_pressure.data(), true);
  rows.release(scratch);
  scratch.release(reciprocal_density);
  demand_convergence(solver.report(), "the pressure solve");
}

void Flow::project_velocity(double dt) {
  const std::size_t n = size();
  ScratchPool& scratch = particles.scratch();
  if (rows.singular) {
    const double mean = parallel_sum(n, [&](std::size_t i) { return reduced_pressure[i]; }) / static_cast<double>(n);
    parallel_for(n, [&](std::size_t i) { reduced_pressure[i] -= mean; });
  }
  FloatVectorScratch gradient;
  scratch.lease(gradient, dimensions, n);
  gfd_gradient_over_density_sweep(arrangement.context, arrangement.packed, reduced_pressure.data(), 0,
                                  density_property(), stencils().correction, write(gradient));
  for (std::size_t axis = 0; axis < 3; ++axis) next_velocity[axis].swap(intermediate_velocity[axis]);
  parallel_for(n, [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis) {
      const double force = features.interfaces ? force_acceleration[axis][i] : 0.0F;
      next_velocity[axis][i] -= dt * (gradient[axis][i] - force);
    }
  });
  if (incremental) parallel_for(n, [&](std::size_t i) { reduced_pressure[i] += kept_pressure * last_reduced(i); });
  if (features.openings) layers->follow(write(next_velocity));
  scratch.release(gradient);
  scratch.release(force_acceleration);
  scratch.release(intermediate_velocity);
}

void Flow::refuse_unconverged_diffusion() const {
  StepFailure::Details details;
  details.cause = "the implicit viscosity did not converge in " +
                  std::to_string(implicit_diffusion.report().iterations) + " iterations";
  details.option = "time.max_step";
  details.value = implicit_diffusion.report().relative_residual;
  throw StepFailure(details);
}

// An unstable run is finite to the end, in ever shorter steps: a step that makes energy from nothing is refused. What a
// flow may hold is its mechanical energy at the start and that of the interfaces, and what rearranged particles lift, a
// tenth of the weight over a spacing. An instability passes twice of it soon.
void Flow::refuse_energy_from_nothing() const {
  if (!gains_no_energy()) return;
  const double kinetic =
      parallel_sum(size(), [&](std::size_t i) { return mass(i) * squared_norm(next_velocity, dimensions, i) / 2; });
  if (kinetic <= 2 * std::max(0.0, energy_supply - potential_energy()) + 0.1 * weight * spacing()) return;
  StepFailure::Details details;
  details.cause =
      "the flow has gained energy from nothing: its kinetic energy is more than twice what it had at the start";
  details.option = "resolution.spacing";
  details.value = kinetic;
  throw StepFailure(details);
}

// Passes over one axis, which the compiler takes several particles of at once; only what walls do goes one by one.
void Flow::accept_block(double dt, std::size_t first, std::size_t last) {
  const std::size_t n = last - first;
  VectorBlock r{}, u{};
  for (int axis = 0; axis < dimensions; ++axis) {
    const double* const from = particles.position[axis]->data() + first;
    std::copy_n(next_velocity[axis].data() + first, n, u[axis].data());
    for (std::size_t k = 0; k < n; ++k) r[axis][k] = from[k] + dt * u[axis][k];
    ParticleBlock moved{}, gained{};
    if (features.shifting) std::copy_n(shift->displacement[axis]->data() + first, n, moved.data());
    if (features.shift_correction) std::copy_n(shift_velocity[axis].data() + first, n, gained.data());
    for (std::size_t k = 0; k < n && features.openings; ++k)
      if (!in_domain(first + k)) moved[k] = gained[k] = 0;
    for (std::size_t k = 0; k < n; ++k) {
      r[axis][k] += moved[k];
      u[axis][k] += gained[k];
    }
  }
  if (boundary.clear_of_sides(boundary.next_walls, {r[0].data(), r[1].data(), r[2].data()}, 0, n)) {
    boundary.go_round(boundary.next_walls, {r[0].data(), r[1].data(), r[2].data()}, 0, n);
  } else {
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 from = vector_at(particles.position, dimensions, first + k);
      Vec3 place{r[0][k], r[1][k], r[2][k]}, velocity{u[0][k], u[1][k], u[2][k]};
      if (features.openings)
        openings->apply_walls(boundary, first + k, place, &velocity, &from);
      else
        boundary.hold_liquid(boundary.next_walls, place, &velocity, &from);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        r[axis][k] = place[axis];
        u[axis][k] = velocity[axis];
      }
    }
  }
  for (int axis = 0; axis < dimensions; ++axis) {
    std::copy_n(r[axis].data(), n, particles.position[axis]->data() + first);
    std::copy_n(u[axis].data(), n, particles.velocity[axis]->data() + first);
  }
}

void Flow::accept(double dt) {
  refuse_long_strides(particles, particles.position, next_velocity, arrangement.grid.support_radius(), dt);
  refuse_energy_from_nothing();
  boundary.advance(time, dt);
  parallel_for(size(), [&](std::size_t i) { (*pressure)[i] = reduced_pressure[i] + hydrostatic_part(i); });
  parallel_blocks(size(), default_block,
                  [&](std::size_t, std::size_t first, std::size_t last) { accept_block(dt, first, last); });
  particles.scratch().release(next_velocity);
  particles.scratch().release(shift_velocity);
  particles.scratch().release(reduced_pressure);
  keep_exchange();
  boundary.accept();
  if (features.openings) openings->accept();
  time += dt;
  ++steps;
  speeds = find_speeds(arrangement, particles);
}

}  // namespace spume::gfd
