// SPDX-License-Identifier: MIT
#include "spume/physics/point_particles/motion.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "spume/core/parallel.hpp"

namespace spume {
namespace {

// What the step multiplies its terms by; one set serves all particles when tau is common.
struct StepCoefficients {
  double half_decay, half_drift;                             // V at mid-step
  double decay, approach, drift, trend;                      // V'
  double from_velocity, from_fluid, from_drift, from_trend;  // X' - X

  StepCoefficients(double dt, double tau) {
    const double h = dt / tau;
    const RelaxationCoefficients whole = relaxation_coefficients(h), half = relaxation_coefficients(h / 2);
    half_decay = half.decay;
    half_drift = dt / 2 * half.phi1;
    decay = whole.decay;
    approach = h * whole.phi1;
    drift = dt * whole.phi1;
    trend = dt * h * (whole.phi2 - whole.phi1 / 2);
    from_velocity = dt * whole.phi1;
    from_fluid = dt * h * whole.phi2;
    from_drift = dt * dt * whole.phi2;
    from_trend = dt * dt * (whole.phi1 / 2 - whole.phi2);
  }
};

struct Sums {
  double velocity = 0, acceleration = 0, slip = 0, max_speed_2 = 0;
};

double larger(double a, double b) {
  return (a > b || a != a) ? a : b;
}

// The velocity that a particle sees of its own force: mean over the step, and change.
struct Disturbance {
  double mean[3], change[3];
};

// Advances the disturbance of particle p by the force that the flow had in the step: with F the mean force of the step
// before that and A the one extrapolated from it, the flow had A, and F + share (A - F) in its step before.
Disturbance advance_disturbance(const DisturbanceStep& self, Particles& particles, const double* amounts, std::size_t p,
                                const std::array<double, 3>& place, double speed_2) {
  const std::array<double, 3> factor = self.disturbance->place_factor(place);
  Disturbance out{};
  for (std::size_t b = 0; b < particles.disturbance.size(); ++b) {
    const SelfDisturbance::Step::Band& band = self.step.band[b];
    const double left = SelfDisturbance::swept(band, speed_2);
    for (std::size_t c = 0; c < 3; ++c) {
      const double now = amounts[3 * p + c], mean = (*particles.force[c])[p];
      double& velocity = (*particles.disturbance[b][c])[p];
      const double next = left * (band.decay[c] * velocity + band.now[c] * now +
                                  band.before[c] * (mean + self.force_share * (now - mean)));
      const double seen = b == 0 ? factor[c] : 1;
      out.mean[c] += seen * (velocity + next) / 2;
      out.change[c] += seen * (next - velocity);
      velocity = next;
    }
  }
  return out;
}

template <int order, bool common_time, bool undisturbed, class Real>
Sums move_range(const MotionModel& model, const SplineField<Real>& field, double dt, const StepCoefficients& common,
                Particles& particles, const ForceOutput& output, std::size_t first, std::size_t last) {
  const PeriodicGrid& grid = field.grid();
  double* X[3] = {particles.position[0]->data(), particles.position[1]->data(), particles.position[2]->data()};
  double* V[3] = {particles.velocity[0]->data(), particles.velocity[1]->data(), particles.velocity[2]->data()};
  const double beta = model.beta, inverse_dt = 1 / dt;
  const double signed_rate = field.present_is_second() ? inverse_dt : -inverse_dt;
  const double density_ratio = output.amounts == nullptr ? 0 : model.density_ratio();
  const double common_volume = sphere_volume(particles.common_diameter);
  Sums sums;
  for (std::size_t p = first; p < last; ++p) {
    double middle[3], v[3];
    for (int c = 0; c < 3; ++c) {
      v[c] = V[c][p];
      middle[c] = wrap_periodic(X[c][p] + 0.5 * dt * v[c], grid.lower[c], grid.length[c]);
    }
    const SplineStencil<order, Real> stencil(field, middle);
    const FieldSample<Real> at = sample(field, stencil);
    double u[3] = {}, gradient[3][3], change[3], material[3], drift[3];
    for (int c = 0; c < 3; ++c) {
      u[c] = 0.5 * (at.value.first(c) + at.value.second(c));
      change[c] = (at.value.second(c) - at.value.first(c)) * signed_rate;
      for (int axis = 0; axis < 3; ++axis)
        gradient[c][axis] = 0.5 * (at.slope[axis].first(c) + at.slope[axis].second(c));
    }
    if constexpr (undisturbed) {
      std::array<double, 3> place;
      double speed_2 = 0;
      for (int c = 0; c < 3; ++c) {
        const double points = (middle[c] - grid.lower[c]) * grid.inverse_spacing(c);
        place[static_cast<std::size_t>(c)] = points - std::floor(points);
        speed_2 += (u[c] - v[c]) * (u[c] - v[c]);
      }
      const Disturbance own = advance_disturbance(output.self, particles, output.amounts, p, place, speed_2);
      for (int c = 0; c < 3; ++c) {
        u[c] -= own.mean[c];
        change[c] -= own.change[c] * inverse_dt;
      }
    }
    for (int c = 0; c < 3; ++c) {
      material[c] = change[c] + u[0] * gradient[c][0] + u[1] * gradient[c][1] + u[2] * gradient[c][2];
      drift[c] = beta * material[c] + (1 - beta) * model.gravity[c];
    }

    const StepCoefficients* k = &common;
    StepCoefficients own = common;
    if constexpr (!common_time) {
      const double diameter = particles.diameter_of(p);
      const double ratio = diameter / particles.common_diameter;
      double tau = model.response_time * ratio * ratio;
      if (model.drag == DragLaw::schiller_naumann) {
        // The slip at mid-step sets the drag; it is reached from the slip at the start, by the drag of that.
        const auto slip_of = [&](const double(&velocity)[3]) {
          return std::sqrt((u[0] - velocity[0]) * (u[0] - velocity[0]) + (u[1] - velocity[1]) * (u[1] - velocity[1]) +
                           (u[2] - velocity[2]) * (u[2] - velocity[2]));
        };
        const double h = 0.5 * dt * schiller_naumann_factor(slip_of(v), diameter, model.viscosity) / tau;
        const RelaxationCoefficients half = relaxation_coefficients(h);
        double mid[3];
        for (int c = 0; c < 3; ++c) mid[c] = u[c] + half.decay * (v[c] - u[c]) + 0.5 * dt * half.phi1 * drift[c];
        tau /= schiller_naumann_factor(slip_of(mid), diameter, model.viscosity);
      }
      own = StepCoefficients(dt, tau);
      k = &own;
    }

    double middle_velocity[3];
    for (int c = 0; c < 3; ++c) middle_velocity[c] = u[c] + k->half_decay * (v[c] - u[c]) + k->half_drift * drift[c];
    double next[3], acceleration[3];
    for (int c = 0; c < 3; ++c) {
      const double trend = change[c] + middle_velocity[0] * gradient[c][0] + middle_velocity[1] * gradient[c][1] +
                           middle_velocity[2] * gradient[c][2];
      const double moved =
          k->from_velocity * v[c] + k->from_fluid * u[c] + k->from_drift * drift[c] + k->from_trend * trend;
      next[c] = k->decay * v[c] + k->approach * u[c] + k->drift * drift[c] + k->trend * trend;
      if (model.frozen) next[c] = 0;
      acceleration[c] = (next[c] - v[c]) * inverse_dt;
      V[c][p] = next[c];
      if (!model.frozen) X[c][p] = wrap_periodic(X[c][p] + moved, grid.lower[c], grid.length[c]);
    }
    if (output.amounts != nullptr) {
      const double volume = particles.diameter == nullptr ? common_volume : sphere_volume((*particles.diameter)[p]);
      for (int c = 0; c < 3; ++c) {
        const double force =
            volume * (material[c] - density_ratio * acceleration[c] - (1 - density_ratio) * model.gravity[c]);
        double& kept = (*particles.force[c])[p];
        output.amounts[3 * p + c] = force + output.extrapolation * (force - kept);
        kept = force;
      }
    }

    double speed_2 = 0;
    for (int c = 0; c < 3; ++c) {
      speed_2 += next[c] * next[c];
      sums.acceleration += acceleration[c] * acceleration[c];
      sums.slip += (u[c] - middle_velocity[c]) * (u[c] - middle_velocity[c]);
    }
    sums.velocity += speed_2;
    sums.max_speed_2 = larger(sums.max_speed_2, speed_2);
  }
  return sums;
}

}  // namespace

double schiller_naumann_factor(double slip, double diameter, double viscosity) {
  return 1 + 0.15 * std::pow(slip * diameter / viscosity, 0.687);
}

RelaxationCoefficients relaxation_coefficients(double h) {
  // Below 1/4, (1 - phi1) / h loses digits; ten terms of phi2 = sum_k (-h)^k / (k+2)! leave 1e-15.
  if (h < 0.25) {
    double phi2 = 0;
    for (int k = 9; k >= 0; --k) phi2 = 1.0 / (k + 2) * (k == 9 ? 1.0 : (1 - h * phi2));
    const double phi1 = 1 - h * phi2;
    return {1 - h * phi1, phi1, phi2};
  }
  const double decay = std::exp(-h);
  const double phi1 = -std::expm1(-h) / h;
  return {decay, phi1, (1 - phi1) / h};
}

template <class Real>
MotionStatistics move_particles(const MotionModel& model, const SplineField<Real>& field, double dt,
                                Particles& particles, const ForceOutput& output) {
  const std::size_t n = particles.size();
  const StepCoefficients common(dt, model.response_time);
  const bool common_time = particles.diameter == nullptr && model.drag == DragLaw::stokes;
  Sums sums;
  with_spline_order(field.order(), [&](auto order) {
    const auto over = [&](auto common_drag, auto undisturbed) {
      return [&](std::size_t first, std::size_t last) {
        return move_range<order(), common_drag(), undisturbed()>(model, field, dt, common, particles, output, first,
                                                                 last);
      };
    };
    const auto add = [](Sums a, const Sums& b) {
      a.velocity += b.velocity;
      a.acceleration += b.acceleration;
      a.slip += b.slip;
      a.max_speed_2 = larger(a.max_speed_2, b.max_speed_2);
      return a;
    };
    const auto sum = [&](auto undisturbed) {
      return common_time ? parallel_reduce(n, Sums{}, over(std::true_type{}, undisturbed), add)
                         : parallel_reduce(n, Sums{}, over(std::false_type{}, undisturbed), add);
    };
    sums = output.self.disturbance != nullptr ? sum(std::true_type{}) : sum(std::false_type{});
  });
  const double inverse = n == 0 ? 0 : 1 / static_cast<double>(n);
  return {sums.velocity * inverse, sums.acceleration * inverse, sums.slip * inverse, std::sqrt(sums.max_speed_2)};
}

template MotionStatistics move_particles(const MotionModel&, const SplineField<double>&, double, Particles&,
                                         const ForceOutput&);
template MotionStatistics move_particles(const MotionModel&, const SplineField<float>&, double, Particles&,
                                         const ForceOutput&);

}  // namespace spume
