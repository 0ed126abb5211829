// SPDX-License-Identifier: MIT
// Positions, gradients, forces and velocities of a step: everything but its pressure.
#include <algorithm>
#include <cmath>

#include "full_tanks.hpp"
#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/core/vectors.hpp"
#include "spume/methods/les_sph/flow.hpp"
#include "spume/particles/blocks.hpp"
#include "spume/particles/sponge.hpp"

namespace spume::les_sph {
namespace {

// Of the bulk value of div r: below it neighbours are missing at a surface, and their arrangement tells nothing of the
// error of the Laplacian. In a lid-driven cavity at 1/40, 0.99 changes the kinetic energy at t = 0.3 by 0.05 % and 0.8
// by 0.02 %.
constexpr double least_divergence_of_position = 0.95;

[[noreturn]] void refuse_body_force(const Flow& flow, double t) {
  StepFailure::Details details;
  details.cause = "the body force is not a finite number";
  details.option = "forces.body";
  for (std::size_t i = 0; i < flow.size() && details.particle < 0; ++i) {
    const Vec3 r = vector_at(flow.intermediate_position, flow.dimensions, i);
    const double size = length((*flow.scene.body_force)(r, t));
    if (std::isfinite(size)) continue;
    details.particle = (*flow.particles.identifier)[i];
    std::copy(r.begin(), r.end(), details.position);
    details.value = size;
  }
  throw StepFailure(details);
}

// Calls use(i, force, r, f) with the body force f at the intermediate position r of every particle, and keeps the
// largest.
template <class Use>
void for_each_body_force(Flow& flow, double t, Use&& use) {
  flow.next_largest_body_force = parallel_reduce(
      flow.size(), 0.0,
      [&](std::size_t first, std::size_t last) {
        const VectorExpression force = flow.scene.body_force->clone();
        double largest = 0;
        for (std::size_t i = first; i < last; ++i) {
          const Vec3 r = vector_at(flow.intermediate_position, flow.dimensions, i), f = force(r, t);
          largest = larger_or_nan(largest, length(f));
          use(i, force, r, f);
        }
        return largest;
      },
      larger_or_nan);
  if (!std::isfinite(flow.next_largest_body_force)) refuse_body_force(flow, t);
}

// The step was chosen for the eddy viscosity of the step before; the first one knew none.
void refuse_unstable_diffusion(const Flow& flow, double dt) {
  const double largest = flow.closure->largest(flow.size());
  const double h = flow.resolution.smoothing_length;
  if ((flow.viscosity() + largest) * flow.diffusion_rate() * dt <= largest_stable_viscous * h * h) return;
  StepFailure::Details details;
  details.cause = "the eddy viscosity has grown beyond what the step is stable with";
  details.option = "time.viscous";
  details.value = largest;
  throw StepFailure(details);
}

}  // namespace

double Flow::inside(std::size_t i) const {
  return surface != nullptr ? surface->interior_weight[i] : fading.weight((*moments.divergence_of_position)[i]);
}

Vec3 Flow::advecting_velocity_of(std::size_t i, double dt) const {
  Vec3 u = vector_at(particles.velocity, dimensions, i);
  if (acceleration[0] != nullptr)
    for (int axis = 0; axis < dimensions; ++axis) u[axis] += 0.5 * dt * (*acceleration[axis])[i];
  return u;
}

void Flow::advecting_velocities(int axis, double dt, std::size_t first, std::size_t last, double* out) const {
  const double* const u = particles.velocity[axis]->data();
  if (acceleration[axis] == nullptr) {
    std::copy(u + first, u + last, out);
    return;
  }
  const float* const a = acceleration[axis]->data();
  const double half = 0.5 * dt;
#pragma GCC ivdep
  for (std::size_t i = first; i < last; ++i) out[i - first] = u[i] + half * a[i];
}

void Flow::move_to_intermediate_position(double dt) {
  if (floating != nullptr) floating->advance(dt);
  boundary.advance(time, dt);
  const auto to = write(intermediate_position);
  parallel_blocks(size(), default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    ParticleBlock u;
    for (int axis = 0; axis < dimensions; ++axis) {
      advecting_velocities(axis, dt, first, last, u.data());
      const double* const from = particles.position[axis]->data();
      double* const r = to[axis];
#pragma GCC ivdep
      for (std::size_t i = first; i < last; ++i) r[i] = from[i] + dt * u[i - first];
    }
    if (boundary.clear_of_sides(boundary.next_walls, read(intermediate_position), first, last)) {
      boundary.go_round(boundary.next_walls, to, first, last);
      return;
    }
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 from = vector_at(particles.position, dimensions, i);
      Vec3 r = vector_at(intermediate_position, dimensions, i);
      boundary.hold_liquid(boundary.next_walls, r, nullptr, &from);
      for (int axis = 0; axis < dimensions; ++axis) to[axis][i] = r[axis];
    }
  });
}

