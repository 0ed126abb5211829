// SPDX-License-Identifier: MIT
#include "spume/physics/bubbles/forces.hpp"

#include <algorithm>
#include <cmath>

#include "spume/core/vectors.hpp"

namespace spume::bubbles {
namespace {

// Drag of King (2.9): Schiller and Naumann (1935), and that of Newton above.
constexpr double schiller_factor = 0.15, schiller_power = 0.687, newton_reynolds = 1000, newton_drag = 0.44;
constexpr double newton_rate = 0.375 * newton_drag;  // 3/8 C_d: drag rate over speed / radius

// Relative change of the speed after which Newton's method has converged: the next would be of the order of its square,
// 1e-10. In a plume 1e-8 changes the slip by 2e-10 %. Should the bracket close to 1e-10 first, at the jump of the
// drag law, it stands there.
constexpr double small_change = 1e-5, closed_bracket = 1e-10;
// More than either method ever needs: bisection halves a bracket to rounding in 53.
constexpr int most_iterations = 100, most_halvings = 200;
constexpr double rounding = 1e-15;

// dw/dt = rate (push - K(|w|) w - w x spin), w = u_l - u_b.
struct Slip {
  double rate;  // beta / (1 + C_vm beta)
  Vec3 push, spin;

  Slip(const Gas& gas, const Surroundings& liquid) {
    const double beta = gas.density_ratio;
    rate = beta / (1 + gas.virtual_mass * beta);
    const double inertia = gas.virtual_mass + (gas.fluid_inertia ? 1 : 0);
    for (std::size_t a = 0; a < 3; ++a) {
      push[a] = -inertia * liquid.acceleration[a] + (1 - 1 / beta) * gas.gravity[a];
      spin[a] = gas.lift * liquid.vorticity[a];
    }
  }
};

// w of k w + w x spin = f, for k > 0.
Vec3 balance(double k, const Vec3& f, const Vec3& spin) {
  const Vec3 turned = cross(f, spin);
  const double along = dot(f, spin) / k, scale = 1 / (k * k + dot(spin, spin));
  Vec3 w;
  for (std::size_t a = 0; a < 3; ++a) w[a] = scale * (k * f[a] - turned[a] + along * spin[a]);
  return w;
}

// Drag rate and its derivative with respect to the speed.
struct Drag {
  double rate, slope;

