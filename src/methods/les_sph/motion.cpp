// SPDX-License-Identifier: MIT
// Velocities and final positions: predictor, projection, acceptance.
#include <algorithm>
#include <cmath>

#include "spume/core/error.hpp"
#include "spume/core/parallel.hpp"
#include "spume/methods/les_sph/free_surface.hpp"
#include "spume/methods/les_sph/liquid.hpp"

namespace spume::les_sph {
namespace {

// NaN when a component is, which the library's function of three numbers is not.
double length_of(const Vec3& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

[[noreturn]] void refuse_body_force(const Liquid& liquid, double t) {
  StepFailure::Details details;
  details.cause = "the body force is not a finite number";
  details.option = "forces.body";
  for (std::size_t i = 0; i < liquid.size() && details.particle < 0; ++i) {
    Vec3 r{};
    for (int axis = 0; axis < liquid.dimensions; ++axis) r[axis] = (*liquid.intermediate[axis])[i];
    const Vec3 force = (*liquid.scene.body_force)(r, t);
    const double size = length_of(force);
    if (std::isfinite(size)) continue;
    details.particle = (*liquid.identifier)[i];
    std::copy(r.begin(), r.end(), details.position);
    details.value = size;
  }
  throw StepFailure(details);
}

void add_body_force(Liquid& liquid, double t, double dt) {
  const int d = liquid.dimensions;
  liquid.largest_body_force = parallel_reduce(
      liquid.size(), 0.0,
      [&](std::size_t first, std::size_t last) {
        const VectorExpression force = liquid.scene.body_force->clone();
        double largest = 0;
        for (std::size_t i = first; i < last; ++i) {
          Vec3 r{};
          for (int axis = 0; axis < d; ++axis) r[axis] = (*liquid.intermediate[axis])[i];
          const Vec3 acceleration = force(r, t);
          largest = larger_or_nan(largest, length_of(acceleration));
          for (int axis = 0; axis < d; ++axis) (*liquid.predicted[axis])[i] += dt * acceleration[axis];
        }
        return largest;
      },
      larger_or_nan);
  if (!std::isfinite(liquid.largest_body_force)) refuse_body_force(liquid, t);
}

void find_diffusivity(Liquid& liquid) {
  // The Morris Laplacian of a quadratic field is d / div r too small. Folding the factor into the coefficient keeps the
  // pair exchange symmetric; near a surface, where the kernel is cut, the factor of the bulk is used.
  const double nu = liquid.scene.fluid.kinematic_viscosity;
  const double bulk = liquid.lattice.divergence_of_position;
  parallel_for(liquid.size(), [&](std::size_t i) {
    const double div_r = std::max<double>((*liquid.divergence_of_position)[i], 0.95 * bulk);
    double eddy = liquid.eddy_viscosity == nullptr ? 0.0 : (*liquid.eddy_viscosity)[i];
    if (liquid.varying) eddy += liquid.bubble_viscosity[i];
    const double alpha = liquid.alpha_at(i);
    // Backscatter is clipped at -nu, in float: what rounding leaves below zero would make harmonic means of two
    // diffusivities of opposite sign, which have no bound.
    const double total = std::max(nu + eddy, 0.0);
    (*liquid.diffusivity)[i] = static_cast<float>(alpha * total * liquid.dimensions / div_r);
  });
}

// A one-sided gradient at the surface extrapolates: fed back through the shift it accelerates particles without any
// force (0.5 sqrt(g lambda) in a tenth of a period at 1/50). The change fades out with the interior weight.
void add_shift_velocity(const Liquid& liquid, std::size_t i, Vec3& u) {
  const double inside = liquid.plan.free_surface ? double{liquid.interior_weight[i]} : 1.0;
  for (int axis = 0; axis < liquid.dimensions; ++axis) u[axis] += inside * (*liquid.shift_velocity[axis])[i];
}

}  // namespace

void find_uniform_acceleration(Liquid& liquid, double t) {
  liquid.uniform_acceleration = {};
  liquid.periodic_acceleration = {};
  Vec3 total = liquid.scene.fluid.gravity;
  if (liquid.scene.body_force && liquid.uniform_body_force) {
    const Vec3 force = (*liquid.scene.body_force)(liquid.origin, t);
    for (int axis = 0; axis < liquid.dimensions; ++axis) total[axis] += force[axis];
  }
  if (!std::isfinite(total[0] + total[1] + total[2])) refuse_body_force(liquid, t);
  for (int axis = 0; axis < liquid.dimensions; ++axis)
    (liquid.scene.domain.periodic(axis) ? liquid.periodic_acceleration : liquid.uniform_acceleration)[axis] =
        total[axis];
}

void predict_velocity(Liquid& liquid, double dt) {
  const int d = liquid.dimensions;
  const double t = liquid.time + dt;
  if (liquid.plan.gravity || liquid.plan.body_force) {
    find_uniform_acceleration(liquid, t);
    parallel_for(liquid.size(), [&](std::size_t i) {
      Vec3 r{};
      for (int axis = 0; axis < d; ++axis) r[axis] = (*liquid.intermediate[axis])[i];
      (*liquid.potential)[i] = liquid.potential_at(r);
    });
  }
  if (liquid.plan.viscosity) {
    find_diffusivity(liquid);
    viscous_sweep(liquid.context, liquid.records, liquid.read(liquid.velocity), liquid.velocity_rule,
                  liquid.diffusivity->data(), liquid.write(liquid.acceleration), liquid.plan.viscous_stress);
  }
  parallel_for(liquid.size(), [&](std::size_t i) {
    for (int axis = 0; axis < d; ++axis) {
      double viscous = liquid.plan.viscosity ? (*liquid.acceleration[axis])[i] : 0.0;
      if (liquid.varying) viscous = viscous / liquid.alpha_at(i) + (*liquid.exchange[axis])[i];
      (*liquid.predicted[axis])[i] = (*liquid.velocity[axis])[i] + dt * (viscous + liquid.periodic_acceleration[axis]);
    }
  });
  if (liquid.plan.body_force && !liquid.uniform_body_force) add_body_force(liquid, t, dt);
}

void project_velocity(Liquid& liquid, double dt) {
  const int d = liquid.dimensions;
  const std::size_t n = liquid.size();
  const double mean = parallel_sum(n, [&](std::size_t i) { return (*liquid.reduced_pressure)[i]; }) /
                      static_cast<double>(std::max<std::size_t>(n, 1));
  gradient_sweep(liquid.context, liquid.records, liquid.reduced_pressure->data(), mean, liquid.read_correction(),
                 liquid.write(liquid.acceleration));
  if (liquid.plan.free_surface) complete_surface_gradient(liquid);
  const float* coordinate[3] = {liquid.list.coordinate(0), liquid.list.coordinate(1), liquid.list.coordinate(2)};
  parallel_for(n, [&](std::size_t i) {
    Vec3 gradient{};
    for (int axis = 0; axis < d; ++axis) gradient[axis] = (*liquid.acceleration[axis])[i];
    if (liquid.uncorrected[i] != 0) {
      // The plain gradient does not reproduce the linear potential: what it misses of it is put back, so that an
      // isolated particle falls with the full acceleration.
      Vec3 seen{};
      with_kernel(liquid.context, [&]<int dimensions, class Kernel>() {
        const auto scale = KernelScale<dimensions, Kernel>(liquid.context).at(liquid.context, i);
        for (const std::int32_t j : liquid.list.of(i)) {
          double r2 = 0, slope = 0;
          std::array<double, dimensions> dr;
          for (int axis = 0; axis < dimensions; ++axis) {
            dr[axis] = double{coordinate[axis][j]} - double{coordinate[axis][i]};
            r2 += dr[axis] * dr[axis];
          }
          // Images mirror the potential of their source.
          const std::size_t source = liquid.particle_of(j);
          if (liquid.potential != nullptr) slope = (*liquid.potential)[source] - (*liquid.potential)[i];
          const double g =
              -scale.gradient * own_volume<Kernel>(liquid.context, source) * Kernel::f(std::sqrt(r2) * scale.inverse_h);
          for (int axis = 0; axis < dimensions; ++axis) seen[axis] += g * dr[axis] * slope;
        }
      });
      for (int axis = 0; axis < d; ++axis) gradient[axis] += -liquid.uniform_acceleration[axis] - seen[axis];
    }
    // King (3.14b) with alpha du/dt: see bubble_coupling.hpp.
    if (liquid.plan.mixture_pressure)
      for (double& component : gradient) component /= liquid.alpha_at(i);
    for (int axis = 0; axis < d; ++axis) (*liquid.predicted[axis])[i] -= dt * gradient[axis];
  });
}

void update_extremes(Liquid& liquid) {
  const int d = liquid.dimensions;
  const auto speed2_at = [&](std::size_t i) {
    double speed2 = 0;
    for (int axis = 0; axis < d; ++axis) speed2 += (*liquid.velocity[axis])[i] * (*liquid.velocity[axis])[i];
    return speed2;
  };
  liquid.max_speed = std::sqrt(parallel_max(liquid.size(), 0.0, speed2_at));
  // One droplet need not hold up the whole liquid. `accept` still refuses a step in which any particle crosses half
  // its support.
  const int spray = spray_neighbours(d);
  const bool listed = liquid.list.particles() == liquid.size();
  liquid.limiting_speed =
      listed ? std::sqrt(parallel_max(liquid.size(), 0.0,
                                      [&](std::size_t i) { return liquid.list.count(i) < spray ? 0.0 : speed2_at(i); }))
             : liquid.max_speed;
  liquid.max_eddy_viscosity = 0;
  if (liquid.eddy_viscosity != nullptr && liquid.started)
    liquid.max_eddy_viscosity =
        parallel_max(liquid.size(), 0.0, [&](std::size_t i) { return double{(*liquid.eddy_viscosity)[i]}; });
  if (liquid.varying && liquid.bubble_viscosity.size() == liquid.size())
    liquid.max_eddy_viscosity = parallel_max(liquid.size(), 0.0, [&](std::size_t i) {
      return double{liquid.bubble_viscosity[i]} +
             (liquid.eddy_viscosity == nullptr ? 0.0 : double{(*liquid.eddy_viscosity)[i]});
    });
}

void accept(Liquid& liquid, double dt) {
  const int d = liquid.dimensions;
  const std::size_t n = liquid.size();
  const auto speed2_at = [&](std::size_t i) {
    double speed2 = 0;
    for (int axis = 0; axis < d; ++axis) speed2 += (*liquid.predicted[axis])[i] * (*liquid.predicted[axis])[i];
    return speed2;
  };
  const double fastest = std::sqrt(parallel_max(n, 0.0, speed2_at));
  // A particle that crosses half its support in one step has left the neighbours that its pressure was solved with.
  const double limit = 0.5 * liquid.grid.support_radius() / dt;
  if (!(fastest <= limit)) {
    StepFailure::Details details;
    for (std::size_t i = 0; i < n; ++i) {
      const double speed = std::sqrt(speed2_at(i));
      if (speed <= limit) continue;
      details.particle = (*liquid.identifier)[i];
      for (int axis = 0; axis < d; ++axis) details.position[axis] = (*liquid.intermediate[axis])[i];
      details.value = speed;
      break;
    }
    details.cause = std::isfinite(fastest) ? "a particle would cross half its support in one step"
                                           : "a velocity is not a finite number";
    details.option = "time.courant";
    throw StepFailure(details);
  }
  liquid.energy_supply = limited_energy_supply(liquid, dt);

  const double density = liquid.scene.fluid.density;
  parallel_for(n, [&](std::size_t i) {
    Vec3 r{}, u{};
    for (int axis = 0; axis < d; ++axis) {
      u[axis] = (*liquid.predicted[axis])[i];
      r[axis] = (*liquid.intermediate[axis])[i];
    }
    if (liquid.plan.bubbles)
      for (int axis = 0; axis < d; ++axis)
        (*liquid.material_acceleration[axis])[i] = (u[axis] - (*liquid.velocity[axis])[i]) / dt;
    if (liquid.plan.shifting) {
      for (int axis = 0; axis < d; ++axis) r[axis] += (*liquid.shift[axis])[i];
      if (liquid.plan.shift_correction) add_shift_velocity(liquid, i, u);
    }
    apply_walls(liquid, liquid.next_walls, r, &u);
    for (int axis = 0; axis < d; ++axis) {
      (*liquid.position[axis])[i] = r[axis];
      (*liquid.velocity[axis])[i] = u[axis];
    }
    (*liquid.pressure)[i] =
        density * ((*liquid.reduced_pressure)[i] - (liquid.potential == nullptr ? 0.0 : (*liquid.potential)[i]));
  });
  liquid.walls = liquid.next_walls;
  liquid.time += dt;
  liquid.last_steps = {dt, liquid.last_steps[0]};
  ++liquid.steps;
  update_extremes(liquid);
  if (liquid.plan.velocity_gradient) {
    const double nu = liquid.scene.fluid.kinematic_viscosity;
    liquid.dissipation = liquid.scene.fluid.density * liquid.volume * parallel_sum(n, [&](std::size_t i) {
                           const double strain = (*liquid.strain)[i];
                           const double eddy = liquid.eddy_viscosity == nullptr ? 0.0 : (*liquid.eddy_viscosity)[i];
                           return (nu + eddy) * strain * strain;
                         });
  }
}

}  // namespace spume::les_sph