void Flow::find_advecting_velocity(double dt) {
  particles.scratch().lease(advecting_velocity, dimensions, size());
  parallel_blocks(size(), default_block, [&](std::size_t, std::size_t first, std::size_t last) {
    for (int axis = 0; axis < dimensions; ++axis)
      advecting_velocities(axis, dt, first, last, advecting_velocity[axis].data() + first);
  });
}

void Flow::compute_shift() {
  ShiftInput input = shift_input(options.get<ShiftingOptions>(), largest_shift, displacement);
  input.remove_drift = features.removes_drift;
  shift->compute(arrangement, particles, input, sizes, moments, surface.get(), boundary.reflection());
  if (rest.share == nullptr) return;
  // In proportion to the speed the shift would drive what stands unevenly, and so feed any motion: a film of 1.88
  // layers gained e in 0.07 s from rounding.
  parallel_for(size(), [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis) (*shift->displacement[axis])[i] *= 1 - (*rest.share)[i];
  });
}

void Flow::differentiate_velocity() {
  differentiate(read(advecting_velocity), false);
}
void Flow::differentiate_first_velocity() {
  differentiate(read(particles.velocity), true);
}

// That change is bounded by what a particle sees: beside voids bends behind a no-slip body make it anything.
bool Flow::shifts_without_bends() const {
  return features.shift_correction && features.no_slip_bodies && fading.missing > 0;
}

void Flow::differentiate(const std::array<const double*, 3>& velocity, bool first) {
  ScratchPool& scratch = particles.scratch();
  VelocityGradientOut out;
  if (features.stored_gradient) {
    scratch.lease(velocity_gradient, dimensions * dimensions, size());
    out.gradient = write(velocity_gradient);
  }
  if (features.test_filter) {
    scratch.lease(filtered_velocity, dimensions, size());
    out.filtered = write(filtered_velocity);
  }
  out.strain = strain->data();
  if (!features.no_slip && (options.get<SchemeOptions>().centred || first)) {
    scratch.lease(gradient_trace, size());
    out.trace = gradient_trace.data();
  }
  VelocityGradientOut of_shift;
  if (features.shift_correction && !first) {
    scratch.lease(shift_velocity, dimensions, size());
    of_shift.displacement = read(shift->displacement);
    of_shift.change = write(shift_velocity);
  }
  const auto sweep = [&](const VelocityImageRule& rule, const VelocityGradientOut& what) {
    velocity_gradient_sweep(arrangement.context, arrangement.packed, velocity, rule, moments.read_correction(), what);
  };
  // The gradient itself needs bends: without, the dissipation in a round pipe of 20 spacings is 2 % too low, not 0.4 %.
  if (of_shift.change[0] != nullptr && shifts_without_bends()) {
    VelocityImageRule odd = boundary.velocity_rule();
    odd.bends = false;
    sweep(odd, of_shift);
  } else {
    out.displacement = of_shift.displacement;
    out.change = of_shift.change;
  }
  sweep(boundary.velocity_rule(), out);
}

void Flow::find_shift_curvature() {
  shift_curvature_sweep(arrangement.context, arrangement.packed, read(velocity_gradient), boundary.velocity_rule(),
                        boundary.reflection(), read(shift->displacement), moments.read_correction(),
                        write(shift_velocity));
}