  Drag(double speed, double radius, double viscosity) : rate(drag_rate(speed, radius, viscosity)), slope(0) {
    if (2 * radius * speed / viscosity > newton_reynolds)
      slope = newton_rate / radius;
    else if (speed > 0)
      slope = schiller_power * (rate - 4.5 * viscosity / (radius * radius)) / speed;
  }
};

// Drag rate at the end of a backward Euler step: that at the root of s = |w(K(s))|, whose right side falls as s rises.
// `speed` and `drag` are those at the start.
double implicit_drag(const Slip& slip, const Vec3& w, double speed, Drag drag, double radius, double viscosity,
                     double dt) {
  const double h = slip.rate * dt;
  Vec3 known, spin;
  for (std::size_t a = 0; a < 3; ++a) {
    known[a] = w[a] + h * slip.push[a];
    spin[a] = h * slip.spin[a];
  }
  // |balance(k, known, spin)|^2 = along^2 / k^2 + across^2 / (k^2 + spin^2).
  const double known2 = dot(known, known), spin2 = dot(spin, spin), common = dot(known, spin);
  const double along2 = spin2 > 0 ? common * common / spin2 : known2, across2 = std::max(0.0, known2 - along2);
  if (!(known2 > 0)) return drag_rate(0, radius, viscosity);
  double low = 0, high = std::sqrt(known2);  // the balance never lengthens what it is given
  double s = speed;
  if (!(s > 0) || !(s < high)) {
    s = high;
    drag = Drag(s, radius, viscosity);
  }
  // Newton's method for s / |w(K(s))| = 1, nearly a straight line; bracketed, so the jump of the drag law does no harm.
  for (int k = 0; k < most_iterations; ++k) {
    const double damping = 1 + h * drag.rate, turning2 = damping * damping + spin2;
    const double root2 = along2 / (damping * damping) + across2 / turning2, root = std::sqrt(root2);
    const double fall = along2 / (damping * damping * damping) + across2 * damping / (turning2 * turning2);
    (s < root ? low : high) = s;
    const double change = (root - s) / (1 + s * h * drag.slope * fall / root2);
    // What is left after this change is of the order of its square.
    if (std::abs(change) < small_change * s) return drag.rate + drag.slope * change;
    s += change;
    if (!(s > low && s < high)) s = 0.5 * (low + high);
    if (high - low <= closed_bracket * high) break;
    drag = Drag(s, radius, viscosity);
  }
  return drag.rate;
}

// Change of the normal velocity by the relaxation alone; `slip_normal` is (u_l - u_b) . n before the step.
double relaxation_of(const Braking& braking, double dt, double slip_normal) {
  return slip_normal * std::min(1.0, dt / std::max(braking.time_left, dt));
}

// The step `change` of a bubble's velocity, with braking.
void brake(const Braking& braking, double dt, double slip_normal, Vec3& change) {
  if (braking.share == 0) return;
  const double along = dot(change, braking.normal);
  const double relaxation = relaxation_of(braking, dt, slip_normal);
  for (std::size_t a = 0; a < 3; ++a) change[a] += braking.share * (relaxation - along) * braking.normal[a];
}

}  // namespace

double drag_coefficient(double bubble_reynolds) {
  if (bubble_reynolds > newton_reynolds) return newton_drag;
  return 24 / bubble_reynolds * (1 + schiller_factor * std::pow(bubble_reynolds, schiller_power));
}

double drag_rate(double speed, double radius, double viscosity) {
  const double bubble_reynolds = 2 * radius * speed / viscosity;
  if (bubble_reynolds > newton_reynolds) return newton_rate * speed / radius;
  return 4.5 * viscosity / (radius * radius) * (1 + schiller_factor * std::pow(bubble_reynolds, schiller_power));
}

double relaxation_time(const Gas& gas, double radius) {
  return (1 / gas.density_ratio + gas.virtual_mass) / drag_rate(0, radius, gas.viscosity);
}

double terminal_speed(const Gas& gas, double radius) {
  const double push = std::abs(1 - 1 / gas.density_ratio) * length(gas.gravity);
  double low = 0, high = push / drag_rate(0, radius, gas.viscosity);  // the drag of Stokes is the least
  for (int k = 0; k < most_halvings && high - low > rounding * high; ++k) {
    const double middle = 0.5 * (low + high);
    (drag_rate(middle, radius, gas.viscosity) * middle < push ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Vec3 advance_stable(const Gas& gas, double radius, const Surroundings& liquid, const Vec3& velocity, double dt,
                    const Braking& braking) {
  const Slip slip(gas, liquid);
  Vec3 w;
  for (std::size_t a = 0; a < 3; ++a) w[a] = liquid.velocity[a] - velocity[a];
  const double speed = length(w);
  const Drag at_start(speed, radius, gas.viscosity);
  const double at_end = implicit_drag(slip, w, speed, at_start, radius, gas.viscosity, dt);
  // Second order in short steps; in long ones the drag at the start is forgotten as fast as the slip there.
  const double weight = 1 / (1 + std::exp(slip.rate * dt * at_end));
  const double drag = weight * at_start.rate + (1 - weight) * at_end;

  const Vec3 steady = balance(drag, slip.push, slip.spin);
  Vec3 rest;
  for (std::size_t a = 0; a < 3; ++a) rest[a] = w[a] - steady[a];
  // d rest/dt = rate (-drag rest + spin x rest): decay and rotation about the spin.
  const double spin = length(slip.spin), angle = slip.rate * spin * dt;
  if (angle > 0) {
    Vec3 axis;
    for (std::size_t a = 0; a < 3; ++a) axis[a] = slip.spin[a] / spin;
    const Vec3 turned = cross(axis, rest);
    const double cosine = std::cos(angle), sine = std::sin(angle), along = (1 - cosine) * dot(axis, rest);
    for (std::size_t a = 0; a < 3; ++a) rest[a] = cosine * rest[a] + sine * turned[a] + along * axis[a];
  }
  const double decay = std::exp(-slip.rate * drag * dt);
  Vec3 change;
  for (std::size_t a = 0; a < 3; ++a) change[a] = w[a] - (steady[a] + decay * rest[a]);
  brake(braking, dt, dot(w, braking.normal), change);
  return {velocity[0] + change[0], velocity[1] + change[1], velocity[2] + change[2]};
}

Vec3 advance_substepped(const Gas& gas, double radius, const Surroundings& liquid, const Vec3& velocity, double dt,
                        double spacing, const Braking& braking) {
  const Slip slip(gas, liquid);
  Vec3 u = velocity, w;
  for (std::size_t a = 0; a < 3; ++a) w[a] = liquid.velocity[a] - u[a];
  // No steady slip is larger than that of either branch of the drag law alone.
  const double push = length(slip.push);
  const double steady = std::min(push / drag_rate(0, radius, gas.viscosity), std::sqrt(push * radius / newton_rate));
  const double fastest = std::max(length(w), steady);
  const double explicit_limit = dt * slip.rate * (drag_rate(fastest, radius, gas.viscosity) + length(slip.spin));
  const double steps = std::ceil(std::max({1.0, spacing / radius, substeps_per_relaxation * explicit_limit}));
  const double part = dt / steps;
  Braking left = braking;
  for (double k = 0; k < steps; ++k) {
    for (std::size_t a = 0; a < 3; ++a) w[a] = liquid.velocity[a] - u[a];
    const double drag = drag_rate(length(w), radius, gas.viscosity);
    const Vec3 turned = cross(w, slip.spin);
    Vec3 change;
    for (std::size_t a = 0; a < 3; ++a) change[a] = -part * slip.rate * (slip.push[a] - drag * w[a] - turned[a]);
    left.time_left = std::max(braking.time_left, dt) - k * part;
    brake(left, part, dot(w, braking.normal), change);
    for (std::size_t a = 0; a < 3; ++a) u[a] += change[a];
  }
  return u;
}

Vec3 braking_force(const Gas& gas, double radius, const Surroundings& liquid, const Vec3& velocity, double slip_normal,
                   double dt, const Braking& braking) {
  const Slip slip(gas, liquid);
  Vec3 w, force;
  for (std::size_t a = 0; a < 3; ++a) w[a] = liquid.velocity[a] - velocity[a];
  const double drag = drag_rate(length(w), radius, gas.viscosity);
  const Vec3 turned = cross(w, slip.spin);
  for (std::size_t a = 0; a < 3; ++a) force[a] = slip.push[a] - drag * w[a] - turned[a];
  const double size =
      braking.share * (dot(force, braking.normal) + relaxation_of(braking, dt, slip_normal) / (dt * slip.rate));
  return {size * braking.normal[0], size * braking.normal[1], size * braking.normal[2]};
}

Vec3 reaction(const Gas& gas, double volume, const Surroundings& liquid, const Vec3& change, double dt,
              bool pressure_holds_inertia) {
  const double beta = gas.density_ratio;
  Vec3 force;
  for (std::size_t a = 0; a < 3; ++a) {
    force[a] = volume * (-change[a] / (dt * beta) + (1 - beta) / beta * gas.gravity[a]);
    if (gas.fluid_inertia && pressure_holds_inertia) force[a] += volume * liquid.acceleration[a];
  }
  return force;
}

}  // namespace spume::bubbles