void Flow::find_eddy_viscosity(double dt) {
  closure->find({.particles = size(),
                 .context = arrangement.context,
                 .images = boundary.image_map(arrangement.images),
                 .resolution = resolution,
                 .sizes = sizes,
                 .velocity = read(advecting_velocity),
                 .strain = strain->data(),
                 .velocity_gradient = read(velocity_gradient),
                 .filtered_velocity = read(filtered_velocity),
                 .kinematic_viscosity = viscosity()},
                {arrangement.packed, particles.scratch()}, dt);
  refuse_unstable_diffusion(*this, dt);
}

void Flow::find_uniform_acceleration(double t) {
  uniform_acceleration = {};
  periodic_acceleration = {};
  Vec3 total = scene.fluid.gravity;
  if (features.uniform_body_force) {
    const Vec3 force = (*scene.body_force)(arrangement.origin, t);
    for (int axis = 0; axis < dimensions; ++axis) total[axis] += force[axis];
  }
  if (!std::isfinite(total[0] + total[1] + total[2])) refuse_body_force(*this, t);
  for (int axis = 0; axis < dimensions; ++axis)
    (scene.domain.periodic(axis) ? periodic_acceleration : uniform_acceleration)[axis] = total[axis];
}

void Flow::find_potential(double dt) {
  const double t = time + dt;
  find_uniform_acceleration(t);
  parallel_for(size(),
               [&](std::size_t i) { (*potential)[i] = potential_at(vector_at(intermediate_position, dimensions, i)); });
  if (force_potential) add_force_potential(t);
}

void Flow::add_force_potential(double t) {
  particles.scratch().lease(varying_force, dimensions, size());
  for_each_body_force(*this, t, [&](std::size_t i, const VectorExpression& force, const Vec3& r, const Vec3& f) {
    (*potential)[i] += (*force_potential)(force, r, t);
    for (int axis = 0; axis < dimensions; ++axis) varying_force[axis][i] = static_cast<float>(f[axis]);
  });
}

void Flow::find_wall_bends() {
  wall_bends->find(arrangement, intermediate_position, started ? read(advecting_velocity) : read(particles.velocity),
                   wall_times.velocity, particles.scratch());
}

void Flow::find_viscous_acceleration(double dt) {
  // The Morris Laplacian of a quadratic field is d / div r too small. Folding the factor into the coefficient keeps the
  // pair exchange symmetric; near a surface, where the kernel is cut, the factor of the bulk is used.
  const double nu = viscosity();
  const double bulk = resolution.lattice.divergence_of_position;
  ScratchArray<float> diffusivity(particles.scratch(), size());
  parallel_for(size(), [&](std::size_t i) {
    const double div_r = std::max<double>((*moments.divergence_of_position)[i], least_divergence_of_position * bulk);
    double eddy = started ? eddy_viscosity_of(i) : 0.0;  // the start knows none yet, of bubbles neither
    if (sizes.variable && started) eddy += bubbles->viscosity()[i];
    const double alpha = sizes.alpha(i);
    // Backscatter is clipped at -nu, in float: what rounding leaves below zero would make harmonic means of two
    // diffusivities of opposite sign, which have no bound.
    const double total = std::max(nu + eddy, 0.0);
    diffusivity[i] = static_cast<float>(alpha * total * dimensions / div_r);
  });
  ScratchArray<float> share(particles.scratch(), features.held_by_bodies ? size() : 0);
  if (features.held_by_bodies) find_held_by_bodies(share.data());
  particles.scratch().lease(viscous_acceleration, dimensions, size());
  const RidingScalars scalars = scalars_beside_viscosity(dt);
  viscous_sweep(arrangement.context, arrangement.packed, started ? read(advecting_velocity) : read(particles.velocity),
                wall_bends != nullptr ? wall_bends->rule() : boundary.velocity_rule(), diffusivity.data(),
                write(viscous_acceleration), features.viscous_stress,
                {features.held_by_bodies ? share.data() : nullptr, moments.read_correction()}, &scalars);
}

void Flow::find_held_by_bodies(float* share) const {
  const WallStencils* walls = arrangement.context.walls;
  const std::int32_t* point = arrangement.images.wall_point();
  parallel_for(size(), [&](std::size_t i) {
    share[i] = 0;
    if (walls == nullptr || point == nullptr || moments.uncorrected[i] != 0) return;
    const ListedPoints seen = arrangement.list.of(i);
    const bool held = std::any_of(seen.begin(), seen.end(), [&](std::int32_t j) {
      const std::int32_t image = j - static_cast<std::int32_t>(size());
      return image >= 0 && point[image] >= 0 && walls->no_slip[static_cast<std::size_t>(point[image])] != 0;
    });
    if (held) share[i] = static_cast<float>(inside(i));
  });
}

void Flow::add_body_force(double t, double dt) {
  for_each_body_force(*this, t, [&](std::size_t i, const VectorExpression&, const Vec3&, const Vec3& f) {
    for (int axis = 0; axis < dimensions; ++axis) intermediate_velocity[axis][i] += dt * f[axis];
  });
}

void Flow::predict_velocity(double dt) {
  ScratchPool& scratch = particles.scratch();
  scratch.lease(intermediate_velocity, dimensions, size());
  const ConstFloatVectorField exchange = bubble_exchange();
  parallel_for(size(), [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis) {
      double viscous = features.viscosity ? viscous_acceleration[axis][i] : 0.0;
      if (sizes.variable) viscous = viscous / sizes.alpha(i) + (*exchange[axis])[i];
      intermediate_velocity[axis][i] = advecting_velocity[axis][i] + dt * (viscous + periodic_acceleration[axis]);
    }
  });
  if (features.body_force && !features.uniform_body_force && !force_potential) add_body_force(time + dt, dt);
  scratch.release(viscous_acceleration);
  // Closures and bubbles have read these.
  scratch.release(velocity_gradient);
  scratch.release(filtered_velocity);
}

void Flow::damp_velocity(double dt) {
  work_of_sponges = particle_mass() * damp_in_sponges(scene.domain, scene.sponges, intermediate_position, size(), dt,
                                                      intermediate_velocity);
}

// F, the acceleration without pressure, in the place of the intermediate velocity.
void Flow::find_first_forces() {
  particles.scratch().lease(intermediate_velocity, dimensions, size());
  parallel_for(size(), [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis)
      intermediate_velocity[axis][i] =
          periodic_acceleration[axis] + (features.viscosity ? viscous_acceleration[axis][i] / sizes.alpha(i) : 0.0);
  });
  if (features.body_force && !features.uniform_body_force && !force_potential) add_body_force(time, 1);
  particles.scratch().release(viscous_acceleration);
}

// F - grad p / rho of the first pressure.
void Flow::set_first_acceleration() {
  project_velocity(1);
  parallel_for(size(), [&](std::size_t i) {
    for (int axis = 0; axis < dimensions; ++axis) (*acceleration[axis])[i] = static_cast<float>(next_velocity[axis][i]);
  });
  particles.scratch().release(next_velocity);
}

void Flow::project_velocity(double dt) {
  const std::size_t n = size();
  const double mean = parallel_sum(n, [&](std::size_t i) { return (*reduced_pressure)[i]; }) /
                      static_cast<double>(std::max<std::size_t>(n, 1));
  FloatVectorScratch gradient_of_q;
  particles.scratch().lease(gradient_of_q, dimensions, n);
  gradient_sweep(arrangement.context, arrangement.packed, reduced_pressure->data(), mean, moments.read_correction(),
                 write(gradient_of_q));
  if (surface != nullptr)
    surface->complete_gradient(moments, sizes, acceleration_in_potential(), *reduced_pressure, potential,
                               gradient_of_q);
  for (std::size_t axis = 0; axis < 3; ++axis) next_velocity[axis].swap(intermediate_velocity[axis]);
  particles.scratch().release(intermediate_velocity);
  const NeighbourList& list = arrangement.list;
  const float* coordinate[3] = {list.coordinate(0), list.coordinate(1), list.coordinate(2)};
  parallel_for(n, [&](std::size_t i) {
    Vec3 gradient = vector_at(gradient_of_q, dimensions, i);
    if (moments.uncorrected[i] != 0 && !(surface != nullptr && surface->is_covered(i))) {
      // The plain gradient does not reproduce the linear potential: what it misses of it is put back, so that an
      // isolated particle falls with the full acceleration.
      Vec3 seen{};
      with_kernel(arrangement.context, [&]<int d, class Kernel>() {
        const auto scale = KernelScale<d, Kernel>(arrangement.context).at(arrangement.context, i);
        for (const std::int32_t j : list.of(i)) {
          double r2 = 0, slope = 0;
          std::array<double, d> dr;
          for (int axis = 0; axis < d; ++axis) {
            dr[axis] = double{coordinate[axis][j]} - double{coordinate[axis][i]};
            r2 += dr[axis] * dr[axis];
          }
          // Images mirror the potential of their source.
          const std::size_t source = arrangement.particle_of(j);
          if (potential != nullptr) slope = (*potential)[source] - (*potential)[i];
          const double g = -scale.gradient * own_volume<Kernel>(arrangement.context, source) *
                           Kernel::f(std::sqrt(r2) * scale.inverse_h);
          for (int axis = 0; axis < d; ++axis) seen[axis] += g * dr[axis] * slope;
        }
      });
      const Vec3 acting = acceleration_in_potential().at(i);
      for (int axis = 0; axis < dimensions; ++axis) gradient[axis] += -acting[axis] - seen[axis];
    }
    // King (3.14b) with alpha du/dt: see physics/bubbles/coupling.hpp.
    if (bubbles != nullptr && bubbles->mixture_pressure())
      for (double& component : gradient) component /= sizes.alpha(i);
    for (int axis = 0; axis < dimensions; ++axis) next_velocity[axis][i] -= dt * gradient[axis];
  });
  particles.scratch().release(gradient_of_q);
  particles.scratch().release(varying_force);
}

// Scalars see the positions and the shift that viscosity sees.
RidingScalars Flow::scalars_beside_viscosity(double dt) {
  if (!features.scalars || !started || features.eddy_viscosity || sizes.variable) return {};
  return solutes.scalars->ride(dt, {.viscosity = viscosity(),
                                    .laplacian_diagonal = moments.laplacian_diagonal,
                                    .shift = shift_of_scalars(),
                                    .correction = moments.read_correction()});
}

FloatVectorField Flow::shift_of_scalars() const {
  return features.shift_correction ? shift->displacement : FloatVectorField{};
}

std::int64_t Flow::transport_scalars(double dt) {
  const bool faded = features.shift_correction && surface == nullptr && fading.missing > 0;
  ScratchArray<float> weight(particles.scratch(), faded ? size() : 0);
  if (faded) parallel_for(size(), [&](std::size_t i) { weight[i] = static_cast<float>(inside(i)); });
  const std::int64_t sweeps = solutes.scalars->transport(
      dt, {.arrangement = arrangement,
           .divergence_of_position = moments.divergence_of_position->data(),
           .correction = moments.read_correction(),
           .eddy_viscosity = eddy_viscosity(),
           .places = particles.position,
           .walls = boundary.walls,
           .time = time - dt,
           .shift = shift_of_scalars(),
           .interior = surface != nullptr ? surface->interior_weight.data() : (faded ? weight.data() : nullptr)});
  // Behind diffusion, which may have been found from the values at the start of the step.
  solutes.scalars->add_sources(time - dt, dt);
  return sweeps;
}

void Flow::transfer_oxygen(double dt) {
  if (bubbles != nullptr && !bubbles->population().empty())
    solutes.oxygen->take_from_bubbles(bubbles->dissolution(), bubbles->dissolved_amount());
  if (solutes.rigid_bubbles != nullptr) solutes.take_from_rigid_bubbles(particles, time, dt);
  if (surface != nullptr)
    solutes.oxygen->exchange_with_air(
        dt, {.interior_weight = surface->interior_weight.data(), .normal = read(moments.normal)});
}

}  // namespace spume::les_sph
